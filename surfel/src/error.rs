//! What can be wrong.

/// What can be wrong with a mesh or a cloud, or with what is asked of them.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfelError {
    /// A position is NaN or infinite.
    #[error("position {index} is not finite")]
    NotFinite {
        /// Its number in the list of positions.
        index: usize,
    },
    /// A triangle refers to a position that does not exist.
    #[error("triangle {triangle} refers to position {index}, and there are {count}")]
    IndexOutOfRange {
        /// Its number in the list of triangles.
        triangle: usize,
        /// What it refers to.
        index: u32,
        /// How many positions there are.
        count: usize,
    },
    /// There is nothing to put points on: no triangle has an area, or the sum is beyond the range of numbers, which is
    /// 1e-280 to 1e280.
    #[error("the triangles have an area of {area}; points need one from 1e-280 to 1e280")]
    NoArea {
        /// The sum of all areas.
        area: f64,
    },
    /// No points are asked for.
    #[error("a count of 0 points; at least 1 is needed")]
    ZeroCount,
    /// The spacing is not a length.
    #[error("a spacing of {spacing}; it must be finite and more than 0")]
    BadSpacing {
        /// As given.
        spacing: f64,
    },
    /// More points than [`crate::MAX_COUNT`].
    #[error("about {count:.3e} points are asked for, and at most {most} can be made")]
    TooMany {
        /// How many there would be.
        count: f64,
        /// How many there may be.
        most: usize,
    },
    /// The mesh is too long for so fine a grid of rays.
    #[error("the mesh is {cells:.3e} spacings long, and a grid has at most {most} rays a side")]
    TooFine {
        /// Rays along the longest side.
        cells: f64,
        /// How many there may be.
        most: u32,
    },
    /// A cloud without points.
    #[error("the cloud has no points")]
    NoPoints,
    /// Attributes are not as many as positions.
    #[error("{length} {what} for {count} positions")]
    LengthMismatch {
        /// Which attribute.
        what: &'static str,
        /// How many there are.
        length: usize,
        /// How many there have to be.
        count: usize,
    },
    /// A normal is zero or not finite.
    #[error("the normal of point {index} is zero or not finite; leave normals out to have them estimated")]
    BadNormal {
        /// Number of the point.
        index: usize,
    },
    /// A channel of a color is negative, not a number, or above [`crate::Points::BRIGHTEST`].
    #[error("the color of point {index} has a channel that is not between 0 and 1e30")]
    BadColor {
        /// Number of the point.
        index: usize,
    },
    /// A radius is not a length.
    #[error(
        "the radius of point {index} is {radius}; it must be above 0 and finite (leave radii out to have them estimated)"
    )]
    BadRadius {
        /// Number of the point.
        index: usize,
        /// As given.
        radius: f32,
    },
    /// A side of the picture is above [`Renderer::LARGEST_SIDE`](crate::Renderer::LARGEST_SIDE).
    #[error("a picture of {width}×{height} pixels cannot be drawn: each side must be at most 16384")]
    TooLarge {
        /// Pixels from left to right.
        width: u32,
        /// Pixels from top to bottom.
        height: u32,
    },
    /// An option outside its range.
    #[error("{name} is {value}: {range}")]
    BadOption {
        /// Which option.
        name: &'static str,
        /// As given.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
}
