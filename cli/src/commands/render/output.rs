//! Picture files: their format, and whether one is there already.

use super::super::Report;
use crate::error::CliError;
use crate::image_io::{ExrFile, Frame, PixelRect, PngOptions, Stamp, encode_png, write_atomically};
use crate::input::is_standard;
use crate::memory;
use std::path::Path;

/// How a picture is written, by the end of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::commands) enum OutputFormat {
    Exr,
    Png,
}

impl OutputFormat {
    /// The format that a path asks for.
    pub(in crate::commands) fn of(path: &Path) -> Result<Self, CliError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "exr" => Ok(Self::Exr),
            "png" => Ok(Self::Png),
            _ if is_standard(path) => {
                let message =
                    "-o -: a picture is no text, and goes to a file whose name ends in .png or .exr";
                Err(CliError::Usage(message.to_owned()))
            }
            _ => Err(CliError::Usage(format!("`{}`: a picture's name ends in .png or .exr", path.display()))),
        }
    }

    /// Refuses layers and floats for a PNG.
    pub(in crate::commands) fn check_layers(self, layers: bool, float: bool) -> Result<(), CliError> {
        if self == Self::Png && (layers || float) {
            let message = "--layers and --float need an .exr output; add -o picture.exr";
            return Err(CliError::Usage(message.to_owned()));
        }
        Ok(())
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

pub(in crate::commands) fn write_exr(path: &Path, file: ExrFile) -> Result<(), CliError> {
    write_atomically(path, |output| file.write(output))
        .map_err(|error| CliError::writing(&path.display().to_string(), &error))
}

pub(in crate::commands) fn write_png(
    path: &Path,
    frame: &Frame,
    options: &PngOptions,
) -> Result<(), CliError> {
    let (width, height) = (frame.window.width(), frame.window.height());
    write_atomically(path, |output| encode_png(output, &frame.color, width, height, options))
        .map_err(|error| CliError::writing(&path.display().to_string(), &error))
}
