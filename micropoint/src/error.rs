use pointillist_view::ViewError;

/// What can be wrong with the input of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MicropointError {
    /// A vertex is NaN or infinite.
    #[error("vertex {index} is not finite: {value:?}")]
    VertexNotFinite {
        /// Position in the vertex array.
        index: usize,
        /// Its coordinates.
        value: [f64; 3],
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are {count}")]
    VertexOutOfRange {
        /// Position in the triangle array.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// A triangle names a surface that does not exist.
    #[error("triangle {triangle} names surface {surface}, but there are {count}")]
    SurfaceOutOfRange {
        /// Position in the triangle array.
        triangle: usize,
        /// The surface it names.
        surface: u32,
        /// How many surfaces there are.
        count: usize,
    },
    /// `surface_of` must have an entry for each triangle.
    #[error("{surfaces} surface indices for {triangles} triangles")]
    LengthMismatch {
        /// Entries of `surface_of`.
        surfaces: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// An opacity is not in 0..=1.
    #[error("surface {index} has opacity {opacity}, which is not in 0..=1")]
    BadOpacity {
        /// Position in the surface array.
        index: usize,
        /// The value.
        opacity: f32,
    },
    /// More triangles than 32 bits can number.
    #[error("{count} triangles are more than this crate can number")]
    TooManyTriangles {
        /// How many.
        count: usize,
    },
    /// A place of a shape that stands in several is not finite, or beyond the range of numbers.
    #[error("place {place} of shape {shape} takes it out of the range of numbers")]
    BadPlacement {
        /// Position in the array of shapes.
        shape: usize,
        /// Position among the shape's places.
        place: usize,
    },
    /// The camera or the size of the picture was refused. No function of this crate returns it: it lets callers use `?` on
    /// [`View`](crate::View) beside the rest.
    #[error(transparent)]
    View(#[from] ViewError),
    /// Cells per pixel side must be 1, 2 or 4.
    #[error("{0} cells per pixel side; 1, 2 and 4 are possible")]
    BadCellsPerPixel(u32),
    /// Squares on a side of a cell under masks must be 1, 2 or 4.
    #[error("{0} squares on a side of a cell under masks; 1, 2 and 4 are possible")]
    BadSquaresUnderMasks(u32),
    /// A range of depths must begin at 0 or later and end beyond its beginning.
    #[error("depths from {near} to {far}: 0 ≤ near < far is possible")]
    BadDepths {
        /// Where the range begins.
        near: f64,
        /// Where it ends.
        far: f64,
    },
    /// Tiles must be 4 to 64 pixels on a side.
    #[error("tiles of {0} pixels; 4 to 64 are possible")]
    BadTileSize(u32),
    /// A texture without texels, or whose texels do not fill it.
    #[error("a texture of {width}×{height} texels with {texels} values")]
    BadTexture {
        /// Texels.
        width: u32,
        /// Texels.
        height: u32,
        /// How many values came.
        texels: usize,
    },
    /// A texel is NaN, infinite or negative.
    #[error("texel {index} is not a finite value of at least 0")]
    BadTexel {
        /// Position in row-major order.
        index: usize,
    },
}
