//! Splits radiance into one directional light and a rest.

use crate::ShError;
use crate::basis::{checked_order, coefficient_count};
use crate::{Lobe, Sh, basis};
use glam::{DVec3, dvec3};
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// Luminance of linear colors (ITU-R BT.709).
const LUMINANCE: DVec3 = dvec3(0.2126, 0.7152, 0.0722);

/// Steps in which the share of a light is sought: to 1e-6 of it.
const SEARCH_STEPS: usize = 20;

/// Light from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DominantLight {
    /// Towards the light, of unit length.
    pub direction: DVec3,
    /// On a surface that faces it; not negative.
    pub irradiance: DVec3,
}

impl DominantLight {
    /// Its irradiance on a surface with this normal, exactly.
    #[must_use]
    pub fn irradiance(&self, normal: DVec3) -> DVec3 {
        self.irradiance * normal.dot(self.direction).max(0.0)
    }

    /// The coefficients of its radiance.
    ///
    /// # Errors
    /// `OrderTooHigh`, `CoefficientNotFinite`.
    pub fn to_sh(&self, order: usize) -> Result<Sh, ShError> {
        let count = coefficient_count(checked_order(order)?);
        Sh::new(basis(order, self.direction)[..count].iter().map(|&y| self.irradiance * y).collect())
    }
}

/// Radiance as a light, to be evaluated exactly, and a rest whose irradiance is nowhere negative.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Split {
    /// The directional light; none if there are neither sharp features nor negative irradiance.
    pub light: Option<DominantLight>,
    /// Radiance without the light; deringed if its irradiance was still negative somewhere.
    pub rest: Sh,
}

impl Split {
    /// E(n) of both, nowhere negative.
    #[must_use]
    pub fn irradiance(&self, normal: DVec3) -> DVec3 {
        self.rest.irradiance(normal) + self.light.map_or(DVec3::ZERO, |light| light.irradiance(normal))
    }
}

impl Sh {
    /// The directional light that with an even sky comes closest to this irradiance (least squares over the sphere;
    /// \[3\], dominant light). `None` below order 1, and where light has no direction.
    ///
    /// Its direction is that of the linear band's luminance. Per color it is not below 0, and not above what the mean
    /// allows. It is more than what a lamp or the sun gives alone: a sky brighter on one side counts as a light, too.
    /// To take lights out, see [`Sh::split`].
    #[must_use]
    pub fn dominant_light(&self) -> Option<DominantLight> {
        let linear = self.band(1);
        let [y, z, x] = <[DVec3; 3]>::try_from(linear).ok()?.map(|c| c.dot(LUMINANCE));
        let direction = dvec3(x, y, z).try_normalize()?;
        // The sky takes band 0.
        Some(DominantLight { direction, irradiance: self.light_in(direction, 1..=self.order()) })
    }

    /// The light from a direction that best explains the irradiance of some bands: one equation,
    /// Σ A_l²·L_lm·Y_lm = I·Σ A_l²·Y_lm²; 0 where the bands have none.
    fn light_in(&self, direction: DVec3, bands: RangeInclusive<usize>) -> DVec3 {
        let values = basis(self.order(), direction);
        let (mut light, mut norm) = (DVec3::ZERO, 0.0);
        for l in bands {
            let a = Lobe::COSINE.bands()[l];
            for (&c, &y) in self.band(l).iter().zip(&values[l * l..]) {
                light += c * (a * a * y);
                norm += a * a * y * y;
            }
        }
        let most = self.mean().max(DVec3::ZERO) * (4.0 * PI);
        if norm > 0.0 { (light / norm).max(DVec3::ZERO).min(most) } else { DVec3::ZERO }
    }

    /// Bands 0 to `order` with a light apart: as much as bands above `order` show to be sharp, at their peak, and as it
    /// takes for the irradiance of the rest not to be negative. Where that is not enough, the rest is deringed.
    ///
    /// So with coefficients of order 4 or more, split to 2, irradiance is closer than that of order 2: of ten HDR maps,
    /// the mean error fell from 2.4…8.2 % to 0.8…4.4 % of the mean irradiance, and in none it rose. With those of order
    /// 2 alone, light is taken out only where there would be negative irradiance: of the dominant light.
    ///
    /// # Errors
    /// `OrderTooHigh`.
    pub fn split(&self, order: usize) -> Result<Split, ShError> {
        let rest = self.with_order(order)?;
        let without = |light: &DominantLight, share: f64| {
            let part = DominantLight { irradiance: light.irradiance * share, ..*light };
            let left =
                part.to_sh(order).and_then(|taken| rest.minus(&taken)).unwrap_or_else(|_| rest.clone());
            (part, left)
        };
        let least = |light: &DominantLight, share: f64| without(light, share).1.least_irradiance();
        let sharp = self.sharp_light(order);
        let is_bright = rest.least_irradiance() >= 0.0;
        // 1. Take out the light that higher bands show to be sharp, or the largest share of it that leaves irradiance
        //    non-negative.
        let (light, share) = match sharp {
            Some(light) if least(&light, 1.0) >= 0.0 => (light, 1.0),
            Some(light) if is_bright => (light, most_share(|share| least(&light, share))),
            // 2. Irradiance is negative somewhere: take out the least light that makes it non-negative, or as much as
            //    raises its minimum most.
            _ if !is_bright => match rest.light_at(sharp.map(|light| light.direction)) {
                Some(light) => (light, least_share(|share| least(&light, share))),
                None => return Ok(Split { light: None, rest: rest.deringed() }),
            },
            _ => return Ok(Split { light: None, rest }),
        };
        let (light, rest) = without(&light, share);
        let light = (light.irradiance != DVec3::ZERO).then_some(light);
        Ok(Split { light, rest: rest.deringed() })
    }

    /// The dominant light, or the one in a given direction.
    fn light_at(&self, direction: Option<DVec3>) -> Option<DominantLight> {
        let at =
            |direction| DominantLight { direction, irradiance: self.light_in(direction, 1..=self.order()) };
        direction.map(at).or_else(|| self.dominant_light())
    }

    /// The light where bands above `order` peak, of the irradiance that they show; `None` without any.
    fn sharp_light(&self, order: usize) -> Option<DominantLight> {
        let bands = order + 1..=self.order();
        let dark: Sh<f64> =
            Sh::from_parts(self.coefficients().iter().map(|c| -c.dot(LUMINANCE)).collect(), self.order());
        let high = dark.map_bands(|l| if bands.contains(&l) { 1.0 } else { 0.0 });
        let direction = high.minimum().0;
        let irradiance = self.light_in(direction, bands);
        (irradiance != DVec3::ZERO).then_some(DominantLight { direction, irradiance })
    }

    /// The lowest irradiance of any color in any direction.
    fn least_irradiance(&self) -> f64 {
        let channels = (0..3).map(|i| self.channel(i).convolved(&Lobe::COSINE).minimum().1);
        channels.fold(f64::INFINITY, f64::min)
    }
}

/// The largest x in 0..=1 where a concave function is not negative, which it is not at 0.
fn most_share(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..SEARCH_STEPS {
        let middle = 0.5 * (low + high);
        (low, high) = if f(middle) < 0.0 { (low, middle) } else { (middle, high) };
    }
    low
}

/// The least x in 0..=1 where a concave function is not negative, or else where it is largest.
fn least_share(f: impl Fn(f64) -> f64) -> f64 {
    if f(0.0) >= 0.0 {
        return 0.0;
    }
    // 1. Ternary search for a point that is not negative: the maximum lies in the interval that is kept.
    let (mut low, mut high) = (0.0, 1.0);
    let mut found = None;
    for _ in 0..SEARCH_STEPS {
        let (a, b) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
        let (fa, fb) = (f(a), f(b));
        found = if fa >= 0.0 { Some(a) } else { (fb >= 0.0).then_some(b) };
        if found.is_some() {
            break;
        }
        (low, high) = if fa < fb { (a, high) } else { (low, b) };
    }
    let Some(mut enough) = found else { return 0.5 * (low + high) };
    // 2. Bisection for the least such point.
    let mut too_little = 0.0;
    for _ in 0..SEARCH_STEPS {
        let middle = 0.5 * (too_little + enough);
        (too_little, enough) = if f(middle) < 0.0 { (middle, enough) } else { (too_little, middle) };
    }
    enough
}
