//! Rectangles of cells.

use std::ops::Range;

/// A rectangle of cells: columns `x0..x1`, rows `y0..y1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellWindow {
    /// First column.
    pub x0: i32,
    /// First row.
    pub y0: i32,
    /// One past the last column.
    pub x1: i32,
    /// One past the last row.
    pub y1: i32,
}

impl CellWindow {
    /// Every cell whose column and row fit into an `i32`.
    pub const ALL: Self = Self { x0: i32::MIN, y0: i32::MIN, x1: i32::MAX, y1: i32::MAX };

    /// The part of `columns` in the window; empty ranges stay empty.
    pub(crate) fn clip_columns(&self, columns: Range<i32>) -> Range<i32> {
        columns.start.max(self.x0)..columns.end.min(self.x1)
    }

    /// The part of `rows` in the window.
    pub(crate) fn clip_rows(&self, rows: Range<i32>) -> Range<i32> {
        rows.start.max(self.y0)..rows.end.min(self.y1)
    }
}
