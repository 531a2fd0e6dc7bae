//! Weights of the corners of a cell at a position.

/// Up to four points and their weights at a position: barycentric coordinates in the cell that holds it.
///
/// Σ wᵢ·f(pᵢ) interpolates values `f` of the points: exactly where `f` is linear, and continuously everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// Indices of points; one whose weight is 0 may repeat another.
    pub points: [u32; 4],
    /// In [0, 1], and 1 together.
    pub weights: [f64; 4],
}

impl Blend {
    /// Weight 1 for one point.
    pub(crate) const fn of_one(point: u32) -> Self {
        Self { points: [point; 4], weights: [1.0, 0.0, 0.0, 0.0] }
    }

    /// From barycentric coordinates, which may be below 0 by rounding, or NaN where a cell is flat to the last digit:
    /// the first point then has weight 1.
    #[inline]
    pub(crate) fn clamped(points: [u32; 4], coordinates: [f64; 4]) -> Self {
        let weights = coordinates.map(|w| if w.is_nan() { 0.0 } else { w.clamp(0.0, 1.0) });
        let sum: f64 = weights.iter().sum();
        if sum > 0.0 { Self { points, weights: weights.map(|w| w / sum) } } else { Self::of_one(points[0]) }
    }

    /// The points whose weight is above 0, with their weights.
    pub fn parts(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.points.iter().copied().zip(self.weights).filter(|&(_, weight)| weight > 0.0)
    }
}
