//! Directional albedo of a BRDF, by quadrature.

use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// The share of light that leaves in all directions: ∫ f(l, v) (n·l) dl over the hemisphere about n = +Z, which for a
/// reciprocal BRDF is also what light from `v` comes to.
///
/// Midpoints of `steps` × `steps` cells in polar coordinates about the direction that mirrors `v`, packed towards
/// it: cells there are `steps`⁴ times smaller than a hemisphere's share, so that lobes as narrow as
/// [`crate::SMALLEST_ROUGHNESS`] are resolved. 64 steps give two digits, 256 three; 0 steps give 0.
#[must_use]
pub fn directional_albedo(to_eye: Vec3, steps: usize, brdf: impl Fn(Vec3, Vec3) -> Vec3) -> Vec3 {
    let mirror =
        DVec3::new(-f64::from(to_eye.x), -f64::from(to_eye.y), f64::from(to_eye.z)).normalize_or(DVec3::Z);
    let across = mirror.any_orthonormal_vector();
    let along = mirror.cross(across);
    let mut sum = DVec3::ZERO;
    for i in 0..steps {
        let x = (i as f64 + 0.5) / steps as f64;
        // Angle from the mirror direction π x⁴; its derivative is the first part of the cell's solid angle.
        let theta = PI * x.powi(4);
        let cell = 4.0 * PI * x.powi(3) * theta.sin() * TAU / (steps * steps) as f64;
        for j in 0..steps {
            let phi = (j as f64 + 0.5) / steps as f64 * TAU;
            let around = across * phi.cos() + along * phi.sin();
            let l = mirror * theta.cos() + around * theta.sin();
            if l.z > 0.0 {
                sum += brdf(l.as_vec3(), to_eye).as_dvec3() * (l.z * cell);
            }
        }
    }
    sum.as_vec3()
}
