//! `render`.

use super::Report;
use super::report::check_output;
use crate::error::CliError;
use crate::image_io::{
    ExrFile, Frame, LayerKind, PixelRect, PngOptions, Precision, Stamp, encode_png, write_atomically,
};
use crate::input::is_standard;
use crate::job::{RenderJob, Watch};
use crate::memory;
use crate::options::{LayerRequest, RenderOptions};
use crate::scene::{self, LoadedScene, Scene};
use pointillist_render::{DrawOptions, Prepared, RenderError};
use std::hash::Hasher as _;
use std::path::{Path, PathBuf};
use std::time::Instant;
use twox_hash::XxHash3_64;

/// How a picture is written, by the end of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OutputFormat {
    Exr,
    Png,
}

impl OutputFormat {
    /// The format that a path asks for.
    pub(super) fn of(path: &Path) -> Result<Self, CliError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "exr" => Ok(Self::Exr),
            "png" => Ok(Self::Png),
            _ if is_standard(path) => {
                let message =
                    "-o -: a picture is no text, and goes to a file whose name ends in .png or .exr";
                Err(CliError::Usage(message.to_owned()))
            }
            _ => Err(CliError::Usage(format!("`{}`: a picture's name ends in .png or .exr", path.display()))),
        }
    }

    /// Refuses layers and floats for a PNG.
    pub(super) fn check_layers(self, layers: bool, float: bool) -> Result<(), CliError> {
        if self == Self::Png && (layers || float) {
            let message = "--layers and --float need an .exr output; add -o picture.exr";
            return Err(CliError::Usage(message.to_owned()));
        }
        Ok(())
    }
}

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
    if format == OutputFormat::Exr
        && !options.picture.overwrite
        && is_there(&output, &stamp, job.window, &report)
    {
        report.note(&format!("{} is already there; --overwrite draws it again", output.display()));
        return report.finish();
    }
    let frame = draw(scene, &job, &report).map_err(|error| CliError::Failed(error.to_string()))?;
    report.stats.count("pixels", job.window.pixels());
    report.stats.stage("write", || match format {
        OutputFormat::Exr => write_exr(&output, ExrFile::from_frame(&frame, stamp, precision(options))),
        OutputFormat::Png => {
            let background = scene.image.background.to_array();
            write_png(&output, &frame, &PngOptions { exposure_ev: options.picture.exposure, background })
        }
    })?;
    tell(&report, options, &output, job.window);
    report.finish()
}

fn draw(scene: &Scene, job: &RenderJob, report: &Report<'_>) -> Result<Frame, RenderError> {
    let progress = report.progress();
    let watch = Watch { task: "render", progress: &progress, stats: &report.stats };
    let prepared = Prepared::new(scene, &watch)?;
    let start = Instant::now();
    let options = DrawOptions::DEFAULT.with_window(job.window).with_layers(job.layers.clone());
    let frame = prepared.draw(&options, &watch);
    report.stats.add_wall("tiles", start.elapsed());
    progress.finish();
    frame
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

fn precision(options: &RenderOptions) -> Precision {
    if options.picture.float { Precision::Float } else { Precision::Half }
}

/// What is to be drawn.
fn job(scene: &Scene, options: &RenderOptions) -> Result<RenderJob, CliError> {
    let (width, height) = (scene.image.width, scene.image.height);
    let (region, window) = options.camera.windows(width, height)?;
    Ok(RenderJob { region, window, layers: layers(scene, &options.layers)? })
}

fn layers(scene: &Scene, requests: &[LayerRequest]) -> Result<Vec<LayerKind>, CliError> {
    let mut kinds = Vec::new();
    let lights = 0..scene.lights.len();
    for request in requests {
        let more = match request {
            LayerRequest::All => {
                use LayerKind::{Albedo, Direct, Id, Indirect, Lit, Normal, Position};
                let mut all = vec![Normal, Position, Albedo, Direct, Indirect, Id];
                all.extend(lights.clone().map(Lit));
                all
            }
            LayerRequest::Normal => vec![LayerKind::Normal],
            LayerRequest::Position => vec![LayerKind::Position],
            LayerRequest::Albedo => vec![LayerKind::Albedo],
            LayerRequest::Direct => vec![LayerKind::Direct],
            LayerRequest::Indirect => vec![LayerKind::Indirect],
            LayerRequest::Id => vec![LayerKind::Id],
            LayerRequest::Lit(None) => lights.clone().map(LayerKind::Lit).collect(),
            LayerRequest::Lit(Some(name)) => {
                let index = scene.lights.iter().position(|light| light.name == *name);
                let index = index.ok_or_else(|| {
                    let names: Vec<&str> = scene.lights.iter().map(|light| light.name.as_str()).collect();
                    CliError::Usage(format!("--layers lit.{name}: the lights are {}", names.join(", ")))
                })?;
                vec![LayerKind::Lit(index)]
            }
        };
        more.into_iter().for_each(|kind| {
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        });
    }
    Ok(kinds)
}

/// Refuses a picture that memory cannot hold, before anything is computed.
fn check_memory(options: &RenderOptions, window: PixelRect, layers: &[LayerKind]) -> Result<(), CliError> {
    let planes: usize = 5 + layers.iter().map(|layer| layer.channels(&[]).len()).sum::<usize>();
    // Once as computed, and once more as it is written.
    let needed = u128::from(window.pixels()) * planes as u128 * 4 * 2;
    let (width, height) = (window.width(), window.height());
    let fits = memory::check(needed, || format!("{width}×{height} pixels take"));
    fits.map_err(|error| match options.camera.size {
        Some([width, height]) => CliError::Usage(format!(
            "--size {width}x{height}: {}; draw it in parts with --tile, or smaller",
            error.with_help()
        )),
        None => error.in_file("image.size").with_help("draw it in parts with --tile, or smaller").into(),
    })
}

/// What `--size` asks for, looked at before the scene is loaded.
fn check_size(options: &RenderOptions) -> Result<(), CliError> {
    let Some([width, height]) = options.camera.size else { return Ok(()) };
    let (_, window) = options.camera.windows(width, height)?;
    check_memory(options, window, &[])
}

fn stamp(loaded: &LoadedScene, job: &RenderJob, options: &RenderOptions) -> Stamp {
    let mut hash = XxHash3_64::default();
    let LoadedScene { scene, fingerprint, .. } = loaded;
    hash.write(&fingerprint.to_le_bytes());
    let names: Vec<&str> = scene.lights.iter().map(|light| light.name.as_str()).collect();
    for channel in job.layers.iter().flat_map(|layer| layer.channels(&names)) {
        hash.write(channel.as_bytes());
        hash.write(b" ");
    }
    hash.write(&[u8::from(options.picture.float)]);
    Stamp {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint: hash.finish(),
        region: job.region,
        tile: options.camera.tile.map(|tile| tile.to_string()),
        background: scene.image.background.to_array(),
    }
}

/// Whether the output is there already, drawn from the same scene with the same options. A damaged one is not, and is told.
pub(super) fn is_there(path: &Path, stamp: &Stamp, window: PixelRect, report: &Report<'_>) -> bool {
    let Ok(bytes) = memory::read(path) else { return false };
    match ExrFile::read(&bytes) {
        Ok(file) => file.window == window && file.stamp.as_ref() == Some(stamp),
        Err(error) => {
            let name = path.display();
            report.note(&format!("{name} is there, but cannot be used ({error}); it is drawn again"));
            false
        }
    }
}

pub(super) fn write_exr(path: &Path, file: ExrFile) -> Result<(), CliError> {
    write_atomically(path, |output| file.write(output))
        .map_err(|error| CliError::writing(&path.display().to_string(), &error))
}

pub(super) fn write_png(path: &Path, frame: &Frame, options: &PngOptions) -> Result<(), CliError> {
    let (width, height) = (frame.window.width(), frame.window.height());
    write_atomically(path, |output| encode_png(output, &frame.color, width, height, options))
        .map_err(|error| CliError::writing(&path.display().to_string(), &error))
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
