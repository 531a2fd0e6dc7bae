//! Positions as integers: cells of a cube with 2³² cells a side around the cloud.
//!
//! A position is off by less than 2⁻³² of the cloud's extent, wherever the cloud lies, and differences to any origin
//! in the cloud are exact before they become `f32`.

use glam::{DVec3, Vec3};
use pointillist_view::{MORTON_BITS, morton_code};

/// Cells per side of the cube.
const CELLS: f64 = 4_294_967_296.0;

/// A cube around a cloud. Lengths inside are in *units* of its side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lattice {
    pub(crate) low: DVec3,
    /// The longest side of the box around the cloud: what is drawn does not depend on the unit of length.
    pub(crate) side: f64,
}

impl Lattice {
    /// `positions` are finite, and so are their differences.
    pub(crate) fn around(positions: &[DVec3]) -> Self {
        let (low, high) = positions
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        let extent = (high - low).max_element();
        // Coincident points have no extent, but discs need a unit of length.
        let extent = if extent > 0.0 { extent.max(1e-290) } else { 1.0 };
        Self { low, side: extent }
    }

    /// The lattice of this cube; nothing if its corner is not finite, or its side not above 0.
    pub(crate) fn of_cube(low: DVec3, side: f64) -> Option<Self> {
        let is_sound = low.is_finite() && (low + side).is_finite() && side >= 1e-290;
        is_sound.then_some(Self { low, side })
    }

    /// The cell that holds `p`, or the nearest one.
    pub(crate) fn cell(&self, p: DVec3) -> [u32; 3] {
        ((p - self.low) / self.side * CELLS).to_array().map(|c| c.clamp(0.0, CELLS - 1.0) as u32)
    }

    /// The middle of a cell in the world.
    pub(crate) fn position(&self, cell: [u32; 3]) -> DVec3 {
        self.way(DVec3::ZERO, cell)
    }

    /// The vector from a position in the world to the middle of a cell. It is computed from differences to the
    /// lattice's corner, so that the distance to the origin of the world costs no digits: the picture is the same
    /// wherever the scene lies.
    pub(crate) fn way(&self, from: DVec3, cell: [u32; 3]) -> DVec3 {
        let middle = DVec3::from_array(cell.map(|c| (f64::from(c) + 0.5) / CELLS));
        (self.low - from) + middle * self.side
    }
}

/// The vector from one cell to another, in units. Rounded once per coordinate.
pub(crate) fn between(from: [u32; 3], to: [u32; 3]) -> Vec3 {
    let coordinate = |i: usize| (i64::from(to[i]) - i64::from(from[i])) as f32 * (1.0 / CELLS as f32);
    Vec3::from_array([0, 1, 2].map(coordinate))
}

/// The cell at this vector, in units, from another cell.
pub(crate) fn moved(from: [u32; 3], way: Vec3) -> [u32; 3] {
    let place = |i: usize| f64::from(from[i]) + f64::from(way[i]) * CELLS;
    [0, 1, 2].map(|i| place(i).round().clamp(0.0, CELLS - 1.0) as u32)
}

/// One coordinate of [`between`], for cells less than half the lattice apart.
#[inline(always)]
pub(crate) fn offset(from: u32, to: u32) -> f32 {
    to.wrapping_sub(from) as i32 as f32 * (1.0 / CELLS as f32)
}

/// The Morton code of a cell, from the highest bits of its numbers: the cells of a node of the octree follow one
/// another.
pub(crate) fn morton(cell: [u32; 3]) -> u64 {
    morton_code(cell.map(|c| c >> (32 - MORTON_BITS)))
}
