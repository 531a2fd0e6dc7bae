//! Clouds of which a picture reads the nodes that it needs.

use super::{CliError, Picture};
use crate::commands::points;
use crate::image_io::Stamp;
use crate::input;
use crate::input_error::InputError;
use crate::options::ScanOptions;
use crate::points::{Density, PointSet, Trees, has_faces, has_nodes};
use pointillist_ibpr as ibpr;
use pointillist_octree::Cut;

/// Pixels around the picture of which points are read: surfaces are fitted to what is around them.
const MARGIN_PX: f64 = 64.0;

/// How far apart points are where there are enough of them, pixels: as for discs.
const SPACING_PX: f64 = 1.0;

/// Draws clouds by their nodes: a coarse picture first, then that of all points that the view needs.
pub(super) fn draw(picture: &Picture<'_>) -> Result<(), CliError> {
    let Picture { options, report, .. } = *picture;
    refuse_others(options)?;
    let progress = report.progress();
    let tell = |line: &str| report.note(line);
    let open = || Trees::open(&options.files, options.reading(), picture.colouring, &progress, &tell);
    let mut trees = report.stats.stage("load", open)?;
    let outline = report.stats.stage("load", || trees.outline())?;
    let camera = points::camera(&options.camera, None, None, || outline.positions())?;
    let frame_options = options.frame_options(outline.has_translucent());
    let size = points::size(&options.camera);
    let view = camera.view(size).map_err(|error| CliError::Usage(error.to_string()))?;
    let cut = trees.cut(&view, SPACING_PX, MARGIN_PX);
    let stamp = picture.stamp(trees.fingerprint(&cut), &frame_options, &camera);
    if picture.target.is_done(&stamp, picture.window, report) {
        return Ok(());
    }
    let coarse = trees.coarse(&cut);
    points::draw_coarse_first((coarse, &cut), &picture.target, stamp, report, |cut, stamp| {
        draw_cut(picture, &mut trees, cut, &view, stamp)
    })?;
    points::count_nodes(report, &trees);
    Ok(())
}

/// Refuses what has no nodes, and none can be made of.
fn refuse_others(options: &ScanOptions) -> Result<(), CliError> {
    for path in &options.files {
        let kind = input::kind_of(path)?;
        let what = match kind.as_str() {
            _ if has_nodes(path) => continue,
            "conf" => "a list of scans",
            "obj" => "a mesh",
            _ if has_faces(path) && !options.vertices => "a mesh",
            _ => continue,
        };
        let message = format!("is {what}, which is not drawn together with clouds by their nodes");
        let help = "leave --octree away; clouds without nodes of their own (.copc.laz, .octree) are then read as a whole, if they fit into memory. \
                    `pointillist sample` makes a cloud of a mesh, and --vertices takes its vertices";
        return Err(InputError::of_file(input::name_of(path), message).with_help(help).into());
    }
    Ok(())
}

fn draw_cut(
    picture: &Picture<'_>,
    trees: &mut Trees,
    cut: &Cut,
    view: &ibpr::View,
    stamp: Stamp,
) -> Result<(), CliError> {
    let Picture { options, report, .. } = *picture;
    let progress = report.progress();
    let regions = trees.regions(cut, view, MARGIN_PX);
    let nodes = trees.nodes_of(&regions);
    progress.begin("read", nodes.len() as u64);
    let (sets, legend) = report.stats.stage("load", || trees.load(&nodes, &mut || progress.advance(1)))?;
    progress.finish();
    if sets.is_empty() {
        let message = "no point is in view; without --eye and --target all are";
        return Err(CliError::Usage(message.to_owned()));
    }
    let mut frame_options = options.frame_options(sets.iter().any(PointSet::has_translucent));
    let density = report.stats.stage("prepare", || trees.density(&regions, view))?;
    // Points are about as far apart in the picture near the eye as far away, so that no one distance in the world says how large its pixels should be.
    if let (Some(Density { spacing_px, .. }), ibpr::Scale::Auto(factor)) = (density, frame_options.scale) {
        frame_options.scale = ibpr::Scale::Spaced { factor, spacing_px: spacing_px.max(0.1) as f32 };
    }
    let spacing = options.surface.spacing.or(density.map(|density| density.spacing));
    let scans: Vec<ibpr::Scan<'_>> =
        sets.iter().map(|set| set.as_scan(spacing.filter(|s| *s > 0.0 && s.is_finite()))).collect();
    let cloud = report
        .stats
        .stage("prepare", || ibpr::Cloud::new(&scans, frame_options.base))
        .map_err(|error| CliError::Failed(error.to_string()))?;
    drop(scans);
    drop(sets);
    picture.draw_cloud(&cloud, view, frame_options, (legend, stamp))
}
