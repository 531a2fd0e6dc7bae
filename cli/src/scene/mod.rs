//! Scenes: what a file describes, resolved until nothing is left to read.
//!
//! A [`Scene`] holds every mesh in world space, every texture decoded and every default filled in, so that whoever
//! draws it needs neither files nor rules.

mod auto_uv;
mod builtin;
pub mod description;
mod details;
mod fingerprint;
mod framing;
mod gltf_materials;
mod gltf_scene;
mod load;
mod materials;
mod measured;
mod mtl_materials;
mod plain_model;
mod resolve;
mod smooth;
pub mod text;
mod texture_lookup;
mod textures;

pub use pointillist_micropoint::Occlusion;
pub use pointillist_shadow::Resolution;
pub use pointillist_view::Projection;

pub use builtin::builtin;
pub use description::{Description, parse_str};
pub use details::{Bump, BumpHeight, Channel, Details, Map, Surroundings, Transmission};
pub use fingerprint::{
    of_geometry as geometry_fingerprint, of_light as light_fingerprint, of_sources as source_fingerprint,
};
pub(crate) use framing::around as frame_around;
pub use load::{Overrides, load, load_to_bake};
pub use measured::MeasuredBrdf;
pub use text::Format;
pub use texture_lookup::{linear_from_srgb, srgb_from_linear};

use crate::input_error::InputError;
use glam::{DVec2, DVec3, Vec3};
use pointillist_shade as shade;
use pointillist_view::{View, ViewError};
use std::path::PathBuf;

/// No normal, no texture coordinate: the value of an index that refers to nothing.
pub const NONE: u32 = u32::MAX;

/// Everything that is needed to draw a picture.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Where the eye is.
    pub camera: Camera,
    /// The picture's size and what is behind everything.
    pub image: ImageSettings,
    /// How to draw.
    pub render: RenderSettings,
    /// All objects together, in world space.
    pub mesh: Mesh,
    /// What [`Mesh::material_of`] refers to; never empty.
    pub materials: Vec<Material>,
    /// What materials and [`ImageSettings::environment`] refer to.
    pub textures: Vec<Texture>,
    /// The lights, in the order of the file.
    pub lights: Vec<LightSource>,
    /// Light that does not come straight from the lights.
    pub ambient: AmbientLight,
    /// Materials of the scene file or of options that no mesh has. They are among the warnings, too.
    pub unmatched: Vec<InputError>,
    /// What was odd but not wrong, for the user to read.
    pub warnings: Vec<String>,
    /// A hash of everything above but what is there to be read: equal scenes draw equal pictures.
    pub fingerprint: u64,
}

/// Light that does not come straight from the lights.
#[derive(Clone, Debug)]
pub enum AmbientLight {
    /// The same everywhere, reflected as albedo · colour.
    Color(Vec3),
    /// By the normal, from a sky and a ground.
    Sky(SkyLight),
    /// Between baked probes, reflected as albedo/π · irradiance.
    Probes {
        /// The light.
        field: Box<pointillist_shprobe::Field>,
        /// A hash of the file.
        fingerprint: u64,
    },
    /// From [`ImageSettings::environment`] by the normal, reflected as albedo/π · irradiance.
    Environment,
    /// Baked on the scene's own triangles, reflected as albedo/π · irradiance.
    Radiosity {
        /// The light.
        light: Box<crate::radiosity::Lightmap>,
        /// A hash of the file.
        fingerprint: u64,
    },
}

/// Light from two half spaces of one radiance each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyLight {
    /// Radiance from above.
    pub sky: Vec3,
    /// Radiance from below.
    pub ground: Vec3,
    /// Unit vector away from the ground.
    pub up: Vec3,
}

impl SkyLight {
    /// Irradiance/π of a surface with this unit normal: it sees a share of (1 + cos)/2 of the sky, weighted by the cosine.
    pub fn seen_by(&self, normal: Vec3) -> Vec3 {
        self.ground.lerp(self.sky, 0.5 + 0.5 * normal.dot(self.up))
    }
}

/// Where the eye is and what it takes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position.
    pub eye: DVec3,
    /// Looked at; differs from `eye`.
    pub target: DVec3,
    /// Up in the picture; neither zero nor parallel to the view direction.
    pub up: DVec3,
    /// The kind of view.
    pub projection: Projection,
}

impl Camera {
    /// Right, up and backward: the axes of the camera in the world, orthonormal. The camera looks along −Z.
    pub fn axes(&self) -> [DVec3; 3] {
        let backward = (self.eye - self.target).normalize();
        let right = self.up.normalize().cross(backward).normalize();
        [right, backward.cross(right), backward]
    }

    /// The camera with a picture of this width and height in pixels.
    ///
    /// # Errors
    /// [`ViewError`] if a field is not as it says, or the picture is empty or larger than [`View::LARGEST_SIDE`].
    pub fn view(&self, [width, height]: [u32; 2]) -> Result<View, ViewError> {
        View::look_at(self.eye, self.target, self.up, self.projection, width, height)
    }
}

/// The picture's size and what is behind everything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageSettings {
    /// Pixels in a row; at least 1.
    pub width: u32,
    /// Rows; at least 1.
    pub height: u32,
    /// Linear colour where nothing is; alpha is 0 there.
    pub background: Vec3,
    /// Equirectangular texture in place of the colour.
    pub environment: Option<usize>,
}

/// How to draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderSettings {
    /// Cells per pixel side: 1, 2 or 4; `None` leaves it to the renderer.
    pub cells_per_pixel: Option<u32>,
    /// How pieces in a cell hide one another; `None` leaves it to the renderer.
    pub occlusion: Option<Occlusion>,
    /// What is interpolated across a triangle.
    pub shading: shade::Interpolation,
}

/// Triangles of all objects, concatenated and transformed into the world.
///
/// The four `…_of` lists are as long as `triangles`; `normal_of` and `uv_of` hold [`NONE`] in all three places where a
/// triangle has no normals or coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// World positions, all finite.
    pub positions: Vec<DVec3>,
    /// Linear factors on the diffuse albedo: none, or one for each position.
    pub colors: Vec<Vec3>,
    /// Corners, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals; empty with flat shading.
    pub normals: Vec<Vec3>,
    /// Corner normals.
    pub normal_of: Vec<[u32; 3]>,
    /// Texture coordinates, v upward.
    pub uvs: Vec<DVec2>,
    /// Corner coordinates.
    pub uv_of: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`].
    pub material_of: Vec<u32>,
    /// Index into `objects`.
    pub object_of: Vec<u32>,
    /// What each object was called and how it is treated.
    pub objects: Vec<Object>,
}

/// What the file says of one object.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// The mesh's file name, or a name given by code.
    pub name: String,
    /// Whether its back is drawn, too.
    pub two_sided: bool,
}

/// What a surface is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// As in the MTL or the scene file.
    pub name: String,
    /// Model and constants; with a map the constant is multiplied by the map.
    pub surface: shade::Material,
    /// Texture of the diffuse albedo.
    pub diffuse_map: Option<usize>,
    /// Texture whose alpha is the opacity.
    pub opacity_map: Option<usize>,
    /// What these two textures are outside the unit square.
    pub wrap: shade::Wrap,
    /// Everything else.
    pub details: Details,
}

impl Material {
    /// A material of constants alone.
    pub fn plain(name: impl Into<String>, surface: shade::Material) -> Self {
        Self {
            name: name.into(),
            surface,
            diffuse_map: None,
            opacity_map: None,
            wrap: shade::Wrap::Repeat,
            details: Details::default(),
        }
    }

    /// Whether any texture is looked up, so that texture coordinates matter.
    pub fn has_maps(&self) -> bool {
        self.diffuse_map.is_some() || self.opacity_map.is_some() || self.details.has_maps()
    }
}

/// A decoded picture; row 0 is the top, that is v = 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Texels in a row; at least 1.
    pub width: u32,
    /// Rows; at least 1.
    pub height: u32,
    /// Row-major, `width · height` of them.
    pub texels: Texels,
    /// Where it came from, for messages.
    pub path: PathBuf,
}

/// The texels of a [`Texture`] as they are stored; [`Texture::texel`] decodes them.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// sRGB-encoded colour with linear alpha.
    Srgb8(Vec<[u8; 4]>),
    /// Linear colour and alpha in 8 bits.
    Linear8(Vec<[u8; 4]>),
    /// One number that is the opacity: colour is white, alpha is the number.
    Opacity8(Vec<u8>),
    /// Linear colour and alpha.
    Float(Vec<[f32; 4]>),
}

/// A light of the scene and how its shadow is made.
#[derive(Clone, Debug, PartialEq)]
pub struct LightSource {
    /// Its `name`, or `light0`, `light1`… by position.
    pub name: String,
    /// What it sends out.
    pub light: shade::Light,
    /// Whether it casts shadows.
    pub shadow: bool,
    /// Cells of its shadow grid.
    pub resolution: Resolution,
}
