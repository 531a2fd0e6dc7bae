//! Light for surfaces that mirror, sharply or not: radiance from about one direction, and how much of the sky is seen there.

use crate::delaunay::Hint;
use crate::field::{check_radiance, expect_count};
use crate::sh::{Lobe, MAX_COUNT, MAX_ORDER, Sh, basis, coefficient_count};
use crate::{Field, ProbeError};
use glam::{DVec3, Vec3};
use std::f64::consts::FRAC_1_PI;

/// What comes from about a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Glossy {
    /// Radiance convolved with the lobe; linear RGB, at least 0.
    pub radiance: Vec3,
    /// The share of the lobe in which nothing but the sky is seen, 0 to 1; `None` if the probes do not know ([`Field::with_sky`]).
    pub sky: Option<f32>,
}

/// Coefficients by probe: of radiance, and of the share of sky if that is known.
#[derive(Clone, Debug)]
pub(crate) struct GlossyLight {
    radiance: Vec<Vec3>,
    sky: Option<Vec<f32>>,
}

impl GlossyLight {
    pub(crate) fn new(radiance: &[Sh]) -> Self {
        Self { radiance: radiance.iter().flat_map(coefficients).collect(), sky: None }
    }

    pub(crate) fn set(&mut self, probe: usize, radiance: &Sh) {
        let own = radiance.coefficients().len();
        self.radiance[probe * own..][..own]
            .iter_mut()
            .zip(coefficients(radiance))
            .for_each(|(to, c)| *to = c);
    }

    /// New probes see no sky until they are told.
    pub(crate) fn extend(&mut self, radiance: &[Sh]) {
        self.radiance.extend(radiance.iter().flat_map(coefficients));
        if let Some(sky) = &mut self.sky {
            sky.resize(self.radiance.len(), 0.0);
        }
    }

    /// Keeps these probes of those that have `count` coefficients each.
    pub(crate) fn keep(&mut self, probes: &[u32], count: usize) {
        let of = |&i: &u32| i as usize * count..(i as usize + 1) * count;
        self.radiance = probes.iter().flat_map(|i| &self.radiance[of(i)]).copied().collect();
        if let Some(sky) = &mut self.sky {
            *sky = probes.iter().flat_map(|i| &sky[of(i)]).copied().collect();
        }
    }
}

fn coefficients(radiance: &Sh) -> impl Iterator<Item = Vec3> + '_ {
    radiance.coefficients().iter().map(|c| c.as_vec3())
}

impl Field {
    /// Lets the field know how much of the sky each probe sees: 1 in directions in which nothing is, of the order of the field. Without it,
    /// [`Glossy::sky`] is unknown.
    ///
    /// # Errors
    /// [`ProbeError::CountMismatch`] if there is not one function for each probe, [`ProbeError::MixedOrders`], [`ProbeError::BadRadiance`]
    /// if a coefficient is beyond [`Field::BRIGHTEST`].
    pub fn with_sky(mut self, sky: &[Sh<f64>]) -> Result<Self, ProbeError> {
        expect_count(self.probe_count(), sky.len())?;
        for (index, sh) in sky.iter().enumerate() {
            self.check_sky(index, sh)?;
        }
        self.glossy.sky =
            Some(sky.iter().flat_map(|sh| sh.coefficients().iter().map(|&c| c as f32)).collect());
        Ok(self)
    }

    /// Replaces what a probe sees of the sky, in constant time.
    ///
    /// # Errors
    /// [`ProbeError::NoSuchProbe`], and as [`Field::with_sky`]; [`ProbeError::CountMismatch`] if the field was made without.
    pub fn set_sky(&mut self, probe: u32, sky: &Sh<f64>) -> Result<(), ProbeError> {
        let index = self.index(probe)?;
        self.check_sky(index, sky)?;
        let count = coefficient_count(self.order);
        let probes = self.probe_count();
        let own = self.glossy.sky.as_mut().ok_or(ProbeError::CountMismatch { probes, given: 0 })?;
        own[index * count..][..count].iter_mut().zip(sky.coefficients()).for_each(|(to, &c)| *to = c as f32);
        Ok(())
    }

    fn check_sky(&self, index: usize, sky: &Sh<f64>) -> Result<(), ProbeError> {
        let grey = sky.coefficients().iter().map(|&c| DVec3::splat(c)).collect();
        let grey = Sh::new(grey).map_err(|_| ProbeError::BadRadiance { index })?;
        check_radiance(index, &grey, self.order)
    }

    /// Light from about `direction` (of length 1) at a surface, as it mirrors it with `lobe`: radiance convolved with the lobe, of the bands
    /// that the probes hold. [`Lobe::MIRROR`] gives radiance itself, [`Lobe::ggx`] what a rough surface sees whose mirrored view is
    /// `direction`. `face_normal` points away from the surface on the side that is seen.
    ///
    /// Light with few bands seen in a mirror is blurred, and swings beyond what it stands for; below 0 it is cut.
    ///
    /// # Errors
    /// [`ProbeError::QueryNotFinite`] if the position or a vector is not finite.
    pub fn glossy(
        &self,
        position: DVec3,
        face_normal: Vec3,
        direction: Vec3,
        lobe: &Lobe,
        hint: &mut Hint,
    ) -> Result<Glossy, ProbeError> {
        if !direction.is_finite() {
            return Err(ProbeError::QueryNotFinite { index: 0 });
        }
        let shares = self.weigh(position, face_normal, hint)?;
        let factors = self.convolved_basis(direction, lobe);
        let count = coefficient_count(self.order);
        let (mut radiance, mut sky) = (Vec3::ZERO, 0.0);
        for (probe, weight) in shares.iter() {
            let own = probe as usize * count..(probe as usize + 1) * count;
            let light = &self.glossy.radiance[own.clone()];
            let at: Vec3 = light.iter().zip(factors).map(|(&c, y)| c * y as f32).sum();
            radiance += at * weight as f32;
            if let Some(shares) = &self.glossy.sky {
                let at: f32 = shares[own].iter().zip(factors).map(|(&c, y)| c * y as f32).sum();
                sky += at * weight as f32;
            }
        }
        let sky = self.glossy.sky.is_some().then(|| sky.clamp(0.0, 1.0));
        Ok(Glossy { radiance: radiance.max(Vec3::ZERO), sky })
    }

    /// The share of an even sky's irradiance that arrives at a surface (ambient occlusion): 1 in the open, 0 where no sky is seen; `None` if the
    /// probes do not know ([`Field::with_sky`]). `normal` has length 1.
    ///
    /// # Errors
    /// As [`Field::glossy`].
    pub fn sky_share(
        &self,
        position: DVec3,
        normal: Vec3,
        hint: &mut Hint,
    ) -> Result<Option<f32>, ProbeError> {
        let cosine = Lobe::new(Lobe::COSINE.bands().map(|a| a * FRAC_1_PI)).unwrap_or(Lobe::COSINE);
        Ok(self.glossy(position, normal, normal, &cosine, hint)?.sky)
    }

    /// The basis in a direction, each band times the lobe's factor.
    fn convolved_basis(&self, direction: Vec3, lobe: &Lobe) -> [f64; MAX_COUNT] {
        let mut values: [f64; MAX_COUNT] = basis(self.order, direction.as_dvec3());
        for (l, factor) in lobe.bands().iter().enumerate().take(self.order.min(MAX_ORDER) + 1) {
            values[l * l..(l + 1) * (l + 1)].iter_mut().for_each(|y| *y *= factor);
        }
        values
    }
}
