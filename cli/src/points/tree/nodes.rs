//! Where the nodes of a cloud come from: an octree of ours, or a COPC file.

use super::make;
use super::record::{Columns, Fields};
use crate::cloud_io::CloudBlock;
use crate::input;
use crate::input_error::InputError;
use crate::job::Progress;
use crate::points::PointOptions;
use pointillist_octree::{OctreeError, TREE_MARK, Tree, TreeReader};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

#[cfg(feature = "las")]
use crate::cloud_io::{COPC_HEAD_BYTES, CloudOptions, CopcFile, is_copc};
#[cfg(feature = "las")]
use std::io::BufReader;

/// A cloud whose nodes are read one by one.
#[derive(Debug)]
pub(super) struct NodeFile {
    /// The cloud as the user named it.
    pub(super) path: PathBuf,
    pub(super) name: String,
    /// Hash of what the cloud is.
    pub(super) fingerprint: u64,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Own {
        reader: Box<TreeReader<File>>,
        fields: Fields,
    },
    #[cfg(feature = "las")]
    Copc {
        file: Box<CopcFile<BufReader<File>>>,
        options: CloudOptions,
    },
}

/// How octrees are made that are not there.
pub(super) struct Making<'a> {
    pub(super) options: &'a PointOptions,
    /// Bytes that may be used.
    pub(super) memory: u64,
    pub(super) progress: &'a Progress,
    /// Gets a line before each that is made, and of what is odd.
    pub(super) tell: &'a dyn Fn(&str),
}

impl NodeFile {
    /// Opens a cloud by nodes: itself, if it has any, or the octree beside it, which is made if there is none of this cloud.
    pub(super) fn open(path: &Path, making: &Making<'_>) -> Result<Self, InputError> {
        let name = input::name_of(path);
        #[cfg(feature = "las")]
        if is_copc_file(path) {
            return Self::open_copc(path, name, making);
        }
        let reader = if is_tree(path) {
            let damaged = |error: OctreeError| {
                InputError::of_file(&name, error.to_string())
                    .with_help("remove it, and draw from the cloud that it was made from")
            };
            let file = File::open(path).map_err(|error| input::cannot_read(&name, &error))?;
            TreeReader::new(file).map_err(damaged)?
        } else {
            beside(path, &name, making)?
        };
        let header = *reader.header();
        let fields = Fields::from_layout(header.layout, header.payload).ok_or_else(|| {
            InputError::of_file(&name, "the octree is of another version")
                .with_help("remove it; it is made again from the cloud")
        })?;
        let kind = Kind::Own { reader: Box::new(reader), fields };
        Ok(Self { path: path.to_owned(), name, fingerprint: header.fingerprint, kind })
    }

    #[cfg(feature = "las")]
    fn open_copc(path: &Path, name: String, making: &Making<'_>) -> Result<Self, InputError> {
        let cannot_read = |error: std::io::Error| input::cannot_read(&name, &error);
        let drop_invalid = making.options.drop_invalid;
        let fingerprint = make::fingerprint(path, drop_invalid).map_err(cannot_read)?;
        // The seek to a node goes past the buffer.
        let input = BufReader::with_capacity(1 << 16, File::open(path).map_err(cannot_read)?);
        let file = Box::new(CopcFile::new(&name, input)?);
        if file.missing() > 0 {
            (making.tell)(&format!(
                "{name}: {} of its points are in no node, and are not drawn",
                file.missing()
            ));
        }
        let options = CloudOptions::default().with_drop_invalid(drop_invalid).with_scalars(true);
        Ok(Self { path: path.to_owned(), name, fingerprint, kind: Kind::Copc { file, options } })
    }

    pub(super) fn tree(&self) -> &Tree {
        match &self.kind {
            Kind::Own { reader, .. } => reader.tree(),
            #[cfg(feature = "las")]
            Kind::Copc { file, .. } => file.tree(),
        }
    }

    /// Whether its points have normals.
    pub(super) fn has_normals(&self) -> bool {
        match &self.kind {
            Kind::Own { fields, .. } => fields.has_normals(),
            #[cfg(feature = "las")]
            Kind::Copc { .. } => false,
        }
    }

    /// The records of a node, and how many bytes of the file they were.
    pub(super) fn read(&mut self, node: u32) -> Result<(Vec<u8>, u64), InputError> {
        match &mut self.kind {
            Kind::Own { reader, .. } => {
                let records = reader.read(node).map_err(|error| damaged_node(&self.path, &error))?;
                let bytes = records.len() as u64;
                Ok((records, bytes))
            }
            #[cfg(feature = "las")]
            Kind::Copc { file, .. } => Ok((file.read(node)?, file.bytes_of(node))),
        }
    }

    /// Hands out the points of records.
    pub(super) fn blocks(
        &self,
        records: &[u8],
        sink: &mut dyn FnMut(CloudBlock<'_>) -> Result<(), InputError>,
    ) -> Result<(), InputError> {
        match &self.kind {
            Kind::Own { reader, fields } => {
                let columns = Columns::decode(records, *fields, &reader.tree().cube());
                if columns.is_empty() { Ok(()) } else { sink(columns.block()) }
            }
            #[cfg(feature = "las")]
            Kind::Copc { file, options } => file.blocks(records, options, sink),
        }
    }
}

/// Names the octree's file, which is not the cloud that the user named if it is beside that.
fn damaged_node(cloud: &Path, error: &OctreeError) -> InputError {
    let tree = if is_tree(cloud) { cloud.to_owned() } else { make::path_of(cloud) };
    InputError::of_file(tree.display().to_string(), format!("the octree is damaged: {error}"))
        .with_help("remove this file; it is made again from the cloud")
}

/// The octree beside a cloud, which is made if there is none of this cloud.
fn beside(path: &Path, name: &str, making: &Making<'_>) -> Result<TreeReader<File>, InputError> {
    let drop_invalid = making.options.drop_invalid;
    let fingerprint =
        make::fingerprint(path, drop_invalid).map_err(|error| input::cannot_read(name, &error))?;
    let tree = make::path_of(path);
    if let Some(reader) = make::open(&tree, fingerprint) {
        return Ok(reader);
    }
    let why = if tree.exists() { "is damaged or of another file, and is made anew" } else { "is made, once" };
    (making.tell)(&format!("{} {why}", tree.display()));
    make::make(path, drop_invalid, fingerprint, making.memory / 2, making.progress)?;
    make::open(&tree, fingerprint).ok_or_else(|| {
        InputError::of_file(tree.display().to_string(), "the octree that was just written cannot be read")
            .with_help("is something else writing to this folder?")
    })
}

fn head_of(path: &Path, bytes: usize) -> Vec<u8> {
    let mut head = vec![];
    // What cannot be read has no mark; the reader will say why.
    let _ = File::open(path).and_then(|file| file.take(bytes as u64).read_to_end(&mut head));
    head
}

/// Whether a file is a PLY, packed or not, that announces faces.
pub(super) fn has_faces(path: &Path) -> bool {
    /// Bytes of a header that are looked at.
    const HEADER_BYTES: usize = 1 << 16;
    let mut head = head_of(path, HEADER_BYTES);
    if head.starts_with(&[0x1f, 0x8b]) {
        let mut unpacked = vec![];
        // What is cut off in the middle of the packed bytes is no longer the header.
        let _ = flate2::read::GzDecoder::new(&head[..]).take(HEADER_BYTES as u64).read_to_end(&mut unpacked);
        head = unpacked;
    }
    let text = String::from_utf8_lossy(&head);
    let header = text.lines().map(str::trim).take_while(|line| *line != "end_header");
    let faces = |line: &str| line.strip_prefix("element face")?.trim().parse::<u64>().ok();
    head.starts_with(b"ply") && header.filter_map(faces).any(|count| count > 0)
}

/// Whether a file is an octree of ours.
pub(super) fn is_tree(path: &Path) -> bool {
    head_of(path, TREE_MARK.len()) == TREE_MARK
}

/// Whether a file is COPC, and this build reads it.
#[cfg(feature = "las")]
fn is_copc_file(path: &Path) -> bool {
    is_copc(&head_of(path, COPC_HEAD_BYTES))
}

#[cfg(not(feature = "las"))]
fn is_copc_file(_: &Path) -> bool {
    false
}

/// Whether a file has nodes of its own.
pub(super) fn has_nodes(path: &Path) -> bool {
    is_tree(path) || is_copc_file(path)
}
