//! What both products ask of a polygon before they begin.

use glam::DVec2;

use crate::fixed::{self, Fixed};
use crate::grid::{Grid, Point};
use crate::{CellWindow, DiceError, MAX_CELLS};

/// The rows and columns that a polygon touches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) min: Point,
    pub(crate) max: Point,
    /// Position of a vertex with the smallest y.
    pub(crate) top: usize,
}

impl Extent {
    /// Checks every vertex; `None` for an empty polygon.
    #[inline]
    pub(crate) fn of(polygon: &[DVec2], grid: &Grid) -> Result<Option<Self>, DiceError> {
        let Some(&first) = polygon.first() else { return Ok(None) };
        let first = grid.point(first, 0)?;
        let mut extent = Self { min: first, max: first, top: 0 };
        for (index, &vertex) in polygon.iter().enumerate().skip(1) {
            let p = grid.point(vertex, index)?;
            if p.y < extent.min.y {
                extent.top = index;
            }
            extent.min = Point { x: extent.min.x.min(p.x), y: extent.min.y.min(p.y) };
            extent.max = Point { x: extent.max.x.max(p.x), y: extent.max.y.max(p.y) };
        }
        Ok(Some(extent))
    }

    /// Rows and columns touched.
    #[inline]
    pub(crate) fn rows_and_columns(&self) -> (u64, u64) {
        let lines = |a: Fixed, b: Fixed| u64::from(fixed::ceil(b).abs_diff(fixed::floor(a)));
        (lines(self.min.y, self.max.y), lines(self.min.x, self.max.x))
    }

    /// Rows and columns touched within the window.
    #[inline]
    pub(crate) fn rows_and_columns_in(&self, window: CellWindow) -> (u64, u64) {
        let rows = window.clip_rows(fixed::floor(self.min.y)..fixed::ceil(self.max.y));
        let columns = window.clip_columns(fixed::floor(self.min.x)..fixed::ceil(self.max.x));
        (rows.len() as u64, columns.len() as u64)
    }

    /// Pieces of this area or less are rounding: twice what the crossings of an edge through all rows and columns are off.
    #[inline]
    pub(crate) fn noise(&self) -> Fixed {
        let (rows, columns) = self.rows_and_columns();
        Fixed::from(rows + columns + 64) << 4
    }
}

/// Refuses work without end.
#[inline]
pub(crate) fn check_count(count: u64) -> Result<(), DiceError> {
    if count > MAX_CELLS { Err(DiceError::TooManyCells { count }) } else { Ok(()) }
}

/// The next position around a ring of `len` vertices.
#[inline]
pub(crate) fn next(index: usize, len: usize) -> usize {
    if index + 1 == len { 0 } else { index + 1 }
}
