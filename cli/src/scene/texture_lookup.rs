//! Reading decoded textures.

use super::{Texels, Texture};
use glam::{DVec2, Vec4};
use pointillist_shade::Wrap;
use std::sync::LazyLock;

/// sRGB byte to linear, once for all: a power per texel would cost more than the rest of the lookup.
static LINEAR_OF_SRGB: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0)));

/// The sRGB transfer function, encoded to linear.
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB transfer function, linear to encoded.
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

impl Texture {
    /// Linear red, green, blue and alpha of column `x`, row `y` from the top.
    ///
    /// # Panics
    ///
    /// Outside the picture.
    pub fn texel(&self, x: u32, y: u32) -> Vec4 {
        let i = y as usize * self.width as usize + x as usize;
        let unit = |byte: u8| f32::from(byte) / 255.0;
        match &self.texels {
            Texels::Srgb8(texels) => {
                let [r, g, b, a] = texels[i];
                let table = &*LINEAR_OF_SRGB;
                Vec4::new(table[r as usize], table[g as usize], table[b as usize], unit(a))
            }
            Texels::Linear8(texels) => Vec4::from_array(texels[i].map(unit)),
            Texels::Opacity8(texels) => Vec4::new(1.0, 1.0, 1.0, unit(texels[i])),
            Texels::Float(texels) => Vec4::from_array(texels[i]),
        }
    }

    /// The texel that holds `uv`, v upward, as [`pointillist_shade::nearest`] finds it.
    pub fn lookup(&self, wrap: Wrap, uv: DVec2) -> Vec4 {
        let column = wrap.texel((uv.x * f64::from(self.width)).floor() as i64, self.width);
        let row_from_bottom = wrap.texel((uv.y * f64::from(self.height)).floor() as i64, self.height);
        self.texel(column, self.height - 1 - row_from_bottom)
    }

    /// Whether all texels are equal, so that there is nothing to dice.
    pub fn is_constant(&self) -> bool {
        fn same<T: PartialEq>(texels: &[T]) -> bool {
            texels.windows(2).all(|pair| pair[0] == pair[1])
        }
        match &self.texels {
            Texels::Srgb8(texels) | Texels::Linear8(texels) => same(texels),
            Texels::Opacity8(texels) => same(texels),
            Texels::Float(texels) => same(texels),
        }
    }

    /// Bytes of the texels.
    pub fn bytes(&self) -> u64 {
        let per_texel = match self.texels {
            Texels::Srgb8(_) | Texels::Linear8(_) => 4,
            Texels::Opacity8(_) => 1,
            Texels::Float(_) => 16,
        };
        u64::from(self.width) * u64::from(self.height) * per_texel
    }
}
