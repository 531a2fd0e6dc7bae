//! `scan`.

mod by_nodes;

use super::Report;
use super::points::{self, Target};
use crate::error::CliError;
use crate::image_io::{PixelRect, Stamp};
use crate::options::{ScanOptions, layer_list};
use crate::points::{Colouring, Drawn, Legend, PointLayer, are_drawn_by_nodes, window_of};
use crate::scan::{LoadOptions, ScanSet};
use crate::scene::Camera;
use pointillist_ibpr as ibpr;

/// Layers of a scan's picture.
const LAYERS: [PointLayer; 3] = [PointLayer::Normal, PointLayer::Position, PointLayer::Count];

/// What is chosen for the picture of a run.
struct Picture<'a> {
    options: &'a ScanOptions,
    report: &'a Report<'a>,
    target: Target<'a>,
    colouring: Colouring,
    layers: Vec<PointLayer>,
    region: PixelRect,
    window: PixelRect,
}

pub(super) fn run(options: &ScanOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.reading(&options.files)?;
    let path = points::output_path(options.output.as_deref(), &options.files[0]);
    let target = Target::new(path, &options.picture, !options.layers.is_empty())?;
    let colouring = target.colouring(&options.look)?;
    let (region, window) = points::check_view(&options.camera)?;
    let layers = layer_list(&options.layers, &LAYERS).unwrap_or_default();
    let picture = Picture { options, report: &report, target, colouring, layers, region, window };
    if are_drawn_by_nodes(&options.files, options.octree) {
        by_nodes::draw(&picture)?;
    } else {
        picture.draw_whole()?;
    }
    report.finish()
}

impl Picture<'_> {
    /// Draws files that are read as a whole.
    fn draw_whole(&self) -> Result<(), CliError> {
        let (options, report) = (self.options, self.report);
        let load = LoadOptions {
            points: options.reading(),
            spacing: options.surface.spacing,
            vertices: options.vertices,
        };
        let mut set = report.stats.stage("load", || ScanSet::load(&options.files, &load))?;
        let camera = points::camera(&options.camera, set.view.as_ref(), None, || set.positions())?;
        let size = points::size(&options.camera);
        report.stats.stage("prepare", || set.cover_meshes(&camera, size, options.surface.spacing));
        set.warnings.iter().for_each(|warning| report.warn(warning));
        if set.dropped > 0 {
            report.warn(&format!("{} points that are not finite were left out", set.dropped));
        }
        let legend = report.stats.stage("prepare", || set.colour(&self.colouring));
        let frame_options = options.frame_options(set.has_translucent());
        let cloud = report.stats.stage("prepare", || set.cloud(frame_options.base))?;
        let stamp = self.stamp(set.fingerprint(), &frame_options, &camera);
        if self.target.is_done(&stamp, self.window, report) {
            return Ok(());
        }
        let view = camera.view(size).map_err(|error| CliError::Usage(error.to_string()))?;
        self.draw_cloud(&cloud, &view, frame_options, (legend, stamp))
    }

    /// What the picture is made from; `points` is the fingerprint of the points.
    fn stamp(&self, points: u64, frame_options: &ibpr::Options, camera: &Camera) -> Stamp {
        let options = self.options;
        let size = points::size(&options.camera);
        let paint = (self.colouring.by, options.look.legend, options.picture.float, options.picture.bg);
        let drawn = format!("{:?}", (frame_options, camera, size, &self.layers, paint));
        points::stamp(points, &drawn, &options.camera, self.region)
    }

    /// Draws points that are ready, and writes the picture.
    fn draw_cloud(
        &self,
        cloud: &ibpr::Cloud,
        view: &ibpr::View,
        frame_options: ibpr::Options,
        (legend, stamp): (Option<Legend>, Stamp),
    ) -> Result<(), CliError> {
        let (options, report, window) = (self.options, self.report, self.window);
        let mut frame = ibpr::Frame::default();
        // Not part of what tiles know one another by.
        let frame_options = frame_options.with_window(window);
        report.stats.stage("draw", || draw(options, cloud, view, &frame_options, &mut frame, report))?;
        tell_counts(report, cloud, &frame, points::is_whole(window, points::size(&options.camera)));
        let picture = window_of(&as_drawn(&frame), window, &self.layers, view, self.colouring.by);
        let legend = legend.filter(|_| options.look.legend);
        self.target.finish(picture, (legend, stamp), cloud.len(), report)
    }
}

fn as_drawn(frame: &ibpr::Frame) -> Drawn<'_> {
    Drawn {
        width: frame.width(),
        height: frame.height(),
        colour: frame.color(),
        depth: frame.depth(),
        normal: frame.normal(),
        count: frame.count(),
    }
}

fn draw(
    options: &ScanOptions,
    cloud: &ibpr::Cloud,
    view: &ibpr::View,
    frame_options: &ibpr::Options,
    frame: &mut ibpr::Frame,
    report: &Report<'_>,
) -> Result<(), CliError> {
    // All that the renderer can refuse now is a value of an option.
    let usage = |error: ibpr::IbprError| CliError::Usage(error.to_string());
    let mut renderer = ibpr::Renderer::new();
    points::repeat(report, options.repeat, || renderer.draw(cloud, view, frame_options, frame).map_err(usage))
}

fn tell_counts(report: &Report<'_>, cloud: &ibpr::Cloud, frame: &ibpr::Frame, is_whole: bool) {
    let counts = frame.counts();
    let stats = &report.stats;
    stats.count("points", cloud.len() as u64);
    stats.count("points_drawn", counts.points as u64);
    stats.count("blocks", counts.blocks as u64);
    stats.skip("points", counts.points_skipped as u64);
    stats.skip("blocks_outside", counts.blocks_outside as u64);
    stats.skip("blocks_facing_away", counts.blocks_facing_away as u64);
    report.detail(&format!(
        "spacing {:.4e} (all scans together {:.4e}), S = {:.2}",
        cloud.spacing(),
        cloud.density_spacing(),
        counts.scale
    ));
    // A part of the picture may well be empty.
    if is_whole && frame.depth().iter().all(|d| d.is_infinite()) {
        report.warn(if counts.points > 0 {
            "nothing was drawn: too few points are near one another; try a larger --scale or --spacing"
        } else if counts.blocks_facing_away > 0 {
            "nothing was drawn: all scans in view face away; --no-cull draws them from behind"
        } else {
            "nothing was drawn: no point is in view; without --eye and --target all are"
        });
    }
}
