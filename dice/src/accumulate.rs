//! Area and centroid per cell of any simple polygon, by exact signed-area accumulation.

use std::ops::Range;

use glam::{DVec2, IVec2, dvec2};

use crate::edge::Edge;
use crate::error::DiceError;
use crate::fill;
use crate::fixed::{self, Fixed, ONE};
use crate::grid::{Grid, Point};
use crate::outline::{Extent, check_count, open_ring, orientation};
use crate::rule::{Boundary, FillRule};
use crate::window::CellWindow;

/// Neighbouring cells of one row that hold the same part of a polygon: one cell that its outline crosses, or a run of
/// cells that it does not.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Run {
    /// The row, the cells' second number.
    pub row: i32,
    /// The columns, the cells' first numbers; at least one.
    pub columns: Range<i32>,
    /// Area in each cell, in input units².
    pub area: f64,
    /// Centre of mass of the part in the first cell, in input coordinates; the next cells' are one cell further each.
    pub centroid: DVec2,
    /// Whether the cells are covered completely and crossed by no edge.
    pub is_full: bool,
}

impl Run {
    /// The cells one by one, with the centroid of each.
    pub fn cells<'a>(&self, grid: &'a Grid) -> impl Iterator<Item = (IVec2, DVec2)> + use<'a> {
        let (row, first, centroid) = (self.row, self.columns.start, self.centroid);
        let step = grid.cell().x;
        self.columns.clone().map(move |column| {
            let across = f64::from(column.wrapping_sub(first)) * step;
            (IVec2::new(column, row), centroid + dvec2(across, 0.0))
        })
    }
}

/// Scratch memory for [`accumulate`], to be used again for the next polygon.
#[derive(Clone, Debug, Default)]
pub struct Accumulator {
    edges: Vec<Walker>,
    active: Vec<u32>,
    row: Vec<Entry>,
}

impl Accumulator {
    /// Empty scratch memory; it grows to what the largest polygon needs.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }
}

/// An edge that the sweep follows from row to row.
#[derive(Clone, Copy, Debug)]
struct Walker {
    edge: Edge,
    /// The heights between which the edge counts.
    from: Fixed,
    to: Fixed,
    /// x at the top of the current row, or at `from`.
    x: Fixed,
    /// +1 if the polygon lies right of the edge, −1 if left.
    sign: i8,
}

/// The contribution of one edge to one cell, and to all cells right of it.
#[derive(Clone, Copy, Debug)]
struct Entry {
    column: i32,
    /// Signed area right of the edge in this cell.
    area: Fixed,
    /// Its first moment within the cell.
    moment: DVec2,
    /// Signed height, which is the area added to each cell to the right.
    height: Fixed,
    /// First moment of that height, ∫ y dy.
    height_moment: f64,
}

/// Area and centroid of a simple polygon in every cell that it meets, concave or convex, in either orientation, open or closed (its last
/// vertex repeats the first, as in GeoJSON; the bits of the answer are the same).
///
/// Runs come row by row and from left to right, by the numbers of the cells, each cell at most once. Cells that the outline crosses are
/// runs of one; between them, equally covered cells are one run, so the cost grows with the perimeter and not with the
/// area. Sums are exact in fixed point: a cell outside is not reported, a cell inside is exactly full.
///
/// Polygons without area have no runs. Where an outline crosses itself, areas are weighted with the winding number
/// relative to the sign of the whole, and cells in which that is negative are left out; [`accumulate_filled`] has rules for that, and takes
/// polygons with holes.
///
/// # Errors
/// [`DiceError::NotFinite`], [`DiceError::OutOfRange`] and [`DiceError::TooManyCells`], all before the first run.
pub fn accumulate(
    ring: &[DVec2],
    grid: &Grid,
    scratch: &mut Accumulator,
    mut visit: impl FnMut(Run),
) -> Result<(), DiceError> {
    let ring = open_ring(ring);
    let Some(extent) = Extent::of(ring, grid)? else { return Ok(()) };
    scratch.collect_edges(ring, grid)?;
    if scratch.edges.is_empty() {
        return Ok(());
    }
    let Some(sign) = orientation(ring, grid) else { return Ok(()) };
    scratch.sweep(&extent, Sweep { grid, noise: extent.noise(), sign, visit: &mut visit });
    Ok(())
}

/// As [`accumulate`] for polygons of several rings: outlines with holes, islands in holes, several parts, and rings that cross themselves or
/// one another. `rule` says what is inside; what is inside counts once, however often rings go round it.
///
/// ```
/// use glam::dvec2;
/// use pointillist_dice::{Accumulator, FillRule, Grid, accumulate_filled};
///
/// // A square of 3 × 3 cells with a square hole of 1.5 × 1.5, both closed.
/// let square = |low: f64, high: f64| [(low, low), (high, low), (high, high), (low, high), (low, low)].map(|(x, y)| dvec2(x, y));
/// let mut area = 0.0;
/// accumulate_filled(
///     &[&square(0.0, 3.0), &square(0.5, 2.0)],
///     FillRule::EvenOdd,
///     &Grid::UNIT,
///     &mut Accumulator::new(),
///     |run| area += run.area * run.columns.len() as f64,
/// )?;
/// assert_eq!(area, 9.0 - 2.25);
/// # Ok::<(), pointillist_dice::DiceError>(())
/// ```
///
/// Rings that do not meet are as exact as in [`accumulate`]: each cell's area is the exact one, rounded once. A single ring that does not meet
/// itself gives what [`accumulate`] gives, bit for bit. Where rings cross, the height of the crossing is rounded to `f64`, and the areas of
/// the cells there are off by about the square of that rounding. Rings nearer to one another than the rounding of their coordinates count as
/// touching; then areas may be off by such a gap times its length.
///
/// Cost beside that of [`accumulate`]: about n log n for the n edges of rings that do not meet, as maps have them. Rings that
/// meet or cross themselves or others cost, for each of their corners, the edges at its height.
///
/// # Errors
/// As [`accumulate`]; vertices are counted through all rings.
pub fn accumulate_filled(
    rings: &[&[DVec2]],
    rule: FillRule,
    grid: &Grid,
    scratch: &mut Accumulator,
    mut visit: impl FnMut(Run),
) -> Result<(), DiceError> {
    // Checks every vertex, too: what follows takes finite numbers for granted.
    let Some(extent) = Extent::of(&rings.concat(), grid)? else { return Ok(()) };
    let unit = grid.binary_unit();
    let in_units: Vec<Vec<DVec2>> =
        rings.iter().map(|ring| ring.iter().map(|v| *v / unit).collect()).collect();
    // Cells are 1 to 2 units tall; beyond 2⁵³ of them rounding is more.
    let margin = |y: f64| 2.0 + 4.0 * f64::EPSILON * y.abs();
    let [first, last] = grid.rows_in_input().map(|y| y / unit.y);
    let rows = [first - margin(first), last + margin(last)];
    let turn = |ring: usize| orientation(open_ring(rings[ring]), grid).map(i32::from);
    let Some(boundary) = fill::boundary(&in_units, rule, rows, turn) else {
        return accumulate(rings[0], grid, scratch, visit);
    };
    scratch.collect_boundary(&boundary, unit, grid)?;
    scratch.sweep(&extent, Sweep { grid, noise: extent.noise(), sign: 1, visit: &mut visit });
    Ok(())
}

impl Accumulator {
    /// Goes through all rows of `extent` with the edges that were collected.
    fn sweep(&mut self, extent: &Extent, mut sweep: Sweep<'_, impl FnMut(Run)>) {
        self.active.clear();
        let mut waiting = 0;
        let window = sweep.grid.window();
        for row in window.clip_rows(fixed::floor(extent.min.y)..fixed::ceil(extent.max.y)) {
            while let Some(walker) = self.edges.get_mut(waiting)
                && fixed::floor(walker.from) <= row
            {
                walker.enter(row);
                self.active.push(waiting as u32);
                waiting += 1;
            }
            self.walk_row(row, window);
            sweep.report(row, &self.row);
        }
    }

    /// As [`Self::collect_edges`] for a boundary, of which a unit is `unit` input units.
    fn collect_boundary(&mut self, boundary: &[Boundary], unit: DVec2, grid: &Grid) -> Result<(), DiceError> {
        self.edges.clear();
        let mut count = 0;
        let point = |v: DVec2| grid.point(v * unit, 0);
        for piece in boundary {
            let (a, b) = (point(piece.top)?, point(piece.bottom)?);
            let (from, to) = (point(piece.top.with_y(piece.from))?.y, point(piece.top.with_y(piece.to))?.y);
            count +=
                self.add_edge([a, b], [from, to], if piece.inside_right { 1 } else { -1 }, grid.window());
        }
        self.edges.sort_by_key(|w| w.from);
        check_count(count)
    }

    /// The edges of a ring that are not horizontal, from top to bottom.
    fn collect_edges(&mut self, ring: &[DVec2], grid: &Grid) -> Result<(), DiceError> {
        self.edges.clear();
        let mut count = 0;
        let Some(&last) = ring.last() else { return Ok(()) };
        let mut a = grid.point(last, ring.len() - 1)?;
        for (index, &vertex) in ring.iter().enumerate() {
            let b = grid.point(vertex, index)?;
            let sign = if a.y < b.y { 1 } else { -1 };
            count += self.add_edge([a, b], [a.y.min(b.y), a.y.max(b.y)], sign, grid.window());
            a = b;
        }
        // Stable: edges that begin in the same place keep their order, and with it the rounding of moments.
        self.edges.sort_by_key(|w| w.from);
        check_count(count)
    }

    /// Adds the part of an edge between two heights, if it has a height and any cell of the window is on it or right of it. Returns about how
    /// many cells of the window it meets.
    #[inline]
    fn add_edge(&mut self, [a, b]: [Point; 2], [from, to]: [Fixed; 2], sign: i8, window: CellWindow) -> u64 {
        let is_seen = to > fixed::line(window.y0)
            && from < fixed::line(window.y1)
            && a.x.min(b.x) < fixed::line(window.x1);
        if !is_seen {
            return 0;
        }
        if from < to {
            let edge = Edge::new(a, b);
            self.edges.push(Walker { x: edge.x_at(from), edge, from, to, sign });
        }
        cells_between(a, b, window)
    }

    /// Moves every active edge through one row and notes what it does to the row's cells, sorted by column.
    fn walk_row(&mut self, row: i32, window: CellWindow) {
        let (edges, entries) = (&mut self.edges, &mut self.row);
        let row_end = fixed::line(row + 1);
        entries.clear();
        self.active.retain(|&index| {
            let walker = &mut edges[index as usize];
            walker.walk(row, window, entries);
            walker.to > row_end
        });
        // Stable for the same reason; an edge's entries are a sorted stretch, which the sort makes use of.
        if !entries.is_sorted_by_key(|e| e.column) {
            entries.sort_by_key(|e| e.column);
        }
    }
}

impl Walker {
    /// Enters the edge at the line above `row` if it begins before it.
    fn enter(&mut self, row: i32) {
        if self.from < fixed::line(row) {
            self.x = self.edge.x_at_row(row);
        }
    }

    /// Goes to the end of `row` or of the edge, one entry for each cell of the window on the way.
    fn walk(&mut self, row: i32, window: CellWindow, entries: &mut Vec<Entry>) {
        let (row_line, edge) = (fixed::line(row), &self.edge);
        let from = Point { x: self.x, y: self.from.max(row_line) };
        let ends = self.to <= row_line + ONE;
        let to = if ends {
            Point { x: edge.x_at(self.to), y: self.to }
        } else {
            Point { x: edge.x_at_row(row + 1), y: row_line + ONE }
        };
        self.x = to.x;
        let step = Step { edge, from, to, row_line, sign: self.sign, window };
        if to.x >= from.x { step.rightward(entries) } else { step.leftward(entries) }
    }
}

/// The part of an edge in one row. What of it lies left or right of the window is moved onto the window's side, where it
/// has the same cells to its right: it is one entry in the column beyond that side.
struct Step<'a> {
    edge: &'a Edge,
    from: Point,
    to: Point,
    row_line: Fixed,
    sign: i8,
    window: CellWindow,
}

impl Step<'_> {
    fn rightward(&self, entries: &mut Vec<Entry>) {
        let CellWindow { x0, x1, .. } = self.window;
        let mut from = self.from;
        let mut column = fixed::floor(from.x);
        let last = (fixed::ceil(self.to.x) - 1).max(column).min(x1);
        if column < x0 {
            if last < x0 {
                return entries.push(self.left_of_window(from, self.to));
            }
            let crossing = self.crossing(x0, from);
            entries.push(self.left_of_window(from, crossing));
            (from, column) = (crossing, x0);
        }
        while column < last {
            let crossing = self.crossing(column + 1, from);
            entries.push(self.within(column, from, crossing));
            from = crossing;
            column += 1;
        }
        let beyond = column >= x1;
        entries.push(if beyond {
            self.right_of_window(from, self.to)
        } else {
            self.within(column, from, self.to)
        });
    }

    fn leftward(&self, entries: &mut Vec<Entry>) {
        let CellWindow { x0, x1, .. } = self.window;
        let mut from = self.from;
        let mut column = fixed::ceil(from.x) - 1;
        let last = fixed::floor(self.to.x).min(column).max(x0.saturating_sub(1));
        if column >= x1 {
            if last >= x1 {
                return entries.push(self.right_of_window(from, self.to));
            }
            let crossing = self.crossing(x1, from);
            entries.push(self.right_of_window(from, crossing));
            (from, column) = (crossing, x1 - 1);
        }
        while column > last {
            let crossing = self.crossing(column, from);
            entries.push(self.within(column, from, crossing));
            from = crossing;
            column -= 1;
        }
        let beyond = column < x0;
        entries.push(if beyond {
            self.left_of_window(from, self.to)
        } else {
            self.within(column, from, self.to)
        });
    }

    /// Where the step meets column line `column`, below `from`.
    fn crossing(&self, column: i32, from: Point) -> Point {
        let y = self.edge.y_at_column(column).clamp(from.y, self.to.y);
        Point { x: fixed::line(column), y }
    }

    fn within(&self, column: i32, from: Point, to: Point) -> Entry {
        let base = Point { x: fixed::line(column), y: self.row_line };
        let entry = Entry::new(column, [from.x - base.x, from.y - base.y], [to.x - base.x, to.y - base.y]);
        if self.sign > 0 { entry } else { entry.negated() }
    }

    fn left_of_window(&self, from: Point, to: Point) -> Entry {
        let x = fixed::line(self.window.x0);
        self.within(self.window.x0 - 1, Point { x, y: from.y }, Point { x, y: to.y })
    }

    fn right_of_window(&self, from: Point, to: Point) -> Entry {
        let x = fixed::line(self.window.x1);
        self.within(self.window.x1, Point { x, y: from.y }, Point { x, y: to.y })
    }
}

impl Entry {
    /// The part of a cell right of the segment from `a` down to `b`, both relative to the cell's corner.
    ///
    /// area = ∫ (1 − x) dy, moments = ∫ (1 − x²)/2 dy and ∫ y·(1 − x) dy, all exact for a straight segment.
    #[inline]
    fn new(column: i32, a: [Fixed; 2], b: [Fixed; 2]) -> Self {
        let height = b[1] - a[1];
        let area = fixed::multiply(height, 2 * ONE - (a[0] + b[0])) / 2;
        let (ax, ay) = (fixed::to_f64(a[0]), fixed::to_f64(a[1]));
        let (bx, by) = (fixed::to_f64(b[0]), fixed::to_f64(b[1]));
        let dy = fixed::to_f64(height);
        let mean_x2 = (ax * ax + ax * bx + bx * bx) / 3.0;
        let mean_y = 0.5 * (ay + by);
        let mean_xy = 0.25 * (ax + bx) * (ay + by) + (bx - ax) * (by - ay) / 12.0;
        let moment = dvec2(0.5 * dy * (1.0 - mean_x2), dy * (mean_y - mean_xy));
        Self { column, area, moment, height, height_moment: dy * mean_y }
    }

    fn negated(self) -> Self {
        Self {
            column: self.column,
            area: -self.area,
            moment: -self.moment,
            height: -self.height,
            height_moment: -self.height_moment,
        }
    }
}

/// About how many cells of the window an edge meets.
fn cells_between(a: Point, b: Point, window: CellWindow) -> u64 {
    let span = |a: Fixed, b: Fixed| fixed::floor(a.min(b))..fixed::floor(a.max(b));
    let (columns, rows) = (window.clip_columns(span(a.x, b.x)), window.clip_rows(span(a.y, b.y)));
    columns.len() as u64 + rows.len() as u64 + 1
}

/// Turns a row's entries into runs.
struct Sweep<'a, V> {
    grid: &'a Grid,
    noise: Fixed,
    sign: i8,
    visit: &'a mut V,
}

impl<V: FnMut(Run)> Sweep<'_, V> {
    fn report(&mut self, row: i32, entries: &[Entry]) {
        // What the edges so far add to every cell right of them.
        let (mut cover, mut cover_moment) = (0, 0.0);
        let mut rest = entries;
        while let Some(&Entry { column, .. }) = rest.first() {
            let (mut area, mut moment) = (cover, dvec2(0.5 * fixed::to_f64(cover), cover_moment));
            while let Some((entry, others)) = rest.split_first()
                && entry.column == column
            {
                area += entry.area;
                moment += entry.moment;
                cover += entry.height;
                cover_moment += entry.height_moment;
                rest = others;
            }
            self.emit(row, column..column + 1, area, moment, false);
            // Edges right of the window are not among the entries.
            let end = rest.first().map_or(self.grid.window().x1, |next| next.column);
            if cover != 0 && end > column + 1 {
                let moment = dvec2(0.5 * fixed::to_f64(cover), cover_moment);
                self.emit(row, column + 1..end, cover, moment, cover.abs() == ONE);
            }
        }
    }

    fn emit(&mut self, row: i32, columns: Range<i32>, area: Fixed, moment: DVec2, is_full: bool) {
        let (area, moment) = if self.sign > 0 { (area, moment) } else { (-area, -moment) };
        let columns = self.grid.window().clip_columns(columns);
        if area <= self.noise || columns.is_empty() {
            return;
        }
        let area = fixed::to_f64(area);
        let local = if is_full { DVec2::splat(0.5) } else { (moment / area).clamp(DVec2::ZERO, DVec2::ONE) };
        let centroid = self.grid.input_from_local(IVec2::new(columns.start, row), local);
        (self.visit)(Run { row, columns, area: area * self.grid.cell_area(), centroid, is_full });
    }
}
