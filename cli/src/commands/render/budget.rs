//! `render --time-budget SECONDS`: coarse first, refined until the time is up.
//!
//! 1. The whole picture is drawn with an eighth of its pixels on a side: that is always there.
//! 2. What that took says whether the full picture fits into the time that is left. If not, a quarter, and then a half, are drawn first.
//! 3. Tiles of the full picture are drawn until the time is up; where they are missing, the finest coarser picture is interpolated.
//!
//! Where tiles are drawn, they are compared with what stood there before: what the tiles that are missing lack is as much.

use super::draw::failed;
use super::output::{OutputFormat, is_there, unseen_background, write_picture};
use super::plan::stamp;
use crate::commands::Report;
use crate::error::CliError;
use crate::image_io::Frame;
use crate::job::{RenderJob, Watch};
use crate::options::RenderOptions;
use crate::scene::{LoadedScene, Scene};
use pointillist_render::{DrawOptions, Monitor, PixelRect, Prepared, RenderError};
use std::path::Path;
use std::time::{Duration, Instant};

/// Pixels of the picture on a side of one of the coarser ones, coarsest first.
const COARSE: [u32; 3] = [8, 4, 2];
/// A picture takes longer than its pixels say, by so much: from tile to tile the scene is walked through anew.
const CAUTION: f64 = 1.2;
/// Seconds that encoding takes for a pixel at most, until it is measured: kept free at the end.
const WRITING_S: f64 = 1e-7;

pub(super) fn draw(
    loaded: &LoadedScene,
    job: &RenderJob,
    output: &Path,
    format: OutputFormat,
    options: &RenderOptions,
    seconds: f64,
    report: &Report<'_>,
) -> Result<(), CliError> {
    let scene = &loaded.scene;
    let mut stamp = stamp(scene, loaded.fingerprint, job, options);
    if format == OutputFormat::Exr
        && !options.picture.overwrite
        && is_there(output, &stamp, job.window, report)
    {
        report.note(&format!("{} is already there; --overwrite draws it again", output.display()));
        return Ok(());
    }
    // Loading is part of the time.
    let writing_s = WRITING_S * job.window.pixels() as f64;
    let left_s = || seconds - writing_s - report.stats.elapsed().as_secs_f64();
    let (frame, reached) = draw_until(scene, job, &left_s, report)?;
    if reached.done < reached.all {
        // It is not the picture that the scene has, and must not be taken for it by the next run.
        stamp.fingerprint = stamp.fingerprint.rotate_left(1) ^ reached.done as u64;
    }
    report.stats.count("pixels", job.window.pixels());
    if let Some(text) = unseen_background(&frame, &scene.image, format, &options.picture) {
        report.note(&text);
    }
    report.stats.stage("write", || write_picture(output, format, frame, stamp, &options.picture))?;
    let took = report.stats.elapsed().as_secs_f64();
    report.note(&format!("{}: {}; {took:.2} s", output.display(), reached.tell(report)));
    if took > seconds {
        report.warn(&format!(
            "--time-budget {seconds}: loading and the coarsest picture alone took longer, {took:.2} s in all"
        ));
    }
    Ok(())
}

/// How far a picture got.
struct Reached {
    /// Tiles that were drawn, of all.
    done: usize,
    all: usize,
    /// By how much the picture is coarser where they are missing.
    coarser: u32,
    /// What missing tiles are expected to be wrong by, over all pixels; infinite if nobody knows.
    believed: f64,
}

impl Reached {
    /// In words; what is believed is kept for `--stats`.
    fn tell(&self, report: &Report<'_>) -> String {
        let Self { done, all, coarser, believed } = self;
        let rest = format!("the rest has one of {coarser}×{coarser} pixels");
        if done == all {
            return "complete".to_owned();
        }
        if believed.is_finite() {
            report.stats.figure("expected_rmse", *believed);
            return format!("{done} of {all} tiles are fine, {rest}; an RMSE of {believed:.1e} is expected");
        }
        format!("{done} of {all} tiles are fine, too few to tell the error; {rest}")
    }
}

/// The picture as fine as there is time for.
fn draw_until(
    scene: &Scene,
    job: &RenderJob,
    left_s: &impl Fn() -> f64,
    report: &Report<'_>,
) -> Result<(Frame, Reached), CliError> {
    let progress = report.progress();
    let watch = Watch { task: "render", progress: &progress, stats: &report.stats };
    let prepared = Prepared::new(scene, &watch).map_err(failed)?;
    let (coarse, coarser) = coarse_picture(&prepared, scene, job, left_s, report)?;
    let mut picture = prepared
        .begin(&DrawOptions::DEFAULT.with_window(job.window).with_layers(job.layers.clone()))
        .map_err(failed)?;
    let until = Instant::now() + Duration::from_secs_f64(left_s().max(0.0));
    match prepared.continue_view(&mut picture, &Deadline { watch, until }) {
        Ok(()) | Err(RenderError::Cancelled) => {}
        Err(error) => return Err(failed(error)),
    }
    progress.finish();
    let (done, all) = (picture.tiles_drawn(), picture.tile_count());
    report.stats.count("tiles_drawn", done as u64);
    report.stats.count("tiles_coarse", (all - done) as u64);
    let drawn = picture.pixels_drawn();
    let mut frame = picture.into_frame();
    let rest = fill(&mut frame, &drawn, &coarse, [scene.image.width, scene.image.height]);
    // Tiles are drawn from the top down: few of them do not stand for all.
    let believed = if 2 * done < all { f64::INFINITY } else { rest };
    Ok((frame, Reached { done, all, coarser, believed }))
}

/// The finest of the coarser pictures that there is time for, and by how much it is coarser.
fn coarse_picture(
    prepared: &Prepared<'_>,
    scene: &Scene,
    job: &RenderJob,
    left_s: &impl Fn() -> f64,
    report: &Report<'_>,
) -> Result<(Frame, u32), CliError> {
    let (mut best, mut full_s) = (None, f64::INFINITY);
    for times in COARSE {
        let fits =
            best.is_none() || (full_s * CAUTION > left_s() && full_s / f64::from(times * times) < left_s());
        if !fits {
            continue;
        }
        let size = [scene.image.width, scene.image.height].map(|n| n.div_ceil(times));
        let view = scene.camera.view(size).map_err(|error| failed(error.into()))?;
        let start = Instant::now();
        let window = shrunk(job.window, times);
        let options = DrawOptions::DEFAULT.with_window(window).with_layers(job.layers.clone());
        best = Some((prepared.draw_view(view, &options, &report.stats).map_err(failed)?, times));
        full_s = start.elapsed().as_secs_f64() * f64::from(times * times);
    }
    Ok(best.expect("the first always fits"))
}

/// The pixels of a coarser picture that a window meets.
fn shrunk(window: PixelRect, times: u32) -> PixelRect {
    let PixelRect { x0, y0, x1, y1 } = window;
    PixelRect { x0: x0 / times, y0: y0 / times, x1: x1.div_ceil(times), y1: y1.div_ceil(times) }
}

/// Fills pixels that are not drawn from a coarser picture. The root mean square of what is filled in is expected to be wrong by what comes
/// back, over all pixels; infinite if none is drawn to compare with.
fn fill(frame: &mut Frame, drawn: &[bool], coarse: &Frame, size: [u32; 2]) -> f64 {
    let window = frame.window;
    let (mut squares, mut compared) = (0.0, 0_usize);
    for (i, &drawn) in drawn.iter().enumerate() {
        let (x, y) = (i as u32 % window.width() + window.x0, i as u32 / window.width() + window.y0);
        // Both pictures have the same middle, and the same field of view from top to bottom.
        let scale = f64::from(coarse.size[1]) / f64::from(size[1]);
        let along = |at: u32, axis: usize| {
            (f64::from(at) + 0.5 - 0.5 * f64::from(size[axis])) * scale + 0.5 * f64::from(coarse.size[axis])
        };
        let (u, v) = (along(x, 0), along(y, 1));
        let color = interpolated(coarse, u, v);
        if drawn {
            let apart = (0..3).map(|c| f64::from(color[c] - frame.color[i][c]).powi(2)).sum::<f64>();
            squares += apart / 3.0;
            compared += 1;
            continue;
        }
        let near = index(coarse, u as i64, v as i64);
        frame.color[i] = color;
        // Between two depths or objects there is nothing.
        frame.depth[i] = coarse.depth[near];
        for (layer, from) in frame.layers.iter_mut().zip(&coarse.layers) {
            for (plane, from) in layer.planes.iter_mut().zip(&from.planes) {
                plane[i] = from[near];
            }
        }
    }
    if compared == 0 {
        return f64::INFINITY;
    }
    let missing = (drawn.len() - compared) as f64 / drawn.len() as f64;
    (squares / compared as f64 * missing).sqrt()
}

/// The pixel of a coarser picture at whole numbers of its pixels, or the nearest that there is.
fn index(coarse: &Frame, x: i64, y: i64) -> usize {
    let window = coarse.window;
    let within =
        |at: i64, low: u32, high: u32| (at.clamp(low.into(), i64::from(high) - 1) - i64::from(low)) as usize;
    within(y, window.y0, window.y1) * window.width() as usize + within(x, window.x0, window.x1)
}

/// The colour between four pixels.
fn interpolated(coarse: &Frame, u: f64, v: f64) -> [f32; 4] {
    let (u, v) = (u - 0.5, v - 0.5);
    let (x, y) = (u.floor(), v.floor());
    let (s, t) = ((u - x) as f32, (v - y) as f32);
    let at = |dx: i64, dy: i64| coarse.color[index(coarse, x as i64 + dx, y as i64 + dy)];
    let (a, b, c, d) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
    std::array::from_fn(|i| (1.0 - t) * ((1.0 - s) * a[i] + s * b[i]) + t * ((1.0 - s) * c[i] + s * d[i]))
}

/// Ends the work when the time is up.
struct Deadline<'a> {
    watch: Watch<'a>,
    until: Instant,
}

impl Monitor for Deadline<'_> {
    fn begin(&self, units: u64) {
        self.watch.begin(units);
    }

    fn advance(&self, units: u64) {
        self.watch.advance(units);
    }

    fn is_cancelled(&self) -> bool {
        Instant::now() >= self.until || self.watch.is_cancelled()
    }

    fn stage(&self, name: &'static str, work: &mut dyn FnMut()) {
        self.watch.stage(name, work);
    }

    fn start_lap(&self) {
        self.watch.start_lap();
    }

    fn lap(&self, stage: &'static str) {
        self.watch.lap(stage);
    }

    fn count(&self, what: &'static str, n: u64) {
        self.watch.count(what, n);
    }

    fn skip(&self, what: &'static str, n: u64) {
        self.watch.skip(what, n);
    }
}
