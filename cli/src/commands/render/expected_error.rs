//! `render --error E`: the fewest cells a pixel with which the picture is expected to be right to E.
//!
//! Coverage is exact; what depends on the cells is what is taken to be constant in one: highlights, normal maps, what a mask lets through. On
//! tiles that are spread over the picture, pictures with 1, 2 and 4 cells a pixel side are compared with one of 8 (4, at twice the
//! resolution). Their differences shrink by a steady factor, and so the error of the 8 itself is that of a geometric series.

use super::draw::failed;
use super::sample_tiles::{TILE, spread};
use crate::commands::Report;
use crate::error::CliError;
use crate::image_io::{Frame, PixelRect};
use crate::job::RenderJob;
use crate::scene::LoadedScene;
use pointillist_render::{DrawOptions, Prepared, View, fingerprint};
use rayon::prelude::*;

/// What `render.subpixel` can be.
const CELLS: [u32; 3] = [1, 2, 4];
/// Differences that shrink by less than this from step to step are not trusted to shrink on.
const SLOWEST: f64 = 0.7;

/// Errors of a picture with so many cells, as far as the sample shows.
struct Belief {
    cells: u32,
    /// Root of the mean square, R G B.
    rmse: f64,
    /// The same with one standard error of the sample's mean square added.
    cautious: f64,
}

/// Chooses `render.subpixel` for the scene, and tells what is expected.
pub(super) fn choose(
    loaded: &mut LoadedScene,
    job: &RenderJob,
    most: f64,
    report: &Report<'_>,
) -> Result<(), CliError> {
    // Of the whole job: tiles of one picture choose the same.
    let tiles = spread(&job.region.tiles(TILE).collect::<Vec<_>>());
    let beliefs = report.stats.stage("error", || beliefs(loaded, &tiles, report))?;
    let last = beliefs.len() - 1;
    let chosen = beliefs.iter().position(|belief| belief.cautious <= most);
    let belief = &beliefs[chosen.unwrap_or(last)];
    let scene = &mut loaded.scene;
    scene.render.cells_per_pixel = Some(belief.cells);
    loaded.light = fingerprint::of_light(scene);
    loaded.fingerprint =
        fingerprint::of_view(&scene.camera, [scene.image.width, scene.image.height], loaded.light);
    report.stats.figure("expected_rmse", belief.rmse);
    report.stats.figure("expected_rmse_cautious", belief.cautious);
    report.stats.count("cells_per_pixel_side", belief.cells.into());
    let all: Vec<String> = beliefs.iter().map(|b| format!("{}: {:.1e}", b.cells, b.rmse)).collect();
    report.note(&format!(
        "render.subpixel = {}: an RMSE of {:.1e} is expected, {:.1e} with caution, from {} tiles ({})",
        belief.cells,
        belief.rmse,
        belief.cautious,
        tiles.len(),
        all.join(", ")
    ));
    if chosen.is_none() {
        report.warn(&format!(
            "--error {most}: not reached with the most cells there are; a larger --size, averaged, has less"
        ));
    }
    Ok(())
}

fn beliefs(loaded: &LoadedScene, tiles: &[PixelRect], report: &Report<'_>) -> Result<Vec<Belief>, CliError> {
    let mut scene = loaded.scene.clone();
    let shared = Prepared::new(&loaded.scene, &report.stats).map_err(failed)?;
    let size = [scene.image.width, scene.image.height];
    let view = |times: u32| -> Result<View, CliError> {
        let size = size.map(|n| n.saturating_mul(times));
        scene.camera.view(size).map_err(|error| failed(error.into()))
    };
    let (own, double) = (view(1)?, view(2)?);
    let mut drawn = vec![];
    for cells in CELLS {
        scene.render.cells_per_pixel = Some(cells);
        let prepared = shared.with_scene(&scene).map_err(failed)?;
        drawn.push(draw(&prepared, own, tiles)?);
        if cells == CELLS[CELLS.len() - 1] {
            let doubled =
                |t: &PixelRect| PixelRect { x0: 2 * t.x0, y0: 2 * t.y0, x1: 2 * t.x1, y1: 2 * t.y1 };
            let fine = draw(&prepared, double, &tiles.iter().map(doubled).collect::<Vec<_>>())?;
            drawn.push(fine.iter().map(halved).collect());
        }
    }
    let between = |a: usize, b: usize| mean_squares(&drawn[a], &drawn[b]);
    let rms = |squares: &[f64]| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    let (before, last) = (rms(&between(1, 2)), rms(&between(2, 3)));
    let shrinks = if before > 0.0 { (last / before).min(SLOWEST) } else { 0.0 };
    let rest = last * shrinks / (1.0 - shrinks);
    let belief = |(index, cells): (usize, u32)| {
        let squares = between(index, CELLS.len());
        let count = squares.len() as f64;
        let mean = squares.iter().sum::<f64>() / count;
        let variance = squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        let rest = rest * rest;
        Belief {
            cells,
            rmse: (mean + rest).sqrt(),
            cautious: (mean + (variance / count).sqrt() + rest).sqrt(),
        }
    };
    Ok(CELLS.into_iter().enumerate().map(|(index, cells)| belief((index, cells))).collect())
}

/// The colours of each tile.
fn draw(prepared: &Prepared<'_>, view: View, tiles: &[PixelRect]) -> Result<Vec<Frame>, CliError> {
    let draw = |tile: &PixelRect| prepared.draw_view(view, &DrawOptions::DEFAULT.with_window(*tile), &());
    tiles.par_iter().map(draw).collect::<Result<_, _>>().map_err(failed)
}

/// Means of two by two pixels.
fn halved(fine: &Frame) -> Frame {
    let (width, height) = (fine.window.width() as usize / 2, fine.window.height() as usize / 2);
    let mean = |i: usize| {
        let (x, y) = (2 * (i % width), 2 * (i / width));
        let at = |dx: usize, dy: usize| fine.color[(y + dy) * 2 * width + x + dx];
        let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
        std::array::from_fn(|c| 0.25 * four.iter().map(|pixel| pixel[c]).sum::<f32>())
    };
    Frame { color: (0..width * height).map(mean).collect(), ..fine.clone() }
}

/// The mean squared difference of red, green and blue in each tile, weighted by its pixels: tiles at the edge are smaller.
fn mean_squares(a: &[Frame], b: &[Frame]) -> Vec<f64> {
    let pixels = a.iter().map(|frame| frame.color.len()).sum::<usize>() as f64 / a.len() as f64;
    let square = |(a, b): (&Frame, &Frame)| {
        let channels =
            a.color.iter().zip(&b.color).flat_map(|(a, b)| (0..3).map(move |c| f64::from(a[c] - b[c])));
        channels.map(|d| d * d).sum::<f64>() / (3.0 * pixels)
    };
    a.iter().zip(b).map(square).collect()
}
