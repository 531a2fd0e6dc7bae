/// What can be wrong with the input of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShadeError {
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
    /// A vertex is NaN or infinite.
    #[error("vertex {index} is not finite: {value:?}")]
    VertexNotFinite {
        /// Position in the vertex array.
        index: usize,
        /// Its coordinates.
        value: [f64; 3],
    },
    /// A crease angle is NaN.
    #[error("a crease angle of {crease_rad} rad; it must be a number")]
    BadCrease {
        /// As given, radians.
        crease_rad: f64,
    },
    /// A texture's slice does not hold `width · height` texels.
    #[error("{len} texels do not make a texture of {width} by {height}")]
    TextureSize {
        /// Texels in the slice.
        len: usize,
        /// Texels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A MERL table with other than 90 × 90 × 180 bins.
    #[error("a MERL table has 90 × 90 × 180 bins, not {} × {} × {}", found[0], found[1], found[2])]
    MerlDimensions {
        /// What the header says.
        found: [i32; 3],
    },
    /// A MERL table that is cut off, or goes on.
    #[error("a MERL table has {wanted} bytes, not {len}")]
    MerlSize {
        /// Bytes there are.
        len: usize,
        /// Bytes there should be.
        wanted: usize,
    },
    /// A value of a MERL table that is NaN or infinite.
    #[error("value {index} of the MERL table is not finite")]
    MerlValue {
        /// Position among all values, red first.
        index: usize,
    },
}

/// What can be wrong with a light.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LightError {
    /// The outline of a light has too few or too many vertices.
    #[error("a light's outline has {found} vertices; 3 to {most} are possible", most = crate::LARGEST_OUTLINE)]
    OutlineLength {
        /// Its vertices.
        found: usize,
    },
}
