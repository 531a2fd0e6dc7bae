//! What can be wrong with a scene.

/// What can be wrong with a scene as data. Positions and opacities are checked where geometry is built from them, cameras and
/// emitters where they are used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A list is longer or shorter than the list that it belongs to.
    #[error("`{list}` has {length} entries, {expected} are needed")]
    Length {
        /// The list, a field of [`crate::Mesh`] or of [`crate::Part`].
        list: &'static str,
        /// Its entries.
        length: usize,
        /// What it should have.
        expected: usize,
    },
    /// A corner of a triangle refers to an entry that does not exist.
    #[error("`{list}[{triangle}]` refers beyond the {count} entries there are")]
    Corner {
        /// The list of corner indices: `triangles`, `normal_of` or `uv_of`.
        list: &'static str,
        /// Which triangle.
        triangle: usize,
        /// Entries there are.
        count: usize,
    },
    /// A triangle refers to a material or an object that does not exist, or an instance to a shape.
    #[error("`{list}[{triangle}]` is {index}, but there are {count}")]
    Index {
        /// The list of indices: `material_of`, `object_of` or `instances`.
        list: &'static str,
        /// Which triangle, or which instance.
        triangle: usize,
        /// What it refers to.
        index: u32,
        /// Entries there are.
        count: usize,
    },
    /// A shape that is to stand in several places has not exactly one object, or instances of its own.
    #[error(
        "a shape of {objects} objects and {instances} instances; it must have one object, and no instances"
    )]
    Shape {
        /// Its objects.
        objects: usize,
        /// Its instances.
        instances: usize,
    },
    /// A material, or the environment, refers to a texture that does not exist.
    #[error("{user}: texture {texture} is asked for, but there are {count}")]
    TextureIndex {
        /// Who refers to it: ``material `name` `` or `image.environment`.
        user: String,
        /// What it refers to.
        texture: usize,
        /// Textures there are.
        count: usize,
    },
    /// A texture has no texels, or not `width · height` of them.
    #[error("texture `{name}` of {width}×{height} texels has {found}")]
    Texels {
        /// The texture's name.
        name: String,
        /// Texels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Texels there are.
        found: usize,
    },
    /// A diffuse albedo, its map included, is not in 0 to 1: light would grow at every reflection.
    #[error("material `{material}`: a diffuse albedo of {value} is not from 0 to 1")]
    Albedo {
        /// The material's name.
        material: String,
        /// The albedo of one of its colours.
        value: f32,
    },
    /// A light map that cannot be averaged.
    #[error("material `{material}`: its light map: {problem}")]
    LightMap {
        /// Its name.
        material: String,
        /// What is wrong with the texels.
        problem: String,
    },
    /// A refraction index is not above 0.
    #[error("material `{material}`: a refraction index of {value} is not above 0")]
    RefractionIndex {
        /// The material's name.
        material: String,
        /// The index.
        value: f32,
    },
    /// A number is infinite or NaN.
    #[error("{what} is not finite")]
    NotFinite {
        /// Which number: `normals[3]`, ``material `name`: emission``, ``light `name` ``…
        what: String,
    },
    /// More entries than 32 bits can number.
    #[error("`{list}` would have {count} entries, more than 32 bits can number")]
    TooMany {
        /// The list.
        list: &'static str,
        /// Entries it would have.
        count: usize,
    },
    /// A material is to light others, and has no emission.
    #[error("material `{material}`: it emits, but its emission is 0")]
    NoEmission {
        /// The material's name.
        material: String,
    },
    /// A material is to light others, and takes light away.
    #[error("material `{material}`: it emits, and its emission is negative")]
    NegativeEmission {
        /// The material's name.
        material: String,
    },
    /// A light's radiance is negative.
    #[error("light `{name}` has a negative radiance")]
    NegativeLight {
        /// Its name.
        name: String,
    },
    /// A polygonal light is no planar convex polygon, or a line has no length.
    #[error("light `{name}`: {fault}")]
    LightOutline {
        /// Its name.
        name: String,
        /// What is wrong.
        fault: pointillist_shadow::ShadowError,
    },
}
