//! The grid, and the way from input coordinates into it and back.

use glam::{DVec2, IVec2, dvec2};

use crate::fixed::{self, Fixed};
use crate::{CellWindow, DiceError};

/// Vertices must lie within this many cells of the grid's origin, so that every cell near them has an `i32` number.
pub const MAX_COORDINATE: f64 = (1u64 << 30) as f64;

/// A grid of equal rectangular cells, endless or limited to a window of them.
///
/// Cell (i, j) covers `origin + [i, i+1)·cell.x × [j, j+1)·cell.y`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    origin: DVec2,
    cell: DVec2,
    window: CellWindow,
}

/// A point in cell coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Point {
    pub(crate) x: Fixed,
    pub(crate) y: Fixed,
}

impl Grid {
    /// Unit cells with a corner at the origin.
    pub const UNIT: Self = Self { origin: DVec2::ZERO, cell: DVec2::ONE, window: CellWindow::ALL };

    /// A grid with a corner of cell (0, 0) at `origin` and cells of the size `cell`.
    ///
    /// # Errors
    /// [`DiceError::BadGrid`] unless `origin` is finite and both sides and the area of a cell are positive, finite, normal numbers.
    pub fn new(origin: DVec2, cell: DVec2) -> Result<Self, DiceError> {
        let normal = |v: f64| v > 0.0 && v.is_normal();
        if origin.is_finite() && normal(cell.x) && normal(cell.y) && normal(cell.x * cell.y) {
            Ok(Self { origin, cell, window: CellWindow::ALL })
        } else {
            Err(DiceError::BadGrid { origin, cell })
        }
    }

    /// The same grid, of which only the cells of `window` are reported and paid for: the cost of a polygon grows with
    /// its vertices and with what of it lies in the window.
    ///
    /// Pieces and areas are those of the endless grid, bit for bit; centroids of [`accumulate`](crate::accumulate()) may
    /// differ in their last place.
    #[must_use]
    pub const fn with_window(mut self, window: CellWindow) -> Self {
        self.window = window;
        self
    }

    /// The cells that are reported.
    #[must_use]
    pub const fn window(&self) -> CellWindow {
        self.window
    }

    /// The corner of cell (0, 0).
    #[must_use]
    pub const fn origin(&self) -> DVec2 {
        self.origin
    }

    /// The size of a cell.
    #[must_use]
    pub const fn cell(&self) -> DVec2 {
        self.cell
    }

    /// The area of a cell in input units².
    #[must_use]
    pub fn cell_area(&self) -> f64 {
        self.cell.x * self.cell.y
    }

    /// The corner of `cell` with the smallest coordinates, as every piece that touches it has it.
    #[must_use]
    pub fn corner(&self, cell: IVec2) -> DVec2 {
        self.input_from_local(cell, DVec2::ZERO)
    }

    /// The input coordinates of the place `local` ∈ [0, 1]² in `cell`. Monotone in both, so that nothing leaves its cell.
    #[inline]
    pub(crate) fn input_from_local(&self, cell: IVec2, local: DVec2) -> DVec2 {
        self.origin + self.cell * (cell.as_dvec2() + local)
    }

    /// The vertex in cell coordinates.
    #[inline]
    pub(crate) fn point(&self, vertex: DVec2, index: usize) -> Result<Point, DiceError> {
        if !vertex.is_finite() {
            return Err(DiceError::NotFinite { index });
        }
        let x = coordinate(vertex.x, self.origin.x, self.cell.x);
        let y = coordinate(vertex.y, self.origin.y, self.cell.y);
        match (x, y) {
            (Some(x), Some(y)) => Ok(Point { x, y }),
            _ => Err(DiceError::OutOfRange { index }),
        }
    }

    /// A vertex of the input as it appears in `cell`: itself, unless rounding of the cell's lines leaves it outside.
    #[inline]
    pub(crate) fn clamp_to(&self, vertex: DVec2, cell: IVec2) -> DVec2 {
        vertex.clamp(self.corner(cell), self.input_from_local(cell, dvec2(1.0, 1.0)))
    }
}

/// (value − origin) / cell, to 2⁻⁹⁶ or about 2⁻¹⁰⁰ of itself; `None` beyond [`MAX_COORDINATE`].
#[inline]
fn coordinate(value: f64, origin: f64, cell: f64) -> Option<Fixed> {
    // The difference and its rounding error (Knuth).
    let high = value - origin;
    let minus_origin = high - value;
    let low = (value - (high - minus_origin)) - (origin + minus_origin);
    let (q1, q0) = if cell == 1.0 {
        (high, low)
    } else {
        let q1 = high / cell;
        (q1, (f64::mul_add(-q1, cell, high) + low) / cell)
    };
    if q1.abs() <= MAX_COORDINATE { Some(fixed::from_f64(q1) + fixed::from_f64(q0)) } else { None }
}
