//! `surfel`.

use super::Report;
use super::points::{self, Target};
use crate::error::CliError;
use crate::options::{SurfelOptions, layer_list};
use crate::points::{Drawn, PointLayer, PointSet, window_of};
use pointillist_surfel as surfel;

/// Layers of a cloud's picture.
const LAYERS: [PointLayer; 2] = [PointLayer::Normal, PointLayer::Position];

pub(super) fn run(options: &SurfelOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.reading(&options.clouds)?;
    let path = points::output_path(options.output.as_deref(), &options.clouds[0]);
    let target = Target::new(path, &options.picture, !options.layers.is_empty())?;
    let colouring = target.colouring(&options.look)?;
    let layers = layer_list(&options.layers, &LAYERS)
        .map_err(|_| CliError::Usage("layers of `surfel` are all, N and P".to_owned()))?;
    let frame_options = options.frame_options().map_err(CliError::Usage)?;
    let fov_deg = options.lens_fov_deg().map_err(CliError::Usage)?;
    let (region, window) = points::check_view(&options.camera)?;
    let mut set = report.stats.stage("load", || PointSet::load(&options.clouds, &options.reading()))?;
    set.warnings.iter().for_each(|warning| report.warn(warning));
    let legend = report.stats.stage("prepare", || set.colour(&colouring));
    let cloud = report.stats.stage("prepare", || set.cloud(options.discs.estimate_normals))?;
    let camera = points::camera(&options.camera, None, fov_deg, || cloud.positions())?;
    let size = points::size(&options.camera);
    let paint = (colouring.by, options.look.legend, options.picture.float, options.picture.bg);
    let drawn = format!("{:?}", (frame_options, &camera, size, &layers, paint));
    let stamp = points::stamp(set.fingerprint(), &drawn, &options.camera, region);
    if target.is_done(&stamp, window, &report) {
        return report.finish();
    }
    drop(set);
    let view = camera.view(size).map_err(|error| CliError::Usage(error.to_string()))?;
    let mut frame = surfel::Frame::default();
    // Not part of what tiles know one another by.
    let frame_options = frame_options.with_window(window);
    report.stats.stage("draw", || {
        // All that the renderer can refuse now is a value of an option.
        let usage = |error: surfel::SurfelError| CliError::Usage(error.to_string());
        let mut renderer = surfel::Renderer::new();
        points::repeat(&report, options.repeat, || {
            renderer.draw(&cloud, &view, &frame_options, &mut frame).map_err(usage)
        })
    })?;
    tell_counts(&report, &cloud, &frame, points::is_whole(window, size));
    let mut picture = window_of(&as_drawn(&frame), window, &layers, &view, colouring.by);
    target.explain(&mut picture, legend.filter(|_| options.look.legend), &report);
    report.stats.stage("write", || target.write(picture, stamp))?;
    let seconds = report.stats.elapsed().as_secs_f64();
    report.note(&format!("{}: {} points in {seconds:.2} s", target.path.display(), cloud.len()));
    report.finish()
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
            "nothing was drawn: everything in view faces away; --estimate-normals shows both sides"
        } else {
            "nothing was drawn: no point is in view; without --eye and --target all are"
        });
    }
}
