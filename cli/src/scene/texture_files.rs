//! Textures that a scene file names.

use super::description::{Description, EnvironmentReference, FileReference, TextureReference};
use super::textures::{Purpose, TextureTable, Tone};
use crate::input_error::InputError;
use std::path::{Path, PathBuf};

/// The number of a texture that the scene file names.
pub(super) fn load_texture(
    textures: &mut TextureTable,
    description: &Description,
    folder: &Path,
    reference: &TextureReference,
    purpose: Purpose,
) -> usize {
    let path = reference.file.path_from(folder);
    let [base, gain] = reference.base_and_gain;
    textures.load(&path, purpose, Tone { base, gain }, || fault(description, &path, &reference.file))
}

/// The number of a map of all directions that the scene file names.
pub(super) fn load_environment(
    textures: &mut TextureTable,
    description: &Description,
    folder: &Path,
    reference: &EnvironmentReference,
) -> usize {
    let mut files: Vec<(PathBuf, InputError)> = reference
        .files
        .iter()
        .map(|file| {
            let path = file.path_from(folder);
            let fault = fault(description, &path, file);
            (path, fault)
        })
        .collect();
    if files.len() > 1 {
        return textures.load_cube(files, Tone::PLAIN);
    }
    let (path, fault) = files.swap_remove(0);
    textures.load(&path, Purpose::Surroundings, Tone::PLAIN, || fault)
}

/// The beginning of an error.
fn fault(description: &Description, path: &Path, file: &FileReference) -> InputError {
    let error = description.document.error(file.span, format!("texture `{}` ", path.display()));
    error.with_help(format!("{}; PNG, JPEG, HDR and EXR can be read", file.relative_to()))
}
