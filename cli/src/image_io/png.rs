//! Writes PNG: 8-bit sRGB with straight alpha.

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, SrgbRenderingIntent};
use pointillist_render::srgb_from_linear;
use std::io::{self, Write};

/// How linear colours become bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PngOptions {
    /// Colours are multiplied by two to this power. Default: 0.
    pub exposure_ev: f32,
    /// Colour that shines through where alpha is less than 1, to be taken out. Default: black.
    pub background: [f32; 3],
}

/// Writes linear, premultiplied colours, `width · height` of them.
///
/// # Errors
///
/// What the output says.
pub fn encode_png(
    output: impl Write,
    color: &[[f32; 4]],
    width: u32,
    height: u32,
    options: &PngOptions,
) -> io::Result<()> {
    let gain = options.exposure_ev.exp2();
    let bytes: Vec<u8> = color.iter().flat_map(|&pixel| straight(pixel, options.background, gain)).collect();
    encode(output, &bytes, width, height, ColorType::Rgba)
}

/// Writes encoded red, green and blue bytes.
///
/// # Errors
///
/// What the output says.
pub fn encode_rgb_png(output: impl Write, bytes: &[u8], width: u32, height: u32) -> io::Result<()> {
    encode(output, bytes, width, height, ColorType::Rgb)
}

fn encode(output: impl Write, bytes: &[u8], width: u32, height: u32, kind: ColorType) -> io::Result<()> {
    let failed = |error: EncodingError| match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other.to_string()),
    };
    let mut encoder = Encoder::new(output, width, height);
    encoder.set_color(kind);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    // Says that the bytes are sRGB: without it, viewers that manage colours may take them for the screen's own.
    encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(bytes).map_err(failed)?;
    writer.finish().map_err(failed)
}

/// The bytes of one pixel. Where nothing but background is seen the colour is kept, under alpha 0.
fn straight([r, g, b, alpha]: [f32; 4], background: [f32; 3], gain: f32) -> [u8; 4] {
    let channel = |total: f32, behind: f32| {
        let own = if alpha > 0.0 && alpha < 1.0 { (total - (1.0 - alpha) * behind) / alpha } else { total };
        byte(srgb_from_linear((own * gain).clamp(0.0, 1.0)))
    };
    let [br, bg, bb] = background;
    [channel(r, br), channel(g, bg), channel(b, bb), byte(alpha)]
}

/// A number from 0 to 1 as the nearest byte; NaN is 0.
fn byte(n: f32) -> u8 {
    (n * 255.0 + 0.5) as u8
}
