//! `render --dry-run`: what the picture is expected to take.
//!
//! The scene is loaded and prepared as for drawing, which is measured. Of the picture, tiles that are spread all over it are drawn, twice: the
//! first time also pays for what is made once, when it is first seen (maps that are summed up, surroundings that are captured). Time of
//! all tiles is that of the second time, for as many as there are. Encoding is measured on the same tiles.

use super::draw::failed;
use super::output::{OutputFormat, encode};
use super::plan::{planes, stamp};
use super::sample_tiles::{TILE, spread};
use crate::commands::Report;
use crate::error::CliError;
use crate::image_io::{Frame, Layer, PixelRect, Stamp};
use crate::job::{Expected, RenderJob, Stats};
use crate::memory;
use crate::options::{PictureOptions, RenderOptions};
use crate::scene::{LoadedScene, weight};
use pointillist_render::{DrawOptions, Prepared, RenderError};
use rayon::prelude::*;
use std::io::Cursor;
use std::time::Instant;

/// Drawing the sample for the first time stops after this, once each thread has drawn a tile.
const PATIENCE_S: f64 = 2.0;
/// Stages of a tile, as the renderer books them.
const TILE_STAGES: [&str; 3] = ["visibility", "shadow", "shade"];

/// What one picture takes.
struct Job<'a> {
    prepared: &'a Prepared<'a>,
    job: &'a RenderJob,
    format: OutputFormat,
    stamp: &'a Stamp,
    options: &'a PictureOptions,
}

/// Measures and scales up, for so many pictures like the scene's own. Everything until now, loading, is part of what is expected.
pub(super) fn expect(
    loaded: &LoadedScene,
    job: &RenderJob,
    format: OutputFormat,
    options: &RenderOptions,
    pictures: usize,
    report: &Report<'_>,
) -> Result<Expected, CliError> {
    let scene = &loaded.scene;
    let prepared = Prepared::new(scene, &report.stats).map_err(failed)?;
    let stamp = stamp(scene, loaded.fingerprint, job, options);
    let job = Job { prepared: &prepared, job, format, stamp: &stamp, options: &options.picture };
    let threads = report.threads();
    let mut expected = Expected { threads, heavy: weight::heavy(scene), ..Expected::default() };
    expected.add("load", report.stats.elapsed().as_secs_f64(), report.stats.cpu_elapsed());
    let all: Vec<PixelRect> = job.job.window.tiles(TILE).collect();
    let first = Sample::draw(&job, &spread(&all), Some(PATIENCE_S)).map_err(failed)?;
    let tiles: Vec<PixelRect> = first.frames.iter().map(|frame| frame.window).collect();
    let second = Sample::draw(&job, &tiles, None).map_err(failed)?;
    let once = (first.tiles_cpu_s - second.tiles_cpu_s).max(0.0);
    expected.add("first use", once.min((first.wall_s - second.wall_s).max(0.0)), once);
    let count = pictures as f64;
    let lights = second.lights_cpu_s / tiles.len() as f64 * count;
    expected.add("lights", lights, lights);
    let cpu = second.tiles_cpu_s * all.len() as f64 / tiles.len() as f64 * count;
    // Threads end with their last tiles, not all at once.
    let wall = cpu / threads as f64 + second.slowest_cpu_s * (1.0 - 1.0 / threads as f64) * count;
    expected.add("tiles", wall, cpu);
    let encoded = encoding_s(&job, &second.frames)? * pixels_of(&all) / pixels_of(&tiles) * count;
    expected.add("write", encoded, encoded);
    // Once as computed, and once more as it is written.
    let frame = job.job.window.pixels() * planes(&job.job.layers) as u64 * 4 * 2;
    expected.peak_bytes = memory::peak_bytes() + frame;
    let film = if pictures > 1 { format!("; {pictures} frames count as the first") } else { String::new() };
    expected.basis = format!(
        "loading was measured; {} of {} tiles were drawn, and the rest is taken to be like them{film}",
        tiles.len(),
        all.len()
    );
    Ok(expected)
}

fn pixels_of(tiles: &[PixelRect]) -> f64 {
    tiles.iter().map(PixelRect::pixels).sum::<u64>() as f64
}

/// Tiles that were drawn, and what they took.
#[derive(Default)]
struct Sample {
    frames: Vec<Frame>,
    tiles_cpu_s: f64,
    slowest_cpu_s: f64,
    lights_cpu_s: f64,
    wall_s: f64,
}

impl Sample {
    /// Draws tiles on all threads; with `patience`, none that would begin later.
    fn draw(job: &Job<'_>, tiles: &[PixelRect], patience_s: Option<f64>) -> Result<Self, RenderError> {
        let start = Instant::now();
        let draw = |(index, tile): (usize, &PixelRect)| {
            let late = patience_s.is_some_and(|limit| start.elapsed().as_secs_f64() > limit);
            if late && index >= rayon::current_num_threads() {
                return Ok(None);
            }
            let stats = Stats::new();
            let options = DrawOptions::DEFAULT.with_window(*tile).with_layers(job.job.layers.clone());
            let frame = job.prepared.draw(&options, &stats)?;
            Ok(Some((frame, stats.cpu_of(&TILE_STAGES), stats.cpu_of(&["lights"]))))
        };
        let drawn: Vec<_> = tiles.par_iter().enumerate().map(draw).collect::<Result<_, RenderError>>()?;
        let mut sample = Self { wall_s: start.elapsed().as_secs_f64(), ..Self::default() };
        for (frame, tiles_cpu_s, lights_cpu_s) in drawn.into_iter().flatten() {
            sample.frames.push(frame);
            sample.tiles_cpu_s += tiles_cpu_s;
            sample.slowest_cpu_s = sample.slowest_cpu_s.max(tiles_cpu_s);
            sample.lights_cpu_s += lights_cpu_s;
        }
        Ok(sample)
    }
}

/// Seconds for encoding the tiles, as one picture of their whole rows.
fn encoding_s(job: &Job<'_>, tiles: &[Frame]) -> Result<f64, CliError> {
    let mut pixels: Frame = tiles[0].clone();
    for tile in &tiles[1..] {
        pixels.color.extend_from_slice(&tile.color);
        pixels.depth.extend_from_slice(&tile.depth);
        let planes = pixels.layers.iter_mut().flat_map(|layer: &mut Layer| &mut layer.planes);
        for (plane, more) in planes.zip(tile.layers.iter().flat_map(|layer| &layer.planes)) {
            plane.extend_from_slice(more);
        }
    }
    let rows = (pixels.color.len() / TILE as usize).max(1) as u32;
    let width = (pixels.color.len() as u32).min(TILE);
    let count = (rows * width) as usize;
    pixels.color.truncate(count);
    pixels.depth.truncate(count);
    pixels.layers.iter_mut().flat_map(|layer| &mut layer.planes).for_each(|plane| plane.truncate(count));
    pixels.size = [width, rows];
    pixels.window = PixelRect::of_picture(width, rows);
    let start = Instant::now();
    let mut bytes = Cursor::new(vec![]);
    encode(&mut bytes, job.format, pixels, job.stamp.clone(), job.options)
        .map_err(|error| CliError::Failed(error.to_string()))?;
    Ok(start.elapsed().as_secs_f64())
}
