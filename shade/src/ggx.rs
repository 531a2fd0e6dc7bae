//! The GGX microfacet model: Trowbridge-Reitz distribution, height-correlated Smith masking, Schlick's Fresnel term,
//! and a diffuse base that gets what the coat above it does not reflect.

use crate::fresnel::schlick;
use crate::ggx_table::{coat_albedo, mean_coat_albedo};
use crate::roughness::alpha;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

/// Keeps 1/x finite where both cosines vanish; the cosine in the numerator then takes the product to 0.
const SMALLEST_DENOMINATOR: f32 = 1e-20;

/// D(h) = α² / π(cos²(α²−1) + 1)² \[6, eq. 33\].
pub(crate) fn distribution(n: Vec3, h: Vec3, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let cos = n.dot(h).max(0.0);
    // cos²(α²−1) + 1 = α²cos² + sin², with the sine from the cross product: 1 − cos² has no digits left where α is small.
    let sin2 = n.cross(h).length_squared();
    let d = a2 * cos * cos + sin2;
    a2 / (PI * d * d).max(f32::MIN_POSITIVE)
}

/// G₂ / (4 cosl cosv), height-correlated Smith \[8, eq. 99\].
pub(crate) fn visibility(cos_l: f32, cos_v: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let masked = |cos: f32| (a2 + (1.0 - a2) * cos * cos).sqrt();
    let sum = cos_v * masked(cos_l) + cos_l * masked(cos_v);
    0.5 / sum.max(SMALLEST_DENOMINATOR)
}

/// The whole BRDF for directions above the surface.
pub(crate) fn brdf(diffuse: Vec3, f0: Vec3, roughness: f32, n: Vec3, l: Vec3, v: Vec3) -> Vec3 {
    let f0 = f0.clamp(Vec3::ZERO, Vec3::ONE);
    let (cos_l, cos_v) = (n.dot(l), n.dot(v));
    let below = base(diffuse, f0, roughness, cos_l, cos_v);
    if f0 == Vec3::ZERO {
        return below;
    }
    let h = (l + v).normalize_or_zero();
    let alpha = alpha(roughness);
    let coat = schlick(f0, h.dot(v)) * (distribution(n, h, alpha) * visibility(cos_l, cos_v, alpha));
    below + coat
}

/// The diffuse base under the coat: ρ/π · (1−E(l))(1−E(v)) / (1−Ē) \[10\].
///
/// Light passes the coat twice. The product keeps it reciprocal and the division makes the sum over all directions
/// ρ(1−E(v)), so that a white base under any coat returns all light and never more.
fn base(diffuse: Vec3, f0: Vec3, roughness: f32, cos_l: f32, cos_v: f32) -> Vec3 {
    if diffuse == Vec3::ZERO || f0 == Vec3::ZERO {
        return diffuse * FRAC_1_PI;
    }
    let through = |e: Vec3| (Vec3::ONE - e).max(Vec3::ZERO);
    let (light, eye) =
        (through(coat_albedo(f0, roughness, cos_l)), through(coat_albedo(f0, roughness, cos_v)));
    let mean = through(mean_coat_albedo(f0, roughness)).max(Vec3::splat(1e-4));
    diffuse * FRAC_1_PI * light * eye / mean
}
