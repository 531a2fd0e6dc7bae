//! `surfel`.

use super::Report;
use super::points::{self, Target};
use crate::error::CliError;
use crate::image_io::{PixelRect, Stamp};
use crate::options::{SurfelOptions, layer_list};
use crate::points::{Colouring, Drawn, Legend, PointLayer, PointSet, Trees, are_drawn_by_nodes, window_of};
use crate::scene::Camera;
use pointillist_octree::{Cut, Region};
use pointillist_surfel as surfel;
use pointillist_view::View;

/// Pixels around the picture of which points are read: discs, and what is out of focus, reach into it.
const MARGIN_PX: f64 = 64.0;

/// Layers of a cloud's picture.
const LAYERS: [PointLayer; 2] = [PointLayer::Normal, PointLayer::Position];

/// What is chosen for all pictures of a run.
struct Pictures<'a> {
    options: &'a SurfelOptions,
    report: &'a Report<'a>,
    colouring: Colouring,
    layers: Vec<PointLayer>,
    frame_options: surfel::Options,
    region: PixelRect,
    window: PixelRect,
}

/// Where points come from.
enum Source {
    /// All are in memory.
    Whole { cloud: Box<surfel::Cloud>, legend: Option<Legend>, fingerprint: u64 },
    /// Each view reads what it needs. Views of the same nodes, one after the other, share what is made of these.
    Trees { trees: Box<Trees>, ready: Option<Box<Ready>> },
}

/// The points of some nodes, ready to be drawn.
struct Ready {
    regions: Vec<Region>,
    cloud: surfel::Cloud,
    legend: Option<Legend>,
}

pub(super) fn run(options: &SurfelOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.reading(&options.clouds)?;
    let path = points::output_path(options.output.as_deref(), &options.clouds[0]);
    let views = options.views.as_deref().map(points::read_views).transpose()?;
    let paths = points::output_paths(&path, views.as_ref().map(Vec::len))?;
    let with_layers = !options.layers.is_empty();
    let targets = paths
        .into_iter()
        .map(|path| Target::new(path, &options.picture, with_layers))
        .collect::<Result<Vec<_>, _>>()?;
    let layers = layer_list(&options.layers, &LAYERS)
        .map_err(|_| CliError::Usage("layers of `surfel` are all, N and P".to_owned()))?;
    let (region, window) = points::check_view(&options.camera)?;
    let pictures = Pictures {
        options,
        report: &report,
        colouring: targets[0].colouring(&options.look)?,
        layers,
        frame_options: options.frame_options().map_err(CliError::Usage)?,
        region,
        window,
    };
    let fov_deg = options.lens_fov_deg().map_err(CliError::Usage)?;
    let mut source = pictures.load()?;
    let given = match views {
        None => vec![options.camera.clone()],
        Some(views) => views.iter().map(|view| view.of(&options.camera)).collect(),
    };
    let framed = match &mut source {
        Source::Whole { cloud, .. } => cloud.positions().collect(),
        Source::Trees { trees, .. } => trees.outline()?.positions().collect::<Vec<_>>(),
    };
    let cameras = given
        .iter()
        .map(|given| points::camera(given, None, fov_deg, || framed.iter().copied()))
        .collect::<Result<Vec<_>, _>>()?;
    drop(framed);
    for (camera, target) in cameras.iter().zip(&targets) {
        pictures.draw(camera, target, &mut source)?;
    }
    if let Source::Trees { trees, .. } = &source {
        points::count_nodes(&report, trees);
        report.stats.count("parts_made", trees.parts_made);
        report.stats.skip("parts_kept", trees.parts_kept);
    }
    report.finish()
}

impl Pictures<'_> {
    fn load(&self) -> Result<Source, CliError> {
        let (options, report) = (self.options, self.report);
        if are_drawn_by_nodes(&options.clouds, options.octree) {
            let progress = report.progress();
            let tell = |line: &str| report.note(line);
            let open = || Trees::open(&options.clouds, options.reading(), self.colouring, &progress, &tell);
            let trees = Box::new(report.stats.stage("load", open)?);
            return Ok(Source::Trees { trees, ready: None });
        }
        let mut set = report.stats.stage("load", || PointSet::load(&options.clouds, &options.reading()))?;
        set.warnings.iter().for_each(|warning| report.warn(warning));
        let (cloud, legend) = self.prepare(&mut set)?;
        Ok(Source::Whole { cloud: Box::new(cloud), legend, fingerprint: set.fingerprint() })
    }

    fn prepare(&self, set: &mut PointSet) -> Result<(surfel::Cloud, Option<Legend>), CliError> {
        self.report.stats.stage("prepare", || {
            let legend = set.colour(&self.colouring);
            Ok((set.cloud(self.options.discs.estimate_normals)?, legend))
        })
    }

    /// Draws one view, unless its picture is there already.
    fn draw(&self, camera: &Camera, target: &Target<'_>, source: &mut Source) -> Result<(), CliError> {
        let (options, report) = (self.options, self.report);
        let size = points::size(&options.camera);
        let paint = (self.colouring.by, options.look.legend, options.picture.float, options.picture.bg);
        let drawn = format!("{:?}", (self.frame_options, camera, size, &self.layers, paint));
        let stamp = |fingerprint| points::stamp(fingerprint, &drawn, &options.camera, self.region);
        let view = camera.view(size).map_err(|error| CliError::Usage(error.to_string()))?;
        match source {
            Source::Whole { cloud, legend, fingerprint } => {
                let stamp = stamp(*fingerprint);
                if target.is_done(&stamp, self.window, report) {
                    return Ok(());
                }
                self.draw_cloud(cloud, legend.clone(), &view, target, stamp)
            }
            Source::Trees { trees, ready } => {
                // Twice as close as the level that is drawn, as points of a node are not on a lattice.
                let spacing_px = 0.7 * f64::from(self.frame_options.level).max(0.5);
                let cut = trees.cut(&view, spacing_px, MARGIN_PX);
                let stamp = stamp(trees.fingerprint(&cut));
                if target.is_done(&stamp, self.window, report) {
                    return Ok(());
                }
                self.draw_trees(trees, ready, (&cut, &view), target, stamp)
            }
        }
    }

    /// A coarse picture first, then that of all points that the view needs.
    fn draw_trees(
        &self,
        trees: &mut Trees,
        ready: &mut Option<Box<Ready>>,
        (cut, view): (&Cut, &View),
        target: &Target<'_>,
        stamp: Stamp,
    ) -> Result<(), CliError> {
        let coarse = trees.coarse(cut).filter(|_| self.options.views.is_none());
        points::draw_coarse_first((coarse, cut), target, stamp, self.report, |cut, stamp| {
            self.draw_cut(trees, ready, cut, view, target, stamp)
        })
    }

    fn draw_cut(
        &self,
        trees: &mut Trees,
        ready: &mut Option<Box<Ready>>,
        cut: &Cut,
        view: &View,
        target: &Target<'_>,
        stamp: Stamp,
    ) -> Result<(), CliError> {
        let regions = trees.regions(cut, view, MARGIN_PX);
        let made = match ready.take() {
            Some(ready) if ready.regions == regions => {
                self.report.stats.skip("clouds_made_ready", 1);
                ready
            }
            other => {
                // Before the next is made: both together may be too much.
                drop(other);
                Box::new(self.make_ready(trees, regions)?)
            }
        };
        let Ready { cloud, legend, .. } = &**ready.insert(made);
        self.draw_cloud(cloud, legend.clone(), view, target, stamp)
    }

    fn make_ready(&self, trees: &mut Trees, regions: Vec<Region>) -> Result<Ready, CliError> {
        let report = self.report;
        let progress = report.progress();
        let estimate_normals = self.options.discs.estimate_normals;
        let made = report.stats.stage("prepare", || {
            let mut has_begun = false;
            trees.ready(&regions, estimate_normals, &mut |octants, of| {
                if !std::mem::replace(&mut has_begun, true) {
                    progress.begin("prepare", of);
                }
                progress.advance(octants);
            })
        })?;
        progress.finish();
        let message = "no point is in view; without --eye, --target and --views all are";
        let (cloud, legend) = made.ok_or_else(|| CliError::Usage(message.to_owned()))?;
        Ok(Ready { regions, cloud, legend })
    }

    fn draw_cloud(
        &self,
        cloud: &surfel::Cloud,
        legend: Option<Legend>,
        view: &View,
        target: &Target<'_>,
        stamp: Stamp,
    ) -> Result<(), CliError> {
        let (options, report) = (self.options, self.report);
        let mut frame = surfel::Frame::default();
        // Not part of what tiles know one another by.
        let frame_options = self.frame_options.with_window(self.window);
        report.stats.stage("draw", || {
            // All that the renderer can refuse now is a value of an option.
            let usage = |error: surfel::SurfelError| CliError::Usage(error.to_string());
            let mut renderer = surfel::Renderer::new();
            points::repeat(report, options.repeat, || {
                renderer.draw(cloud, view, &frame_options, &mut frame).map_err(usage)
            })
        })?;
        tell_counts(report, cloud, &frame, points::is_whole(self.window, points::size(&options.camera)));
        let picture = window_of(&as_drawn(&frame), self.window, &self.layers, view, self.colouring.by);
        let legend = legend.filter(|_| options.look.legend);
        target.finish(picture, (legend, stamp), cloud.len(), report)
    }
}

fn as_drawn(frame: &surfel::Frame) -> Drawn<'_> {
    Drawn {
        width: frame.width(),
        height: frame.height(),
        colour: frame.color(),
        depth: frame.depth(),
        normal: frame.normal(),
        count: &[],
    }
}

fn tell_counts(report: &Report<'_>, cloud: &surfel::Cloud, frame: &surfel::Frame, is_whole: bool) {
    let counts = frame.counts();
    let stats = &report.stats;
    stats.count("points", cloud.len() as u64);
    stats.count("points_drawn", counts.points as u64);
    stats.count("links_drawn", counts.links as u64);
    stats.count("nodes", counts.nodes as u64);
    stats.skip("nodes_hidden", counts.nodes_hidden as u64);
    stats.skip("nodes_outside", counts.nodes_outside as u64);
    stats.skip("nodes_facing_away", counts.nodes_facing_away as u64);
    report.detail(&format!(
        "spacing {:.4e}, {:.1} bytes per point beside its attributes",
        cloud.spacing(),
        cloud.overhead_per_point()
    ));
    let seen = || frame.depth().iter().copied().filter(|d| d.is_finite());
    if let Some(nearest) = seen().min_by(f32::total_cmp) {
        let farthest = seen().fold(nearest, f32::max);
        report.detail(&format!(
            "seen from {nearest:.4} to {farthest:.4} along the view axis: --focus goes there"
        ));
    } else if is_whole {
        // A part of the picture may well be empty.
        report.warn(if counts.points > 0 {
            "nothing was drawn: points are too far apart to cover a pixel, or blurred too much"
        } else if counts.nodes_facing_away > 0 {
            "nothing was drawn: everything in view faces away; --estimate-normals looks for the outside itself"
        } else {
            "nothing was drawn: no point is in view; without --eye and --target all are"
        });
    }
}
