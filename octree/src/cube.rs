//! The cube of the whole tree, and the lattice that positions are kept on.

use crate::error::OctreeError;
use crate::key::NodeKey;
use glam::DVec3;

/// Cells of the lattice along a side of the root: 2³².
const CELLS: f64 = 4_294_967_296.0;

/// The cube of the whole tree, world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cube {
    /// The corner with the lowest coordinates.
    pub low: DVec3,
    /// Length of a side; above 0.
    pub side: f64,
}

impl Cube {
    /// Largest absolute coordinate.
    pub const FARTHEST: f64 = 1e150;

    /// The smallest cube around a box, with the box in its low corner. A box without extent gets a side that its coordinates can tell apart.
    ///
    /// # Errors
    /// [`OctreeError::BadBounds`] for bounds that are not finite, beyond [`Cube::FARTHEST`], or the wrong way round.
    pub fn around(low: DVec3, high: DVec3) -> Result<Self, OctreeError> {
        let side = (high - low).max_element();
        let largest = low.abs().max(high.abs()).max_element();
        // Not `largest > FARTHEST`, which NaN passes.
        let in_range = largest <= Self::FARTHEST && low.cmple(high).all();
        if !in_range {
            return Err(OctreeError::BadBounds { low, high });
        }
        // A millionth more, so that the highest point is within the last cell.
        let least = (largest * f64::EPSILON * CELLS).max(f64::MIN_POSITIVE * CELLS);
        Ok(Self {
            low,
            side: (side * (1.0 + 1e-6)).max(if side > 0.0 { f64::MIN_POSITIVE * CELLS } else { least }),
        })
    }

    /// Whether coordinates and side are of use.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let far = self.low.abs().max_element();
        far <= Self::FARTHEST && self.side > 0.0 && self.side <= 4.0 * Self::FARTHEST && self.low.is_finite()
    }

    /// The lattice cell of a position; outside of the cube the nearest one.
    #[must_use]
    pub fn cell(&self, position: DVec3) -> [u32; 3] {
        // `as` moves what is out of range to the ends.
        ((position - self.low) * (CELLS / self.side)).to_array().map(|c| c as u32)
    }

    /// The middle of a lattice cell.
    #[must_use]
    pub fn position(&self, cell: [u32; 3]) -> DVec3 {
        let steps = DVec3::from_array(cell.map(|c| f64::from(c) + 0.5));
        self.low + steps * (self.side / CELLS)
    }

    /// The cube of a node.
    #[must_use]
    pub fn of(&self, key: NodeKey) -> Self {
        let side = self.side / (key.level as f64).exp2();
        Self { low: self.low + DVec3::from_array(key.place.map(f64::from)) * side, side }
    }
}
