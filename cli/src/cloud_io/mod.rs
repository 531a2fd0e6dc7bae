//! Clouds of points from files, in blocks: PLY and PLY in gzip, XYZ text, LAS/LAZ, E57, and Stanford's `.conf`.
//!
//! [`read_cloud`] hands out blocks and forgets them, so that a scan of any size needs a few megabytes here. What the
//! content says wins over the name of the file: gzip, PLY, LAS and E57 begin with bytes of their own; text is known by its
//! extension. Nothing is allocated on the word of a header.

mod block;
mod colour;
mod conf;
mod copc;
#[cfg(feature = "e57")]
mod e57_file;
mod format;
mod gunzip;
#[cfg(feature = "las")]
mod las_axis;
#[cfg(feature = "las")]
mod las_check;
#[cfg(feature = "las")]
mod las_file;
mod number;
mod ply;
mod ply_write;
mod scalar;
mod source;
mod xyz;
mod xyz_header;
mod xyz_row;

pub use block::{CloudBlock, CloudOptions, CloudSummary, MAX_BLOCK_POINTS, RangeGrid};
pub use conf::{Conf, ConfScan, Pose, read_conf, read_conf_bytes};
#[cfg(feature = "las")]
pub use copc::CopcFile;
pub use copc::{COPC_HEAD_BYTES, CopcChunk, CopcError, CopcHierarchy, CopcKey, is_copc};
pub use format::CloudFormat;
pub use ply_write::{CloudPoint, PlyEncoding, write_ply};
pub use scalar::{Scalar, Scalars};

use crate::input;
use crate::input_error::InputError;
use crate::memory;
use block::{Gather, Stop};
use format::{Content, HEAD_BYTES};
use gunzip::Gunzip;
use source::Source;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

/// The way out for a cloud where a mesh is wanted.
pub(crate) const DRAW_CLOUD: &str = "`pointillist scan FILE` draws points as closed surfaces, `pointillist surfel FILE` as discs; \
     `pointillist info FILE` says what the file holds";

/// Reads a cloud from a file, or standard input for `-`, and hands it out in blocks, in the order of the file.
///
/// Formats, each known by content or extension:
///
/// * PLY, ascii and binary of both byte orders: `x y z` of the element `vertex`; normals `nx ny nz`, and `face_nx face_ny face_nz` where those are
///   interpolated; colours `red green blue`, `diffuse_red …` or `r g b`; opacities `alpha` or `a`; `radius`. Faces and other elements are passed
///   over, but for a Stanford `range_grid`, which gives [`CloudSummary::grid`].
/// * XYZ text (`.xyz`, `.txt`, `.asc`, `.pts`, `.csv`): three to seven numbers a line; which of them are colours is
///   described in the module that reads it and in the messages.
/// * LAS and LAZ with the feature `las`, which is on by default; E57 with the feature `e57`.
/// * Any PLY or text compressed with gzip.
///
/// Intensities, classes and numbers of returns come out of all of them as they are stored; [`Scalar`] says by what names PLY and
/// text have them.
///
/// Colours are stored sRGB-encoded in all of these and come out linear. Points that are not finite (NaN or infinite, in
/// any number that is handed out) end the reading with an error that counts them, unless
/// [`CloudOptions::drop_invalid`] is set. After the first of them no more blocks are handed out.
///
/// # Errors
///
/// [`InputError`], converted into `E`, for anything wrong with the file: missing, of unknown kind, damaged, cut short, without
/// points, with points that are not finite. Messages name the line of text and the byte of binary files, both counted in
/// the unpacked data if it was packed. Blocks may have been handed out before. An error of `sink` ends the
/// reading and comes back as it is.
pub fn read_cloud<E: From<InputError>>(
    path: &Path,
    options: &CloudOptions,
    sink: &mut dyn FnMut(CloudBlock<'_>) -> Result<(), E>,
) -> Result<CloudSummary, E> {
    let name = input::name_of(path);
    with_sink(sink, options, |gather| {
        if input::is_standard(path) {
            return read_any(&name, Cursor::new(input::standard()?), gather);
        }
        let file = File::open(path).map_err(|error| input::cannot_read(&name, &error))?;
        // The seek of LAS and E57 goes past the buffer; the others bring their own.
        read_any(&name, BufReader::with_capacity(1 << 16, file), gather)
    })
}

/// [`read_cloud`] for bytes in memory; `name` is how messages call them, and its extension counts as that of a file.
///
/// # Errors
///
/// As [`read_cloud`].
pub fn read_cloud_bytes<E: From<InputError>>(
    name: &str,
    bytes: &[u8],
    options: &CloudOptions,
    sink: &mut dyn FnMut(CloudBlock<'_>) -> Result<(), E>,
) -> Result<CloudSummary, E> {
    // The readers of LAS want to own what they read.
    with_sink(sink, options, |gather| read_any(name, Cursor::new(bytes.to_vec()), gather))
}

/// Keeps the sink's own error aside, so that the readers need not be generic over it.
fn with_sink<T, E: From<InputError>>(
    sink: &mut dyn FnMut(CloudBlock<'_>) -> Result<(), E>,
    options: &CloudOptions,
    read: impl FnOnce(&mut Gather<'_>) -> Result<T, Stop>,
) -> Result<T, E> {
    let mut refusal = None;
    let mut keep = |block: CloudBlock<'_>| {
        sink(block).map_err(|error| {
            refusal = Some(error);
            Stop::Sink
        })
    };
    let result = read(&mut Gather::new(options, &mut keep));
    result.map_err(|stop| match (stop, refusal) {
        (Stop::Input(error), _) => E::from(error),
        (Stop::Sink, Some(error)) => error,
        (Stop::Sink, None) => unreachable!("only a refusal of the sink makes `Stop::Sink`"),
    })
}

/// What every kind of file can be read through.
trait ReadSeek: Read + Seek + Send + Sync + 'static {}
impl<T: Read + Seek + Send + Sync + 'static> ReadSeek for T {}

fn read_any<R: ReadSeek>(name: &str, mut input: R, gather: &mut Gather<'_>) -> Result<CloudSummary, Stop> {
    let head = read_head(name, &mut input)?;
    match Content::of(name, &head)? {
        Content::Gzip => {
            let unpacked_name = format::without_gz(name);
            let mut unpacked = Gunzip::new(BufReader::new(Cursor::new(head).chain(input)));
            let head = read_head(name, &mut unpacked)?;
            match Content::of(unpacked_name, &head)? {
                Content::Ply => ply::read(Source::new(name, Cursor::new(head).chain(unpacked)), gather),
                Content::Xyz => xyz::read(Source::new(name, Cursor::new(head).chain(unpacked)), gather),
                Content::Gzip | Content::Las | Content::E57 => Err(packed_twice(name).into()),
            }
        }
        Content::Ply => ply::read(Source::new(name, Cursor::new(head).chain(input)), gather),
        Content::Xyz => xyz::read(Source::new(name, Cursor::new(head).chain(input)), gather),
        Content::Las => read_las(name, input, gather),
        Content::E57 => read_e57(name, input, gather),
    }
}

/// What a file in gzip holds, unpacked.
///
/// # Errors
///
/// It is damaged or cut short, or does not fit into memory.
pub fn unpack(name: &str, packed: &[u8]) -> Result<Vec<u8>, InputError> {
    memory::read_to_end(Gunzip::new(packed), 0, "its unpacked bytes take")
        .map_err(|error| InputError::of_file(name, error.to_string()))
}

fn packed_twice(name: &str) -> InputError {
    InputError::of_file(name, "only PLY and text are read out of gzip")
        .with_help("unpack it with `gunzip` first")
}

/// The first bytes, or all of a shorter file.
fn read_head(name: &str, input: &mut impl Read) -> Result<Vec<u8>, InputError> {
    let mut head = Vec::with_capacity(HEAD_BYTES);
    match input.take(HEAD_BYTES as u64).read_to_end(&mut head) {
        Ok(_) => Ok(head),
        Err(error) => Err(InputError::of_file(name, format!("cannot be read: {error}"))),
    }
}

#[cfg(feature = "las")]
fn read_las<R: ReadSeek>(name: &str, input: R, gather: &mut Gather<'_>) -> Result<CloudSummary, Stop> {
    las_file::read(name, input, gather)
}

#[cfg(not(feature = "las"))]
fn read_las<R: ReadSeek>(name: &str, _: R, _: &mut Gather<'_>) -> Result<CloudSummary, Stop> {
    Err(not_built(name, "LAS or LAZ", "las").into())
}

#[cfg(feature = "e57")]
fn read_e57<R: ReadSeek>(name: &str, input: R, gather: &mut Gather<'_>) -> Result<CloudSummary, Stop> {
    e57_file::read(name, input, gather)
}

#[cfg(not(feature = "e57"))]
fn read_e57<R: ReadSeek>(name: &str, _: R, _: &mut Gather<'_>) -> Result<CloudSummary, Stop> {
    Err(not_built(name, "E57", "e57").into())
}

#[cfg(not(all(feature = "las", feature = "e57")))]
fn not_built(name: &str, kind: &str, feature: &str) -> InputError {
    InputError::of_file(name, format!("this is {kind}, which this build does not read")).with_help(format!(
        "build with `cargo install pointillist --features {feature}`, or convert it to PLY"
    ))
}
