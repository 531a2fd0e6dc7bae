//! Textures summed up for exact means, when they are first looked up.
//!
//! A picture shows some of its scene's textures: the others cost no time and no memory beyond their texels. Sums of 8-bit texels
//! share these.

use crate::scene::{LINEAR_OF_SRGB, Texels, Texture, unit_of_byte};
use pointillist_micropoint::{MOST_TEXELS_ON_A_SIDE, MaskSums, MicropointError, TexelSums, TexelWrap};
use std::sync::{Arc, LazyLock};

/// A value that is made when it is first read, by one thread while others that need it wait.
pub(crate) type Lazy<T> = LazyLock<T, Box<dyn FnOnce() -> T + Send>>;

/// What is made of textures when it is first read; at once if making it may fail.
///
/// # Errors
/// Those of `make`.
pub(crate) fn when_needed<T: Send + 'static, const K: usize>(
    textures: [&Texture; K],
    make: impl FnOnce([&Texture; K]) -> Result<T, MicropointError> + Send + 'static,
) -> Result<Lazy<T>, MicropointError> {
    let cannot_fail =
        |texture: &Texture| !is_float(texture) && texture.width.max(texture.height) <= MOST_TEXELS_ON_A_SIDE;
    if textures.iter().all(|texture| cannot_fail(texture)) {
        let textures = textures.map(Texture::clone);
        let make = move || make(textures.each_ref()).expect("bytes stand for numbers from 0 to 1");
        return Ok(Lazy::new(Box::new(make)));
    }
    let made = make(textures)?;
    Ok(Lazy::new(Box::new(|| made)))
}

fn is_float(texture: &Texture) -> bool {
    matches!(texture.texels, Texels::Float(_))
}

/// The sums of texels of this size that are made of those of some textures, and are not above 1 where all of these are bytes.
///
/// # Errors
/// As [`TexelSums::new`].
pub(crate) fn sums_of<const N: usize, const K: usize>(
    textures: [&Texture; K],
    [width, height]: [u32; 2],
    wrap: TexelWrap,
    texel: impl Fn(u32, u32) -> [f32; N],
) -> Result<TexelSums<N>, MicropointError> {
    match textures.into_iter().any(is_float) {
        true => TexelSums::new(width, height, wrap, texel),
        false => TexelSums::in_16_bits(1.0, width, height, wrap, texel),
    }
}

/// The sums of a texture's colours.
///
/// # Errors
/// [`MicropointError`] for a texture that is too large, or with a value that is not finite or negative.
pub(crate) fn color_sums(texture: &Texture, wrap: TexelWrap) -> Result<TexelSums<3>, MicropointError> {
    let Texture { width, height, .. } = *texture;
    let of_bytes =
        |texels: &Arc<_>, values: &_| TexelSums::from_bytes(width, height, wrap, Arc::clone(texels), values);
    match &texture.texels {
        Texels::OpaqueSrgb8(texels) => of_bytes(texels, &LINEAR_OF_SRGB),
        Texels::OpaqueLinear8(texels) => of_bytes(texels, &values(unit_of_byte)),
        _ => sums_of([texture], [width, height], wrap, |x, y| texture.texel(x, y).truncate().to_array()),
    }
}

/// The sums of a texture's opacities.
///
/// # Errors
/// As [`color_sums`].
pub(crate) fn opacity_sums(texture: &Texture, wrap: TexelWrap) -> Result<MaskSums, MicropointError> {
    let Texture { width, height, .. } = *texture;
    let sums = match &texture.texels {
        Texels::Opacity8(texels) => TexelSums::of_levels(width, height, wrap, texels.clone()),
        _ => sums_of([texture], [width, height], wrap, |x, y| [texture.texel(x, y).w]),
    };
    sums.map(MaskSums::new)
}

/// A value for each byte.
pub(crate) fn values(of: impl Fn(u8) -> f32) -> [f32; 256] {
    std::array::from_fn(|byte| of(byte as u8))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, Vec3, dvec2};
    use pointillist_micropoint::TexelCorner;
    use pointillist_shade::Wrap;

    #[test]
    fn borders_belong_to_the_same_texels_as_in_lookups_of_points() {
        let texture =
            Texture::from_srgb("any", [8, 4], |x, y| [(x * 31) as u8, (y * 60) as u8, (x * y) as u8]);
        for (wrap, texel_wrap) in [(Wrap::Repeat, TexelWrap::Repeat), (Wrap::Clamp, TexelWrap::Clamp)] {
            let sums = color_sums(&texture, texel_wrap).unwrap();
            for (i, j) in (-20..20).flat_map(|i| (-20..20).map(move |j| (i, j))) {
                let uv = dvec2(f64::from(i), f64::from(j)) / 8.0;
                let texel = dvec2(uv.x, 1.0 - uv.y) * dvec2(8.0, 4.0);
                let mean = sums.mean(&[TexelCorner { grid: DVec2::ZERO, rational: 1.0, texel }; 3]);
                let mean = Vec3::from_array(mean.map(|v| v as f32));
                let expected = texture.lookup(wrap, uv).truncate();
                assert!((mean - expected).abs().max_element() < 1e-6, "{uv}: {mean} {expected}");
            }
        }
    }
}
