//! What can be wrong with the input.

use crate::limits::{MAX_CELLS, MAX_COORDINATE};

/// What can be wrong with the input of this crate.
///
/// Polygons without area (fewer than three vertices, all on one line) are no error: they have no pieces.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DiceError {
    /// A coordinate of a vertex, or a value carried with it, is NaN or infinite.
    #[error("vertex {index} is not finite")]
    NotFinite {
        /// Position of the vertex in the polygon.
        index: usize,
    },
    /// A vertex lies more than [`MAX_COORDINATE`](crate::MAX_COORDINATE) cells from the grid's origin, where an
    /// `i32` no longer numbers the cells safely.
    #[error("vertex {index} lies more than {limit} cells from the grid's origin: use larger cells or an origin near the polygon", limit = MAX_COORDINATE)]
    OutOfRange {
        /// Position of the vertex in the polygon.
        index: usize,
    },
    /// The polygon that [`split`](crate::split()) was given is not convex.
    #[error(
        "the polygon is not convex at vertex {index}: triangulate it, or use `accumulate`, which needs no convexity"
    )]
    NotConvex {
        /// Position of a vertex where the outline turns the wrong way.
        index: usize,
    },
    /// The polygon meets more cells than [`MAX_CELLS`](crate::MAX_CELLS).
    #[error("the polygon meets about {count} cells, more than {limit}: use larger cells or clip it first", limit = MAX_CELLS)]
    TooManyCells {
        /// About how many cells would have to be visited.
        count: u64,
    },
    /// A grid's origin is not finite, or the sides of its cells are not finite numbers with a finite, normal product (so not 0).
    #[error("a grid needs a finite origin and cells with finite sides and area that are not 0: origin ({}, {}), cell ({}, {})", origin.x, origin.y, cell.x, cell.y)]
    BadGrid {
        /// The origin that was asked for.
        origin: glam::DVec2,
        /// The size of a cell that was asked for.
        cell: glam::DVec2,
    },
}
