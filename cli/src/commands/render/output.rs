//! Picture files: their format, what fits into it, and whether one is there already.

use super::super::Report;
use crate::error::CliError;
use crate::image_io::{
    Bits, ExrFile, Frame, JpegOptions, PixelRect, PngOptions, Precision, Stamp, encode_jpeg, encode_png,
    write_atomically,
};
use crate::input::is_standard;
use crate::memory;
use crate::options::{Colour, DisplayOptions, PictureOptions};
use glam::Vec3;
use pointillist_render::ImageSettings;
use std::io::{self, Seek, Write};
use std::path::Path;

/// How a picture is written, by the end of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::commands) enum OutputFormat {
    Exr,
    Png,
    Jpeg,
}

impl OutputFormat {
    /// The format that a path asks for.
    pub(in crate::commands) fn of(path: &Path) -> Result<Self, CliError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "exr" => Ok(Self::Exr),
            "png" => Ok(Self::Png),
            "jpg" | "jpeg" => Ok(Self::Jpeg),
            _ if is_standard(path) => {
                let message =
                    "-o -: a picture is no text, and goes to a file whose name ends in .png, .jpg or .exr";
                Err(CliError::Usage(message.to_owned()))
            }
            _ => Err(CliError::Usage(format!(
                "`{}`: a picture's name ends in .png, .jpg or .exr",
                path.display()
            ))),
        }
    }

    /// Refuses what the format has no room for: layers, floats, more bits, a quality.
    pub(in crate::commands) fn check(self, layers: bool, options: &PictureOptions) -> Result<(), CliError> {
        if self != Self::Exr && (layers || options.float) {
            let message = "--layers and --float need an .exr output; add -o picture.exr";
            return Err(CliError::Usage(message.to_owned()));
        }
        self.check_display(&options.display)
    }

    /// Refuses options of another format than this.
    pub(in crate::commands) fn check_display(self, options: &DisplayOptions) -> Result<(), CliError> {
        let usage = |message: &str| Err(CliError::Usage(message.to_owned()));
        match self {
            Self::Exr if options.bits.is_some() => {
                usage("--bits is for PNG; an EXR has 16 bits, or 32 with --float")
            }
            Self::Jpeg if options.bits == Some(Bits::Sixteen) => {
                usage("--bits 16: a JPEG has 8 bits; add -o picture.png")
            }
            Self::Exr | Self::Png if options.quality.is_some() => {
                usage("--quality is for JPEG; PNG and EXR lose nothing")
            }
            _ => Ok(()),
        }
    }

    /// Refuses a picture with longer sides than the format can say.
    pub(in crate::commands) fn check_sides(self, window: PixelRect) -> Result<(), CliError> {
        let (width, height, most) = (window.width(), window.height(), JpegOptions::LARGEST_SIDE);
        if self != Self::Jpeg || width.max(height) <= most {
            return Ok(());
        }
        Err(CliError::Usage(format!(
            "{width}×{height} pixels: a JPEG has at most {most} a side; add -o picture.png"
        )))
    }

    /// What colours are multiplied by when they are written.
    pub(in crate::commands) fn gain(self, options: &DisplayOptions) -> f32 {
        if self == Self::Exr { 1.0 } else { options.exposure.exp2() }
    }
}

/// Whether the output is there already, drawn from the same scene with the same options. A damaged one is not, and is told.
pub(in crate::commands) fn is_there(
    path: &Path,
    stamp: &Stamp,
    window: PixelRect,
    report: &Report<'_>,
) -> bool {
    let Ok(bytes) = memory::read(path) else { return false };
    match ExrFile::read(&bytes) {
        Ok(file) => file.window == window && file.stamp.as_ref() == Some(stamp),
        Err(error) => {
            let name = path.display();
            report.note(&format!("{name} is there, but cannot be used ({error}); it is drawn again"));
            false
        }
    }
}

/// What is to be said of a picture whose background is there, but not seen by who looks at it.
pub(super) fn unseen_background(
    frame: &Frame,
    image: &ImageSettings,
    format: OutputFormat,
    options: &PictureOptions,
) -> Option<String> {
    let is_bare = || frame.color.iter().any(|pixel| pixel[3] == 0.0);
    if format != OutputFormat::Png || options.bg.is_some() || !is_bare() {
        return None;
    }
    let key = match (&image.environment, image.background != Vec3::ZERO) {
        (Some(_), _) if !image.hides_environment => "image.environment",
        (_, true) => "image.background",
        _ => return None,
    };
    Some(format!(
        "`{key}` is under alpha 0 in a PNG, where viewers show nothing; a .jpg shows it, and --bg COLOR puts a colour there"
    ))
}

/// Writes a drawn picture in any format.
pub(in crate::commands) fn write_picture(
    path: &Path,
    format: OutputFormat,
    frame: Frame,
    stamp: Stamp,
    options: &PictureOptions,
) -> Result<(), CliError> {
    write_atomically(path, |output| encode(output, format, frame, stamp, options))
        .map_err(|error| CliError::writing(&path.display().to_string(), &error))
}

/// The bytes of a picture in any format. With `--bg` it becomes opaque: what is open shows the colour, which
/// `frame` may hold already (its stamp's background).
pub(super) fn encode(
    output: impl Write + Seek,
    format: OutputFormat,
    mut frame: Frame,
    stamp: Stamp,
    options: &PictureOptions,
) -> io::Result<()> {
    if let Some(Colour(color)) = options.bg {
        let gain = format.gain(&options.display);
        make_opaque(&mut frame, stamp.background, color.map(|channel| channel / gain));
    }
    if format == OutputFormat::Exr {
        let precision = if options.float { Precision::Float } else { Precision::Half };
        return ExrFile::from_frame(&frame, stamp, precision).write(output);
    }
    encode_display(output, format, &frame, stamp.background, options.bg.is_some(), &options.display)
}

/// Fills what is open with a colour in the place of `before`, which is behind the picture so far.
fn make_opaque(frame: &mut Frame, before: [f32; 3], color: [f32; 3]) {
    for pixel in &mut frame.color {
        let open = 1.0 - pixel[3];
        for channel in 0..3 {
            pixel[channel] += open * (color[channel] - before[channel]);
        }
        pixel[3] = 1.0;
    }
}

pub(in crate::commands) fn write_exr(path: &Path, file: ExrFile) -> Result<(), CliError> {
    write_atomically(path, |output| file.write(output))
        .map_err(|error| CliError::writing(&path.display().to_string(), &error))
}

/// Writes a PNG or JPEG.
pub(in crate::commands) fn write_display(
    path: &Path,
    format: OutputFormat,
    frame: &Frame,
    background: [f32; 3],
    options: &DisplayOptions,
) -> Result<(), CliError> {
    write_atomically(path, |output| encode_display(output, format, frame, background, false, options))
        .map_err(|error| CliError::writing(&path.display().to_string(), &error))
}

fn encode_display(
    output: impl Write,
    format: OutputFormat,
    frame: &Frame,
    background: [f32; 3],
    opaque: bool,
    options: &DisplayOptions,
) -> io::Result<()> {
    let (width, height) = (frame.window.width(), frame.window.height());
    let exposure_ev = options.exposure;
    if format == OutputFormat::Jpeg {
        let quality = options.quality.unwrap_or(JpegOptions::QUALITY);
        return encode_jpeg(output, &frame.color, width, height, &JpegOptions { exposure_ev, quality });
    }
    let png = PngOptions { exposure_ev, background, opaque, bits: options.bits.unwrap_or_default() };
    encode_png(output, &frame.color, width, height, &png)
}
