//! Errors of meshes, clouds and options.

/// Errors of meshes, clouds, views and options.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfelError {
    /// A vertex of the mesh is NaN or infinite.
    #[error("vertex {index} is not finite: {value:?}")]
    VertexNotFinite {
        /// Position in the vertex array.
        index: usize,
        /// Its coordinates.
        value: [f64; 3],
    },
    /// A triangle has an index of a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are {count}")]
    VertexOutOfRange {
        /// Position in the triangle array.
        triangle: usize,
        /// The index.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// Points have normals for light, but none of their own.
    #[error("shading normals without normals; give the normals of the discs, too")]
    OnlyShadingNormals,
    /// A point of the cloud is NaN or infinite.
    #[error("point {index} is not finite: {value:?}")]
    PointNotFinite {
        /// Number of the point.
        index: usize,
        /// Its coordinates.
        value: [f64; 3],
    },
    /// A coordinate is beyond [`Points::FARTHEST`](crate::Points::FARTHEST).
    #[error("point {index} is too far from the origin: {value:?}; coordinates can be up to 4.4e307")]
    PointTooFar {
        /// Number of the point.
        index: usize,
        /// Its coordinates.
        value: [f64; 3],
    },
    /// The sum of the triangles' areas is 0, or outside of the range 1e-280 to 1e280.
    #[error("the triangles have an area of {area}; points need one from 1e-280 to 1e280")]
    NoArea {
        /// The sum of all areas.
        area: f64,
    },
    /// A count of 0 points is asked for.
    #[error("a count of 0 points; at least 1 is needed")]
    ZeroCount,
    /// The spacing is not finite, or not above 0.
    #[error("a spacing of {spacing}; it must be finite and more than 0")]
    BadSpacing {
        /// As given.
        spacing: f64,
    },
    /// More points than [`MAX_COUNT`](crate::MAX_COUNT) to be sampled, or [`Points::MOST`](crate::Points::MOST) in a
    /// cloud.
    #[error("about {count:.3e} points, and there can be at most {limit}")]
    TooManyPoints {
        /// How many there would be; an estimate, since points are only counted while they are made.
        count: f64,
        /// How many there can be.
        limit: usize,
    },
    /// The spacing is too small for the extent of the mesh: the grid of rays would be too large.
    #[error("the mesh is {cells:.3e} spacings long, and a grid has at most {limit} rays a side")]
    TooFine {
        /// Rays along the longest side.
        cells: f64,
        /// How many there can be.
        limit: u32,
    },
    /// A cloud without points.
    #[error("the cloud has no points")]
    NoPoints,
    /// The cube of a division is not one: its corner is not finite, or its side not above 0.
    #[error("the cube at {low:?} with a side of {side} cannot be divided")]
    BadCube {
        /// Its lowest corner.
        low: [f64; 3],
        /// Its side.
        side: f64,
    },
    /// Clouds that are to be joined were not made within one cube, or only some of them have normals of their own.
    #[error("part {index} was made in another way than the first; only parts of one cube can be joined")]
    NotOfOneKind {
        /// Its number.
        index: usize,
    },
    /// The number of an attribute's values is not that of positions.
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
    /// A radius is not finite, or not above 0.
    #[error(
        "the radius of point {index} is {radius}; it must be above 0 and finite (leave radii out to have them estimated)"
    )]
    BadRadius {
        /// Number of the point.
        index: usize,
        /// As given.
        radius: f32,
    },
    /// An opacity is not a number, or not from 0 to 1.
    #[error(
        "the opacity of point {index} is {value}; it must be from 0 to 1 (leave opacities out if all points are opaque)"
    )]
    BadOpacity {
        /// Number of the point.
        index: usize,
        /// As given.
        value: f32,
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
