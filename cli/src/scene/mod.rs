//! Scenes: what a file describes, resolved until nothing is left to read.
//!
//! What comes out is a [`Scene`] of `pointillist-render`, with every mesh in world space, every texture decoded and every default
//! filled in, so that whoever draws it needs neither files nor rules.

mod ambient;
mod auto_uv;
mod builtin;
mod copies;
pub mod description;
mod framing;
mod generated;
mod gltf_materials;
mod gltf_scene;
mod load;
mod materials;
mod measured;
mod motion;
mod mtl_library;
mod mtl_materials;
mod no_effect;
mod objects;
mod plain_model;
mod resolve;
mod smooth;
pub mod text;
mod texture_decoding;
mod texture_files;
mod textures;
pub mod weight;

pub use pointillist_render::{
    AmbientLight, Bump, BumpHeight, Camera, Channel, Details, LightSource, Map, MapPlace, Material,
    MeasuredBrdf, Mesh, NONE, Object, Occlusion, Projection, Resolution, Scene, SkyLight, Surroundings,
    Texels, Texture, Transmission, UvSet, linear_from_srgb, srgb_from_linear,
};

pub use builtin::builtin;
pub use description::{Description, parse_str};
pub(crate) use framing::{MARGIN as FRAME_MARGIN, around as frame_around, distance_to as framing_distance};
pub use load::{Overrides, is_model, load, load_to_bake};
pub use motion::Motion;
pub(crate) use plain_model::key_light;
pub use text::Format;

use crate::input_error::InputError;

/// A scene, and what was noticed while it was read.
#[derive(Clone, Debug)]
pub struct LoadedScene {
    /// What is drawn.
    pub scene: Scene,
    /// Materials of the scene file or of options that no mesh has. They are among the warnings, too.
    pub unmatched: Vec<InputError>,
    /// What was odd but not wrong, for the user to read.
    pub warnings: Vec<String>,
    /// A hash of the scene: equal scenes draw equal pictures.
    pub fingerprint: u64,
    /// The same of all but the camera and the size of the picture.
    pub light: u64,
    /// What of it moves. The scene is that of frame 0.
    pub motion: Motion,
    /// Whether the only light is one that was added, and comes from beside the camera.
    pub is_lit_from_camera: bool,
}
