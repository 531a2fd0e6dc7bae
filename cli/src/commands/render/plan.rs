//! What a run is to draw, from the scene and the options, and whether memory can hold it.

use super::layers::layers;
use crate::error::CliError;
use crate::image_io::{LayerKind, PixelRect, Stamp};
use crate::job::RenderJob;
use crate::memory;
use crate::options::RenderOptions;
use crate::scene::Scene;
use std::hash::Hasher as _;
use twox_hash::XxHash3_64;

/// What is to be drawn.
pub(super) fn job(scene: &Scene, options: &RenderOptions) -> Result<RenderJob, CliError> {
    let (width, height) = (scene.image.width, scene.image.height);
    let (region, window) = options.camera.windows(width, height)?;
    Ok(RenderJob { region, window, layers: layers(scene, &options.layers)? })
}

/// Numbers of a pixel: colour, depth and those of layers.
pub(super) fn planes(layers: &[LayerKind]) -> usize {
    5 + layers.iter().map(|layer| layer.channels(&[]).len()).sum::<usize>()
}

/// Refuses a picture that memory cannot hold, before anything is computed.
pub(super) fn check_memory(
    options: &RenderOptions,
    window: PixelRect,
    layers: &[LayerKind],
) -> Result<(), CliError> {
    // Once as computed, and once more as it is written.
    let needed = u128::from(window.pixels()) * planes(layers) as u128 * 4 * 2;
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
pub(super) fn check_size(options: &RenderOptions) -> Result<(), CliError> {
    let Some([width, height]) = options.camera.size else { return Ok(()) };
    let (_, window) = options.camera.windows(width, height)?;
    check_memory(options, window, &[])
}

/// Where a picture comes from, as its header says; `fingerprint` is that of the scene.
pub(super) fn stamp(scene: &Scene, fingerprint: u64, job: &RenderJob, options: &RenderOptions) -> Stamp {
    let mut hash = XxHash3_64::default();
    hash.write(&fingerprint.to_le_bytes());
    let names: Vec<&str> = scene.lights.iter().map(|light| light.name.as_str()).collect();
    for channel in job.layers.iter().flat_map(|layer| layer.channels(&names)) {
        hash.write(channel.as_bytes());
        hash.write(b" ");
    }
    hash.write(&[u8::from(options.picture.float), u8::from(options.picture.bg.is_some())]);
    Stamp {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint: hash.finish(),
        region: job.region,
        tile: options.camera.tile.map(|tile| tile.to_string()),
        unfinished: false,
        background: scene.image.background.to_array(),
    }
}
