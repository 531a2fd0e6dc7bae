//! How much of a light passes many masks, cell by cell: the light is cut by a grid as pictures are, and coverage becomes opacity.

use glam::{DVec2, IVec2};
use pointillist_dice::{CellWindow, ConvexPolygon, Cut, MAX_CUT_VERTICES, convex, cut};

/// Most cells of a light. Four times as many halve the error on the ground below an oak, at twice the time.
const MOST_CELLS: usize = 64;

/// Light of less than this share of a cell counts as none.
const FAINT: f64 = 1e-4;

/// Corners further from the light than this many cells are cut off first: what `cut` rounds grows with coordinates.
const FAR: f64 = 1e3;

/// About square cells over the bounding rectangle of a light, in its plane.
#[derive(Clone, Copy, Debug)]
struct Cells {
    low: DVec2,
    size: DVec2,
    window: CellWindow,
}

/// The share of light that passes in each cell that is asked for. Masks that meet in one cell count as independent there, unless they are covered together.
#[derive(Debug)]
pub(crate) struct TransmittanceGrid {
    cells: Cells,
    passed: [f64; MOST_CELLS],
    /// What was covered since the last [`TransmittanceGrid::weaken`].
    covered: [f64; MOST_CELLS],
    is_needed: bool,
}

impl Default for TransmittanceGrid {
    fn default() -> Self {
        let window = CellWindow { x0: 0, y0: 0, x1: 0, y1: 0 };
        let cells = Cells { low: DVec2::ZERO, size: DVec2::ONE, window };
        Self { cells, passed: [0.0; MOST_CELLS], covered: [0.0; MOST_CELLS], is_needed: false }
    }
}

impl TransmittanceGrid {
    /// Begins with a light of which nothing is asked for.
    pub(crate) fn start(&mut self, outline: &[DVec2]) {
        self.cells = Cells::over(outline);
        self.passed.fill(0.0);
        self.covered.fill(0.0);
        self.is_needed = false;
    }

    /// Asks for the cells that a part of the light touches; nothing is in front of it yet.
    pub(crate) fn need(&mut self, part: &ConvexPolygon) {
        self.is_needed = true;
        self.cells.cut(part, |cell, _, _| self.passed[cell] = 1.0);
    }

    /// Whether any cells are asked for.
    pub(crate) fn is_needed(&self) -> bool {
        self.is_needed
    }

    /// Covers each cell by what a convex polygon covers of it, times the mean opacity of that part. Parts of less than `negligible` of a
    /// cell count as none. Polygons between two calls of [`Self::weaken`] do not overlap: what they cover adds up.
    pub(crate) fn cover(
        &mut self,
        polygon: &ConvexPolygon,
        negligible: f64,
        mut mean_opacity: impl FnMut(&[DVec2]) -> f64,
    ) {
        let Self { cells, passed, covered, .. } = self;
        cells.cut(polygon, |cell, share, part| {
            if passed[cell] > 0.0 && share > negligible {
                covered[cell] += share * mean_opacity(part);
            }
        });
    }

    /// The cell in which all of a rectangle is.
    pub(crate) fn cell_around(&self, bounds: (DVec2, DVec2)) -> Option<usize> {
        self.cells.around(bounds)
    }

    /// Covers a cell by a polygon of this area within it, as [`Self::cover`] does.
    pub(crate) fn cover_within(
        &mut self,
        cell: usize,
        area: f64,
        negligible: f64,
        mean_opacity: impl FnOnce() -> f64,
    ) {
        let share = area / self.cells.size.element_product();
        if self.passed[cell] > 0.0 && share > negligible {
            self.covered[cell] += share * mean_opacity();
        }
    }

    /// Weakens each cell by what covers it.
    pub(crate) fn weaken(&mut self) {
        for (passed, covered) in self.passed.iter_mut().zip(&mut self.covered) {
            let rest = *passed * (1.0 - covered.min(1.0));
            *passed = if rest < FAINT { 0.0 } else { rest };
            *covered = 0.0;
        }
    }

    /// Calls `visit` with the pieces of a part of the light that was asked for through which some light passes, and the share that does.
    pub(crate) fn divide(&self, part: &ConvexPolygon, mut visit: impl FnMut(&[DVec2], f64)) {
        self.cells.cut(part, |cell, _, piece| {
            let passed = self.passed[cell];
            if passed > 0.0 {
                visit(piece, passed);
            }
        });
    }
}

impl Cells {
    fn over(outline: &[DVec2]) -> Self {
        let (low, high) = convex::bounds(outline);
        let extent = high - low;
        let most = MOST_CELLS as f64;
        let columns = (most * extent.x / extent.y).sqrt().round().clamp(1.0, most);
        let rows = (most / columns).floor();
        let window = CellWindow { x0: 0, y0: 0, x1: columns as i32, y1: rows as i32 };
        Self { low, size: extent / DVec2::new(columns, rows), window }
    }

    /// The cell in which all of a rectangle is.
    fn around(&self, (low, high): (DVec2, DVec2)) -> Option<usize> {
        let [first, last] = [low, high].map(|corner| ((corner - self.low) / self.size).floor());
        let CellWindow { x1, y1, .. } = self.window;
        let is_inside = first.cmpge(DVec2::ZERO).all() && last.cmplt(DVec2::new(x1.into(), y1.into())).all();
        (is_inside && first == last).then(|| (first.y as i32 * x1 + first.x as i32) as usize)
    }

    /// Calls `visit` with the number of each cell that a convex polygon covers some of, the share that it covers, and the part of the polygon in it.
    fn cut(&self, polygon: &ConvexPolygon, mut visit: impl FnMut(usize, f64, &[DVec2])) {
        let mut in_cells = [DVec2::ZERO; convex::MAX_VERTICES];
        let near = self.near(polygon);
        let count = near.vertices().len();
        for (to, &v) in in_cells.iter_mut().zip(near.vertices()) {
            *to = (v - self.low) / self.size;
        }
        let mut report = |cell: IVec2, covered: f64, part: &ConvexPolygon| {
            let mut in_plane = [DVec2::ZERO; convex::MAX_VERTICES];
            for (to, &v) in in_plane.iter_mut().zip(part.vertices()) {
                *to = self.low + v * self.size;
            }
            let number = (cell.y * self.window.x1 + cell.x) as usize;
            visit(number, covered, &in_plane[..part.vertices().len()]);
        };
        let mut cut_ring = |ring: &[DVec2]| {
            cut(ring, self.window, |part| match part {
                Cut::Span { row, first, end } => {
                    for column in first..end {
                        let cell = IVec2::new(column, row);
                        let low = cell.as_dvec2();
                        report(cell, 1.0, &ConvexPolygon::rectangle(low, low + 1.0));
                    }
                }
                Cut::Piece { cell, polygon } => report(cell, polygon.area().min(1.0), polygon),
            });
        };
        if count <= MAX_CUT_VERTICES {
            cut_ring(&in_cells[..count]);
        } else {
            // An outline of the most vertices, with one more where the horizon cuts it.
            let middle = count / 2;
            cut_ring(&in_cells[..=middle]);
            in_cells[middle - 1] = in_cells[0];
            cut_ring(&in_cells[middle - 1..count]);
        }
    }

    /// The polygon, or what of it is near the light; nothing if its corners overflow.
    fn near(&self, polygon: &ConvexPolygon) -> ConvexPolygon {
        let reach = self.size * FAR;
        let is_near = |v: &DVec2| (*v - self.low).abs().cmple(reach).all();
        if polygon.vertices().iter().all(is_near) {
            return *polygon;
        }
        let rectangle = ConvexPolygon::rectangle(self.low - 0.5 * reach, self.low + 0.5 * reach);
        let cut_off = |rest: ConvexPolygon, half: convex::HalfPlane| rest.clipped(&half);
        let near = convex::half_planes(rectangle.vertices()).fold(*polygon, cut_off);
        if near.vertices().iter().all(is_near) { near } else { ConvexPolygon::from_vertices(&[]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    fn rectangle(low: (f64, f64), high: (f64, f64)) -> ConvexPolygon {
        ConvexPolygon::rectangle(low.into(), high.into())
    }

    /// Sum over the pieces of a part of area times what passes.
    fn passed(grid: &TransmittanceGrid, part: &ConvexPolygon) -> f64 {
        let mut sum = 0.0;
        grid.divide(part, |piece, passed| sum += passed * convex::area(piece));
        sum
    }

    #[test]
    fn cells_are_about_square_and_no_more_than_there_is_room_for() {
        for (width, height) in [(1.0, 1.0), (10.0, 1.0), (1.0, 3.0), (1e9, 1.0), (1.0, 1e-9), (3e-5, 2e-5)] {
            let cells = Cells::over(rectangle((-1.0, 2.0), (width - 1.0, height + 2.0)).vertices());
            let CellWindow { x1, y1, .. } = cells.window;
            let count = (x1 * y1) as usize;
            assert!(
                (MOST_CELLS / 2..=MOST_CELLS).contains(&count),
                "{x1} × {y1} cells of {width} × {height}"
            );
            let shape = cells.size.x / cells.size.y;
            assert!(
                x1 == 1 || y1 == 1 || (0.4..2.5).contains(&shape),
                "cells of {shape} of {width} × {height}"
            );
        }
    }

    #[test]
    fn what_is_covered_together_adds_up_and_what_is_not_multiplies() {
        let light = rectangle((0.0, 0.0), (2.0, 2.0));
        let mut grid = TransmittanceGrid::default();
        grid.start(light.vertices());
        grid.need(&light);
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)].map(DVec2::from);
        for half in [[0, 1, 2], [0, 2, 3]] {
            grid.cover(&ConvexPolygon::from_vertices(&half.map(|i| corners[i])), 0.0, |_| 1.0);
        }
        grid.weaken();
        assert!((passed(&grid, &light) - 2.0).abs() < 1e-12);
        for _ in 0..2 {
            grid.cover(&rectangle((1.0, -1e7), (1e7, 1.0)), 0.0, |_| 0.5);
            grid.weaken();
        }
        assert!((passed(&grid, &light) - 1.25).abs() < 1e-8);
        let part = rectangle((1.2, 0.1), (1.3, 1.1));
        assert!((passed(&grid, &part) - 0.1 * (0.9 * 0.25 + 0.1)).abs() < 1e-8);
    }

    #[test]
    fn outlines_of_the_most_vertices_and_one_are_divided_whole() {
        for n in 3..=13 {
            let corner =
                |i: usize| DVec2::from_angle(std::f64::consts::TAU * i as f64 / n as f64) + dvec2(7.0, -3.0);
            let ring: Vec<DVec2> = (0..n).map(corner).collect();
            let mut grid = TransmittanceGrid::default();
            grid.start(&ring);
            grid.need(&ConvexPolygon::from_vertices(&ring));
            let all = passed(&grid, &ConvexPolygon::from_vertices(&ring));
            assert!((all - convex::area(&ring)).abs() < 1e-13, "{n} corners: {all}");
        }
    }

    #[test]
    fn corners_that_overflow_cover_nothing() {
        let light = rectangle((0.0, 0.0), (1.0, 1.0));
        let mut grid = TransmittanceGrid::default();
        grid.start(light.vertices());
        grid.need(&light);
        let endless = [DVec2::ZERO, dvec2(f64::INFINITY, 0.0), dvec2(0.0, f64::INFINITY)];
        grid.cover(&ConvexPolygon::from_vertices(&endless), 0.0, |_| 1.0);
        grid.weaken();
        assert_eq!(passed(&grid, &light), 1.0);
    }
}
