//! What a point sees of a light behind many outlines, cell by cell of a grid over the light.
//!
//! Under a roof nearly all outlines lie behind it and show nothing, but a sweep over the light has to put each in its place. Here, cells that one
//! connected piece of opaque casters covers are found first, from that piece's outlines alone: around a point of known winding number, it
//! cannot fall by more than the outlines that meet the cell take away. What is left of the light is swept cell by cell, each with the outlines in its row.
//!
//! A cell that is left out would have shown nothing, and whether the grid is used depends on the light's outlines alone: which casters a group has changes no bit.

use super::light::SeenLight;
use super::sheets::{Kind, Sheets};
use super::sweep::Sweep;
use glam::{DVec2, dvec2};
use pointillist_dice::{clip_ring, convex, share_before_crossing};
use std::ops::Range;

/// Rows and columns of the grid.
const SIDE: usize = 8;

/// All cells of a row.
const ROW: u64 = (1 << SIDE) - 1;

/// A light with more outlines than this is divided, and its cells are, so many times.
const MANY: usize = 192;
const LEVELS: u32 = 3;

/// So many edges on the left of a cell are not joined.
const FEW_LEFT: usize = 16;

/// Cutting a polygon out of a cell may give it so many vertices more.
const CORNERS: usize = 4;

/// Edges this close to a cell are taken to meet it: a share of its size and of their length, and of their coordinates.
const NEAR: f64 = 1e-9;
const ROUNDING: f64 = 1e-14;

/// An edge of an outline, projected onto the light's plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outlined {
    pub(crate) from: DVec2,
    pub(crate) to: DVec2,
    pub(crate) winding: i32,
    pub(crate) kind: Kind,
    /// The number of the edge, or of one of its sheet's.
    pub(crate) edge: u32,
}

/// The outlines that a point sees, and memory.
#[derive(Debug, Default)]
pub(crate) struct LightCells {
    edges: Vec<Outlined>,
    /// For each edge of the batch, the number of the connected piece of casters that it belongs to; empty as long as nobody asked.
    pieces: Vec<u32>,
    /// Opaque edges by their pieces.
    by_piece: Vec<(u32, u32)>,
    steps: Vec<Step>,
}

/// Where the winding number on the left of a cell changes, upward.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// Kind and piece.
    key: (Kind, u32),
    y: f64,
    change: i32,
    edge: u32,
}

impl LightCells {
    /// Begins a batch.
    pub(crate) fn start(&mut self) {
        self.pieces.clear();
    }

    /// Begins with another point.
    pub(crate) fn clear(&mut self) {
        self.edges.clear();
    }

    pub(crate) fn push(&mut self, edge: Outlined) {
        self.edges.push(edge);
    }

    /// Appends what is visible of a convex polygon in positive order.
    pub(crate) fn see(
        &mut self,
        polygon: &[DVec2],
        sheets: &Sheets,
        sweep: &mut Sweep,
        seen: &mut SeenLight,
    ) {
        let Self { edges, pieces, by_piece, steps } = self;
        Division { pieces, by_piece, steps, sheets, sweep, seen }.see(polygon, edges, LEVELS);
    }
}

/// A light while it is divided.
struct Division<'a> {
    pieces: &'a mut Vec<u32>,
    by_piece: &'a mut Vec<(u32, u32)>,
    steps: &'a mut Vec<Step>,
    sheets: &'a Sheets,
    sweep: &'a mut Sweep,
    seen: &'a mut SeenLight,
}

impl Division<'_> {
    /// Appends what is visible of a polygon, which may be divided so many times.
    fn see(&mut self, polygon: &[DVec2], edges: &[Outlined], levels: u32) {
        self.sweep.start(polygon);
        edges.iter().for_each(|e| self.sweep.add(e.from, e.to, e.winding, e.kind));
        let is_simple = self.sweep.outline_count() <= MANY;
        if is_simple || levels == 0 || polygon.len() + CORNERS > convex::MAX_VERTICES {
            return self.sweep.finish(polygon, self.sheets, self.seen);
        }
        let grid = Grid::over(polygon);
        let hidden = self.hidden_cells(&grid, edges);
        let (mut row, mut strip, mut cell) = (vec![], vec![], vec![]);
        for r in (0..SIDE).filter(|r| hidden >> (r * SIDE) & ROW != ROW) {
            let (low, high) = (grid.line(r, 1), grid.line(r + 1, 1));
            between(polygon, 1, (low, high), &mut strip);
            row.clear();
            let meets = |e: &&Outlined| {
                e.from.y.max(e.to.y) > low
                    && e.from.y.min(e.to.y) < high
                    && e.from.x.min(e.to.x) < grid.high.x
            };
            row.extend(edges.iter().filter(meets));
            for c in (0..SIDE).filter(|c| hidden >> (r * SIDE + c) & 1 == 0) {
                let (left, right) = (grid.line(c, 0), grid.line(c + 1, 0));
                between(&strip, 0, (left, right), &mut cell);
                if convex::area(&cell) > 0.0 {
                    self.join_left(&mut row, left, (low, high));
                    self.see(&cell, &row, levels - 1);
                }
            }
        }
    }

    /// Joins the edges of a row that lie to the left of a place: of each piece, its winding number there is all that counts.
    fn join_left(&mut self, row: &mut Vec<Outlined>, x: f64, (low, high): (f64, f64)) {
        let is_left = |e: &Outlined| e.from.x.max(e.to.x) <= x;
        if row.iter().filter(|e| is_left(e)).count() <= FEW_LEFT {
            return;
        }
        let Self { pieces, steps, .. } = self;
        steps.clear();
        row.retain(|e| {
            if !is_left(e) {
                return true;
            }
            let (from, to) = (e.from.y.clamp(low, high), e.to.y.clamp(low, high));
            let key = (e.kind, pieces[e.edge as usize]);
            steps.push(Step { key, y: from, change: e.winding, edge: e.edge });
            steps.push(Step { key, y: to, change: -e.winding, edge: e.edge });
            false
        });
        steps.sort_unstable_by(|a, b| a.key.cmp(&b.key).then(a.y.total_cmp(&b.y)));
        // Of each piece the steps add up to 0, so that the next one begins with no winding.
        let (mut winding, mut from) = (0, low);
        for same in steps.chunk_by(|a, b| a.key == b.key && a.y == b.y) {
            let Step { key: (kind, _), y, edge, .. } = same[0];
            let change: i32 = same.iter().map(|s| s.change).sum();
            if change != 0 {
                if winding != 0 {
                    row.push(Outlined { from: dvec2(x, from), to: dvec2(x, y), winding, kind, edge });
                }
                (winding, from) = (winding + change, y);
            }
        }
    }

    /// The cells that some piece of opaque casters covers by itself, as bits, row by row.
    fn hidden_cells(&mut self, grid: &Grid, edges: &[Outlined]) -> u64 {
        if self.pieces.is_empty() {
            *self.pieces = self.sheets.connected_edges();
        }
        let Self { pieces, by_piece, .. } = self;
        by_piece.clear();
        let opaque = edges.iter().enumerate().filter(|(_, e)| e.kind == 0);
        by_piece.extend(opaque.map(|(i, e)| (pieces[e.edge as usize], i as u32)));
        by_piece.sort_unstable();
        let mut hidden = 0;
        for piece in by_piece.chunk_by(|a, b| a.0 == b.0) {
            let own = || piece.iter().map(|&(_, i)| &edges[i as usize]);
            // Edges on the right of the grid may be missing, those on the left of a cell that is covered are as high as it.
            let heights = own().flat_map(|e| [e.from.y, e.to.y]);
            let (low, high) =
                heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
            if high - low < grid.size.y {
                continue;
            }
            let mut layers = Layers::default();
            own().for_each(|e| layers.add(grid, e));
            hidden |= layers.covered();
        }
        hidden
    }
}

/// What is between two values of one coordinate of a convex polygon.
fn between(polygon: &[DVec2], axis: usize, (low, high): (f64, f64), part: &mut Vec<DVec2>) {
    let crossing = |at: f64| {
        move |(a, va): (DVec2, f64), (b, vb): (DVec2, f64)| {
            let mut p = a + (b - a) * share_before_crossing(va, vb);
            p[axis] = at;
            p
        }
    };
    let mut above = vec![];
    clip_ring(polygon, |p| p[axis] - low, crossing(low), |p| above.push(p));
    part.clear();
    clip_ring(&above, |p| high - p[axis], crossing(high), |p| part.push(p));
}

/// A grid over the bounding rectangle of a light.
struct Grid {
    low: DVec2,
    high: DVec2,
    size: DVec2,
}

impl Grid {
    fn over(polygon: &[DVec2]) -> Self {
        let (low, high) = convex::bounds(polygon);
        Self { low, high, size: (high - low) / SIDE as f64 }
    }

    /// The line before a row or column.
    fn line(&self, i: usize, axis: usize) -> f64 {
        if i == SIDE { self.high[axis] } else { self.low[axis] + self.size[axis] * i as f64 }
    }

    /// The middle of a row or column.
    fn middle(&self, i: usize, axis: usize) -> f64 {
        self.low[axis] + self.size[axis] * (i as f64 + 0.5)
    }

    /// The rows or columns that meet a range, or are so near that rounding decides; none if it is beside the grid.
    fn range(&self, from: f64, to: f64, near: f64, axis: usize) -> Range<usize> {
        let place = |v: f64| (v - self.low[axis]) / self.size[axis];
        let (first, last) = (place(from.min(to) - near), place(from.max(to) + near));
        if first < SIDE as f64 && last >= 0.0 {
            first.max(0.0) as usize..(last as usize + 1).min(SIDE)
        } else {
            0..0
        }
    }
}

/// How many layers of one piece of casters lie over the cells of a grid.
#[derive(Default)]
struct Layers {
    /// Over the middle of a cell, less those over the middle of the one on its left.
    steps: [[i32; SIDE]; SIDE],
    /// How many fewer may lie over the rest of a cell.
    fewer: [[i32; SIDE]; SIDE],
}

impl Layers {
    fn add(&mut self, grid: &Grid, edge: &Outlined) {
        let &Outlined { from, to, winding, .. } = edge;
        // Layers to the right of it, less those to its left: a layer's winding number is −1.
        let (low, high, more) = if from.y < to.y { (from, to, -winding) } else { (to, from, winding) };
        if high.y < grid.low.y || low.y > grid.high.y || low.x.min(high.x) > grid.high.x {
            return;
        }
        let along = high - low;
        let near = NEAR * (grid.size + along.abs()) + ROUNDING * low.abs().max(high.abs());
        let x_at = |y: f64| low.x + (y.min(high.y) - low.y).max(0.0) * (along.x / along.y);
        // Rounding moves a place along an edge that is nearly level by much of its length.
        let is_level = along.y <= near.y;
        for row in grid.range(low.y, high.y, near.y, 1) {
            let middle = grid.middle(row, 1);
            let mut next = None;
            if low.y <= middle && middle < high.y {
                let place = (x_at(middle) - grid.low.x) / grid.size.x;
                // The first column of which the middle is on the right.
                let first = (place + 0.5).floor().clamp(0.0, SIDE as f64) as usize;
                if first < SIDE {
                    self.steps[row][first] += more;
                }
                next = Some(first);
            }
            let (left, right) = if is_level {
                (low.x, high.x)
            } else {
                (x_at(grid.line(row, 1) - near.y), x_at(grid.line(row + 1, 1) + near.y))
            };
            for column in grid.range(left, right, near.x, 0) {
                let is_right = next.map_or_else(
                    || along.perp_dot(dvec2(grid.middle(column, 0), middle) - low) < 0.0,
                    |first| column >= first,
                );
                self.fewer[row][column] += if is_right { more.max(0) } else { (-more).max(0) };
            }
        }
    }

    /// The cells with a layer all over, as bits.
    fn covered(&self) -> u64 {
        let mut bits = 0;
        for (row, (steps, fewer)) in self.steps.iter().zip(&self.fewer).enumerate() {
            let mut layers = 0;
            for (column, (step, fewer)) in steps.iter().zip(fewer).enumerate() {
                layers += step;
                bits |= u64::from(layers > *fewer) << (row * SIDE + column);
            }
        }
        bits
    }
}

#[cfg(test)]
mod tests {
    use super::super::sweep::tests::Numbers;
    use super::*;
    use std::f64::consts::TAU;

    /// Rings of so many edges about random middles, each a connected piece of casters.
    fn rings(seed: u64, count: u32, sides: u32) -> (Vec<Outlined>, Vec<u32>) {
        let mut numbers = Numbers(seed);
        let (mut edges, mut pieces) = (vec![], vec![]);
        for piece in 0..count {
            let mut any = |size: f64| (numbers.next() - 0.5) * size;
            let (middle, radius) =
                (dvec2(any(3.0), any(3.0)), 0.1 + any(0.2) + if piece % 5 == 0 { 0.8 } else { 0.0 });
            let corners: Vec<DVec2> = (0..sides)
                .map(|i| {
                    middle
                        + radius * (1.0 + any(0.6)) * DVec2::from_angle(TAU * f64::from(i) / f64::from(sides))
                })
                .collect();
            for (i, &from) in corners.iter().enumerate() {
                let to = corners[(i + 1) % corners.len()];
                edges.push(Outlined { from, to, winding: 1, kind: 0, edge: edges.len() as u32 });
                pieces.push(piece);
            }
        }
        (edges, pieces)
    }

    const LIGHT: [DVec2; 4] = [dvec2(-1.0, -0.5), dvec2(0.5, -1.0), dvec2(1.0, 0.75), dvec2(-0.75, 1.0)];

    fn seen(edges: &[Outlined], pieces: &[u32], levels: u32) -> SeenLight {
        let (mut sweep, mut seen) = (Sweep::default(), SeenLight::default());
        let (mut pieces, mut by_piece) = (pieces.to_vec(), vec![]);
        let sheets = &Sheets::default();
        let (pieces, by_piece, steps) = (&mut pieces, &mut by_piece, &mut vec![]);
        Division { pieces, by_piece, steps, sheets, sweep: &mut sweep, seen: &mut seen }
            .see(&LIGHT, edges, levels);
        seen
    }

    #[test]
    fn cells_show_what_the_whole_shows() {
        let mut dark = 0;
        for seed in 0..200 {
            let (edges, pieces) = rings(seed, 4 + seed as u32 % 40, 3 + seed as u32 % 17);
            let whole = seen(&edges, &pieces, 0).area();
            let by_cells = seen(&edges, &pieces, LEVELS).area();
            dark += usize::from(whole == 0.0);
            assert!((whole - by_cells).abs() < 1e-9, "seed {seed}: {whole} and {by_cells}");
        }
        assert!((5..150).contains(&dark), "{dark} of 200 lights are dark");
    }

    /// More cells are left out if it is known that rings are apart from each other.
    #[test]
    fn cells_that_are_left_out_change_no_bit() {
        let mut left_out = 0;
        for seed in 0..200 {
            let (edges, pieces) = rings(seed, 4 + seed as u32 % 40, 3 + seed as u32 % 17);
            let together = vec![0; pieces.len()];
            let parts = |pieces: &[u32]| {
                let seen = seen(&edges, pieces, LEVELS);
                seen.plane_parts().map(|(part, passed)| (part.to_vec(), passed)).collect::<Vec<_>>()
            };
            assert!(parts(&pieces) == parts(&together), "seed {seed}");
            let (mut pieces, mut by_piece) = (pieces, vec![]);
            let (sweep, seen) = (&mut Sweep::default(), &mut SeenLight::default());
            let mut division = Division {
                pieces: &mut pieces,
                by_piece: &mut by_piece,
                steps: &mut vec![],
                sheets: &Sheets::default(),
                sweep,
                seen,
            };
            left_out += division.hidden_cells(&Grid::over(&LIGHT), &edges).count_ones();
        }
        assert!(left_out > 200 * 64 / 8, "{left_out} cells are left out");
    }

    #[test]
    fn a_cell_is_hidden_if_a_piece_covers_it() {
        let ring = [dvec2(-9.0, -9.0), dvec2(0.05, -9.0), dvec2(0.05, 9.0), dvec2(-9.0, 9.0)];
        let edges: Vec<Outlined> = (0..4)
            .map(|i| Outlined { from: ring[i], to: ring[(i + 1) % 4], winding: 1, kind: 0, edge: i as u32 })
            .collect();
        let square = [dvec2(-1.0, -1.0), dvec2(1.0, -1.0), dvec2(1.0, 1.0), dvec2(-1.0, 1.0)];
        let (sweep, seen) = (&mut Sweep::default(), &mut SeenLight::default());
        let (pieces, by_piece, sheets) = (&mut vec![0; 4], &mut vec![], &Sheets::default());
        let mut division = Division { pieces, by_piece, steps: &mut vec![], sheets, sweep, seen };
        // Columns are a quarter wide: four are on the left of the middle, and the edge is in the fifth.
        assert_eq!(division.hidden_cells(&Grid::over(&square), &edges), 0x0f0f_0f0f_0f0f_0f0f);
    }
}
