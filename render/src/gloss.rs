//! What glossy surfaces see of ambient light: radiance from about a direction, spread as their roughness says, not what lights a matt surface.

use crate::ambient::{Ambient, Spot};
use crate::reflections::SceneMap;
use crate::scene::SkyLight;
use glam::Vec3;
use pointillist_delaunay::Hint;
use pointillist_sh::{Lobe, MAX_ORDER};
use pointillist_shade::SMALLEST_ROUGHNESS;
use std::f32::consts::{FRAC_1_PI, PI};
use std::sync::LazyLock;

/// Lobes that are computed; between them, factors of bands are interpolated, to 2e-3 (see the test).
const LOBES: usize = 64;

/// Factors of GGX's bands at perceptual roughness i/[`LOBES`].
static FACTORS: LazyLock<Vec<[f64; MAX_ORDER + 1]>> = LazyLock::new(|| {
    let of = |i: usize| {
        let alpha = (i as f64 / LOBES as f64).powi(2);
        // The first is that of a mirror: none is as narrow as that.
        *Lobe::ggx(alpha).unwrap_or(Lobe::MIRROR).bands()
    };
    (0..=LOBES).map(of).collect()
});

/// The lobe about the mirrored view of a surface of this perceptual roughness.
pub(crate) fn lobe_of(roughness: f32) -> Lobe {
    if roughness.is_nan() || roughness <= SMALLEST_ROUGHNESS {
        return Lobe::MIRROR;
    }
    let at = f64::from(roughness.min(1.0)) * LOBES as f64;
    let below = (at as usize).min(LOBES - 1);
    let share = at - below as f64;
    let (a, b) = (&FACTORS[below], &FACTORS[below + 1]);
    Lobe::new(std::array::from_fn(|l| a[l] + (b[l] - a[l]) * share)).unwrap_or(Lobe::MIRROR)
}

impl Ambient<'_> {
    /// Radiance that a surface of this perceptual roughness mirrors from about a direction, without a map of its surroundings.
    pub(crate) fn towards(&self, spot: &Spot, direction: Vec3, roughness: f32, hint: &mut Hint) -> Vec3 {
        match self {
            Self::Color(color) => *color,
            Self::Sky(light) => light.mirrored(direction, roughness),
            Self::Environment(map) => map.radiance(direction, roughness),
            // Only a position that is not finite is refused; geometry with such positions is refused before.
            Self::Probes(field, _) | Self::RadiosityAndProbes(_, field, _) => field
                .glossy(spot.position, self.side(spot), direction, &lobe_of(roughness), hint)
                .map_or(Vec3::ZERO, |glossy| glossy.radiance),
            // What surfaces hold is known only where they are: light of the mirrored ones is taken to be like that of this one.
            Self::Radiosity(light) => light.irradiance(spot.triangle, spot.front, spot.position) * FRAC_1_PI,
        }
    }

    /// The same with the scene's own map, of which probes say how much is seen from the spot: none indoors, all of it in the open. What
    /// probes hold of the sky ends with their bands; the map adds the rest as far as it is seen.
    pub(crate) fn towards_map(
        &self,
        spot: &Spot,
        direction: Vec3,
        roughness: f32,
        map: &SceneMap,
        hint: &mut Hint,
    ) -> Vec3 {
        let Some(field) = self.field() else { return map.environment.radiance(direction, roughness) };
        let lobe = lobe_of(roughness);
        let Ok(glossy) = field.glossy(spot.position, self.side(spot), direction, &lobe, hint) else {
            return Vec3::ZERO;
        };
        let (Some(sky), Some(bands)) = (glossy.sky, &map.bands) else { return glossy.radiance };
        let detail = map.environment.radiance(direction, roughness)
            - bands.glossy(direction.as_dvec3(), &lobe).as_vec3();
        (glossy.radiance + detail * sky).max(Vec3::ZERO)
    }
}

/// Rings about the mirrored view that stand for a lobe.
const RINGS: usize = 16;

impl SkyLight {
    /// Radiance that a surface of this perceptual roughness mirrors from about a direction: the sky's and the ground's, by the share of the
    /// lobe above the horizon. A mirror sees a sharp horizon.
    pub(crate) fn mirrored(&self, direction: Vec3, roughness: f32) -> Vec3 {
        let height = direction.dot(self.up).clamp(-1.0, 1.0);
        if roughness.is_nan() || roughness <= SMALLEST_ROUGHNESS {
            return if height >= 0.0 { self.sky } else { self.ground };
        }
        let alpha2 = roughness.min(1.0).powi(4);
        let (mut above, mut all) = (0.0, 0.0);
        for i in 0..RINGS {
            // Half vectors of GGX at even steps of their share; what arrives counts with the cosine to the normal, here the mirrored view.
            let u = (i as f32 + 0.5) / RINGS as f32;
            let cos2_half = (1.0 - u) / (1.0 + (alpha2 - 1.0) * u);
            let cos = 2.0 * cos2_half - 1.0;
            let weight = cos.max(0.0);
            above += weight * share_above(height, cos);
            all += weight;
        }
        self.ground.lerp(self.sky, if all > 0.0 { above / all } else { 0.5 })
    }
}

/// The share of a ring about a direction that is above the horizon: `height` is the direction's sine, `cos` that of the ring's angle.
fn share_above(height: f32, cos: f32) -> f32 {
    let across = ((1.0 - height * height) * (1.0 - cos * cos)).max(0.0).sqrt();
    let least = -height * cos;
    if across <= least.abs() {
        return if least <= 0.0 { 1.0 } else { 0.0 };
    }
    (least / across).clamp(-1.0, 1.0).acos() / PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lobes_between_entries_are_those_of_their_roughness() {
        for i in 0..200 {
            let roughness = 0.05 + 0.95 * f64::from(i) / 199.0;
            let exact = Lobe::ggx(roughness * roughness).unwrap();
            let found = lobe_of(roughness as f32);
            for (a, b) in exact.bands().iter().zip(found.bands()) {
                assert!((a - b).abs() < 2e-3, "{roughness}: {a} {b}");
            }
        }
        assert_eq!(lobe_of(0.0), Lobe::MIRROR);
        assert_eq!(lobe_of(f32::NAN), Lobe::MIRROR);
    }

    #[test]
    fn a_sky_over_a_ground_is_seen_sharply_by_mirrors_and_evenly_at_the_horizon() {
        let (sky, ground) = (Vec3::new(1.0, 2.0, 4.0), Vec3::splat(0.5));
        let light = SkyLight { sky, ground, up: Vec3::Y };
        let slant = |sin: f32| Vec3::new((1.0 - sin * sin).sqrt(), sin, 0.0);
        assert_eq!((light.mirrored(slant(0.01), 0.0), light.mirrored(slant(-0.01), 0.0)), (sky, ground));
        for roughness in [0.1, 0.5, 1.0] {
            let level = light.mirrored(Vec3::X, roughness) - 0.5 * (sky + ground);
            assert!(level.abs().max_element() < 1e-5, "{roughness}: {level}");
            // Up and down share what there is.
            let both = light.mirrored(slant(0.3), roughness) + light.mirrored(slant(-0.3), roughness);
            assert!((both - sky - ground).abs().max_element() < 1e-5, "{roughness}: {both}");
            assert_eq!(light.mirrored(Vec3::Y, roughness), sky);
        }
    }

    #[test]
    fn the_horizon_of_a_rough_surface_is_that_of_its_lobe_in_harmonics() {
        // The half space as zonal harmonics: odd bands of P_l, of which those above 8 are nothing to lobes as wide as these.
        let light = SkyLight { sky: Vec3::ONE, ground: Vec3::ZERO, up: Vec3::Y };
        let step = [0.75, -0.4375, 0.343_75, -0.292_968_75];
        for (roughness, error) in [(0.8_f32, 0.01), (1.0, 0.01)] {
            let lobe = Lobe::ggx(f64::from(roughness).powi(2)).unwrap();
            for height in [-0.9_f64, -0.4, 0.1, 0.6] {
                let p = legendre(height);
                let wanted: f64 =
                    0.5 + (0..4).map(|k| step[k] * lobe.bands()[2 * k + 1] * p[2 * k + 1]).sum::<f64>();
                let x = (1.0 - height * height).sqrt() as f32;
                let found = f64::from(light.mirrored(Vec3::new(x, height as f32, 0.0), roughness).x);
                assert!((found - wanted).abs() < error, "{roughness} {height}: {found} {wanted}");
            }
        }
    }

    fn legendre(x: f64) -> [f64; 9] {
        let mut p = [1.0, x, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for l in 2..9 {
            let n = l as f64;
            p[l] = ((2.0 * n - 1.0) * x * p[l - 1] - (n - 1.0) * p[l - 2]) / n;
        }
        p
    }
}
