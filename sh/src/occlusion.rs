//! Visibility of the sky.

use crate::{Channel, Sh};
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

impl Sh<f64> {
    /// For a visibility function (1 where the sky is visible, 0 elsewhere): the share of an even sky's irradiance that
    /// arrives at a surface, ∫ V·max(cos θ, 0) dω/π. 0 is fully occluded, 1 is open; values beyond, which truncation
    /// can give, are clamped.
    #[must_use]
    pub fn ambient_occlusion(&self, normal: DVec3) -> f64 {
        (self.irradiance(normal) * FRAC_1_PI).clamp(0.0, 1.0)
    }

    /// For a visibility function: the radiance of a sky where it is visible. Its [`Sh::irradiance`] is the light from
    /// the sky; light from what occludes the sky is to be added by the caller.
    #[must_use]
    pub fn lit_by<T: Channel>(&self, sky: &Sh<T>) -> Sh<T> {
        sky.product(self, sky.order()).expect("functions have orders that products take")
    }
}
