//! A tile of the picture, drawn layer by layer.
//!
//! Each layer is the nearest surface behind the one before, wherever pixels are not yet opaque: its depth is that of the
//! nearest disc, and all discs that lie within their thickness behind that are averaged. Neither depends on the order of
//! discs, up to the rounding of sums, and that is fixed by the order of nodes.

use crate::camera::Camera;
use crate::cloud::Cloud;
use crate::frame::Band;
use crate::kernel;
use crate::select::Selected;
use crate::shade::{Pixel, Shader, opacity};
use crate::splat::{Items, Projector, Shape, Splat};
use std::sync::atomic::{AtomicBool, Ordering};

/// Pixels of a tile: sums and depths fit into the second-level cache.
pub(crate) const WIDTH: usize = 128;
pub(crate) const HEIGHT: usize = 64;

/// Entries from row to row: runs of lanes may reach beyond the tile.
pub(crate) const PITCH: usize = WIDTH + kernel::LANES;

/// Surfaces behind one another in a pixel. All that lies behind the last but one is taken for the last.
const MOST_LAYERS: usize = 4;

/// Less weight is none: its inverse would not be a number that can be used.
const LEAST_WEIGHT: f32 = 1e-30;

/// Beside a pixel with less weight than this there is an edge.
const LEAST_INSIDE: f32 = 0.25;

/// Side of the squares for which the farthest depth is kept, to skip what is hidden.
const SQUARE: usize = 16;
const SQUARES: [usize; 2] = [WIDTH / SQUARE, HEIGHT / SQUARE];

/// Weighted sums of a pixel: weight, bent depth, normal, colour.
pub(crate) type Sums = [f32; 8];

/// Where a tile lies in the picture, in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) x: usize,
    pub(crate) y: usize,
    pub(crate) width: usize,
    pub(crate) height: usize,
}

/// Depths and sums of the layer that is being drawn.
pub(crate) struct Layer {
    /// Bent depth and sharpness of the nearest disc.
    pub(crate) near: Vec<f32>,
    pub(crate) sharpness: Vec<f32>,
    /// The same of the layer before: discs must lie behind it by more than their thickness. +∞ where the pixel is done.
    pub(crate) floor: Vec<f32>,
    pub(crate) sums: Vec<Sums>,
}

impl Layer {
    pub(crate) fn new() -> Self {
        let n = PITCH * HEIGHT;
        let plane = vec![0.0; n];
        Self { near: plane.clone(), sharpness: plane.clone(), floor: plane, sums: vec![[0.0; 8]; n] }
    }

    /// The weight of a pixel, or, inside a surface, that of the 3×3 pixels around it if it is larger.
    ///
    /// Weights vary between points. Over an edge that is blurred they fall evenly: there the mean is that of the middle.
    fn evened(&self, place: &Place, column: usize, row: usize) -> f32 {
        let own = self.sums[row * PITCH + column][0];
        if own >= 1.0 {
            return own;
        }
        let around = |at: usize, size: usize| at.saturating_sub(1)..(at + 2).min(size);
        let (mut sum, mut count, mut least) = (0.0, 0.0, own);
        for y in around(row, place.height) {
            for sums in &self.sums[y * PITCH..][around(column, place.width)] {
                (sum, count, least) = (sum + sums[0], count + 1.0, least.min(sums[0]));
            }
        }
        if least > LEAST_INSIDE { own.max(sum / count) } else { own }
    }
}

/// Working memory for tiles.
pub(crate) struct Tile {
    projector: Box<Projector>,
    splats: Vec<Splat>,
    /// Numbers of splats that the next layer may show.
    behind: Vec<u32>,
    layer: Layer,
    pixels: Vec<Pixel>,
    /// Farthest depth of each square, +∞ as long as a pixel is empty.
    farthest: [[f32; SQUARES[0]]; SQUARES[1]],
    /// Nodes that no pixel of the first layer shows.
    hidden: Vec<Selected>,
}

impl Default for Tile {
    fn default() -> Self {
        Self {
            projector: Projector::new(),
            splats: vec![],
            behind: vec![],
            layer: Layer::new(),
            pixels: vec![Pixel::EMPTY; PITCH * HEIGHT],
            farthest: [[f32::INFINITY; SQUARES[0]]; SQUARES[1]],
            hidden: vec![],
        }
    }
}

/// What all tiles of a frame share.
pub(crate) struct Scene<'a> {
    pub(crate) cloud: &'a Cloud,
    pub(crate) camera: Camera,
    pub(crate) shader: Shader,
    pub(crate) culling: bool,
    /// Which of the selected nodes any tile has drawn.
    pub(crate) shown: &'a [AtomicBool],
}

/// Pixels of a tile that discs may touch.
#[derive(Clone, Copy)]
struct Touched {
    columns: [usize; 2],
    rows: [usize; 2],
}

impl Touched {
    const NOTHING: Self = Self { columns: [WIDTH, 0], rows: [HEIGHT, 0] };

    fn add(&mut self, splats: &[Splat]) {
        for s in splats {
            self.columns[0] = self.columns[0].min(s.columns[0].into());
            self.columns[1] = self.columns[1].max(s.columns[1].into());
            self.rows[0] = self.rows[0].min(s.rows[0].into());
            self.rows[1] = self.rows[1].max(s.rows[1].into());
        }
    }

    /// Indices of a row's pixels.
    fn pixels(&self, row: usize) -> std::ops::Range<usize> {
        row * PITCH + self.columns[0]..row * PITCH + self.columns[1]
    }
}

impl Tile {
    /// Draws `nodes`, those with parts in the tile, the nearest first.
    pub(crate) fn draw(
        &mut self,
        scene: &Scene<'_>,
        place: &Place,
        nodes: impl Iterator<Item = Selected>,
        band: &mut Band<'_>,
    ) {
        self.splats.clear();
        self.hidden.clear();
        self.layer.near.fill(f32::INFINITY);
        self.farthest = [[f32::INFINITY; SQUARES[0]]; SQUARES[1]];
        let mut touched = Touched::NOTHING;
        for selected in nodes {
            if scene.culling && self.hides(&selected, place) {
                self.hidden.push(selected);
                continue;
            }
            let first = self.splats.len();
            self.project(scene, place, &selected);
            kernel::nearest::<true>(&mut self.layer, &self.splats[first..]);
            touched.add(&self.splats[first..]);
            self.note_farthest(&selected, place);
        }
        if self.splats.is_empty() {
            band.clear(place.x / WIDTH);
            return;
        }
        for row in 0..place.height {
            self.pixels[row * PITCH..][..WIDTH].fill(Pixel::EMPTY);
        }
        self.behind.clear();
        let all = 0..self.splats.len() as u32;
        kernel::add::<true>(&mut self.layer, &self.splats, all, &mut self.behind, 0.0);
        let mut open = self.resolve(scene, place, touched);
        for number in 1..MOST_LAYERS {
            if !open {
                break;
            }
            touched = self.add_hidden(scene, place);
            if self.behind.is_empty() {
                break;
            }
            let slack = if number + 1 == MOST_LAYERS { f32::INFINITY } else { 0.0 };
            open = self.next_layer(scene, place, touched, slack);
        }
        self.write(scene, place, band);
    }

    fn project(&mut self, scene: &Scene<'_>, place: &Place, selected: &Selected) {
        let node = &scene.cloud.nodes[selected.node as usize];
        scene.shown[selected.place as usize].store(true, Ordering::Relaxed);
        let items = Items { node, stride: selected.stride.into() };
        self.projector.project(scene.cloud, &items, &scene.camera, &Shape::BLENDED, place, &mut self.splats);
    }

    /// Projects those of the hidden nodes that may be seen through pixels that are not done; what all discs that are left may
    /// touch.
    fn add_hidden(&mut self, scene: &Scene<'_>, place: &Place) -> Touched {
        let mut hidden = std::mem::take(&mut self.hidden);
        hidden.retain(|selected| {
            if !self.is_open_in(selected, place) {
                return true;
            }
            let first = self.splats.len() as u32;
            self.project(scene, place, selected);
            self.behind.extend(first..self.splats.len() as u32);
            false
        });
        self.hidden = hidden;
        let mut touched = Touched::NOTHING;
        self.behind.iter().for_each(|&i| touched.add(&self.splats[i as usize..=i as usize]));
        touched
    }

    fn next_layer(&mut self, scene: &Scene<'_>, place: &Place, touched: Touched, slack: f32) -> bool {
        for row in touched.rows[0]..touched.rows[1] {
            self.layer.near[touched.pixels(row)].fill(f32::INFINITY);
        }
        kernel::nearest_of(&mut self.layer, &self.splats, &self.behind);
        let candidates = std::mem::take(&mut self.behind);
        let numbers = candidates.iter().copied();
        kernel::add::<false>(&mut self.layer, &self.splats, numbers, &mut self.behind, slack);
        self.resolve(scene, place, touched)
    }

    /// Lays the layer under what is there; whether any pixel that it touched lets light through.
    fn resolve(&mut self, scene: &Scene<'_>, place: &Place, touched: Touched) -> bool {
        let mut open = false;
        for row in touched.rows[0]..touched.rows[1] {
            for i in touched.pixels(row) {
                let sums = &self.layer.sums[i];
                if sums[0].is_nan() || sums[0] <= LEAST_WEIGHT {
                    // Nothing here, now or later.
                    self.layer.floor[i] = f32::INFINITY;
                    continue;
                }
                let column = i - row * PITCH;
                let alpha = opacity(self.layer.evened(place, column, row), self.layer.sharpness[i]);
                let at = (place.x + column, place.y + row);
                let done = scene.shader.lay_under(&mut self.pixels[i], sums, alpha, at);
                self.layer.floor[i] = if done { f32::INFINITY } else { self.layer.near[i] };
                open |= !done;
            }
        }
        for row in touched.rows[0]..touched.rows[1] {
            self.layer.sums[touched.pixels(row)].fill([0.0; 8]);
        }
        open
    }

    fn write(&self, scene: &Scene<'_>, place: &Place, band: &mut Band<'_>) {
        band.drawn[place.x / WIDTH] = true;
        for row in 0..place.height {
            let from = &self.pixels[row * PITCH..][..place.width];
            let to = row * band.width + place.x..row * band.width + place.x + place.width;
            for (pixel, colour) in from.iter().zip(&mut band.colour[to.clone()]) {
                *colour = pixel.colour;
            }
            for (pixel, depth) in from.iter().zip(&mut band.depth[to.clone()]) {
                *depth = scene.shader.depth(pixel);
            }
            if let Some(normals) = &mut band.normal {
                for (pixel, normal) in from.iter().zip(&mut normals[to]) {
                    *normal = scene.shader.in_world(pixel.normal.into());
                }
            }
        }
    }

    /// Squares that a node touches in the tile.
    fn squares(selected: &Selected, place: &Place) -> [std::ops::RangeInclusive<usize>; 2] {
        let range = |ends: [u16; 2], start: usize, size: usize| {
            let end = |v: u16| usize::from(v).saturating_sub(start).min(size - 1);
            end(ends[0]) / SQUARE..=end(ends[1]) / SQUARE
        };
        [range(selected.x, place.x, place.width), range(selected.y, place.y, place.height)]
    }

    fn hides(&self, selected: &Selected, place: &Place) -> bool {
        let [columns, rows] = Self::squares(selected, place);
        let limit = selected.nearest - selected.thickness;
        rows.into_iter().all(|row| self.farthest[row][columns.clone()].iter().all(|far| *far < limit))
    }

    fn note_farthest(&mut self, selected: &Selected, place: &Place) {
        let [columns, rows] = Self::squares(selected, place);
        for y in rows {
            for x in columns.clone() {
                let lines = y * SQUARE..((y + 1) * SQUARE).min(place.height);
                let width = SQUARE.min(place.width - x * SQUARE);
                let line = |row: usize| &self.layer.near[row * PITCH + x * SQUARE..][..width];
                let far = |row: usize| {
                    line(row).iter().fold(f32::NEG_INFINITY, |far, &d| if d > far { d } else { far })
                };
                self.farthest[y][x] = lines.map(far).fold(f32::NEG_INFINITY, f32::max);
            }
        }
    }

    fn is_open_in(&self, selected: &Selected, place: &Place) -> bool {
        let range = |ends: [u16; 2], start: usize, size: usize| {
            let end = |v: u16| usize::from(v).saturating_sub(start).min(size - 1);
            end(ends[0])..=end(ends[1])
        };
        let columns = range(selected.x, place.x, place.width);
        range(selected.y, place.y, place.height)
            .any(|row| self.layer.floor[row * PITCH..][columns.clone()].iter().any(|f| *f < f32::INFINITY))
    }
}
