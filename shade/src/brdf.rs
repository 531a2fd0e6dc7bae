//! The terms of the reflection models, each as its paper writes it.

use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

/// The exponent is cut here: beyond it the lobe is narrower than `f32` directions can tell apart, and its
/// normalisation would overflow.
const LARGEST_SHININESS: f32 = 1e7;

/// Lambert: albedo / π.
pub(crate) fn lambert(albedo: Vec3) -> Vec3 {
    albedo * FRAC_1_PI
}

/// Phong's lobe `(r·v)^m`, with `r` the light direction mirrored at the normal \[1\].
pub(crate) fn phong_lobe(n: Vec3, l: Vec3, v: Vec3, m: f32) -> f32 {
    let r = 2.0 * n.dot(l) * n - l;
    power(r.dot(v), m)
}

/// Blinn's lobe `(h·n)^m`, with `h` half way between light and eye \[2\].
pub(crate) fn blinn_lobe(n: Vec3, l: Vec3, v: Vec3, m: f32) -> f32 {
    power((l + v).normalize_or_zero().dot(n), m)
}

/// (m+2) / 2π: the lobe around the normal then integrates to 1 \[3\].
pub(crate) fn phong_norm(m: f32) -> f32 {
    (exponent(m) + 2.0) / (2.0 * PI)
}

/// (m+2)(m+4) / 8π(2^(−m/2) + m): Blinn's lobe at normal incidence then integrates to 1 \[4\].
pub(crate) fn blinn_norm(m: f32) -> f32 {
    let m = exponent(m);
    let integral = 8.0 * PI * ((-0.5 * m).exp2() + m);
    (m + 2.0) * (m + 4.0) / integral
}

/// `max(cosine, 0)^m`, at most 1: rounding may lift the cosine of a direction with itself above it.
pub(crate) fn power(cosine: f32, m: f32) -> f32 {
    cosine.clamp(0.0, 1.0).powf(exponent(m))
}

fn exponent(m: f32) -> f32 {
    m.clamp(0.0, LARGEST_SHININESS)
}
