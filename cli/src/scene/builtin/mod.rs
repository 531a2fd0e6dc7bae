//! The built-in scene: a scene file like any other, with meshes and textures made by code.

mod shapes;
mod textures;

use super::load::{Overrides, apply};
use super::text::{Document, Format};
use super::textures::Purpose;
use super::{Description, LoadedScene, Texture, resolve};
use crate::input_error::InputError;
use crate::mesh_io::FileMesh;
use std::path::Path;

/// Meshes and textures that are made instead of read.
pub(super) struct Generated {
    /// The mesh of that name.
    pub(super) mesh: fn(&str) -> Option<FileMesh>,
    /// Textures by name.
    pub(super) textures: Vec<(&'static str, Purpose, Texture)>,
}

/// The scene that is drawn when none is given.
///
/// # Errors
///
/// Overrides that make no sense.
pub fn builtin(overrides: &Overrides) -> Result<LoadedScene, InputError> {
    let mut document = Document::parse("built-in scene", include_str!("scene.toml"), Format::Toml)?;
    apply(&mut document, overrides)?;
    let description = Description::new(document)?;
    let generated = Generated { mesh: shapes::by_name, textures: textures::all() };
    resolve::resolve(&description, Path::new(""), false, Some(generated))
}
