//! What can be wrong with points, cells and queries.

/// What can be wrong with the input of this crate.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DelaunayError {
    /// There are no points.
    #[error("there are no points; at least one is needed")]
    NoPoints,
    /// A point has a coordinate that is NaN or infinite.
    #[error("point {index} is not finite")]
    PointNotFinite {
        /// Its index, from 0.
        index: usize,
    },
    /// There are more points than 32-bit indices of cells allow for.
    #[error("{count} points are too many: at most {limit} fit")]
    TooManyPoints {
        /// Number that was given.
        count: usize,
        /// Largest number.
        limit: usize,
    },
    /// There are more cells between these points than 32-bit links can number.
    #[error("more than {limit} cells are needed")]
    TooManyCells {
        /// Largest number.
        limit: usize,
    },
    /// There is no point of this index, or it was removed.
    #[error("there is no point {index}")]
    NoSuchPoint {
        /// The index.
        index: u32,
    },
    /// A cell of a partition is invalid.
    #[error("cell {cell} of the partition {problem}")]
    BadCell {
        /// Which, from 0; of a line, the place in its list; of a point, 0.
        cell: usize,
        /// What is wrong with it, as a predicate.
        problem: &'static str,
    },
    /// A query position has a coordinate that is NaN or infinite.
    #[error("query {index} is not finite")]
    QueryNotFinite {
        /// Its index, from 0.
        index: usize,
    },
}
