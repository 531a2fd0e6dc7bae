/// What can be wrong with a light.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShadowError {
    /// A position or direction is NaN or infinite.
    #[error("the light's {what} is not finite")]
    NotFinite {
        /// Position or direction.
        what: &'static str,
    },
    /// A direction is zero.
    #[error("the light's direction is zero")]
    NoDirection,
    /// A fixed light grid must have 1 to 2²⁰ cells per side.
    #[error("a light grid of {0} cells per side; 1 to 1048576 are possible")]
    BadResolution(u32),
    /// Squares on a side of a cell under masks must be 1, 2 or 4.
    #[error("{0} squares on a side of a cell under masks; 1, 2 and 4 are possible")]
    BadSquaresUnderMasks(u32),
    /// The outline of a polygonal light has too few or too many vertices.
    #[error("the light's outline has {found} vertices; 3 to {most} are possible")]
    OutlineLength {
        /// Its vertices.
        found: usize,
        /// The most there may be.
        most: usize,
    },
    /// A vertex of a polygonal light is NaN or infinite.
    #[error("vertex {index} of the light is not finite")]
    OutlineNotFinite {
        /// Position of the vertex.
        index: usize,
    },
    /// Both ends of a line that shines are one point.
    #[error("the light's line has no length")]
    LineWithoutLength,
    /// The vertices of a polygonal light lie on a line.
    #[error("the light's outline has no area")]
    OutlineWithoutArea,
    /// A vertex of a polygonal light is off the plane of the others.
    #[error("vertex {index} of the light is not in the plane of the others")]
    OutlineNotPlanar {
        /// Position of the vertex.
        index: usize,
    },
    /// The outline of a polygonal light bends inward at a vertex, or turns round more than once.
    #[error("the light's outline is not convex at vertex {index}")]
    OutlineNotConvex {
        /// Position of the vertex.
        index: usize,
    },
}
