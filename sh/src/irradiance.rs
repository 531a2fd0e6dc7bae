//! Irradiance of any order.

use crate::basis::{MAX_COUNT, fill_basis};
use crate::{Channel, Lobe, Sh};
use glam::DVec3;

impl<T: Channel> Sh<T> {
    /// E(n) = Σ A_l·L_lm·Y_lm(n) for a normal of unit length \[1\], with the A_l of [`Lobe::COSINE`]; reflected is
    /// albedo/π of it.
    #[must_use]
    pub fn irradiance(&self, normal: DVec3) -> T {
        self.glossy(normal, &Lobe::COSINE)
    }

    /// The convolution with a lobe about a direction of unit length: light that a glossy surface reflects, if the
    /// direction is the mirrored view and the lobe its kernel.
    #[must_use]
    pub fn glossy(&self, direction: DVec3, lobe: &Lobe) -> T {
        let mut values = [0.0; MAX_COUNT];
        fill_basis(self.order(), direction, &mut values);
        let mut sum = T::default();
        for (l, &factor) in lobe.bands().iter().enumerate().take(self.order() + 1) {
            let of_band = self.band(l).iter().zip(&values[l * l..]);
            sum += of_band.fold(T::default(), |sum, (&c, &y)| sum + c * y) * factor;
        }
        sum
    }
}
