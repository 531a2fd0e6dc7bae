//! A tile of the picture, drawn layer by layer.
//!
//! Each layer is the nearest surface behind the one before, wherever pixels are not yet opaque: its depth is that of
//! the nearest disc, and all discs that lie within their thickness behind that are averaged. Neither depends on the
//! order of discs, up to the rounding of sums, and that is fixed by the order of nodes.

use crate::frame::Band;
use crate::grid::{DRAWN_HEIGHT, DRAWN_WIDTH, SQUARE, TileRect};
use crate::kernel;
use crate::layer::{Layer, Open, PITCH, Pixels, Touched};
use crate::project::Projector;
use crate::resolve::{resolve, write};
use crate::scene::Scene;
use crate::select::Selected;
use crate::splat::Shape;
use crate::splats::Splats;
use std::ops::Range;
use std::sync::atomic::Ordering;

/// Most layers of a pixel. All that lies behind the last but one is drawn as one layer, the last.
const MOST_LAYERS: usize = 4;

/// The same in a cloud with opacities, where more is seen behind more.
const MOST_CLEAR_LAYERS: usize = 16;

/// Squares of a tile: columns, rows.
const SQUARES: [usize; 2] = [DRAWN_WIDTH.div_ceil(SQUARE), DRAWN_HEIGHT.div_ceil(SQUARE)];

/// Working memory for tiles.
pub(crate) struct Tile {
    projector: Box<Projector>,
    splats: Splats,
    /// Numbers of splats that the next layer may show.
    behind: Vec<u32>,
    layer: Layer,
    pixels: Vec<Pixels>,
    /// Farthest depth of each square, +∞ as long as a pixel is empty. None where discs were drawn since it was last
    /// asked for.
    farthest: [[Option<f32>; SQUARES[0]]; SQUARES[1]],
    /// Nodes that no pixel of the first layer shows.
    hidden: Vec<Selected>,
}

impl Default for Tile {
    fn default() -> Self {
        Self {
            projector: Projector::new(),
            splats: Splats::default(),
            behind: vec![],
            layer: Layer::new(),
            pixels: vec![Pixels::EMPTY; PITCH * DRAWN_HEIGHT],
            farthest: [[None; SQUARES[0]]; SQUARES[1]],
            hidden: vec![],
        }
    }
}

impl Tile {
    /// Draws `nodes`, those with parts in `rect`, the nearest first, and puts what tile `number` shows into its band.
    pub(crate) fn draw(
        &mut self,
        scene: &Scene<'_>,
        rect: &TileRect,
        nodes: impl Iterator<Item = Selected> + Clone,
        (band, number): (&mut Band<'_>, usize),
    ) {
        self.splats.clear();
        self.hidden.clear();
        let mut touched = Touched::NOTHING;
        nodes.clone().for_each(|s| touched.add(columns_of(&s, rect), rows_of(&s, rect)));
        self.layer.clear_near(&touched.in_squares());
        self.farthest = [[Some(f32::INFINITY); SQUARES[0]]; SQUARES[1]];
        for selected in nodes {
            if scene.culling && self.hides(&selected, rect) {
                self.hidden.push(selected);
                continue;
            }
            let first = self.splats.as_slice().len();
            self.project(scene, rect, &selected);
            kernel::nearest(&mut self.layer, &self.splats.as_slice()[first..], kernel::SOFT);
            self.forget_farthest(&selected, rect);
        }
        if self.splats.as_slice().is_empty() {
            band.clear(number);
            return;
        }
        match (scene.normals, scene.cloud.has_opacities()) {
            (false, false) => self.draw_layers::<false, false>(scene, rect, touched),
            (true, false) => self.draw_layers::<true, false>(scene, rect, touched),
            // Rarer: one more copy of the kernels is not worth what it saves.
            (_, true) => self.draw_layers::<true, true>(scene, rect, touched),
        }
        write(&self.pixels, &scene.shader, rect, (band, number));
    }

    /// Composites all layers, beginning with the splats of the first, which touch these pixels; with extras if they
    /// are `WANTED`.
    fn draw_layers<const WANTED: bool, const CLEAR: bool>(
        &mut self,
        scene: &Scene<'_>,
        rect: &TileRect,
        mut touched: Touched,
    ) {
        for blocks in touched.others(rect.height) {
            self.pixels[blocks.clone()].fill(Pixels::EMPTY);
            self.layer.open(blocks);
        }
        self.behind.clear();
        let mut open = Open::NOWHERE;
        let all = 0..self.splats.as_slice().len() as u32;
        kernel::add::<true, WANTED, CLEAR>(
            &mut self.layer,
            self.splats.as_slice(),
            all,
            &mut self.behind,
            (&open, 0.0),
        );
        open = resolve::<true, WANTED, CLEAR>(&mut self.layer, &mut self.pixels, rect, &touched);
        let most = if CLEAR { MOST_CLEAR_LAYERS } else { MOST_LAYERS };
        for number in 1..most {
            if open.is_nowhere() {
                break;
            }
            touched = self.add_hidden(scene, rect, &open);
            if self.behind.is_empty() {
                break;
            }
            let slack = if number + 1 == most { f32::INFINITY } else { 0.0 };
            open = self.next_layer::<WANTED, CLEAR>(rect, touched, (&open, slack));
        }
    }

    fn project(&mut self, scene: &Scene<'_>, rect: &TileRect, selected: &Selected) {
        scene.shown[selected.place as usize].store(true, Ordering::Relaxed);
        self.projector.project(scene, selected, &Shape::BLENDED, rect, &mut self.splats);
    }

    /// Leaves those of the discs behind that may be seen through `open` pixels, and adds those of hidden nodes, in the
    /// order of nodes. Returns all that they may touch.
    fn add_hidden(&mut self, scene: &Scene<'_>, rect: &TileRect, open: &Open) -> Touched {
        let drawn = self.splats.as_slice().len();
        let mut hidden = std::mem::take(&mut self.hidden);
        hidden.retain(|selected| {
            let mut touched = Touched::NOTHING;
            touched.add(columns_of(selected, rect), rows_of(selected, rect));
            if !open.meets(touched.columns(), touched.rows()) {
                return true;
            }
            let first = self.splats.as_slice().len() as u32;
            self.project(scene, rect, selected);
            self.behind.extend(first..self.splats.as_slice().len() as u32);
            false
        });
        self.hidden = hidden;
        let mut touched = Touched::NOTHING;
        let splats = self.splats.as_slice();
        self.behind.retain(|&i| {
            let splat = &splats[i as usize];
            let is_seen = open.meets(splat.blocks(), splat.rows());
            if is_seen {
                touched.add(splat.columns.map(usize::from), splat.rows.map(usize::from));
            }
            is_seen
        });
        if self.splats.as_slice().len() > drawn {
            // Sums are rounded, so terms must be added in the same order as without culling.
            self.splats.sort_by_node(&mut self.behind);
        }
        touched
    }

    fn next_layer<const WANTED: bool, const CLEAR: bool>(
        &mut self,
        rect: &TileRect,
        touched: Touched,
        limits: (&Open, f32),
    ) -> Open {
        self.layer.clear_near(&touched);
        kernel::nearest_behind(&mut self.layer, self.splats.as_slice(), &self.behind, limits.0);
        let candidates = std::mem::take(&mut self.behind);
        let numbers = candidates.iter().copied();
        kernel::add::<false, WANTED, CLEAR>(
            &mut self.layer,
            self.splats.as_slice(),
            numbers,
            &mut self.behind,
            limits,
        );
        resolve::<false, WANTED, CLEAR>(&mut self.layer, &mut self.pixels, rect, &touched)
    }

    fn hides(&mut self, selected: &Selected, rect: &TileRect) -> bool {
        let limit = selected.nearest - selected.thickness;
        let [columns, rows] = squares_of(selected, rect);
        rows.into_iter().all(|row| columns.clone().all(|column| self.farthest(rect, column, row) < limit))
    }

    fn farthest(&mut self, rect: &TileRect, column: usize, row: usize) -> f32 {
        *self.farthest[row][column].get_or_insert_with(|| {
            let [columns, rows] = pixels_of_square(rect, [column, row]);
            kernel::farthest(&self.layer, columns, rows)
        })
    }

    fn forget_farthest(&mut self, selected: &Selected, rect: &TileRect) {
        let [columns, rows] = squares_of(selected, rect);
        self.farthest[rows].iter_mut().for_each(|row| row[columns.clone()].fill(None));
    }
}

/// The pixels of a tile that a node touches, the last not included: columns, rows.
fn columns_of(selected: &Selected, rect: &TileRect) -> [usize; 2] {
    within(selected.x, rect.x, rect.width)
}

fn rows_of(selected: &Selected, rect: &TileRect) -> [usize; 2] {
    within(selected.y, rect.y, rect.height)
}

fn within([first, last]: [u16; 2], start: usize, size: usize) -> [usize; 2] {
    let end = |v: u16| usize::from(v).saturating_sub(start).min(size - 1);
    [end(first), end(last) + 1]
}

/// Columns and rows of pixels.
fn pixels_of_square(rect: &TileRect, [column, row]: [usize; 2]) -> [Range<usize>; 2] {
    let span = |square: usize, size: usize| square * SQUARE..((square + 1) * SQUARE).min(size);
    [span(column, rect.width), span(row, rect.height)]
}

/// The squares of a tile that a node touches.
fn squares_of(selected: &Selected, rect: &TileRect) -> [Range<usize>; 2] {
    [columns_of(selected, rect), rows_of(selected, rect)].map(|[a, b]| a / SQUARE..b.div_ceil(SQUARE))
}
