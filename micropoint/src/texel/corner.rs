//! What texels are looked up with.

use glam::DVec2;

/// What a texture is outside the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TexelWrap {
    /// Repeated.
    #[default]
    Repeat,
    /// The border texels go on for ever.
    Clamp,
    /// Repeated, every other time mirrored.
    Mirror,
}

/// A corner of a polygon on a textured surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexelCorner {
    /// Position in the grid in which the mean is taken.
    pub grid: DVec2,
    /// The denominator of perspective interpolation: 1/depth, or 1 where there is no perspective.
    pub rational: f64,
    /// Position in texels: (u · width, (1 − v) · height).
    pub texel: DVec2,
}

/// Coordinate beyond which neighbouring texels can hardly be told apart in f64, and counting columns one by one soon stops
/// to make progress.
const LARGEST: f64 = 1e12;

pub(super) fn is_usable(texel: DVec2) -> bool {
    texel.is_finite() && texel.abs().max_element() < LARGEST
}
