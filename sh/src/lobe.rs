//! Kernels about an axis: how a surface spreads light.

use crate::ShError;
use crate::basis::MAX_ORDER;
use crate::gauss_legendre::gauss_legendre;
use crate::legendre::legendre;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// A kernel k(θ) about a direction, as a factor per band: a_l = 2π ∫ k(θ) P_l(cos θ) sin θ dθ. Convolution with it
/// multiplies band l by a_l.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    bands: [f64; MAX_ORDER + 1],
}

impl Lobe {
    /// max(cos θ, 0), which makes irradiance of radiance (\[1\], eq. 8): π, 2π/3, π/4, 0, −π/24, 0, π/64, 0, −π/128.
    pub const COSINE: Self =
        Self { bands: [PI, TAU / 3.0, FRAC_PI_4, 0.0, -PI / 24.0, 0.0, PI / 64.0, 0.0, -PI / 128.0] };

    /// The identity of convolution: factor 1 for every band.
    pub const MIRROR: Self = Self { bands: [1.0; MAX_ORDER + 1] };

    /// From a factor per band.
    ///
    /// # Errors
    /// `LobeBand` if one is not finite.
    pub fn new(bands: [f64; MAX_ORDER + 1]) -> Result<Self, ShError> {
        match bands.iter().position(|a| !a.is_finite()) {
            Some(band) => Err(ShError::LobeBand { band }),
            None => Ok(Self { bands }),
        }
    }

    /// Phong's lobe max(cos θ, 0)^n, with integral 1: a_l = (n+1) ∫₀¹ tⁿ P_l(t) dt, which each second band gets from
    /// the one before by the factor (n − l + 2)/(n + l + 1).
    ///
    /// # Errors
    /// `LobeShape` unless the exponent is finite and at least 0.
    pub fn phong(exponent: f64) -> Result<Self, ShError> {
        if !(exponent >= 0.0 && exponent.is_finite()) {
            return Err(ShError::LobeShape { value: exponent });
        }
        let mut bands = [1.0; MAX_ORDER + 1];
        bands[1] = (exponent + 1.0) / (exponent + 2.0);
        for l in 2..=MAX_ORDER {
            let band = l as f64;
            bands[l] = bands[l - 2] * (exponent - band + 2.0) / (exponent + band + 1.0);
        }
        Ok(Self { bands })
    }

    /// The reflection of GGX with α = `roughness_alpha`, seen along the normal (\[7\]): D(θ/2)·max(cos θ, 0), with
    /// integral 1.
    ///
    /// # Errors
    /// `LobeShape` unless 1e-4 ≤ α ≤ 1.
    pub fn ggx(roughness_alpha: f64) -> Result<Self, ShError> {
        if !(1e-4..=1.0).contains(&roughness_alpha) {
            return Err(ShError::LobeShape { value: roughness_alpha });
        }
        let a2 = roughness_alpha * roughness_alpha;
        // With c = 1 − cos θ: D ~ 1/(α² + (1 − α²)·c/2)².
        let kernel = |cos: f64| cos / (a2 + 0.5 * (1.0 - a2) * (1.0 - cos)).powi(2);
        let bands = zonal(kernel, a2);
        Ok(Self { bands: bands.map(|a| a / bands[0]) })
    }

    /// The factors of bands 0 to [`MAX_ORDER`].
    #[must_use]
    pub const fn bands(&self) -> &[f64; MAX_ORDER + 1] {
        &self.bands
    }
}

/// 2π ∫₀¹ k(t) P_l(t) dt of a kernel with a peak of width `scale` in 1 − t: panels that double in size away from it.
fn zonal(kernel: impl Fn(f64) -> f64, scale: f64) -> [f64; MAX_ORDER + 1] {
    let rule = gauss_legendre(16);
    let mut bands = [0.0; MAX_ORDER + 1];
    let (mut from, mut to) = (0.0, scale.min(1.0));
    while from < 1.0 {
        for &(x, weight) in &rule {
            let t = 1.0 - (from + 0.5 * (x + 1.0) * (to - from));
            let mut values = [0.0; MAX_ORDER + 1];
            legendre(t, &mut values);
            let factor = TAU * kernel(t) * weight * 0.5 * (to - from);
            bands.iter_mut().zip(values).for_each(|(a, p)| *a += factor * p);
        }
        (from, to) = (to, (2.0 * to).min(1.0));
    }
    bands
}
