//! Recognises the format of a cloud by its first bytes or its extension.

use crate::input::STANDARD_INPUT;
use crate::input_error::InputError;
use std::path::Path;

/// Bytes that tell the format of every kind of file.
pub(super) const HEAD_BYTES: usize = 8;

/// Extensions of text with a point a line.
const TEXT: [&str; 5] = ["xyz", "txt", "asc", "pts", "csv"];

/// What a cloud is written in, inside of any compression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CloudFormat {
    /// Polygon file format, ascii.
    PlyAscii,
    /// Polygon file format, lowest byte first.
    PlyLittleEndian,
    /// Polygon file format, highest byte first.
    PlyBigEndian,
    /// Text with a point a line.
    Xyz,
    /// LAS, or its compressed form LAZ.
    Las,
    /// ASTM E2807.
    E57,
}

impl CloudFormat {
    /// The name in messages and in the output of `info`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::PlyAscii => "ply ascii",
            Self::PlyLittleEndian => "ply binary_little_endian",
            Self::PlyBigEndian => "ply binary_big_endian",
            Self::Xyz => "xyz",
            Self::Las => "las",
            Self::E57 => "e57",
        }
    }
}

/// The reader to take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    Gzip,
    Ply,
    Xyz,
    Las,
    E57,
}

impl Content {
    /// By the first bytes if they say, by the extension otherwise, and standard input is then text: a wrong name is more common than a text that begins with
    /// the mark of another format.
    pub(super) fn of(name: &str, head: &[u8]) -> Result<Self, InputError> {
        let extension = Path::new(name).extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let starts = |mark: &[u8]| head.starts_with(mark);
        if starts(&[0x1f, 0x8b]) {
            Ok(Self::Gzip)
        } else if starts(b"ply\n") || starts(b"ply\r") || starts(b"ply ") {
            Ok(Self::Ply)
        } else if starts(b"LASF") {
            Ok(Self::Las)
        } else if starts(b"ASTM-E57") {
            Ok(Self::E57)
        } else if TEXT.contains(&extension.as_str()) || name == STANDARD_INPUT {
            Ok(Self::Xyz)
        } else {
            Err(refusal(name, &extension))
        }
    }
}

fn refusal(name: &str, extension: &str) -> InputError {
    let (message, help) = match extension {
        "ply" => (
            "the first line is not `ply`",
            "a PLY file begins with a line `ply`; was it unpacked or renamed?",
        ),
        "gz" => ("this is not gzip", "a gzip file begins with the bytes 1f 8b; was it unpacked already?"),
        "las" | "laz" => ("this is not LAS", "a LAS or LAZ file begins with `LASF`"),
        "e57" => ("this is not E57", "an E57 file begins with `ASTM-E57`"),
        "obj" | "gltf" | "glb" | "toml" | "json" => (
            "this is a mesh or a scene, not a cloud",
            "`pointillist sample FILE -o cloud.ply` puts points all over it; `pointillist render FILE` draws it",
        ),
        "conf" => (
            "this is a list of scans, not a cloud",
            "`pointillist scan FILE` draws it, with each scan in its place",
        ),
        _ => (
            "neither the name nor the first bytes say what kind of cloud this is",
            "known are .ply, .ply.gz, .xyz, .txt, .asc, .pts, .csv, .las, .laz, .e57 and .conf",
        ),
    };
    InputError::of_file(name, message).with_help(help)
}

/// The name without `.gz`, which tells what is packed.
pub(super) fn without_gz(name: &str) -> &str {
    let cut = name.len().saturating_sub(3);
    match name.get(cut..) {
        Some(end) if end.eq_ignore_ascii_case(".gz") => &name[..cut],
        _ => name,
    }
}
