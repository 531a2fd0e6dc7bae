//! Positions of points as a locator holds them, and what of them is rounding.

use glam::DVec3;

/// What is lower than this share of its length is flat: how high it is has too few digits left.
const LEAST_HEIGHT: f64 = 1e-9;

/// How far the rounding of coordinates takes points from their plane or line, relative to the largest coordinate: half a unit in the last place
/// along each axis, as much for each of the three points that the plane is laid through, and the same once more for what was computed before.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// How far these positions may lie from where they are meant to be.
pub(crate) fn rounding_of(positions: &[DVec3]) -> f64 {
    ROUNDING * positions.iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()))
}

/// Points of a set, moved and resized to about a unit box about 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vertices {
    at: Vec<DVec3>,
    rounding: f64,
}

impl Vertices {
    /// Of finite positions.
    pub(crate) fn new(positions: &[DVec3], centre: DVec3, scale: f64) -> Self {
        let at = positions.iter().map(|p| (*p - centre) * scale).collect();
        Self { at, rounding: rounding_of(positions) * scale }
    }

    pub(crate) fn len(&self) -> usize {
        self.at.len()
    }

    #[inline]
    pub(crate) fn at(&self, point: u32) -> DVec3 {
        self.at[point as usize]
    }

    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        let with = |(low, high): (DVec3, DVec3), p: &DVec3| (low.min(*p), high.max(*p));
        self.at.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), with)
    }

    /// The height up to which a cell or facet with this longest edge is flat.
    #[inline]
    pub(crate) fn flat_below(&self, longest: f64) -> f64 {
        self.rounding.max(LEAST_HEIGHT * longest)
    }
}
