//! Texture coordinates to texels.

use crate::ShadeError;
use glam::DVec2;

/// What a texture is outside the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Tiles the plane.
    #[default]
    Repeat,
    /// Its border goes on for ever.
    Clamp,
    /// Tiles the plane, every other tile mirrored.
    Mirror,
}

impl Wrap {
    /// The texel of `0..size` that stands for texel number `i` of the endless row. A `size` of 0 counts as 1.
    #[must_use]
    pub fn texel(self, i: i64, size: u32) -> u32 {
        let n = i64::from(size.max(1));
        let wrapped = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp => i.clamp(0, n - 1),
            Self::Mirror => {
                let i = i.rem_euclid(2 * n);
                i.min(2 * n - 1 - i)
            }
        };
        wrapped as u32
    }
}

/// The texel at `uv` of a row-major image whose row 0 is the top, that is v = 1.
///
/// A texel is half open: a place on a border belongs to the texel on the right (growing u) and below (falling v), as where v grows
/// downward. So v = 1 is the top row. NaN is in the first column or row.
///
/// # Errors
///
/// The slice does not hold `width · height` texels, or none.
pub fn nearest<T: Copy>(
    texels: &[T],
    width: u32,
    height: u32,
    wrap: Wrap,
    uv: DVec2,
) -> Result<T, ShadeError> {
    let size_error = ShadeError::TextureSize { len: texels.len(), width, height };
    if width == 0 || height == 0 || texels.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(size_error);
    }
    let x = wrap.texel(number(uv.x, width), width);
    let y = wrap.texel(number(1.0 - uv.y, height), height);
    Ok(texels[y as usize * width as usize + x as usize])
}

/// The texel number along one axis; saturates, so that any coordinate has an answer.
fn number(coordinate: f64, size: u32) -> i64 {
    // `as` turns NaN into 0 and cuts at the ends of i64.
    (coordinate * f64::from(size)).floor() as i64
}
