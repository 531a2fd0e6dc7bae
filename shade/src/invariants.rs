//! Facts that hold for every material and every measured table, as functions `fn fact(…) -> Result<(), String>`: `Err` says what was found instead.
//!
//! For property testers and fuzzers: the tests of this crate and its fuzz targets call them, and so can those of a crate
//! that builds on it, with the feature `invariants`. What each asks of its arguments stands with it.
//!
//! ```
//! use pointillist_shade::{Material, invariants::brdf_is_reciprocal};
//! # use glam::Vec3;
//!
//! let (to_light, to_eye) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.28, 0.96));
//! brdf_is_reciprocal(&Material::metallic_roughness(Vec3::ONE, 0.5, 0.3), Vec3::Z, to_light, to_eye)?;
//! # Ok::<(), String>(())
//! ```

use crate::{MERL_DIMENSIONS, Material, MerlTable, Model, ShadeError};
use glam::Vec3;

/// Exchanging light and eye changes nothing, and the value is finite and not negative. All vectors of unit length, `material` with
/// albedos from 0 to 1.
///
/// # Errors
/// The material, and both values.
pub fn brdf_is_reciprocal(
    material: &Material,
    normal: Vec3,
    to_light: Vec3,
    to_eye: Vec3,
) -> Result<(), String> {
    let (there, back) = (material.brdf(normal, to_light, to_eye), material.brdf(normal, to_eye, to_light));
    if !(there.is_finite() && there.min_element() >= 0.0) {
        return Err(format!("{:?}: {there}", material.model));
    }
    // Rounding of the cosine is raised to the power of the exponent, or divided by α² twice.
    let rounding = match material.model {
        Model::Ggx => 1e-6 / material.roughness.clamp(crate::SMALLEST_ROUGHNESS, 1.0).powi(2),
        _ => 4e-7 * material.shininess.clamp(0.0, 1e7),
    };
    let allowed = there.max(back) * (1e-5 + rounding).min(1.0) + Vec3::splat(1e-30);
    if (there - back).abs().cmple(allowed).all() {
        Ok(())
    } else {
        Err(format!("{material:?}: {there} one way and {back} the other"))
    }
}

/// A table is read, and then answers with finite numbers, or refused for one of the reasons that there are.
///
/// # Errors
/// The value, or the error that does not belong to tables.
pub fn merl_is_read_or_refused(bytes: &[u8], directions: [Vec3; 3]) -> Result<(), String> {
    let table = match MerlTable::from_bytes(bytes) {
        Ok(table) => table,
        Err(
            ShadeError::MerlDimensions { .. } | ShadeError::MerlSize { .. } | ShadeError::MerlValue { .. },
        ) => return Ok(()),
        Err(other) => return Err(other.to_string()),
    };
    let [normal, to_light, to_eye] = directions.map(Vec3::normalize_or_zero);
    let value = table.brdf(normal, to_light, to_eye);
    if value.is_finite() && value.min_element() >= 0.0 { Ok(()) } else { Err(format!("{value}")) }
}

/// A file of the right size that repeats `pattern`, so that a fuzzer need not find 35 MB by itself.
#[must_use]
pub fn merl_of_pattern(pattern: &[u8]) -> Vec<u8> {
    let mut bytes: Vec<u8> = MERL_DIMENSIONS.iter().flat_map(|&n| (n as i32).to_le_bytes()).collect();
    let values = 3 * 8 * MERL_DIMENSIONS.iter().product::<usize>();
    bytes.extend(pattern.iter().chain([&0]).cycle().take(values));
    bytes
}
