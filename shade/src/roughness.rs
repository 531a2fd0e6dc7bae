//! Perceptual roughness and the width α of the GGX distribution.

/// Perceptual roughness below this counts as this.
///
/// Chosen: α = 9e-4, a highlight of a twentieth of a degree; narrower ones cannot be told from a mirror by `f32`
/// directions, and a lamp without size would never be seen in them.
pub const SMALLEST_ROUGHNESS: f32 = 0.03;

/// α = perceptual roughness squared \[7\]; from [`SMALLEST_ROUGHNESS`]² to 1, also for NaN.
pub(crate) fn alpha(roughness: f32) -> f32 {
    // Not `clamp`, which lets NaN pass.
    let r = if roughness > SMALLEST_ROUGHNESS { roughness.min(1.0) } else { SMALLEST_ROUGHNESS };
    r * r
}
