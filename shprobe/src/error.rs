//! What can be wrong with probes and what they hold.

/// What can be wrong with the input of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProbeError {
    /// There is no point at all.
    #[error("there are no probes; at least one is needed")]
    NoProbes,
    /// A position has a coordinate that is NaN or infinite.
    #[error("position {index} is not finite")]
    PositionNotFinite {
        /// Which, from 0.
        index: usize,
    },
    /// More points than 32-bit indices can tell apart.
    #[error("{count} probes are too many: at most {limit} fit")]
    TooManyProbes {
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A cell of a partition whose corners are no points given, or whose neighbours are no neighbours.
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
    /// Spherical harmonics of an order that is not computed.
    #[error("order {order} is too high: at most {limit} is computed")]
    OrderTooHigh {
        /// What was asked for.
        order: usize,
        /// The highest there is.
        limit: usize,
    },
    /// Coefficients whose number is not that of any order.
    #[error("{count} coefficients: there must be (order + 1)², 1 to 81")]
    CoefficientCount {
        /// How many there are.
        count: usize,
    },
    /// A coefficient is NaN or infinite.
    #[error("coefficient {index} is not finite")]
    CoefficientNotFinite {
        /// Which, from 0.
        index: usize,
    },
    /// Functions of different orders do not fit together.
    #[error("order {left} does not fit order {right}")]
    MixedOrders {
        /// Of the first, or of what is asked for.
        left: usize,
        /// Of the other.
        right: usize,
    },
    /// A cube map without texels or with too many.
    #[error("a cube map cannot have faces of {size}×{size} texels: 1 to {limit} along an edge")]
    CubeSize {
        /// Texels along an edge.
        size: usize,
        /// How many there may be.
        limit: usize,
    },
    /// Not as many texels as six faces have.
    #[error("{count} texels: six faces of {size}×{size} have {expected}")]
    CubeTexelCount {
        /// Texels along an edge.
        size: usize,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        count: usize,
    },
    /// A cube map of another size than was prepared for.
    #[error("a cube map of size {size} where {expected} is expected")]
    WrongCubeSize {
        /// Prepared for.
        expected: usize,
        /// Given.
        size: usize,
    },
    /// A texel of a cube map is NaN or infinite.
    #[error("face {face} has a texel at column {x}, row {y} that is not finite")]
    TexelNotFinite {
        /// 0 to 5: +X, −X, +Y, −Y, +Z, −Z.
        face: usize,
        /// Column from the left.
        x: usize,
        /// Row from the top.
        y: usize,
    },
    /// A panorama without pixels, or with another number than its sides say.
    #[error("{count} pixels are no panorama of {width}×{height}")]
    PanoramaSize {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// How many pixels there are.
        count: usize,
    },
    /// A panorama of another size than was prepared for.
    #[error("a panorama of {width}×{height} is not what was prepared for")]
    WrongPanoramaSize {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A pixel of a panorama is NaN or infinite.
    #[error("the pixel at column {x}, row {y} is not finite")]
    PixelNotFinite {
        /// Column from the left.
        x: usize,
        /// Row from the top.
        y: usize,
    },
    /// A matrix or quaternion that does more, or other, than to turn.
    #[error("not a rotation")]
    NotARotation,
    /// An exponent or roughness of a lobe out of its range.
    #[error("{value} is no shape of a lobe")]
    LobeShape {
        /// What was given.
        value: f64,
    },
    /// A factor of a lobe is NaN or infinite.
    #[error("the factor of band {band} is not finite")]
    LobeBand {
        /// Of which band.
        band: usize,
    },
    /// A camera's exponent out of its range.
    #[error("a gamma of {gamma} is not above 0 and at most 16")]
    Gamma {
        /// What was given.
        gamma: f64,
    },
    /// A camera's curve has too few or too many samples, or one that is not finite or does not rise.
    #[error("the response curve ends or does not rise at sample {index}")]
    ResponseCurve {
        /// The first sample that is wrong or missing.
        index: usize,
    },
    /// An exposure out of its range.
    #[error("an exposure of {exposure_ev} EV is not from −64 to 64")]
    Exposure {
        /// What was given, in stops.
        exposure_ev: f32,
    },
    /// The Delaunay tetrahedra of these points are more than 32-bit links can tell apart.
    #[error("more than {limit} cells are needed")]
    TooManyCells {
        /// How many there may be.
        limit: usize,
    },
    /// There is no probe of this index, or no longer.
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
    /// A distance is negative or not finite, or there are not as many as the map has texels.
    #[error("distance {index} of a map is missing, negative or not finite, or one too many")]
    BadDistances {
        /// Which, from 0.
        index: usize,
    },
}
