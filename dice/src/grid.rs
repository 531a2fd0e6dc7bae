//! The grid, and the way from input coordinates into it and back.

use glam::{DVec2, IVec2, dvec2};

use crate::error::DiceError;
use crate::fixed::{self, Fixed};
use crate::limits::MAX_COORDINATE;
use crate::window::CellWindow;

/// A grid of equal rectangular cells, endless or limited to a window of them.
///
/// Cell (i, j) covers `origin + [i, i+1)·cell.x × [j, j+1)·cell.y`. Sides may be negative: in a north-up raster `origin` is the north-western
/// corner and `cell.y` is below 0, so that rows are numbered from north to south. "Smaller" and "left" then mean by numbers of cells.
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

    /// A grid with a corner of cell (0, 0) at `origin` and cells of the size `cell`, in input units. Sides may be negative, for rasters
    /// whose rows or columns go against the axes.
    ///
    /// ```
    /// use glam::{DVec2, dvec2};
    /// use pointillist_dice::{Accumulator, Grid, accumulate};
    ///
    /// // A map with its north-western corner at 5° E, 50° N and pixels of a quarter of a degree.
    /// let grid = Grid::new(dvec2(5.0, 50.0), dvec2(0.25, -0.25))?;
    /// let pixel = [dvec2(5.5, 49.75), dvec2(5.75, 49.75), dvec2(5.75, 50.0), dvec2(5.5, 50.0)];
    /// accumulate(&pixel, &grid, &mut Accumulator::new(), |run| assert_eq!((run.row, run.columns), (0, 2..3)))?;
    /// # Ok::<(), pointillist_dice::DiceError>(())
    /// ```
    ///
    /// # Errors
    /// [`DiceError::BadGrid`] unless `origin` is finite and both sides and the area of a cell are finite, normal numbers (so not 0).
    pub fn new(origin: DVec2, cell: DVec2) -> Result<Self, DiceError> {
        if origin.is_finite() && cell.x.is_normal() && cell.y.is_normal() && (cell.x * cell.y).is_normal() {
            Ok(Self { origin, cell, window: CellWindow::ALL })
        } else {
            Err(DiceError::BadGrid { origin, cell })
        }
    }

    /// The same grid, of which only the cells of `window` are reported and paid for: time grows with the number of vertices (one
    /// comparison each outside of the window) and with what of the polygon lies in the window, not with the polygon's size in cells.
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

    /// The size of a cell, with the signs that [`Self::new`] was given.
    #[must_use]
    pub const fn cell(&self) -> DVec2 {
        self.cell
    }

    /// The area of a cell in input units².
    #[must_use]
    pub fn cell_area(&self) -> f64 {
        (self.cell.x * self.cell.y).abs()
    }

    /// The corner that `cell` shares with the cells of smaller numbers, as every piece that touches it has it. With positive sides it has the
    /// smallest coordinates of the cell.
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

    /// Powers of two with the signs of the cell's sides and at most their sizes: divided by it, exactly, coordinates grow with the numbers of
    /// cells and are neither huge nor tiny.
    pub(crate) fn binary_unit(&self) -> DVec2 {
        const SIGN_AND_EXPONENT: u64 = !((1 << 52) - 1);
        let unit = |side: f64| f64::from_bits(side.to_bits() & SIGN_AND_EXPONENT);
        dvec2(unit(self.cell.x), unit(self.cell.y))
    }

    /// Input y of the first and last line of the window's rows.
    pub(crate) fn rows_in_input(&self) -> [f64; 2] {
        let y = |row: i32| self.origin.y + self.cell.y * f64::from(row);
        [y(self.window.y0), y(self.window.y1)]
    }

    /// A vertex of the input as it appears in `cell`: itself, unless rounding of the cell's lines leaves it outside.
    #[inline]
    pub(crate) fn clamp_to(&self, vertex: DVec2, cell: IVec2) -> DVec2 {
        let corners = [self.corner(cell), self.input_from_local(cell, dvec2(1.0, 1.0))];
        vertex.clamp(corners[0].min(corners[1]), corners[0].max(corners[1]))
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
