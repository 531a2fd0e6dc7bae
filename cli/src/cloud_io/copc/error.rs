//! What can be wrong with the head or the hierarchy of a COPC file.

use pointillist_octree::OctreeError;
use std::fmt;
use std::io;

/// The name of a node as a hierarchy has it: level, x, y, z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CopcKey(pub [i32; 4]);

impl fmt::Display for CopcKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [level, x, y, z] = self.0;
        write!(f, "{level}-{x}-{y}-{z}")
    }
}

/// What can be wrong with the head or the hierarchy of a COPC file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CopcError {
    /// Not LAS 1.4 whose first record is that of COPC, with compressed points of format 6, 7 or 8.
    #[error("not COPC 1.0: {0}")]
    NotCopc(&'static str),
    /// Centre, half size or spacing are not finite, or not above 0.
    #[error(
        "the cube of its octree cannot be used: centre {centre:?}, half size {half_size}, spacing {spacing}"
    )]
    BadCube {
        /** Centre of the cube. */
        centre: [f64; 3],
        /** Half of its side. */
        half_size: f64,
        /** Distance of points in the root. */
        spacing: f64,
    },
    /// A page or the points of a node are not in the file.
    #[error("{what} at byte {offset} has {bytes} bytes, but the file has {length}")]
    OutsideFile {
        /** The page or node. */
        what: String,
        /** Where it is said to be. */
        offset: u64,
        /** How long it is said to be. */
        bytes: u64,
        /** Bytes of the file. */
        length: u64,
    },
    /// A page does not consist of entries of 32 bytes.
    #[error("{what} has {bytes} bytes, which is no number of entries of 32 bytes")]
    BadPage {
        /** The page. */
        what: String,
        /** How long it is said to be. */
        bytes: u64,
    },
    /// Two pages, or pages and points, share bytes: a page that leads back to itself, for example.
    #[error("{what} at byte {offset} has bytes that {other} has already")]
    Overlap {
        /** The page or node. */
        what: String,
        /** Where it is. */
        offset: u64,
        /** What is there, too. */
        other: String,
    },
    /// A node whose name is that of no cube, or beyond level 31.
    #[error("node {key} is no cube of an octree of 32 levels")]
    BadKey {
        /** Its name. */
        key: CopcKey,
    },
    /// A page has a node that is not in the one that the page is for.
    #[error("node {key} is in the page of {page}, of which it is no part")]
    WrongPage {
        /** Its name. */
        key: CopcKey,
        /** The node that the page is for. */
        page: CopcKey,
    },
    /// A number of points below -1, or of points without bytes.
    #[error("node {key} announces {points} points in {bytes} bytes")]
    BadCount {
        /** Its name. */
        key: CopcKey,
        /** Its number of points. */
        points: i32,
        /** Its bytes. */
        bytes: i32,
    },
    /// The nodes have more points than the file.
    #[error("its nodes announce {nodes} points, but the file has {file}")]
    TooManyPoints {
        /** Points of all nodes so far. */
        nodes: u64,
        /** Points of the file, by its header. */
        file: u64,
    },
    /// Nodes that are no tree.
    #[error("its nodes are no tree: {0}")]
    NoTree(#[from] OctreeError),
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
}
