//! Writes PNG: sRGB in 8 or 16 bits, with straight alpha or opaque.

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, SrgbRenderingIntent};
use pointillist_render::srgb_from_linear;
use std::io::{self, Write};

/// Bits of a number in a PNG.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bits {
    /// 8: what screens show.
    #[default]
    Eight,
    /// 16: for further work on the picture, without banding.
    Sixteen,
}

/// How linear colours become numbers of a PNG.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PngOptions {
    /// Colours are multiplied by two to this power. Default: 0.
    pub exposure_ev: f32,
    /// Colour that shines through where alpha is less than 1, to be taken out. Default: black.
    pub background: [f32; 3],
    /// Leave alpha out: the colours are written as they are seen in front of the background. Default: `false`.
    pub opaque: bool,
    /// Default: 8.
    pub bits: Bits,
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
    let numbers = color.iter().flat_map(|&pixel| {
        let seen = if options.opaque { pixel } else { straight(pixel, options.background) };
        let [r, g, b] = display_rgb(seen, gain);
        let alpha = (!options.opaque).then_some(pixel[3]);
        [r, g, b].into_iter().chain(alpha)
    });
    let kind = if options.opaque { ColorType::Rgb } else { ColorType::Rgba };
    match options.bits {
        Bits::Eight => {
            let bytes: Vec<u8> = numbers.map(byte).collect();
            encode(output, &bytes, [width, height], kind, BitDepth::Eight)
        }
        Bits::Sixteen => {
            // PNG has the high byte first.
            let bytes: Vec<u8> = numbers.flat_map(|n| word(n).to_be_bytes()).collect();
            encode(output, &bytes, [width, height], kind, BitDepth::Sixteen)
        }
    }
}

/// Writes encoded red, green and blue bytes.
///
/// # Errors
///
/// What the output says.
pub fn encode_rgb_png(output: impl Write, bytes: &[u8], width: u32, height: u32) -> io::Result<()> {
    encode(output, bytes, [width, height], ColorType::Rgb, BitDepth::Eight)
}

fn encode(
    output: impl Write,
    bytes: &[u8],
    [width, height]: [u32; 2],
    kind: ColorType,
    depth: BitDepth,
) -> io::Result<()> {
    let failed = |error: EncodingError| match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other.to_string()),
    };
    let mut encoder = Encoder::new(output, width, height);
    encoder.set_color(kind);
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    // Says that the numbers are sRGB: without it, viewers that manage colours may take them for the screen's own.
    encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(bytes).map_err(failed)?;
    writer.finish().map_err(failed)
}

/// A pixel's colour without what is seen of the background. Where nothing but background is seen the colour is kept, under alpha 0.
fn straight([r, g, b, alpha]: [f32; 4], background: [f32; 3]) -> [f32; 4] {
    let own = |total: f32, behind: f32| {
        if alpha > 0.0 && alpha < 1.0 { (total - (1.0 - alpha) * behind) / alpha } else { total }
    };
    let [br, bg, bb] = background;
    [own(r, br), own(g, bg), own(b, bb), alpha]
}

/// A linear colour, brightened by `gain`, as sRGB from 0 to 1.
pub(super) fn display_rgb([r, g, b, _]: [f32; 4], gain: f32) -> [f32; 3] {
    [r, g, b].map(|channel| srgb_from_linear((channel * gain).clamp(0.0, 1.0)))
}

/// A number from 0 to 1 as the nearest byte; NaN is 0.
pub(super) fn byte(n: f32) -> u8 {
    (n * 255.0 + 0.5) as u8
}

/// A number from 0 to 1 as the nearest of 16 bits; NaN is 0.
fn word(n: f32) -> u16 {
    (n * 65535.0 + 0.5) as u16
}
