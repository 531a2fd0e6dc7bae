//! Mirrored and refracted directions, and how light divides between them.

use glam::Vec3;

/// How a ray from the eye continues at a smooth, transparent surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Refraction {
    /// Unit vector on, away from the eye: into the medium, or mirrored if no light passes.
    pub direction: Vec3,
    /// The share of light that is mirrored instead; 1 for total reflection.
    pub reflectance: f32,
}

/// The direction that mirrors `to_eye` at the normal; unit vectors give a unit vector.
#[must_use]
pub fn mirror(to_eye: Vec3, normal: Vec3) -> Vec3 {
    2.0 * normal.dot(to_eye) * normal - to_eye
}

/// Snell's law and the Fresnel equations for unpolarised light, without absorption.
///
/// `normal` is on the eye's side, and `index` is the refraction index beyond the surface over that on the eye's
/// side: 1.5 looking into glass, 1/1.5 out of it. An index that is not positive counts as 1. Both vectors are of unit
/// length; an eye below the surface counts as one at its edge.
#[must_use]
pub fn refract(to_eye: Vec3, normal: Vec3, index: f32) -> Refraction {
    let index = if index > 0.0 && index.is_finite() { index } else { 1.0 };
    let cos_i = normal.dot(to_eye).clamp(0.0, 1.0);
    let sin2_t = (1.0 - cos_i * cos_i) / (index * index);
    if sin2_t >= 1.0 {
        return Refraction { direction: mirror(to_eye, normal), reflectance: 1.0 };
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let onward = -to_eye / index + normal * (cos_i / index - cos_t);
    Refraction { direction: onward.normalize_or(-to_eye), reflectance: fresnel(cos_i, cos_t, index) }
}

/// The mean of both polarisations' reflectances, given the cosines on both sides.
fn fresnel(cos_i: f32, cos_t: f32, index: f32) -> f32 {
    let across = (cos_i - index * cos_t) / (cos_i + index * cos_t);
    let parallel = (index * cos_i - cos_t) / (index * cos_i + cos_t);
    (0.5 * (across * across + parallel * parallel)).clamp(0.0, 1.0)
}
