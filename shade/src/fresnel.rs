//! Reflectance by angle.

use glam::Vec3;

/// Reflectance at normal incidence below which the Fresnel term at grazing angles fades, too \[7\]: no real surface
/// reflects less than 2 %, so smaller values are taken for occlusion baked into the map, and 0 for no reflection at all.
const LEAST_REAL_REFLECTANCE: f32 = 0.02;

/// The reflectance at grazing angles that goes with one at normal incidence.
pub(crate) fn f90(f0: Vec3) -> f32 {
    (f0.max_element() / LEAST_REAL_REFLECTANCE).clamp(0.0, 1.0)
}

/// Schlick's F = f0 + (f90 − f0)(1 − cos)⁵ \[9\].
pub(crate) fn schlick(f0: Vec3, cos: f32) -> Vec3 {
    let x = (1.0 - cos).clamp(0.0, 1.0);
    let x5 = x * x * (x * x) * x;
    f0 + (Vec3::splat(f90(f0)) - f0) * x5
}
