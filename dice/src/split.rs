//! Every piece of a convex polygon: the paper's scan conversion by rows of cells.

use glam::{DVec2, IVec2, dvec2};

use crate::code::Corner;
use crate::edge::Edge;
use crate::fixed::{self, Fixed, ONE};
use crate::grid::{Grid, Point};
use crate::outline::{Extent, check_count, next, open_ring};
use crate::{CONVEXITY_TOLERANCE, Code, DiceError};

/// The part of a polygon that lies in one cell, between two neighbouring bands' lines.
///
/// A cell with a vertex of the polygon at its left or right edge is cut at the height of that vertex, as in the paper,
/// so it may hold more than one piece.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Piece<'a> {
    /// The cell.
    pub cell: IVec2,
    /// Three to six corners in input coordinates, in the polygon's orientation.
    pub vertices: &'a [DVec2],
    /// Area in input units², positive whatever the orientation.
    pub area: f64,
    /// Centre of mass in input coordinates.
    pub centroid: DVec2,
    /// The ternary code that cut the piece.
    pub code: Code,
}

/// Cuts a convex polygon, in either orientation, open or closed (its last vertex repeats the first), into the pieces that each lie in one cell.
///
/// Pieces come row by row, from left to right within a band, by the numbers of the cells. Together they are the polygon: corners
/// that lie on a line of the grid have exactly its coordinate ([`Grid::corner`]), and the points in which an edge
/// crosses the grid do not depend on the polygon that it belongs to. Polygons without area have no pieces.
///
/// 1. Find the top and the two chains of edges that go down from it.
/// 2. A band reaches from LU to LB, the next row line or the nearer lower end of the two edges: one trapezium.
/// 3. For each cell of the band, the code of the trapezium's corners says which intersections bound the piece.
///
/// No heap is used. Areas keep their relative accuracy down to slivers; see the crate's documentation for figures.
///
/// # Errors
/// [`DiceError::NotFinite`], [`DiceError::OutOfRange`], [`DiceError::NotConvex`] and [`DiceError::TooManyCells`], all
/// before the first piece.
pub fn split(polygon: &[DVec2], grid: &Grid, mut visit: impl FnMut(Piece<'_>)) -> Result<(), DiceError> {
    let polygon = open_ring(polygon);
    let Some(extent) = Extent::of(polygon, grid)? else { return Ok(()) };
    if polygon.len() > 3 {
        check_convex(polygon, grid)?;
    }
    check_size(polygon, grid, &extent)?;
    // 1
    let mut up = Chain::new(polygon, grid, extent.top, true);
    let mut down = Chain::new(polygon, grid, extent.top, false);
    let mut cutter =
        Cutter { grid, noise: extent.noise(), points: [Point { x: 0, y: 0 }; 6], visit: &mut visit };
    let window = grid.window();
    let mut upper = extent.min.y.max(fixed::line(window.y0));
    let end = extent.max.y.min(fixed::line(window.y1));
    while upper < end {
        // 2
        if !(up.advance(upper) && down.advance(upper)) {
            break;
        }
        let row_end = fixed::line(fixed::floor(upper) + 1);
        let lower = row_end.min(up.edge.bottom.y).min(down.edge.bottom.y);
        let (a, b) = (up.side(lower), down.side(lower));
        // 3
        let band = if a.upper + a.lower <= b.upper + b.lower {
            Band { upper, lower, left: a, right: b.not_left_of(&a), reverse: true }
        } else {
            Band { upper, lower, left: b, right: a.not_left_of(&b), reverse: false }
        };
        cutter.cut_band(&band);
        upper = lower;
    }
    Ok(())
}

/// Refuses a polygon that meets more than [`MAX_CELLS`](crate::MAX_CELLS) cells. Only large ones are measured.
fn check_size(polygon: &[DVec2], grid: &Grid, extent: &Extent) -> Result<(), DiceError> {
    let (rows, columns) = extent.rows_and_columns_in(grid.window());
    if check_count(rows * columns).is_ok() {
        return Ok(());
    }
    let local = |v: &DVec2| (*v - polygon[0]) / grid.cell();
    let mut twice_area = 0.0;
    for (i, v) in polygon.iter().enumerate() {
        twice_area += local(v).perp_dot(local(&polygon[next(i, polygon.len())]));
    }
    // A convex outline crosses each row and each column twice.
    check_count((0.5 * twice_area.abs()) as u64 + 2 * (rows + columns))
}

/// Refuses outlines that turn both ways, or around more than once.
fn check_convex(polygon: &[DVec2], grid: &Grid) -> Result<(), DiceError> {
    let len = polygon.len();
    let edge = |i: usize| (polygon[next(i, len)] - polygon[i]) / grid.cell();
    let Some(last) = (0..len).rfind(|&i| edge(i) != DVec2::ZERO) else { return Ok(()) };
    let (mut before, mut turn, mut reversals, mut heading) = (edge(last), 0.0, 0, 0.0);
    for index in 0..len {
        let after = edge(index);
        if after == DVec2::ZERO {
            continue;
        }
        let size = before.length() * after.length();
        let cross = before.perp_dot(after);
        if cross.abs() > CONVEXITY_TOLERANCE * size {
            if turn * cross < 0.0 {
                return Err(DiceError::NotConvex { index });
            }
            turn = cross.signum();
        }
        if after.y.abs() > CONVEXITY_TOLERANCE * after.length() {
            reversals += u32::from(heading * after.y < 0.0);
            heading = after.y.signum();
        }
        // Forth and back on one line is no area, and no error.
        if reversals > 2 && turn != 0.0 {
            return Err(DiceError::NotConvex { index });
        }
        before = after;
    }
    Ok(())
}

/// One of the two chains of edges from the top of the polygon to its bottom.
struct Chain<'a> {
    polygon: &'a [DVec2],
    grid: &'a Grid,
    /// Position of the vertex at the lower end of `edge`.
    index: usize,
    forward: bool,
    end: Point,
    edge: Edge,
    upper: Fixed,
    upper_vertex: Option<DVec2>,
    steps: usize,
}

impl<'a> Chain<'a> {
    fn new(polygon: &'a [DVec2], grid: &'a Grid, top: usize, forward: bool) -> Self {
        let end = point(polygon, grid, top);
        let edge = Edge::at(end);
        Self { polygon, grid, index: top, forward, end, edge, upper: end.x, upper_vertex: None, steps: 0 }
    }

    /// Goes on to the edge that reaches below `upper`; false at the end of the chain.
    fn advance(&mut self, upper: Fixed) -> bool {
        while self.edge.bottom.y <= upper {
            if self.steps == self.polygon.len() {
                return false;
            }
            self.steps += 1;
            let from = (self.index, self.end);
            let len = self.polygon.len();
            self.index = if self.forward {
                next(self.index, len)
            } else {
                self.index.checked_sub(1).unwrap_or(len - 1)
            };
            let to = point(self.polygon, self.grid, self.index);
            if to.y < from.1.y {
                continue; // reflex by less than the tolerance: the chain stays where it was
            }
            self.end = to;
            if to.y > from.1.y {
                self.edge = Edge::new(from.1, to);
                // An edge that begins above the first row of the window is entered at that row's line.
                let begins_here = from.1.y >= upper;
                self.upper = if begins_here { from.1.x } else { self.edge.x_at(upper) };
                self.upper_vertex = begins_here.then(|| self.polygon[from.0]);
            }
        }
        true
    }

    /// The chain between the last band and `lower`, where the next band begins.
    fn side(&mut self, lower: Fixed) -> Side<'_> {
        let ends = lower == self.edge.bottom.y;
        let lower_x = if ends { self.edge.bottom.x } else { self.edge.x_at(lower) };
        let upper_x = std::mem::replace(&mut self.upper, lower_x);
        let upper_vertex = self.upper_vertex.take();
        let lower_vertex = ends.then(|| self.polygon[self.index]);
        Side { edge: &self.edge, upper: upper_x, lower: lower_x, upper_vertex, lower_vertex }
    }
}

fn point(polygon: &[DVec2], grid: &Grid, index: usize) -> Point {
    grid.point(polygon[index], index).expect("every vertex was checked at the door")
}

/// One edge of a band's trapezium.
#[derive(Clone, Copy)]
struct Side<'a> {
    edge: &'a Edge,
    upper: Fixed,
    lower: Fixed,
    upper_vertex: Option<DVec2>,
    lower_vertex: Option<DVec2>,
}

impl Side<'_> {
    /// Rounding may let two edges cross by 2⁻⁹⁵ where they meet.
    fn not_left_of(mut self, left: &Self) -> Self {
        if self.upper < left.upper {
            (self.upper, self.upper_vertex) = (left.upper, left.upper_vertex);
        }
        if self.lower < left.lower {
            (self.lower, self.lower_vertex) = (left.lower, left.lower_vertex);
        }
        self
    }
}

/// The trapezium between LU and LB.
struct Band<'a> {
    upper: Fixed,
    lower: Fixed,
    left: Side<'a>,
    right: Side<'a>,
    reverse: bool,
}

impl Band<'_> {
    /// The corner in cell coordinates, and the polygon's vertex if it is one.
    #[inline]
    fn corner(&self, corner: Corner, left_line: Fixed, column: i32) -> (Point, Option<DVec2>) {
        let right_line = left_line + ONE;
        let on_edge = |side: &Side<'_>, column, x| {
            let y = side.edge.y_at_column(column).clamp(self.upper, self.lower);
            (Point { x, y }, None)
        };
        let at = |x, y| (Point { x, y }, None);
        match corner {
            Corner::UpperLeft => (Point { x: self.left.upper, y: self.upper }, self.left.upper_vertex),
            Corner::LowerLeft => (Point { x: self.left.lower, y: self.lower }, self.left.lower_vertex),
            Corner::UpperRight => (Point { x: self.right.upper, y: self.upper }, self.right.upper_vertex),
            Corner::LowerRight => (Point { x: self.right.lower, y: self.lower }, self.right.lower_vertex),
            Corner::CellUpperLeft => at(left_line, self.upper),
            Corner::CellUpperRight => at(right_line, self.upper),
            Corner::CellLowerLeft => at(left_line, self.lower),
            Corner::CellLowerRight => at(right_line, self.lower),
            Corner::LeftEdgeAtLeft => on_edge(&self.left, column, left_line),
            Corner::LeftEdgeAtRight => on_edge(&self.left, column + 1, right_line),
            Corner::RightEdgeAtLeft => on_edge(&self.right, column, left_line),
            Corner::RightEdgeAtRight => on_edge(&self.right, column + 1, right_line),
        }
    }
}

/// Cuts bands into pieces.
struct Cutter<'a, V> {
    grid: &'a Grid,
    noise: Fixed,
    points: [Point; 6],
    visit: &'a mut V,
}

impl<V: FnMut(Piece<'_>)> Cutter<'_, V> {
    fn cut_band(&mut self, band: &Band<'_>) {
        let (left, right) = (&band.left, &band.right);
        let columns = fixed::floor(left.upper.min(left.lower))..fixed::ceil(right.upper.max(right.lower));
        let columns = self.grid.window().clip_columns(columns);
        let row = fixed::floor(band.upper);
        for column in columns {
            let left_line = fixed::line(column);
            let digit = |x: Fixed| u8::from(x >= left_line) + u8::from(x > left_line + ONE);
            let digits = [digit(left.upper), digit(left.lower), digit(right.upper), digit(right.lower)];
            let code = Code::from_digits(digits).expect("digits are 0 to 2");
            let cell = IVec2::new(column, row);
            if code == Code::FULL {
                self.emit_full(band, cell);
            } else {
                self.emit(band, cell, code, left_line);
            }
        }
    }

    /// A piece from side to side of its cell: no intersection to find.
    fn emit_full(&mut self, band: &Band<'_>, cell: IVec2) {
        let row_line = fixed::line(cell.y);
        let (top, bottom) = (fixed::to_f64(band.upper - row_line), fixed::to_f64(band.lower - row_line));
        let mut vertices = [dvec2(0.0, top), dvec2(1.0, top), dvec2(1.0, bottom), dvec2(0.0, bottom)]
            .map(|local| self.grid.input_from_local(cell, local));
        if band.reverse {
            vertices.reverse();
        }
        let area = fixed::to_f64(band.lower - band.upper) * self.grid.cell_area();
        let centroid = self.grid.input_from_local(cell, dvec2(0.5, 0.5 * (top + bottom)));
        (self.visit)(Piece { cell, vertices: &vertices, area, centroid, code: Code::FULL });
    }

    fn emit(&mut self, band: &Band<'_>, cell: IVec2, code: Code, left_line: Fixed) {
        let base = Point { x: left_line, y: fixed::line(cell.y) };
        let mut vertices = [DVec2::ZERO; 6];
        let mut count = 0;
        for &corner in code.shape().corners() {
            let (p, vertex) = band.corner(corner, left_line, cell.x);
            if count > 0 && self.points[count - 1] == p {
                continue;
            }
            self.points[count] = p;
            vertices[count] = match vertex {
                Some(vertex) => self.grid.clamp_to(vertex, cell),
                None => self.grid.input_from_local(cell, local(p, base)),
            };
            count += 1;
        }
        if count > 1 && self.points[0] == self.points[count - 1] {
            count -= 1;
        }
        let Some((area, centroid)) = area_and_centroid(&self.points[..count], base, self.noise) else {
            return;
        };
        let vertices = &mut vertices[..count];
        if band.reverse {
            vertices.reverse();
        }
        let area = area * self.grid.cell_area();
        (self.visit)(Piece {
            cell,
            vertices,
            area,
            centroid: self.grid.input_from_local(cell, centroid),
            code,
        });
    }
}

fn local(p: Point, base: Point) -> DVec2 {
    dvec2(fixed::to_f64(p.x - base.x), fixed::to_f64(p.y - base.y))
}

/// Area in cells and centroid within the cell; `None` where the area is no more than rounding.
///
/// Fans of triangles around the first point: its differences to the others are exact before they are rounded to `f64`.
fn area_and_centroid(points: &[Point], base: Point, noise: Fixed) -> Option<(f64, DVec2)> {
    let (&first, rest) = points.split_first()?;
    let (mut twice_area, mut size, mut moment) = (0.0, 0.0, DVec2::ZERO);
    let mut spoke = local(*rest.first()?, first);
    for &p in &rest[1..] {
        let next_spoke = local(p, first);
        let cross = spoke.perp_dot(next_spoke);
        twice_area += cross;
        size += (spoke.x * next_spoke.y).abs() + (spoke.y * next_spoke.x).abs();
        moment += cross * (spoke + next_spoke);
        spoke = next_spoke;
    }
    if twice_area < CANCELLED * size {
        (twice_area, moment) = exact_area_and_moment(points);
    }
    if twice_area <= fixed::to_f64(noise) {
        return None;
    }
    let centroid = local(first, base) + moment / (3.0 * twice_area);
    Some((0.5 * twice_area, centroid.clamp(DVec2::ZERO, DVec2::ONE)))
}

/// Below this part of its terms, a sum of products in `f64` has lost the digits that a sliver needs (2⁻⁸ leaves 45 bits).
const CANCELLED: f64 = 1.0 / (1 << 8) as f64;

/// The same in fixed point, slower: (twice the area, its first moment times six, from the first point).
fn exact_area_and_moment(points: &[Point]) -> (f64, DVec2) {
    let first = points[0];
    let (mut twice_area, mut moment) = (0, DVec2::ZERO);
    for pair in points[1..].windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let cross =
            fixed::multiply(a.x - first.x, b.y - first.y) - fixed::multiply(a.y - first.y, b.x - first.x);
        twice_area += cross;
        moment += fixed::to_f64(cross) * (local(a, first) + local(b, first));
    }
    (fixed::to_f64(twice_area), moment)
}
