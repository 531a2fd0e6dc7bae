//! What a position takes from which probes.

/// Up to four probes and their shares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// Indices of probes; those whose weight is 0 may repeat another.
    pub probes: [u32; 4],
    /// In [0, 1], and 1 together.
    pub weights: [f64; 4],
}

impl Blend {
    /// All of one probe.
    pub(crate) const fn of_one(probe: u32) -> Self {
        Self { probes: [probe; 4], weights: [1.0, 0.0, 0.0, 0.0] }
    }

    /// Of coordinates that may be below 0 by rounding, or no numbers where a cell is flat to the last digit: then the first probe
    /// takes all.
    pub(crate) fn clamped(probes: [u32; 4], coordinates: [f64; 4]) -> Self {
        let weights = coordinates.map(|w| if w.is_nan() { 0.0 } else { w.clamp(0.0, 1.0) });
        let sum: f64 = weights.iter().sum();
        if sum > 0.0 { Self { probes, weights: weights.map(|w| w / sum) } } else { Self::of_one(probes[0]) }
    }

    /// The probes that count, with their weights.
    pub fn parts(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.probes.iter().copied().zip(self.weights).filter(|&(_, weight)| weight > 0.0)
    }
}
