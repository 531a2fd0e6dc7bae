//! Axis-aligned boxes in the world.

use crate::interval::Interval;
use glam::DVec3;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub low: DVec3,
    /// Largest coordinates.
    pub high: DVec3,
}

impl Bounds {
    pub(crate) const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    pub(crate) fn include(&mut self, p: DVec3) {
        self.low = self.low.min(p);
        self.high = self.high.max(p);
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Smallest and largest value of `direction · (p − origin)` over the box, widened by rounding.
    #[must_use]
    #[inline]
    pub fn extent_along(&self, origin: DVec3, direction: DVec3) -> Interval {
        let centre = 0.5 * (self.low + self.high) - origin;
        let half = 0.5 * (self.high - self.low);
        let middle = direction.dot(centre);
        let reach = direction.abs().dot(half) + 1e-12 * direction.abs().dot(centre.abs() + half);
        Interval { least: middle - reach, most: middle + reach }
    }
}
