//! The cells of the light grid under the paper's rule.

use glam::DVec2;

/// Shadow micropoints per receiver beyond which the cells are made larger: a fixed grid may be finer
/// than any receiver, and the cost would be without bound.
const MOST_CELLS: f64 = 256.0;

/// Cells from the middle of the light grid to the farthest receiver.
const MOST_DISTANCE: f64 = (1 << 29) as f64;

/// The cells of a light grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightCells {
    /// Side of a cell in units of the screen; `None`: for each target the smallest power of two that is no smaller than it.
    pub(crate) size: Option<f64>,
}

impl LightCells {
    /// Size of the cells for a target with these bounds.
    pub(crate) fn size(&self, (low, high): (DVec2, DVec2)) -> f64 {
        let extent = (high - low).max_element();
        // Receivers far smaller than their distance from the middle: cells must be numbered in 32 bits.
        let least = low.abs().max(high.abs()).max_element() / MOST_DISTANCE;
        match self.size {
            Some(size) => size.max(extent / MOST_CELLS.sqrt()).max(least),
            None => extent.max(least).max(f64::MIN_POSITIVE).log2().ceil().exp2(),
        }
    }

    /// Bounds of the cells that a target touches: a caster in any of them may darken it.
    pub(crate) fn around(&self, bounds: (DVec2, DVec2)) -> (DVec2, DVec2) {
        let size = self.size(bounds);
        ((bounds.0 / size).floor() * size, (bounds.1 / size).ceil() * size)
    }
}
