//! `scan`.

use super::Report;
use super::render::{OutputFormat, is_there, write_exr, write_png};
use crate::error::CliError;
use crate::image_io::{ExrFile, PngOptions, Precision, Stamp, Window};
use crate::job::Progress;
use crate::options::{ScanOptions, Vector};
use crate::scan::{LoadOptions, ScanSet, window_of};
use crate::scene::description::{CameraDescription, DEFAULT_FOV_DEG};
use crate::scene::{Camera, Projection, frame_around};
use cpu_time::ProcessTime;
use glam::DVec3;
use pointillist_ibpr as ibpr;
use std::hash::Hasher as _;
use std::path::PathBuf;
use std::time::Instant;
use twox_hash::XxHash3_64;

/// Width and height of a picture without `--size`.
const DEFAULT_SIZE: [u32; 2] = [1024, 1024];

pub(super) fn run(options: &ScanOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?;
    let output = output_path(options);
    let format = OutputFormat::of(&output)?;
    format.check_layers(!options.layers.is_empty(), options.picture.float)?;
    let load = LoadOptions {
        drop_invalid: options.drop_invalid,
        spacing: options.surface.spacing,
        vertices: options.vertices,
    };
    let set = report.stats.stage("load", || ScanSet::load(&options.files, &load))?;
    set.warnings.iter().for_each(|warning| report.warn(warning));
    if set.dropped > 0 {
        report.warn(&format!("{} points that are not finite were left out", set.dropped));
    }
    let frame_options = options.frame_options();
    let cloud = report.stats.stage("prepare", || set.cloud(frame_options.base))?;
    let camera = camera(options, &cloud)?;
    let [width, height] = options.camera.size.unwrap_or(DEFAULT_SIZE);
    let (region, window) = options.camera.windows(width, height)?;
    let stamp = stamp(options, &set, &camera, region);
    if format == OutputFormat::Exr && !options.picture.overwrite && is_there(&output, &stamp, window) {
        report.note(&format!("{} is already there; --overwrite draws it again", output.display()));
        return report.finish();
    }
    let mut frame = ibpr::Frame::default();
    report.stats.stage("draw", || draw(options, &cloud, &camera, &mut frame, &report))?;
    tell_counts(&report, &cloud, &frame);
    let picture = window_of(&frame, window, &options.layer_list(), &camera);
    report.stats.stage("write", || match format {
        OutputFormat::Exr => {
            let precision = if options.picture.float { Precision::Float } else { Precision::Half };
            write_exr(&output, ExrFile::from_frame(&picture, stamp, precision))
        }
        OutputFormat::Png => {
            let png = PngOptions { exposure_ev: options.picture.exposure, background: [0.0; 3] };
            write_png(&output, &picture, &png)
        }
    })?;
    let seconds = report.stats.elapsed().as_secs_f64();
    report.note(&format!("{}: {} points in {seconds:.2} s", output.display(), cloud.len()));
    report.finish()
}

fn output_path(options: &ScanOptions) -> PathBuf {
    let first = || {
        // `bun.ply.gz` gives `bun.png`.
        let name = PathBuf::from(options.files[0].file_name().unwrap_or_default());
        let name = if name.extension().is_some_and(|e| e == "gz") { name.with_extension("") } else { name };
        name.with_extension("png")
    };
    options.output.clone().unwrap_or_else(first)
}

/// The camera of the options; what they leave open has all points in view.
fn camera(options: &ScanOptions, cloud: &ibpr::Cloud) -> Result<Camera, CliError> {
    let given = &options.camera;
    let place = |v: Option<Vector>| v.map(|Vector(v)| DVec3::from(v));
    let fov_y_rad = given.fov.unwrap_or(DEFAULT_FOV_DEG).to_radians();
    let description = CameraDescription {
        eye: place(given.eye),
        target: place(given.target),
        up: place(given.up).unwrap_or(DVec3::Y),
        projection: Some(Projection::Perspective { fov_y_rad }),
    };
    let [width, height] = given.size.unwrap_or(DEFAULT_SIZE);
    let aspect = f64::from(width) / f64::from(height);
    frame_around(&description, || cloud.positions(), aspect)
        .map_err(|fault| CliError::Usage(format!("the camera cannot be used: {fault}")))
}

fn draw(
    options: &ScanOptions,
    cloud: &ibpr::Cloud,
    camera: &Camera,
    frame: &mut ibpr::Frame,
    report: &Report<'_>,
) -> Result<(), CliError> {
    // All that the renderer can refuse now is a value of an option.
    let usage = |error: ibpr::IbprError| CliError::Usage(error.to_string());
    let [width, height] = options.camera.size.unwrap_or(DEFAULT_SIZE);
    let projection = match camera.projection {
        Projection::Perspective { fov_y_rad } => ibpr::Projection::Perspective { fov_y_rad },
        Projection::Orthographic { height } => ibpr::Projection::Orthographic { height },
    };
    let view = ibpr::View::look_at(camera.eye, camera.target, camera.up, projection, width, height)
        .map_err(usage)?;
    let frame_options = options.frame_options();
    let mut renderer = ibpr::Renderer::new();
    let progress = Progress::new(options.common.progress_mode());
    progress.begin("draw", u64::from(options.repeat));
    for _ in 0..options.repeat {
        let (wall, cpu) = (Instant::now(), ProcessTime::try_now().ok());
        renderer.draw(cloud, &view, &frame_options, frame).map_err(usage)?;
        let cpu = cpu.and_then(|start| start.try_elapsed().ok()).unwrap_or_default();
        report.stats.frame(wall.elapsed(), cpu);
        progress.advance(1);
    }
    progress.finish();
    Ok(())
}

fn tell_counts(report: &Report<'_>, cloud: &ibpr::Cloud, frame: &ibpr::Frame) {
    let counts = &frame.counts;
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
    if frame.depth.iter().all(|d| d.is_infinite()) {
        report.warn(if counts.points > 0 {
            "nothing was drawn: too few points are near one another; try a larger --scale or --spacing"
        } else if counts.blocks_facing_away > 0 {
            "nothing was drawn: all scans in view face away; --no-cull draws them from behind"
        } else {
            "nothing was drawn: no point is in view; without --eye and --target all are"
        });
    }
}

fn stamp(options: &ScanOptions, set: &ScanSet, camera: &Camera, region: Window) -> Stamp {
    let mut hash = XxHash3_64::default();
    hash.write(&set.fingerprint().to_le_bytes());
    let drawn =
        (options.frame_options(), camera, options.camera.size, options.layer_list(), options.picture.float);
    hash.write(format!("{drawn:?}").as_bytes());
    Stamp {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint: hash.finish(),
        region,
        tile: options.camera.tile.map(|tile| tile.to_string()),
        background: [0.0; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{Cli, Command};
    use clap::Parser as _;
    use std::path::Path;

    fn output(file: &str) -> PathBuf {
        let Command::Scan(options) = Cli::parse_from(["pointillist", "scan", file]).command else {
            unreachable!("`scan` was asked for")
        };
        output_path(&options)
    }

    #[test]
    fn the_picture_is_called_like_the_first_file() {
        assert_eq!(output("a/bun.conf"), Path::new("bun.png"));
        assert_eq!(output("dragon_0.ply.gz"), Path::new("dragon_0.png"));
    }
}
