//! What can be wrong with points, cells and queries.

/// What can be wrong with the input of this crate.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DelaunayError {
    /// There is no point at all.
    #[error("there are no points; at least one is needed")]
    NoPoints,
    /// A point has a coordinate that is NaN or infinite.
    #[error("point {index} is not finite")]
    PointNotFinite {
        /// Which, from 0.
        index: usize,
    },
    /// More points than 32-bit indices of cells allow for.
    #[error("{count} points are too many: at most {limit} fit")]
    TooManyPoints {
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// The cells between these points are more than 32-bit links can tell apart.
    #[error("more than {limit} cells are needed")]
    TooManyCells {
        /// How many there may be.
        limit: usize,
    },
    /// There is no point of this index, or no longer.
    #[error("there is no point {index}")]
    NoSuchPoint {
        /// The index.
        index: u32,
    },
    /// A cell of a partition is not what it has to be.
    #[error("cell {cell} of the partition {problem}")]
    BadCell {
        /// Which, from 0; of a line, the place in its list; of a point, 0.
        cell: usize,
        /// What is wrong.
        problem: &'static str,
    },
    /// A position asked for has a coordinate that is NaN or infinite.
    #[error("query {index} is not finite")]
    QueryNotFinite {
        /// Which, from 0.
        index: usize,
    },
}
