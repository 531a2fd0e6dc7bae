//! One convex piece per cell, with spans of covered cells: the cut that renderers want.
//!
//! [`split`](crate::split) follows the paper and cuts at every vertex, too; here a polygon is clipped
//! to a row of cells once, then walked from left to right. Cells that it covers wholly are never cut
//! but reported as one span. It computes in `f64` ([`CUT_ERROR`]), where `split` and
//! [`accumulate`](crate::accumulate) compute in fixed point, and checks nothing that costs time.

use crate::convex::ConvexPolygon;
use crate::strip;
use crate::window::CellWindow;
use glam::{DVec2, IVec2};
use std::ops::Range;

/// What [`cut`] reports.
#[derive(Clone, Copy, Debug)]
pub enum Cut<'a> {
    /// Cells `first..end` of this row are covered wholly.
    Span {
        /// The row.
        row: i32,
        /// First column.
        first: i32,
        /// One past the last column.
        end: i32,
    },
    /// The part of the polygon in one cell, in positive order, inside the closed cell.
    Piece {
        /// Column and row.
        cell: IVec2,
        /// The part.
        polygon: &'a ConvexPolygon,
    },
}

/// Most vertices of a polygon given to [`cut`]: a piece has at most four more.
pub const MAX_CUT_VERTICES: usize = 12;

/// How far the area of a cell may be off, times the largest coordinate (in cells, at least 1): 2⁻⁴⁹.
///
/// A crossing with a grid line is off by a few units in the last place of its coordinates, and with it a side of the piece, which is at most
/// √2 long. The worst of 600,000 triangles, most of them on grid lines, next to them, or thin, was a third of this.
pub const CUT_ERROR: f64 = 1.776_356_839_400_250_5e-15;

/// An edge of the input with its end points in canonical order, so that both polygons that share it
/// compute the same crossings, bit for bit.
#[derive(Clone, Copy)]
struct Edge {
    low: DVec2,
    high: DVec2,
    /// dx/dy.
    run: f64,
    /// dy/dx.
    rise: f64,
}

impl Edge {
    const NONE: Self = Self::grid_line(0.0);

    /// The grid line between two rows.
    const fn grid_line(y: f64) -> Self {
        let on_line = DVec2::new(0.0, y);
        Self { low: on_line, high: on_line, run: 0.0, rise: 0.0 }
    }

    fn new(a: DVec2, b: DVec2) -> Self {
        let ordered = (a.y, a.x) <= (b.y, b.x);
        let (low, high) = if ordered { (a, b) } else { (b, a) };
        let d = high - low;
        // A slope that overflows belongs to an edge of no extent to speak of in the other direction (1e-300 cells): such an edge
        // crosses a grid line at its lower end. Level and upright edges do not ask for theirs.
        let finite = |slope: f64| if slope.is_finite() { slope } else { 0.0 };
        Self { low, high, run: finite(d.x / d.y), rise: finite(d.y / d.x) }
    }

    /// x where the edge meets the horizontal line `y`; the caller knows that it does.
    #[inline]
    fn x_at(&self, y: f64) -> f64 {
        let x = self.low.x + (y - self.low.y) * self.run;
        let (a, b) = (self.low.x, self.high.x);
        if a < b { within(x, a, b) } else { within(x, b, a) }
    }

    /// y where the edge meets the vertical line `x`.
    #[inline]
    fn y_at(&self, x: f64) -> f64 {
        let y = self.low.y + (x - self.low.x) * self.rise;
        within(y, self.low.y, self.high.y)
    }
}

/// The number between two bounds that is closest to `value`. `f64::clamp` also checks that the bounds are in order.
#[inline]
fn within(value: f64, low: f64, high: f64) -> f64 {
    let above = if value < low { low } else { value };
    if above > high { high } else { above }
}

/// The polygon within one row of cells. `edges[i]` is what the side from vertex `i` lies on: an edge
/// of the input, or one of the two [grid lines](Edge::grid_line) of the row, which follow these.
struct Slab {
    len: usize,
    vertices: [DVec2; 16],
    edges: [u8; 16],
}

impl Slab {
    const EMPTY: Self = Self { len: 0, vertices: [DVec2::ZERO; 16], edges: [0; 16] };

    #[inline]
    fn push(&mut self, p: DVec2, edge: u8) {
        // Corners on a grid line arrive once from each of their two edges.
        if self.len > 0 && self.vertices[self.len - 1] == p {
            self.edges[self.len - 1] = edge;
            return;
        }
        self.vertices[self.len] = p;
        self.edges[self.len] = edge;
        self.len += 1;
    }
}

/// Cuts a convex polygon (cell units, positive area, at most [`MAX_CUT_VERTICES`] vertices) into one
/// piece per cell of the window, left to right and top to bottom.
///
/// The caller promises finite coordinates within ±2³⁰; other numbers give cells without meaning. Areas are accurate to
/// [`CUT_ERROR`]. Crossings with grid lines depend only on the edge, not on the polygon or the window, so that neighbours
/// share them bit for bit and a window cut in two gives the same pieces. Pieces without area may be reported where an
/// edge runs along a grid line; polygons with fewer than three vertices have no pieces.
///
/// # Panics
/// If there are more than [`MAX_CUT_VERTICES`] vertices, or a coordinate is NaN.
///
/// ```
/// use glam::dvec2;
/// use pointillist_dice::{CellWindow, Cut, cut};
///
/// let triangle = [dvec2(0.0, 0.0), dvec2(4.0, 0.0), dvec2(0.0, 4.0)];
/// let window = CellWindow { x0: 0, y0: 0, x1: 4, y1: 4 };
/// let (mut full, mut partial) = (0, 0.0);
/// cut(&triangle, window, |part| match part {
///     Cut::Span { first, end, .. } => full += end - first,
///     Cut::Piece { polygon, .. } => partial += polygon.area(),
/// });
/// assert_eq!((full, partial), (6, 2.0));
/// ```
#[inline]
pub fn cut(polygon: &[DVec2], window: CellWindow, mut visit: impl FnMut(Cut<'_>)) {
    let n = polygon.len();
    assert!(n <= MAX_CUT_VERTICES, "at most {MAX_CUT_VERTICES} vertices, not {n}");
    if n < 3 {
        return;
    }
    let (lo, hi) = crate::convex::bounds(polygon);
    let mut rows = cells_between(lo.y, hi.y, window.y0..window.y1);
    let columns = cells_between(lo.x, hi.x, window.x0..window.x1);
    if rows.len() > 1 && (lo.x < f64::from(window.x0) || hi.x > f64::from(window.x1)) {
        let (low, high) = strip::heights(polygon, &columns);
        rows = cells_between(low, high, rows);
    }
    if rows.is_empty() || columns.is_empty() {
        return;
    }
    let one_row = f64::from(rows.start) <= lo.y && hi.y <= f64::from(rows.start + 1);
    let one_column = f64::from(columns.start) <= lo.x && hi.x <= f64::from(columns.start + 1);
    if one_row && one_column {
        let whole = ConvexPolygon::from_vertices(polygon);
        visit(Cut::Piece { cell: IVec2::new(columns.start, rows.start), polygon: &whole });
        return;
    }
    // Nearly all polygons are triangles; clearing room for twelve edges would cost as much as one cut.
    if n <= 4 {
        cut_rows::<6>(polygon, rows, columns, &mut visit);
    } else {
        cut_rows::<{ MAX_CUT_VERTICES + 2 }>(polygon, rows, columns, &mut visit);
    }
}

/// Cuts a polygon of at most `N - 2` vertices row by row.
#[inline]
fn cut_rows<const N: usize>(
    polygon: &[DVec2],
    rows: Range<i32>,
    columns: Range<i32>,
    visit: &mut impl FnMut(Cut<'_>),
) {
    let n = polygon.len();
    let mut edges = [Edge::NONE; N];
    for i in 0..n {
        edges[i] = Edge::new(polygon[i], polygon[if i + 1 == n { 0 } else { i + 1 }]);
    }
    let (mut slab, mut piece) = (Slab::EMPTY, ConvexPolygon::EMPTY);
    for row in rows {
        edges[n] = Edge::grid_line(f64::from(row));
        edges[n + 1] = Edge::grid_line(f64::from(row + 1));
        clip_to_row(polygon, &edges, row, &mut slab);
        if slab.len >= 3 {
            walk_row(&slab, &edges, row, columns.clone(), &mut piece, visit);
        }
    }
}

/// The cells that the interval touches with more than a point, within limits.
fn cells_between(lo: f64, hi: f64, limits: Range<i32>) -> Range<i32> {
    let first = lo.floor().max(f64::from(limits.start)) as i32;
    let end = hi.ceil().min(f64::from(limits.end)) as i32;
    // An interval that is one grid line still belongs to a cell, so that nothing gets lost unseen.
    let end = if hi == lo && hi.floor() == hi { (first + 1).min(limits.end) } else { end };
    first..end
}

/// The part of a polygon in a row, into a slab that is there already: clearing one costs as much as clipping.
fn clip_to_row(polygon: &[DVec2], edges: &[Edge], row: i32, slab: &mut Slab) {
    let (top, bottom) = (f64::from(row), f64::from(row + 1));
    slab.len = 0;
    let n = polygon.len();
    let (top_line, bottom_line) = (n as u8, n as u8 + 1);
    for i in 0..n {
        let (a, b) = (polygon[i], polygon[if i + 1 == n { 0 } else { i + 1 }]);
        let (above_a, below_a) = (a.y < top, a.y > bottom);
        let (above_b, below_b) = (b.y < top, b.y > bottom);
        if (above_a && above_b) || (below_a && below_b) {
            continue;
        }
        let edge = i as u8;
        if above_a {
            slab.push(DVec2::new(edges[i].x_at(top), top), edge);
        } else if below_a {
            slab.push(DVec2::new(edges[i].x_at(bottom), bottom), edge);
        } else {
            slab.push(a, edge);
        }
        // Where the edge leaves the row, a side along the grid line follows.
        if above_b {
            slab.push(DVec2::new(edges[i].x_at(top), top), top_line);
        } else if below_b {
            slab.push(DVec2::new(edges[i].x_at(bottom), bottom), bottom_line);
        }
    }
    while slab.len > 1 && slab.vertices[slab.len - 1] == slab.vertices[0] {
        slab.len -= 1;
    }
}

/// Walks a row's polygon from left to right. `piece` is memory for the part in a cell.
#[inline]
fn walk_row(
    slab: &Slab,
    edges: &[Edge],
    row: i32,
    columns: Range<i32>,
    piece: &mut ConvexPolygon,
    visit: &mut impl FnMut(Cut<'_>),
) {
    let vertices = &slab.vertices[..slab.len];
    let (lo, hi) = crate::convex::bounds(vertices);
    let touched = cells_between(lo.x, hi.x, columns);
    // A cell is covered wholly only where the polygon reaches from one grid line to the other.
    let crosses = lo.y == f64::from(row) && hi.y == f64::from(row + 1);
    let full = if crosses { covered_columns(vertices, row) } else { 0..0 };
    let mut column = touched.start;
    while column < touched.end {
        if full.start <= column && column < full.end {
            let end = full.end.min(touched.end);
            visit(Cut::Span { row, first: column, end });
            column = end;
            continue;
        }
        clip_to_column(slab, edges, row, column, piece);
        if !piece.is_empty() {
            visit(Cut::Piece { cell: IVec2::new(column, row), polygon: piece });
        }
        column += 1;
    }
}

/// The columns that a row's polygon covers wholly: between the innermost ends of its top and bottom
/// sides, because the chains between those bulge outward.
fn covered_columns(vertices: &[DVec2], row: i32) -> Range<i32> {
    let span_on = |y: f64| {
        let on_line = vertices.iter().filter(|v| v.y == y).map(|v| v.x);
        let widen = |(l, r), x| (if x < l { x } else { l }, if x > r { x } else { r });
        on_line.fold((f64::INFINITY, f64::NEG_INFINITY), widen)
    };
    let (top, bottom) = (span_on(f64::from(row)), span_on(f64::from(row + 1)));
    let (left, right) = (top.0.max(bottom.0), top.1.min(bottom.1));
    if left < right { left.ceil() as i32..right.floor() as i32 } else { 0..0 }
}

fn clip_to_column(slab: &Slab, edges: &[Edge], row: i32, column: i32, piece: &mut ConvexPolygon) {
    let (left, right) = (f64::from(column), f64::from(column + 1));
    let (top, bottom) = (f64::from(row), f64::from(row + 1));
    piece.clear();
    let mut push = |p: DVec2| {
        if piece.vertices().last() != Some(&p) {
            piece.push(p);
        }
    };
    for i in 0..slab.len {
        let j = if i + 1 == slab.len { 0 } else { i + 1 };
        let (a, b, edge) = (slab.vertices[i], slab.vertices[j], &edges[usize::from(slab.edges[i])]);
        if (a.x < left && b.x < left) || (a.x > right && b.x > right) {
            continue;
        }
        let crossing = |x: f64| DVec2::new(x, within(edge.y_at(x), top, bottom));
        if a.x < left {
            push(crossing(left));
        } else if a.x > right {
            push(crossing(right));
        } else {
            push(a);
        }
        if b.x < left {
            push(crossing(left));
        } else if b.x > right {
            push(crossing(right));
        }
    }
}
