//! Ranges of a number.

/// A closed range of numbers, such as the nearness of all points of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The smallest number.
    pub least: f64,
    /// The largest.
    pub most: f64,
}

impl Interval {
    /// No number at all.
    pub const EMPTY: Self = Self { least: f64::INFINITY, most: f64::NEG_INFINITY };

    /// Every number.
    pub const ALL: Self = Self { least: f64::NEG_INFINITY, most: f64::INFINITY };

    /// Widens it to hold a number.
    #[inline]
    pub fn include(&mut self, value: f64) {
        // Comparisons are one instruction each, `f64::min` and `f64::max` five; of NaN both keep the bounds.
        self.least = if value < self.least { value } else { self.least };
        self.most = if value > self.most { value } else { self.most };
    }

    /// The smallest interval that holds both.
    #[must_use]
    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), most: self.most.max(other.most) }
    }

    /// The number of the interval that is closest to `value`; one that is not NaN.
    #[must_use]
    #[inline]
    pub fn clamp(self, value: f64) -> f64 {
        let above = if value > self.least { value } else { self.least };
        if above < self.most { above } else { self.most }
    }
}
