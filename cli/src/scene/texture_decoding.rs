//! From the bytes of a picture to texels, as their purpose wants them.

use super::textures::{Purpose, Tone};
use super::{Texels, Texture, linear_from_srgb};
use crate::image_io::{self, face_fault, faces_of_strip, strip_face};
use image::DynamicImage;
use std::path::Path;
use std::sync::Arc;

/// The texture of a picture.
///
/// # Errors
///
/// What is wrong, as the end of a sentence that begins with the picture's name.
pub(super) fn decode(path: &Path, bytes: &[u8], purpose: Purpose, tone: Tone) -> Result<Texture, String> {
    let image = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        let picture =
            image_io::read_exr_picture(bytes).map_err(|error| format!("cannot be decoded: {error}"))?;
        let [width, height] = picture.size;
        let flat = picture.color.into_iter().flatten().collect();
        let buffer = image::ImageBuffer::from_raw(width, height, flat);
        DynamicImage::ImageRgba32F(buffer.ok_or("has an impossible size")?)
    } else {
        image_io::decode_image(bytes).map_err(|error| format!("cannot be decoded: {error}"))?
    };
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        return Err("has no pixels".to_owned());
    }
    let texture = Texture::new(path.display().to_string(), [width, height], texels(image, purpose));
    let texture = toned(texture, tone);
    Ok(if purpose == Purpose::Surroundings { upright(texture) } else { texture })
}

/// A strip of six faces side by side as one of six below another; other pictures as they are.
fn upright(mut texture: Texture) -> Texture {
    let size = [texture.width, texture.height].map(|n| n as usize);
    if let Some(face) = strip_face(size) {
        let width = size[0];
        texture.texels = match &texture.texels {
            Texels::Srgb8(texels) => Texels::Srgb8(faces_of_strip(face, width, texels).into()),
            Texels::OpaqueSrgb8(texels) => Texels::OpaqueSrgb8(faces_of_strip(face, width, texels).into()),
            Texels::Float(texels) => Texels::Float(faces_of_strip(face, width, texels).into()),
            _ => Texels::Float(faces_of_strip(face, width, &floats(&texture)).into()),
        };
        (texture.width, texture.height) = (face as u32, 6 * face as u32);
    }
    texture
}

/// Six squares as the faces of one cube.
///
/// # Errors
///
/// The number of the first that does not fit, and what is wrong with it, as the end of a sentence.
pub(super) fn joined_faces(faces: &[Texture]) -> Result<Texture, (usize, String)> {
    let size = |t: &Texture| [t.width, t.height].map(|n| n as usize);
    for (number, face) in faces.iter().enumerate() {
        if let Some(fault) = face_fault(size(face), size(&faces[0])) {
            return Err((number, fault));
        }
    }
    let bytes = |t: &Texture| match &t.texels {
        Texels::OpaqueSrgb8(texels) => Some(texels.clone()),
        _ => None,
    };
    let texels = match faces.iter().map(bytes).collect::<Option<Vec<_>>>() {
        Some(lists) => {
            Texels::OpaqueSrgb8(lists.iter().flat_map(|list| list.iter().copied()).collect::<Vec<_>>().into())
        }
        None => Texels::Float(faces.iter().flat_map(floats).collect::<Vec<_>>().into()),
    };
    let side = faces[0].width;
    Ok(Texture::new(faces[0].name.clone(), [side, 6 * side], texels))
}

fn floats(t: &Texture) -> Vec<[f32; 4]> {
    (0..t.height).flat_map(|y| (0..t.width).map(move |x| t.texel(x, y).to_array())).collect()
}

/// Texels with another tone.
fn toned(texture: Texture, tone: Tone) -> Texture {
    if tone == Tone::PLAIN {
        return texture;
    }
    let Texture { width, height, .. } = texture;
    let texels = match &texture.texels {
        Texels::Opacity8(bytes) => {
            let toned = |&[byte]: &[u8; 1]| (255.0 * tone.of(f32::from(byte) / 255.0)).round() as u8;
            Texels::from_opacities(bytes.iter().map(toned).collect())
        }
        // Not as bytes, which would round a second time.
        _ => {
            let toned = |[r, g, b, a]: [f32; 4]| [tone.of(r), tone.of(g), tone.of(b), a];
            Texels::Float(floats(&texture).into_iter().map(toned).collect::<Vec<_>>().into())
        }
    };
    Texture::new(texture.name, [width, height], texels)
}

fn texels(image: DynamicImage, purpose: Purpose) -> Texels {
    let is_byte = image.color().bytes_per_pixel() == image.color().channel_count();
    let is_float = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let srgb = purpose != Purpose::Color { srgb: false };
    match purpose {
        Purpose::Opacity => opacity(&image),
        Purpose::Alpha => Texels::from_opacities(alpha(&image)),
        Purpose::Mask(from) => {
            let mask = |a| if u16::from(a) >= from { u8::MAX } else { 0 };
            Texels::from_opacities(alpha(&image).into_iter().map(mask).collect())
        }
        Purpose::Color { .. } | Purpose::Surroundings if is_byte => bytes(image, srgb),
        Purpose::Color { .. } | Purpose::Surroundings => {
            let decode = |c: f32| if srgb && !is_float { linear_from_srgb(c) } else { c };
            let finite = |c: f32| if c.is_finite() { c } else { 0.0 };
            let texel = |[r, g, b, a]: [f32; 4]| [decode(r), decode(g), decode(b), a].map(finite);
            let texels: Vec<_> = image.into_rgba32f().pixels().map(|p| texel(p.0)).collect();
            Texels::Float(texels.into())
        }
    }
}

/// The texels of a picture with 8 bits for each channel.
fn bytes(image: DynamicImage, srgb: bool) -> Texels {
    match with_copied_grays(image) {
        DynamicImage::ImageLuma8(grays) if !srgb => Texels::from_grays(grays.into_raw()),
        DynamicImage::ImageLuma8(grays) => {
            Texels::OpaqueSrgb8(grays.as_raw().iter().map(|&gray| [gray; 3]).collect::<Vec<_>>().into())
        }
        image if image.color().has_alpha() => {
            let texels = in_texels(&image.into_rgba8());
            if srgb { Texels::Srgb8(texels) } else { Texels::Linear8(texels) }
        }
        image => {
            let texels = in_texels(&image.into_rgb8());
            if srgb {
                Texels::OpaqueSrgb8(texels)
            } else if texels.iter().all(|&[r, g, b]| r == g && r == b) {
                Texels::from_grays(texels.iter().map(|texel| texel[0]).collect())
            } else {
                Texels::OpaqueLinear8(texels)
            }
        }
    }
}

/// Greys with an alpha as colours: the library's conversion takes a hundred times as long, since it allows for colour spaces.
fn with_copied_grays(image: DynamicImage) -> DynamicImage {
    let DynamicImage::ImageLumaA8(grays) = &image else { return image };
    let mut colors = image::RgbaImage::new(grays.width(), grays.height());
    for (to, &image::LumaA([gray, alpha])) in colors.pixels_mut().zip(grays.pixels()) {
        to.0 = [gray, gray, gray, alpha];
    }
    colors.into()
}

fn in_texels<const CHANNELS: usize>(channels: &[u8]) -> Arc<Vec<[u8; CHANNELS]>> {
    Arc::new(channels.as_chunks().0.to_vec())
}

fn alpha(image: &DynamicImage) -> Vec<u8> {
    match image {
        DynamicImage::ImageLumaA8(texels) => texels.pixels().map(|p| p.0[1]).collect(),
        DynamicImage::ImageRgba8(texels) => texels.pixels().map(|p| p.0[3]).collect(),
        _ => image.to_rgba8().pixels().map(|p| p.0[3]).collect(),
    }
}

fn opacity(image: &DynamicImage) -> Texels {
    if image.color().has_alpha() {
        let alpha = alpha(image);
        if alpha.iter().any(|&a| a != u8::MAX) {
            return Texels::from_opacities(alpha);
        }
    }
    Texels::from_opacities(image.to_luma8().into_raw())
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Luma, LumaA};

    const SIZE: u32 = 16;

    fn level(x: u32, y: u32) -> u8 {
        (SIZE * y + x) as u8
    }

    #[test]
    fn greys_are_what_they_are_as_colours() {
        let grays: DynamicImage = ImageBuffer::from_fn(SIZE, SIZE, |x, y| Luma([level(x, y)])).into();
        let veiled: DynamicImage =
            ImageBuffer::from_fn(SIZE, SIZE, |x, y| LumaA([level(x, y), 255 - level(y, x)])).into();
        for srgb in [false, true] {
            let colors = DynamicImage::ImageRgb8(grays.to_rgb8());
            assert_eq!(bytes(grays.clone(), srgb), bytes(colors, srgb));
            let colors = DynamicImage::ImageRgba8(veiled.to_rgba8());
            assert_eq!(bytes(veiled.clone(), srgb), bytes(colors, srgb));
        }
        let colors = DynamicImage::ImageRgba8(veiled.to_rgba8());
        assert_eq!(alpha(&veiled), alpha(&colors));
        assert_eq!(alpha(&grays), [u8::MAX; (SIZE * SIZE) as usize]);
    }
}
