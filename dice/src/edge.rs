//! A polygon's edge and where it crosses the lines of the grid.

use crate::fixed::{self, Fixed, ONE};
use crate::grid::Point;

/// An edge from its upper (smaller y, then smaller x) to its lower end.
///
/// All crossings are computed from the ends in this order, so that an edge shared by two polygons is cut into the same
/// points, bit for bit, whichever polygon and direction it is reached from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub(crate) top: Point,
    pub(crate) bottom: Point,
    /// dx/dy if the edge is at least a row tall; below that it crosses at most one line and may be too flat for a slope.
    slope: Fixed,
    /// dy/|dx| if the edge is at least a column wide.
    steepness: Fixed,
    /// The first row line strictly below `top`, and x there.
    first_row: i32,
    first_x: Fixed,
    /// The first column line strictly beyond `top` in the edge's direction, and y there.
    first_column: i32,
    first_y: Fixed,
}

impl Edge {
    /// The edge from `p` to itself: a chain before its first edge.
    pub(crate) fn at(p: Point) -> Self {
        Self {
            top: p,
            bottom: p,
            slope: 0,
            steepness: 0,
            first_row: 0,
            first_x: p.x,
            first_column: 0,
            first_y: p.y,
        }
    }

    /// The edge between two points.
    #[inline]
    pub(crate) fn new(a: Point, b: Point) -> Self {
        let (top, bottom) = if (a.y, a.x) <= (b.y, b.x) { (a, b) } else { (b, a) };
        let first_row = fixed::floor(top.y) + 1;
        let rightward = bottom.x >= top.x;
        let first_column = if rightward { fixed::floor(top.x) + 1 } else { fixed::ceil(top.x) - 1 };
        let mut edge = Self {
            top,
            bottom,
            slope: 0,
            steepness: 0,
            first_row,
            first_x: top.x,
            first_column,
            first_y: top.y,
        };
        let (dx, dy) = (bottom.x - top.x, bottom.y - top.y);
        if fixed::line(first_row) < bottom.y {
            (edge.slope, edge.first_x) = first_crossing(top.x, dx, dy, fixed::line(first_row) - top.y);
        } else if dy >= ONE {
            edge.slope = fixed::divide(dx, dy);
        }
        let to_column = (fixed::line(first_column) - top.x).abs();
        if to_column < dx.abs() {
            (edge.steepness, edge.first_y) = first_crossing(top.y, dy, dx.abs(), to_column);
        }
        edge
    }

    /// x where the edge crosses row line `row`, between its ends.
    #[inline]
    pub(crate) fn x_at_row(&self, row: i32) -> Fixed {
        let lines = Fixed::from(row - self.first_row);
        self.clamp_x(self.first_x + lines * self.slope)
    }

    /// y where the edge meets column line `column`; its nearer end for lines that it does not reach.
    #[inline]
    pub(crate) fn y_at_column(&self, column: i32) -> Fixed {
        let line = fixed::line(column);
        let rightward = self.bottom.x >= self.top.x;
        // The ends exactly: a corner on a line must not appear twice, 2⁻⁹⁵ apart.
        let (before, after) = if rightward {
            (line <= self.top.x, line >= self.bottom.x)
        } else {
            (line >= self.top.x, line <= self.bottom.x)
        };
        if before || after {
            return if before { self.top.y } else { self.bottom.y };
        }
        let lines = Fixed::from(column.abs_diff(self.first_column));
        (self.first_y + lines * self.steepness).min(self.bottom.y)
    }

    /// x at any height between the ends.
    #[inline]
    pub(crate) fn x_at(&self, y: Fixed) -> Fixed {
        if y >= self.bottom.y {
            return self.bottom.x;
        }
        if y <= self.top.y {
            return self.top.x;
        }
        let row = fixed::floor(y);
        if fixed::line(row) == y {
            return self.x_at_row(row);
        }
        let (dx, dy, below) = (self.bottom.x - self.top.x, self.bottom.y - self.top.y, y - self.top.y);
        let across = if dy >= ONE {
            fixed::multiply(self.slope, below)
        } else {
            fixed::multiply(dx, fixed::divide(below, dy))
        };
        self.clamp_x(self.top.x + across)
    }

    #[inline]
    fn clamp_x(&self, x: Fixed) -> Fixed {
        x.clamp(self.top.x.min(self.bottom.x), self.top.x.max(self.bottom.x))
    }
}

/// Slope and first crossing along one axis: `start` and `rise` on the axis asked for, `run` > `to_line` > 0 on the other.
#[inline]
fn first_crossing(start: Fixed, rise: Fixed, run: Fixed, to_line: Fixed) -> (Fixed, Fixed) {
    if rise == 0 {
        (0, start)
    } else if run >= ONE {
        let slope = fixed::divide(rise, run);
        (slope, start + fixed::multiply(slope, to_line))
    } else {
        (0, start + fixed::multiply(rise, fixed::divide(to_line, run)))
    }
}
