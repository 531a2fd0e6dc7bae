//! Decoded pictures, and how they are looked up.

use super::error::SceneError;
use glam::{DVec2, Vec3, Vec4};
use pointillist_shade::Wrap;
use std::sync::{Arc, LazyLock};

/// A decoded picture; row 0 is the top, that is v = 1.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Texture {
    /// Texels in a row; at least 1.
    pub width: u32,
    /// Rows; at least 1.
    pub height: u32,
    /// Row-major, `width · height` of them.
    pub texels: Texels,
    /// For messages: the file that it is from, for instance.
    pub name: String,
}

/// The texels of a [`Texture`] as they are stored; [`Texture::texel`] decodes them. Clones share them.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Texels {
    /// sRGB-encoded colour with linear alpha.
    Srgb8(Arc<Vec<[u8; 4]>>),
    /// sRGB-encoded colour; alpha is 1.
    OpaqueSrgb8(Arc<Vec<[u8; 3]>>),
    /// Linear colour and alpha in 8 bits.
    Linear8(Arc<Vec<[u8; 4]>>),
    /// Linear colour in 8 bits; alpha is 1.
    OpaqueLinear8(Arc<Vec<[u8; 3]>>),
    /// Linear grey in 8 bits; alpha is 1.
    Gray8(Arc<Vec<[u8; 1]>>),
    /// One number that is the opacity: colour is white, alpha is the number.
    Opacity8(Arc<Vec<[u8; 1]>>),
    /// Linear colour and alpha.
    Float(Arc<Vec<[f32; 4]>>),
}

impl Texels {
    /// Opacities, one byte for each texel.
    #[must_use]
    pub fn from_opacities(bytes: Vec<u8>) -> Self {
        Self::Opacity8(single(bytes))
    }

    /// Linear greys, one byte for each texel.
    #[must_use]
    pub fn from_grays(bytes: Vec<u8>) -> Self {
        Self::Gray8(single(bytes))
    }

    /// Whether all of them have an alpha of 1, as masks of many programs have.
    #[must_use]
    pub fn are_opaque(&self) -> bool {
        match self {
            Self::Srgb8(texels) | Self::Linear8(texels) => texels.iter().all(|texel| texel[3] == u8::MAX),
            Self::OpaqueSrgb8(_) | Self::OpaqueLinear8(_) | Self::Gray8(_) => true,
            Self::Opacity8(texels) => texels.iter().all(|[opacity]| *opacity == u8::MAX),
            Self::Float(texels) => texels.iter().all(|texel| texel[3] == 1.0),
        }
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Srgb8(texels) | Self::Linear8(texels) => texels.len(),
            Self::OpaqueSrgb8(texels) | Self::OpaqueLinear8(texels) => texels.len(),
            Self::Gray8(texels) | Self::Opacity8(texels) => texels.len(),
            Self::Float(texels) => texels.len(),
        }
    }
}

/// Texels of one byte.
fn single(bytes: Vec<u8>) -> Arc<Vec<[u8; 1]>> {
    // The same memory: entries are of the same size.
    Arc::new(bytes.into_iter().map(|byte| [byte]).collect())
}

/// sRGB byte to linear, once for all: a power per texel would cost more than the rest of the lookup.
pub(crate) static LINEAR_OF_SRGB: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0)));

/// What a byte that is not sRGB-encoded stands for.
pub(crate) fn unit_of_byte(byte: u8) -> f32 {
    f32::from(byte) / 255.0
}

/// The sRGB transfer function, encoded to linear.
#[must_use]
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB transfer function, linear to encoded.
#[must_use]
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Whether a texture has texels, and as many as its size says.
pub(super) fn check_size(name: &str, width: u32, height: u32, found: usize) -> Result<(), SceneError> {
    if found > 0 && u64::from(width) * u64::from(height) == found as u64 {
        return Ok(());
    }
    Err(SceneError::Texels { name: name.to_owned(), width, height, found })
}

impl Texture {
    /// A picture of `width` by `height` texels, row by row from the top.
    #[must_use]
    pub fn new(name: impl Into<String>, [width, height]: [u32; 2], texels: Texels) -> Self {
        Self { width, height, texels, name: name.into() }
    }

    /// A picture of sRGB-encoded opaque colours, from a function of column and row from the top.
    #[must_use]
    pub fn from_srgb(name: impl Into<String>, size: [u32; 2], color: impl Fn(u32, u32) -> [u8; 3]) -> Self {
        let texels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).map(|(x, y)| color(x, y));
        Self::new(name, size, Texels::OpaqueSrgb8(texels.collect::<Vec<_>>().into()))
    }

    /// Linear red, green, blue and alpha of column `x`, row `y` from the top.
    ///
    /// # Panics
    ///
    /// Outside the picture.
    #[must_use]
    pub fn texel(&self, x: u32, y: u32) -> Vec4 {
        // A column beyond the last would be one of the next row.
        assert!(x < self.width, "column {x} of a picture that is {} wide", self.width);
        let i = y as usize * self.width as usize + x as usize;
        let unit = unit_of_byte;
        let linear = |byte: u8| LINEAR_OF_SRGB[byte as usize];
        match &self.texels {
            Texels::Srgb8(texels) => {
                let [r, g, b, a] = texels[i];
                Vec4::new(linear(r), linear(g), linear(b), unit(a))
            }
            Texels::OpaqueSrgb8(texels) => Vec3::from_array(texels[i].map(linear)).extend(1.0),
            Texels::Linear8(texels) => Vec4::from_array(texels[i].map(unit)),
            Texels::OpaqueLinear8(texels) => Vec3::from_array(texels[i].map(unit)).extend(1.0),
            Texels::Gray8(texels) => Vec3::splat(unit(texels[i][0])).extend(1.0),
            Texels::Opacity8(texels) => Vec4::new(1.0, 1.0, 1.0, unit(texels[i][0])),
            Texels::Float(texels) => Vec4::from_array(texels[i]),
        }
    }

    /// The texel that holds `uv`, v upward, as [`pointillist_shade::nearest`] finds it.
    #[must_use]
    pub fn lookup(&self, wrap: Wrap, uv: DVec2) -> Vec4 {
        let column = wrap.texel((uv.x * f64::from(self.width)).floor() as i64, self.width);
        let row = wrap.texel(((1.0 - uv.y) * f64::from(self.height)).floor() as i64, self.height);
        self.texel(column, row)
    }

    /// Whether it shows all directions as the faces of a cube: six squares one below another, in the order and orientation of
    /// [`pointillist_shade::cube_direction`]. Other pictures of all directions are equirectangular.
    #[must_use]
    pub fn is_cube(&self) -> bool {
        u64::from(self.height) == 6 * u64::from(self.width)
    }

    /// Whether all texels are equal, so that there is nothing to dice.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        fn same<T: PartialEq>(texels: &[T]) -> bool {
            texels.windows(2).all(|pair| pair[0] == pair[1])
        }
        match &self.texels {
            Texels::Srgb8(texels) | Texels::Linear8(texels) => same(texels),
            Texels::OpaqueSrgb8(texels) | Texels::OpaqueLinear8(texels) => same(texels),
            Texels::Gray8(texels) | Texels::Opacity8(texels) => same(texels),
            Texels::Float(texels) => same(texels),
        }
    }

    /// Bytes of the texels.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let per_texel = match self.texels {
            Texels::Srgb8(_) | Texels::Linear8(_) => 4,
            Texels::OpaqueSrgb8(_) | Texels::OpaqueLinear8(_) => 3,
            Texels::Gray8(_) | Texels::Opacity8(_) => 1,
            Texels::Float(_) => 16,
        };
        u64::from(self.width) * u64::from(self.height) * per_texel
    }
}
