//! Reading any picture for its colours.

use super::exr_check::DECODED_PIXEL_BYTES;
use super::{ExrError, ExrFile, PixelRect};
use crate::input;
use crate::input_error::InputError;
use crate::memory;
use image::{DynamicImage, ImageReader};
use pointillist_render::linear_from_srgb;
use std::io::Cursor;
use std::path::Path;

/// Linear colours of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height of what is here.
    pub size: [u32; 2],
    /// Where it lies in the whole picture.
    pub window: PixelRect,
    /// Linear R G B A, row-major; premultiplied if it came from an EXR or [`read_picture`].
    pub color: Vec<[f32; 4]>,
}

/// The colours of an EXR: R G B, or Y for all three; alpha 1 if there is none.
///
/// # Errors
///
/// Not an EXR, or one without colours.
pub fn read_exr_picture(bytes: &[u8]) -> Result<Picture, ExrError> {
    let file = ExrFile::read(bytes)?;
    let grey = file.plane("Y");
    let plane = |name: &str| file.plane(name).or_else(|| grey.clone());
    let (Some(r), Some(g), Some(b)) = (plane("R"), plane("G"), plane("B")) else {
        return Err(ExrError::NoColor);
    };
    let alpha = file.plane("A").unwrap_or_else(|| vec![1.0; r.len()]);
    let color = r.into_iter().zip(g).zip(b).zip(alpha).map(|(((r, g), b), a)| [r, g, b, a]).collect();
    Ok(Picture { size: [file.window.width(), file.window.height()], window: file.window, color })
}

/// Reads an EXR, PNG, JPEG or HDR file as linear, premultiplied colours; 8- and 16-bit values are decoded from sRGB.
///
/// # Errors
///
/// The file cannot be read or decoded.
pub fn read_picture(path: &Path) -> Result<Picture, InputError> {
    let image = match decode(path)? {
        Decoded::Exr(picture) => return Ok(picture),
        Decoded::Other(image) => image,
    };
    let is_float = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let decode = |c: f32| if is_float { c } else { linear_from_srgb(c) };
    let pixel = |[r, g, b, a]: [f32; 4]| [decode(r) * a, decode(g) * a, decode(b) * a, a];
    let (width, height) = (image.width(), image.height());
    let color = image.into_rgba32f().pixels().map(|p| pixel(p.0)).collect();
    Ok(Picture { size: [width, height], window: PixelRect::of_picture(width, height), color })
}

/// The 8-bit values of a photograph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Levels {
    /// Width and height.
    pub size: [u32; 2],
    /// Red, green and blue as stored, row-major.
    pub pixels: Vec<[u8; 3]>,
}

/// The values of a picture as they are stored; `None` if they have more than 8 bits.
///
/// # Errors
///
/// The file cannot be read or decoded.
pub fn read_levels(path: &Path) -> Result<Option<Levels>, InputError> {
    let Decoded::Other(image) = decode(path)? else { return Ok(None) };
    if image.color().bytes_per_pixel() != image.color().channel_count() {
        return Ok(None);
    }
    let size = [image.width(), image.height()];
    Ok(Some(Levels { size, pixels: image.into_rgb8().pixels().map(|p| p.0).collect() }))
}

enum Decoded {
    Exr(Picture),
    Other(DynamicImage),
}

fn decode(path: &Path) -> Result<Decoded, InputError> {
    let name = input::name_of(path);
    let bytes = input::read(path)?;
    input::not_empty(&name, &bytes)?;
    let fault = |message: String| {
        let error = InputError::of_file(&name, format!("cannot be decoded: {message}"));
        error.with_help("EXR, PNG, JPEG and HDR pictures can be read")
    };
    if bytes.starts_with(&exr::meta::magic_number::BYTES) {
        return read_exr_picture(&bytes).map(Decoded::Exr).map_err(|error| fault(error.to_string()));
    }
    decode_image(&bytes).map(Decoded::Other).map_err(fault)
}

/// Decodes a PNG, JPEG or HDR that fits into memory.
///
/// # Errors
///
/// What is wrong, or how much memory is missing.
pub fn decode_image(bytes: &[u8]) -> Result<DynamicImage, String> {
    let reader = || {
        let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
        reader.map_err(|error| error.to_string())
    };
    let (width, height) = reader()?.into_dimensions().map_err(|error| error.to_string())?;
    let needed = u128::from(width) * u128::from(height) * DECODED_PIXEL_BYTES;
    memory::check(needed, || format!("its {width}×{height} pixels take")).map_err(|e| e.with_help())?;
    let mut reader = reader()?;
    // The library's own limit is 512 MiB, whatever the machine.
    let mut limits = image::Limits::default();
    limits.max_alloc = memory::available_bytes().or(limits.max_alloc);
    reader.limits(limits);
    reader.decode().map_err(|error| error.to_string())
}
