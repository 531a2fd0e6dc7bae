//! How much of a photograph is over- or underexposed.

/// The share of a photograph, 0 to 1, whose radiance is unknown: by pixels, or of a panorama by solid angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Clipping {
    /// Share in which a channel has the highest level: the true radiance there is at least that, and is unknown.
    pub over_exposed: f64,
    /// Share in which all channels have the lowest level.
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
