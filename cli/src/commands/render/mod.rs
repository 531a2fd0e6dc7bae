//! `render`.

mod kept;
mod layers;
mod output;
mod plan;

pub(super) use output::{OutputFormat, is_there, write_exr, write_png};

use super::Report;
use super::report::check_output;
use crate::error::CliError;
use crate::image_io::{ExrFile, Frame, PixelRect, PngOptions};
use crate::input::is_standard;
use crate::job::interrupt::Keeper;
use crate::job::{RenderJob, Watch};
use crate::options::RenderOptions;
use crate::scene;
use kept::Kept;
use plan::{check_memory, check_size, job, precision, stamp};
use pointillist_render::{DrawOptions, Prepared, RenderError};
use std::path::{Path, PathBuf};
use std::time::Instant;

pub(super) fn run(options: &RenderOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?;
    let output = output_path(options);
    let format = OutputFormat::of(&output)?;
    check_output(&output)?;
    check_options(options, format, &report)?;
    options.camera.check_view()?;
    check_size(options)?;
    let overrides = options.camera.overrides(&options.set);
    let loaded = report.stats.stage("load", || match &options.scene {
        Some(path) => scene::load(path, &overrides),
        None => scene::builtin(&overrides),
    })?;
    let scene = &loaded.scene;
    loaded.warnings.iter().for_each(|warning| report.warn(warning));
    let job = job(scene, options)?;
    check_memory(options, job.window, &job.layers)?;
    let stamp = stamp(&loaded, &job, options);
    let mut kept = Kept::of(&output, &stamp);
    if format == OutputFormat::Exr
        && !options.picture.overwrite
        && is_there(&output, &stamp, job.window, &report)
    {
        report.note(&format!("{} is already there; --overwrite draws it again", output.display()));
        kept.remove_unused(&report);
        return report.finish();
    }
    let progress = report.progress();
    let watch = Watch { task: "render", progress: &progress, stats: &report.stats };
    let prepared = Prepared::new(scene, &watch).map_err(failed)?;
    // From here on there are tiles to keep, until the picture is written.
    let keeper = Keeper::new();
    let frame = draw(&prepared, &job, &mut kept, &watch, &report)?;
    progress.finish();
    report.stats.count("pixels", job.window.pixels());
    report.stats.stage("write", || match format {
        OutputFormat::Exr => write_exr(&output, ExrFile::from_frame(&frame, stamp, precision(options))),
        OutputFormat::Png => {
            let background = scene.image.background.to_array();
            write_png(&output, &frame, &PngOptions { exposure_ev: options.picture.exposure, background })
        }
    })?;
    kept.remove(&report);
    drop(keeper);
    tell(&report, options, &output, job.window);
    report.finish()
}

/// Draws what an interrupted run has not, or keeps what is finished if this one is interrupted.
fn draw(
    prepared: &Prepared<'_>,
    job: &RenderJob,
    kept: &mut Kept,
    watch: &Watch<'_>,
    report: &Report<'_>,
) -> Result<Frame, CliError> {
    let options = DrawOptions::DEFAULT.with_window(job.window).with_layers(job.layers.clone());
    let mut picture = prepared.begin(&options).map_err(failed)?;
    report.stats.stage("load", || kept.restore(&mut picture, report));
    let start = Instant::now();
    let drawn = prepared.continue_view(&mut picture, watch);
    report.stats.add_wall("tiles", start.elapsed());
    match drawn {
        // A request that came with the last tile has nothing left to end.
        Err(RenderError::Cancelled) if !picture.is_complete() => Err(kept.keep(&picture)),
        Ok(()) | Err(RenderError::Cancelled) => Ok(picture.into_frame()),
        Err(error) => Err(failed(error)),
    }
}

fn failed(error: RenderError) -> CliError {
    CliError::Failed(error.to_string())
}

fn output_path(options: &RenderOptions) -> PathBuf {
    match (&options.output, &options.scene) {
        (Some(output), _) => output.clone(),
        (None, Some(scene)) if !is_standard(scene) => {
            PathBuf::from(scene.with_extension("png").file_name().unwrap_or_default())
        }
        _ => PathBuf::from("pointillist.png"),
    }
}

fn check_options(options: &RenderOptions, format: OutputFormat, report: &Report<'_>) -> Result<(), CliError> {
    format.check_layers(!options.layers.is_empty(), options.picture.float)?;
    if format == OutputFormat::Exr && options.picture.exposure != 0.0 {
        report.warn("--exposure changes PNG only; EXR keeps the light as it is");
    }
    if format == OutputFormat::Png && options.camera.tile.is_some() {
        report.warn("`merge` joins EXR parts only; add -o part.exr");
    }
    Ok(())
}

fn tell(report: &Report<'_>, options: &RenderOptions, output: &Path, window: PixelRect) {
    let seconds = report.stats.elapsed().as_secs_f64();
    let (width, height) = (window.width(), window.height());
    report.note(&format!("{}: {width}×{height} pixels in {seconds:.2} s", output.display()));
    if options.scene.is_none() {
        report.note(
            "This is the built-in scene. Next: `pointillist render model.obj`, another view with\n\
             `pointillist render --eye 3,2.5,6.5 --fov 30`, and all options with `pointillist render --help`.",
        );
    }
}
