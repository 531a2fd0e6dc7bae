//! How much of a photograph is over- or underexposed.

/// The share of a photograph, 0 to 1, whose radiance is unknown: by pixels, or of a panorama by solid angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Clipping {
    /// Where a channel has the highest level: light that was brighter is missing.
    pub over_exposed: f64,
    /// Where all channels have the lowest level.
    pub under_exposed: f64,
}

impl Clipping {
    /// Takes one pixel into account.
    pub(crate) fn add(&mut self, pixel: [u8; 3], share: f64) {
        if pixel.contains(&u8::MAX) {
            self.over_exposed += share;
        }
        if pixel == [0; 3] {
            self.under_exposed += share;
        }
    }
}
