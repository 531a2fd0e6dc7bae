//! Errors of coefficients, images and their parameters.

/// What can be wrong with the input of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShError {
    /// Spherical harmonics of an order that is not computed.
    #[error("order {order} is too high: at most {limit} is computed")]
    OrderTooHigh {
        /// The order asked for.
        order: usize,
        /// The highest order, [`MAX_ORDER`](crate::MAX_ORDER).
        limit: usize,
    },
    /// Coefficients whose number is not that of any order.
    #[error("{count} coefficients: there must be (order + 1)², 1 to 81")]
    CoefficientCount {
        /// Number that was given.
        count: usize,
    },
    /// A coefficient is NaN or infinite.
    #[error("coefficient {index} is not finite")]
    CoefficientNotFinite {
        /// Its index, from 0.
        index: usize,
    },
    /// Functions of different orders do not fit together.
    #[error("order {left} does not fit order {right}")]
    MixedOrders {
        /// Order of the first function, or the order asked for.
        left: usize,
        /// Order of the other function.
        right: usize,
    },
    /// A blend of no functions has no order.
    #[error("there is no function to blend; at least one is needed")]
    NothingToBlend,
    /// A cube map without texels or with too many.
    #[error("a cube map cannot have faces of {size}×{size} texels: 1 to {limit} along an edge")]
    CubeSize {
        /// Texels along an edge.
        size: usize,
        /// Largest number.
        limit: usize,
    },
    /// The number of texels is not that of six faces.
    #[error("{count} texels: six faces of {size}×{size} have {expected}")]
    CubeTexelCount {
        /// Texels along an edge.
        size: usize,
        /// How many there must be.
        expected: usize,
        /// Number that was given.
        count: usize,
    },
    /// A cube map of another size than its projector was made for.
    #[error("a cube map of size {size} where {expected} is expected")]
    WrongCubeSize {
        /// Texels along an edge that the projector was made for.
        expected: usize,
        /// Texels along an edge of the cube map.
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
    /// A panorama without pixels, with too many along a side, or whose number of pixels is not width · height.
    #[error("{count} pixels are no panorama of {width}×{height}")]
    PanoramaSize {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// How many pixels there are.
        count: usize,
    },
    /// A panorama of another size than its projector was made for.
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
    /// A matrix or quaternion that is not a rotation.
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
        /// Its band.
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
    /// Pictures of one scene that have different numbers of pixels.
    #[error("a picture of {count} pixels among pictures of {expected}")]
    BracketSize {
        /// How many it has.
        count: usize,
        /// How many the first has.
        expected: usize,
    },
    /// An exposure out of its range.
    #[error("an exposure of {exposure_ev} EV is not from −64 to 64")]
    Exposure {
        /// The exposure, in stops.
        exposure_ev: f32,
    },
}
