//! The built-in scene: a scene file like any other, with meshes and textures made by code.

mod shapes;
mod textures;

use super::generated::Generated;
use super::load::{Overrides, apply};
use super::text::{Document, Format};
use super::{Description, LoadedScene, resolve};
use crate::input_error::InputError;
use std::path::Path;

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
