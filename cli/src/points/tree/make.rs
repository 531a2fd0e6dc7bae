//! Makes the octree beside a cloud's file, once.

use super::record::Fields;
use crate::cloud_io::{CloudBlock, CloudOptions, Scalar, read_cloud};
use crate::image_io::write_atomically;
use crate::input;
use crate::input_error::InputError;
use crate::job::{Progress, ProgressMode};
use glam::DVec3;
use pointillist_octree::{Builder, Cube, OctreeError, POSITION_BYTES, TreeHeader, TreeReader, TreeWriter};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use twox_hash::XxHash3_64;

/// Changes with the way in which trees are made.
const VERSION: u64 = 1;

/// Pieces of a file that its fingerprint is made of, from the first to the last, and bytes of each.
const PIECES: u64 = 64;
const PIECE_BYTES: u64 = 4096;

/// Where the octree of a file is.
pub(super) fn path_of(cloud: &Path) -> PathBuf {
    let mut name = cloud.as_os_str().to_owned();
    name.push(".octree");
    name.into()
}

/// A hash of a file's length and of 64 pieces of it, and of how it is read.
pub(super) fn fingerprint(path: &Path, drop_invalid: bool) -> io::Result<u64> {
    let mut file = File::open(path)?;
    let length = file.seek(SeekFrom::End(0))?;
    let mut hash = XxHash3_64::with_seed(VERSION);
    std::hash::Hasher::write(&mut hash, &length.to_le_bytes());
    std::hash::Hasher::write(&mut hash, &[u8::from(drop_invalid)]);
    let mut piece = vec![];
    for number in 0..PIECES {
        let last = length.saturating_sub(PIECE_BYTES);
        file.seek(SeekFrom::Start((u128::from(last) * u128::from(number) / u128::from(PIECES - 1)) as u64))?;
        piece.clear();
        file.by_ref().take(PIECE_BYTES).read_to_end(&mut piece)?;
        std::hash::Hasher::write(&mut hash, &piece);
    }
    Ok(std::hash::Hasher::finish(&hash))
}

/// The octree of a file, if there is a sound one.
pub(super) fn open(tree: &Path, fingerprint: u64) -> Option<TreeReader<File>> {
    let reader = TreeReader::new(File::open(tree).ok()?).ok()?;
    (reader.header().fingerprint == fingerprint).then_some(reader)
}

/// Reads a cloud twice, and writes its octree in at most `memory` bytes, about. Nothing is there if this fails or is interrupted.
pub(super) fn make(
    cloud: &Path,
    drop_invalid: bool,
    fingerprint: u64,
    memory: u64,
    progress: &Progress,
) -> Result<PathBuf, InputError> {
    let options = CloudOptions::default().with_drop_invalid(drop_invalid).with_scalars(true);
    // Its length is not known yet.
    let summary = read_cloud::<InputError>(cloud, &options, &mut |_| Ok(()))?;
    let what = Contents {
        bounds: summary.bounds,
        points: summary.points,
        fields: Fields::of(&summary),
        fingerprint,
        name: input::name_of(cloud),
    };
    progress.begin("octree", 3 * summary.points);
    progress.advance(summary.points);
    let path = path_of(cloud);
    write(&path, &what, memory, progress, &mut |sink| read_cloud(cloud, &options, sink).map(|_| ()))?;
    Ok(path)
}

/// Hands out all points of a cloud in blocks.
type Source<'a> =
    &'a mut dyn FnMut(&mut dyn FnMut(CloudBlock<'_>) -> Result<(), InputError>) -> Result<(), InputError>;

/// What an octree is made of.
struct Contents {
    bounds: [DVec3; 2],
    points: u64,
    fields: Fields,
    fingerprint: u64,
    /// How messages call the cloud.
    name: String,
}

/// Writes the octree of points without a file, such as those of a simulation: positions within `bounds`, and `scalars` of each. `source` hands out
/// all `points` of them in blocks of any size.
///
/// # Errors
///
/// [`InputError`] if the octree cannot be written, or a point is out of bounds; that of `source`.
pub fn write_octree(
    path: &Path,
    bounds: [DVec3; 2],
    points: u64,
    scalars: &[Scalar],
    memory: u64,
    source: Source<'_>,
) -> Result<(), InputError> {
    let fields = Fields::of_scalars(scalars);
    let name = input::name_of(path);
    let what = Contents { bounds, points, fields, fingerprint: points, name };
    write(path, &what, memory, &Progress::new(ProgressMode::Off), source)
}

fn write(
    path: &Path,
    what: &Contents,
    memory: u64,
    progress: &Progress,
    source: Source<'_>,
) -> Result<(), InputError> {
    let Contents { bounds: [low, high], fields, .. } = *what;
    let cube = Cube::around(low, high).map_err(|error| what.refused(&error))?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let spill = tempfile::tempfile_in(folder).map_err(|error| what.cannot_write(path, &error))?;
    let mut builder = Builder::new(cube, fields.bytes(), memory, spill);
    let mut payload = vec![];
    let mut failure = None;
    let read = source(&mut |block| {
        for (i, position) in block.positions.iter().enumerate() {
            fields.encode(&block, i, &mut payload);
            if let Err(error) = builder.push(*position, &payload) {
                failure = Some(error);
                return Err(InputError::of_file(&what.name, "its octree cannot be written"));
            }
        }
        progress.advance(block.positions.len() as u64);
        Ok(())
    });
    match failure {
        Some(OctreeError::Io(error)) => return Err(what.cannot_write(path, &error)),
        Some(other) => return Err(what.refused(&other)),
        None => read?,
    }
    what.write_tree(path, cube, builder, progress)
}

impl Contents {
    /// The second half: from the temporary file to the tree.
    fn write_tree(
        &self,
        path: &Path,
        cube: Cube,
        builder: Builder<File>,
        progress: &Progress,
    ) -> Result<(), InputError> {
        let Self { fields, fingerprint, .. } = *self;
        let header =
            TreeHeader { fingerprint, cube, payload: fields.bytes() as u32, layout: fields.layout() };
        let mut refused = None;
        let mut before = 0;
        let written = write_atomically(path, |output| {
            let mut writer = TreeWriter::new(output, &header)?;
            let built = builder.finish(&mut |key, records| writer.node(key, records), &mut |placed| {
                progress.advance(placed - before);
                before = placed;
            });
            match built {
                Err(OctreeError::Io(error)) => return Err(error),
                Err(other) => {
                    refused = Some(other);
                    return Err(io::Error::other("refused"));
                }
                Ok(()) => {}
            }
            // What is not on the disk when the power fails is not the file's name.
            writer.finish()?.get_ref().sync_all()
        });
        progress.finish();
        match (refused, written) {
            (Some(error), _) => Err(self.refused(&error)),
            (None, Err(error)) => Err(self.cannot_write(path, &error)),
            (None, Ok(())) => Ok(()),
        }
    }

    fn refused(&self, error: &OctreeError) -> InputError {
        InputError::of_file(&self.name, format!("no octree can be made of it: {error}")).with_help(
            "remove points that are there many times, or give it more --memory so that it is drawn without",
        )
    }

    fn cannot_write(&self, path: &Path, error: &io::Error) -> InputError {
        // The temporary file and the tree.
        let needed = 2 * u128::from(self.points) * (POSITION_BYTES + self.fields.bytes()) as u128;
        let needed = crate::memory::human(needed);
        InputError::of_file(path.display().to_string(), format!("the octree cannot be written: {error}")).with_help(format!(
            "making it takes {needed} in this folder, half of which stay; make room, or link the cloud into a folder with room (`ln -s`)"
        ))
    }
}
