//! Writes JPEG: 8-bit sRGB without alpha, for pictures that are looked at and sent around.

use super::png::{byte, display_rgb};
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder as _, ImageError};
use std::io::{self, Write};

/// How linear colours become a JPEG.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JpegOptions {
    /// Colours are multiplied by two to this power.
    pub exposure_ev: f32,
    /// 1 (smallest file) to 100 (least loss).
    pub quality: u8,
}

impl JpegOptions {
    /// The quality at which losses are hard to see at the size of the picture.
    pub const QUALITY: u8 = 92;
    /// Most pixels along a side: the format has 16 bits for them.
    pub const LARGEST_SIDE: u32 = u16::MAX as u32;
}

/// Writes linear colours, `width · height` of them, as they are seen in front of the background.
///
/// # Errors
///
/// What the output says, or a side of more than [`JpegOptions::LARGEST_SIDE`].
pub fn encode_jpeg(
    output: impl Write,
    color: &[[f32; 4]],
    width: u32,
    height: u32,
    options: &JpegOptions,
) -> io::Result<()> {
    let gain = options.exposure_ev.exp2();
    let bytes: Vec<u8> = color.iter().flat_map(|&pixel| display_rgb(pixel, gain).map(byte)).collect();
    let encoder = JpegEncoder::new_with_quality(output, options.quality);
    encoder.write_image(&bytes, width, height, ExtendedColorType::Rgb8).map_err(|error| match error {
        ImageError::IoError(error) => error,
        other => io::Error::other(other.to_string()),
    })
}
