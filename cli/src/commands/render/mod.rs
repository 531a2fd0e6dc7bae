//! `render`.

mod budget;
mod draw;
mod dry_run;
mod expected_error;
mod kept;
mod layers;
mod output;
mod plan;
mod preview;
mod sample_tiles;
mod shots;
mod watch;

pub(super) use output::{OutputFormat, is_there, write_display, write_exr, write_picture};
pub(super) use shots::numbered;

use super::Report;
use crate::error::CliError;
use crate::options::RenderOptions;
use crate::scene;
use draw::Film;
use plan::{check_memory, check_size, job};
use shots::{check_outputs, check_turntable, cut_off, motion, shots};

pub(super) fn run(options: &RenderOptions) -> Result<(), CliError> {
    if options.watch { watch::run(options, &draw_once) } else { draw_once(options) }
}

fn draw_once(options: &RenderOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?;
    let shots = shots(options)?;
    let format = OutputFormat::of(&shots[0].output)?;
    let is_shown_only = options.preview && options.output.is_none();
    if is_shown_only {
        preview::check(options)?;
    } else {
        check_outputs(&shots)?;
    }
    check_options(options, format, &report)?;
    check_turntable(options)?;
    options.camera.check_view()?;
    check_size(options)?;
    check_map(options)?;
    let overrides = options.overrides(format.gain(&options.picture.display));
    let mut loaded = report.stats.stage("load", || match &options.scene {
        Some(path) => scene::load(path, &overrides),
        None => scene::builtin(&overrides),
    })?;
    loaded.warnings.iter().for_each(|warning| report.warn(warning));
    let motion = motion(options, &loaded);
    if motion.is_still() && shots.len() > 1 {
        report.warn("nothing in the scene moves: all frames are alike");
    }
    let job = job(&loaded.scene, options)?;
    format.check_sides(job.window)?;
    check_memory(options, job.window, &job.layers)?;
    // All cameras before the first picture: a film that would end in the middle of the night ends now.
    shots.iter().try_for_each(|shot| motion.camera(&loaded.scene.camera, shot.frame).map(drop))?;
    if let Some(message) = cut_off(options, &loaded, &motion, &shots) {
        report.warn(&message);
    }
    if options.preview {
        preview::show(&loaded, options, &report)?;
        if is_shown_only {
            return report.finish();
        }
    }
    if let Some(error) = options.error {
        expected_error::choose(&mut loaded, &job, error, &report)?;
    }
    if let Some(seconds) = options.time_budget {
        budget::draw(&loaded, &job, &shots[0].output, format, options, seconds, &report)?;
        return report.finish();
    }
    if options.dry_run {
        let expected = dry_run::expect(&loaded, &job, format, options, shots.len(), &report)?;
        return report.finish_expecting(expected);
    }
    Film { options, report: &report, format, job, motion, shots }.draw(loaded)?;
    if options.scene.is_none() {
        report.note(
            "This is the built-in scene. Next: `pointillist render model.obj`, another view with\n\
             `pointillist render --eye 3,2.5,6.5 --fov 30`, and all options with `pointillist render --help`.",
        );
    }
    report.finish()
}

fn check_options(options: &RenderOptions, format: OutputFormat, report: &Report<'_>) -> Result<(), CliError> {
    format.check(!options.layers.is_empty(), &options.picture)?;
    if format == OutputFormat::Exr && options.picture.display.exposure != 0.0 {
        report.warn("--exposure changes PNG and JPEG only; EXR keeps the light as it is");
    }
    if format != OutputFormat::Exr && options.camera.tile.is_some() {
        report.warn("`merge` joins EXR parts only; add -o part.exr");
    }
    Ok(())
}

/// Refuses `--env` for scenes, which name their own map.
fn check_map(options: &RenderOptions) -> Result<(), CliError> {
    let (Some(map), scene) = (&options.env, &options.scene) else { return Ok(()) };
    let is_model = match scene {
        Some(path) => scene::is_model(path)?,
        None => false,
    };
    if is_model {
        return Ok(());
    }
    Err(CliError::Usage(format!(
        "--env is for models; a scene names its own map: --set '{}' --set ambient.environment=true",
        map.assignment()
    )))
}
