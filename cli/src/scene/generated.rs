//! What a scene has that is made by code.

use super::Texture;
use super::textures::Purpose;
use crate::mesh_io::FileMesh;

/// Meshes and textures that are made instead of read.
pub(super) struct Generated {
    /// The mesh of that name.
    pub(super) mesh: fn(&str) -> Option<FileMesh>,
    /// Textures by name.
    pub(super) textures: Vec<(&'static str, Purpose, Texture)>,
}
