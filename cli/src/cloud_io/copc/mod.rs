//! COPC: a LAZ whose points are in the order of an octree, of which single nodes can be read.

mod error;
#[cfg(feature = "las")]
mod file;
mod hierarchy;

pub use error::{CopcError, CopcKey};
#[cfg(feature = "las")]
pub use file::CopcFile;
pub use hierarchy::{COPC_HEAD_BYTES, CopcChunk, CopcHierarchy, is_copc};
