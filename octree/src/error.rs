//! What can be wrong with a cloud, or with the file of a tree.

use crate::key::NodeKey;
use glam::DVec3;
use std::io;

/// What can be wrong with a cloud, with a tree's list of nodes, or with a tree's file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OctreeError {
    /// Bounds that are not finite, beyond [`crate::Cube::FARTHEST`], or the wrong way round.
    #[error("the bounds {low} to {high} cannot be used")]
    BadBounds {
        /** The lowest coordinates. */
        low: DVec3,
        /** The highest coordinates. */
        high: DVec3,
    },
    /// A point's payload is not as long as the tree's.
    #[error("a point comes with {length} bytes, but those of this tree have {wanted}")]
    BadPayload {
        /** Bytes of the point. */
        length: usize,
        /** Bytes of the others. */
        wanted: usize,
    },
    /// A point is outside of the cube that was announced, or not finite.
    #[error("a point is at {position}, outside of the bounds that were announced")]
    Outside {
        /** Where it is. */
        position: DVec3,
    },
    /// More points are at one place than fit into memory together.
    #[error("{count} points are within {extent:e} of one another, at {position}; at most {most} can be")]
    TooDense {
        /** Points there. */
        count: u64,
        /** Side of the cube that they are in, world units. */
        extent: f64,
        /** A corner of that cube. */
        position: DVec3,
        /** How many there may be. */
        most: u64,
    },
    /// A node's name is that of no cube.
    #[error("node {index} is named {key:?}, which is no cube")]
    BadKey {
        /** Position in the list of nodes. */
        index: usize,
        /** Its name. */
        key: NodeKey,
    },
    /// Two nodes have one name.
    #[error("node {index} is {key:?}, which there is already")]
    TwiceThere {
        /** Position in the list of nodes. */
        index: usize,
        /** Its name. */
        key: NodeKey,
    },
    /// A node without the node around it.
    #[error("node {index}, {key:?}, is in no other node")]
    NoParent {
        /** Position in the list of nodes. */
        index: usize,
        /** Its name. */
        key: NodeKey,
    },
    /// The file is not a tree, or not of this version.
    #[error("this is no octree of this version")]
    NotATree,
    /// The file was altered or cut off.
    #[error("{what} is not what was written")]
    Damaged {
        /** Which part of it. */
        what: String,
    },
    /// A file cannot be read or written.
    #[error(transparent)]
    Io(#[from] io::Error),
}
