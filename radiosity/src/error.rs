//! What can be wrong with polygons, surfaces and options.

/// What can be wrong with the vertices of a polygon.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolygonError {
    /// A coordinate is NaN, infinite or beyond 1e70.
    #[error("vertex {index} is not finite, or beyond 1e70")]
    NotFinite {
        /// Which, from 0.
        index: usize,
    },
    /// Fewer than three different vertices.
    #[error("{count} different vertices enclose nothing; a polygon has at least 3")]
    TooFewVertices {
        /// How many there are.
        count: usize,
    },
    /// All vertices on one line, or so nearly that there is no normal.
    #[error("the vertices lie on one line: a polygon without area has no normal")]
    NoArea,
    /// A vertex off the plane of the others.
    #[error("vertex {index} is {off:e} off the polygon's plane; split it into triangles")]
    NotPlanar {
        /// Which, from 0.
        index: usize,
        /// Distance to the plane.
        off: f64,
    },
    /// A corner that bends inward, or a ring that goes around more than once.
    #[error("the corner at vertex {index} bends inward; split the polygon into convex parts")]
    NotConvex {
        /// Which, from 0, after repeated vertices are dropped.
        index: usize,
    },
}

/// What can be wrong with a scene, its options, or what is asked of it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RadiosityError {
    /// A surface whose outline is no convex planar polygon.
    #[error("surface {surface}: {problem}")]
    Outline {
        /// Which, from 0.
        surface: usize,
        /// What is wrong with it.
        problem: PolygonError,
    },
    /// A reflectance that is NaN or negative.
    #[error("surface {surface}: a reflectance of {value} is not from 0 to 1")]
    Reflectance {
        /// Which, from 0.
        surface: usize,
        /// The value.
        value: f64,
    },
    /// A surface that gives back more than it gets: there is no equilibrium.
    #[error(
        "surface {surface}: a reflectance of {value} is above 1: light would grow without end; use less than 1"
    )]
    ReflectanceAboveOne {
        /// Which, from 0.
        surface: usize,
        /// The value.
        value: f64,
    },
    /// An emission that is NaN, negative, or above 1e100.
    #[error("surface {surface}: an emission of {value} is not from 0 to 1e100")]
    Emission {
        /// Which, from 0.
        surface: usize,
        /// The value.
        value: f64,
    },
    /// A surface that emits and has no area: its power is 0 whatever its emission.
    #[error("surface {surface} emits light and has no area; give it an area, or use a point light")]
    EmitterWithoutArea {
        /// Which, from 0.
        surface: usize,
    },
    /// There is no surface of this number, or it was dropped because it has no area.
    #[error("there is no surface {surface} with an area")]
    UnknownSurface {
        /// The number, from 0.
        surface: usize,
    },
    /// There is nothing to light.
    #[error("there is no surface with an area")]
    NoSurface,
    /// An option out of its range.
    #[error("{name} = {value} is not {expected}")]
    Option {
        /// Which option.
        name: &'static str,
        /// The value.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// Patches of the wanted size would be too many.
    #[error("patches of this size are more than {limit}; use larger ones, or allow more")]
    TooManyPatches {
        /// How many there may be.
        limit: usize,
    },
    /// The light of a closed scene that absorbs nothing.
    #[error(
        "no equilibrium: reflectance times what surfaces see of each other reaches {contraction}; make a surface darker"
    )]
    NoEquilibrium {
        /// Largest reflectance times row sum.
        contraction: f64,
    },
    /// A list with another length than there are patches.
    #[error("{given} entries for {patches} patches")]
    CountMismatch {
        /// How many patches there are.
        patches: usize,
        /// How many entries were given.
        given: usize,
    },
    /// A point or normal that is not finite, or a normal without length.
    #[error("the point or its normal is not finite, or the normal has no length")]
    BadPoint,
    /// A lamp whose position or direction is not finite, or has no length, or whose exitance is no light.
    #[error(
        "lamp {lamp} has a position, direction or exitance that is not finite, has no length, or is below 0"
    )]
    BadLamp {
        /// Which, from 0.
        lamp: usize,
    },
    /// A lamp's irradiance of a patch is no light.
    #[error(
        "lamp {lamp} gives patch {patch}, about {centre:?}, an irradiance of {value}; it must be from 0 to 1e100"
    )]
    LampIrradiance {
        /// Which lamp, from 0.
        lamp: usize,
        /// Which patch, from 0, in the order that patches have at that time: edges of shadows may have divided some before.
        patch: usize,
        /// Its centre, world space.
        centre: [f64; 3],
        /// Mean irradiance.
        value: f64,
    },
    /// A direct irradiance that is no light.
    #[error("the direct irradiance of patch {patch} is {value}; it must be from 0 to 1e100")]
    DirectIrradiance {
        /// Which patch, from 0.
        patch: usize,
        /// The value.
        value: f64,
    },
    /// An importance that is NaN, infinite or negative.
    #[error("the importance of patch {patch} is {value}; it must be from 0 to 1e100")]
    Importance {
        /// Which patch, from 0.
        patch: usize,
        /// The value.
        value: f64,
    },
}
