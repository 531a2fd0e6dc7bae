//! `render --error E`: the fewest cells a pixel with which the picture is expected to be right to E.
//!
//! Coverage is exact; what depends on the cells is what is taken to be constant in one: highlights, normal maps, what a mask lets through. Such errors
//! may all be in a handful of pixels, where the sun is mirrored, which few tiles taken anywhere would miss. So
//!
//! 1. the whole picture is drawn with 1 and with 2 cells a pixel side, which says roughly where it is wrong;
//! 2. the tiles in which these two differ most are looked at, and tiles that are spread over the rest and stand for it;
//! 3. there, pictures with 1, 2 and 4 cells a pixel side are compared with one of 8 (4, at twice the resolution). Their differences shrink by
//!    a steady factor, and so the error of the 8 itself is that of a geometric series.

use super::draw::failed;
use super::sample_tiles::{TILE, sample_size, spread};
use crate::commands::Report;
use crate::error::CliError;
use crate::image_io::{Frame, PixelRect};
use crate::job::RenderJob;
use crate::scene::{LoadedScene, Scene};
use pointillist_render::{DrawOptions, Prepared, View, fingerprint};
use rayon::prelude::*;

/// What `render.subpixel` can be.
const CELLS: [u32; 3] = [1, 2, 4];
/// Differences that shrink by less than this from step to step are not trusted to shrink on.
const SLOWEST: f64 = 0.7;
/// Rows of tiles that are drawn at once where the whole picture is: memory for pictures of any height.
const ROWS: u32 = 16;

/// Errors of a picture with so many cells, as far as the tiles show.
struct Belief {
    cells: u32,
    /// Root of the mean square, R G B.
    rmse: f64,
    /// The same with one standard error of the sample's mean square added.
    cautious: f64,
}

/// Tiles that are looked at: those that are roughly worst, and some that stand for all others.
struct Looked {
    tiles: Vec<PixelRect>,
    /// The first so many stand for themselves.
    worst: usize,
    /// How many tiles each of the others stands for.
    weight: f64,
    /// Pixels of the whole picture.
    pixels: f64,
}

/// Chooses `render.subpixel` for the scene, and tells what is expected.
pub(super) fn choose(
    loaded: &mut LoadedScene,
    job: &RenderJob,
    most: f64,
    report: &Report<'_>,
) -> Result<(), CliError> {
    // Of the whole job: tiles of one picture choose the same.
    let (beliefs, looked_at) = report.stats.stage("error", || beliefs(loaded, job.region))?;
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
        "render.subpixel = {}: an RMSE of {:.1e} is expected, {:.1e} with caution, from {looked_at} tiles ({})",
        belief.cells,
        belief.rmse,
        belief.cautious,
        all.join(", ")
    ));
    if chosen.is_none() {
        report.warn(&format!(
            "--error {most}: not reached with the most cells there are; a larger --size, averaged, has less"
        ));
    }
    Ok(())
}

/// What is believed of each number of cells, and from how many tiles.
fn beliefs(loaded: &LoadedScene, region: PixelRect) -> Result<(Vec<Belief>, usize), CliError> {
    let mut scene = loaded.scene.clone();
    let shared = Prepared::new(&loaded.scene, &()).map_err(failed)?;
    let size = [scene.image.width, scene.image.height];
    let view = |times: u32| -> Result<View, CliError> {
        let size = size.map(|n| n.saturating_mul(times));
        scene.camera.view(size).map_err(|error| failed(error.into()))
    };
    let (own, double) = (view(1)?, view(2)?);
    let looked = Looked::new(&shared, &scene, own, region)?;
    let mut drawn = vec![];
    for cells in CELLS {
        scene.render.cells_per_pixel = Some(cells);
        let prepared = shared.with_scene(&scene).map_err(failed)?;
        drawn.push(draw(&prepared, own, &looked.tiles)?);
        if cells == CELLS[CELLS.len() - 1] {
            let doubled =
                |t: &PixelRect| PixelRect { x0: 2 * t.x0, y0: 2 * t.y0, x1: 2 * t.x1, y1: 2 * t.y1 };
            let fine = draw(&prepared, double, &looked.tiles.iter().map(doubled).collect::<Vec<_>>())?;
            drawn.push(fine.iter().map(halved).collect());
        }
    }
    let step = |from: usize, to: usize| Step { from: &drawn[from], to: &drawn[to] };
    let (before, last) = (step(1, 2), step(2, 3));
    let [before_size, last_size] = [before, last].map(|step| looked.mean_product(step, step).0.sqrt());
    let shrinks = if before_size > 0.0 { (last_size / before_size).min(SLOWEST) } else { 0.0 };
    let rest = last_size * shrinks / (1.0 - shrinks);
    // Steps of what is smooth go the same way and add up, those of what is caught or missed by chance do not.
    let product = before_size * last_size;
    let alike = if product > 0.0 { (looked.mean_product(before, last).0 / product).max(0.0) } else { 0.0 };
    let belief = |(index, cells): (usize, u32)| {
        let to_finest = step(index, CELLS.len());
        let (mean, standard_error) = looked.mean_product(to_finest, to_finest);
        let with_rest = |mean: f64| (mean + 2.0 * alike * mean.sqrt() * rest + rest * rest).sqrt();
        Belief { cells, rmse: with_rest(mean), cautious: with_rest(mean + standard_error) }
    };
    Ok((CELLS.into_iter().enumerate().map(belief).collect(), looked.tiles.len()))
}

/// The difference of the same tiles in two pictures.
#[derive(Clone, Copy)]
struct Step<'f> {
    from: &'f [Frame],
    to: &'f [Frame],
}

impl Looked {
    /// Draws the whole picture with 1 and with 2 cells a pixel side, and chooses by what differs.
    fn new(shared: &Prepared<'_>, scene: &Scene, view: View, region: PixelRect) -> Result<Self, CliError> {
        let mut scenes = [scene.clone(), scene.clone()];
        scenes.iter_mut().zip(CELLS).for_each(|(scene, cells)| scene.render.cells_per_pixel = Some(cells));
        let [one, two] = &scenes;
        let pictures = [shared.with_scene(one).map_err(failed)?, shared.with_scene(two).map_err(failed)?];
        let mut rough: Vec<(f64, PixelRect)> = vec![];
        for y0 in (region.y0..region.y1).step_by((ROWS * TILE) as usize) {
            let window = PixelRect { y0, y1: region.y1.min(y0 + ROWS * TILE), ..region };
            let draw = |picture: &Prepared<'_>| {
                picture.draw_view(view, &DrawOptions::DEFAULT.with_window(window), &()).map_err(failed)
            };
            let (a, b) = (draw(&pictures[0])?, draw(&pictures[1])?);
            rough.extend(window.tiles(TILE).map(|tile| (product_within([&a, &b], [&a, &b], tile), tile)));
        }
        let count = sample_size(rough.len());
        // Stable: tiles that are alike stay in order.
        rough.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut tiles: Vec<PixelRect> = rough.iter().map(|&(_, tile)| tile).collect();
        let mut others = tiles.split_off(count);
        others.sort_by_key(|tile| (tile.y0, tile.x0));
        let spread = spread(&others);
        let weight = if spread.is_empty() { 0.0 } else { others.len() as f64 / spread.len() as f64 };
        tiles.extend(spread);
        Ok(Self { tiles, worst: count, weight, pixels: region.pixels() as f64 })
    }

    /// The mean product of two differences, of red, green and blue over the picture, and its standard error.
    fn mean_product(&self, a: Step<'_>, b: Step<'_>) -> (f64, f64) {
        let product =
            |i: usize| product_within([&a.from[i], &a.to[i]], [&b.from[i], &b.to[i]], self.tiles[i]);
        let products: Vec<f64> = (0..self.tiles.len()).map(product).collect();
        let (worst, others) = products.split_at(self.worst);
        let sum = worst.iter().sum::<f64>() + self.weight * others.iter().sum::<f64>();
        let count = others.len() as f64;
        let mean = others.iter().sum::<f64>() / count.max(1.0);
        let variance = others.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        // Of all others drawn, nothing is left to chance.
        let left = (1.0 - 1.0 / self.weight.max(1.0)) * count * variance;
        (sum / self.pixels, self.weight * left.sqrt() / self.pixels)
    }
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

/// The product of two differences in a rectangle that all frames have, mean of red, green and blue, sum of pixels.
fn product_within([a, b]: [&Frame; 2], [c, d]: [&Frame; 2], tile: PixelRect) -> f64 {
    let window = a.window;
    let of_pixel = |i: usize| {
        let channel = |k: usize| {
            let difference = |a: &Frame, b: &Frame| f64::from(a.color[i][k]) - f64::from(b.color[i][k]);
            difference(a, b) * difference(c, d)
        };
        (0..3).map(channel).sum::<f64>()
    };
    let of_row = |y: u32| {
        let start = ((y - window.y0) * window.width() + tile.x0 - window.x0) as usize;
        (start..start + tile.width() as usize).map(of_pixel).sum::<f64>()
    };
    (tile.y0..tile.y1).map(of_row).sum::<f64>() / 3.0
}
