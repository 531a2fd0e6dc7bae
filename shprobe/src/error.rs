//! Errors of probes, their harmonics and their distances.

use crate::delaunay::DelaunayError;
use crate::sh::ShError;

/// What can be wrong with the input of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProbeError {
    /// There are no probes.
    #[error("there are no probes; at least one is needed")]
    NoProbes,
    /// A position has a coordinate that is NaN or infinite.
    #[error("position {index} is not finite")]
    PositionNotFinite {
        /// Its index, from 0.
        index: usize,
    },
    /// There are more probes than 32-bit indices of cells allow for.
    #[error("{count} probes are too many: at most {limit} fit")]
    TooManyProbes {
        /// Number that was given.
        count: usize,
        /// Largest number.
        limit: usize,
    },
    /// A query position, or a normal, has a coordinate that is NaN or infinite.
    #[error("query {index} is not finite")]
    QueryNotFinite {
        /// Its index, from 0.
        index: usize,
    },
    /// There is no probe of this index, or it was removed.
    #[error("there is no probe {index}")]
    NoSuchProbe {
        /// The index.
        index: u32,
    },
    /// Lists that belong together have different lengths.
    #[error("{given} entries are given for {probes} probes")]
    CountMismatch {
        /// How many probes there are.
        probes: usize,
        /// How many entries were given.
        given: usize,
    },
    /// A probe holds more or fewer bands than the first.
    #[error("probe {index} holds order {order}, and the first order {expected}")]
    MixedOrders {
        /// Which probe, from 0.
        index: usize,
        /// Its order.
        order: usize,
        /// That of the first probe.
        expected: usize,
    },
    /// A coordinate of a probe is beyond [`Field::FARTHEST`](crate::Field::FARTHEST).
    #[error("position {index} is too far from the origin: coordinates can be up to 1e150")]
    PositionTooFar {
        /// Its index, from 0.
        index: usize,
    },
    /// A coefficient of a probe is not finite, or beyond [`Field::BRIGHTEST`](crate::Field::BRIGHTEST).
    #[error("probe {index} holds a coefficient that is not from −1e30 to 1e30")]
    BadRadiance {
        /// Which probe, from 0.
        index: usize,
    },
    /// The weight of a candidate is negative or not finite, or all are 0.
    #[error(
        "candidate {index} counts {weight}: weights must be finite and at least 0, and one must be above 0"
    )]
    BadWeight {
        /// Which candidate, from 0.
        index: usize,
        /// As given.
        weight: f64,
    },
    /// An option or distance outside its range.
    #[error("{name} is {value}: {range}")]
    BadOption {
        /// Which option.
        name: &'static str,
        /// As given.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// A map of distances without texels, or with too many.
    #[error("a map of distances with {size} texels along an edge: there must be 1 to {limit}")]
    MapSize {
        /// Texels along an edge.
        size: usize,
        /// Largest number.
        limit: usize,
    },
    /// A distance is negative or not finite, or there are not as many as the map has texels.
    #[error("distance {index} of a map is missing, negative or not finite, or one too many")]
    BadDistances {
        /// Its index, from 0.
        index: usize,
    },
    /// Distances were set for a probe of a field that has no distances.
    #[error("the field has no distances: it was made without `with_distances`")]
    NoDistances,
    /// The harmonics of a probe, or an image that they are projected from, are invalid.
    #[error(transparent)]
    Harmonics(#[from] ShError),
    /// Cells between the probes are invalid, or there are too many.
    #[error("cells between probes: {0}")]
    Cells(DelaunayError),
}

impl From<DelaunayError> for ProbeError {
    /// Errors of points become errors of probes; all others are [`ProbeError::Cells`].
    fn from(error: DelaunayError) -> Self {
        match error {
            DelaunayError::NoPoints => Self::NoProbes,
            DelaunayError::PointNotFinite { index } => Self::PositionNotFinite { index },
            DelaunayError::TooManyPoints { count, limit } => Self::TooManyProbes { count, limit },
            DelaunayError::NoSuchPoint { index } => Self::NoSuchProbe { index },
            DelaunayError::QueryNotFinite { index } => Self::QueryNotFinite { index },
            other => Self::Cells(other),
        }
    }
}
