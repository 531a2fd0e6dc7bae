//! Textures that a scene file names.

use super::description::{Description, TextureReference};
use super::textures::{Purpose, TextureTable};
use std::path::Path;

/// The number of a texture that the scene file names.
pub(super) fn load_texture(
    textures: &mut TextureTable,
    description: &Description,
    folder: &Path,
    reference: &TextureReference,
    purpose: Purpose,
) -> usize {
    let path = reference.file.path_from(folder);
    textures.load(&path, purpose, || {
        let message = format!("texture `{}` ", path.display());
        let error = description.document.error(reference.file.span, message);
        error.with_help(format!("{}; PNG, JPEG, HDR and EXR can be read", reference.file.relative_to()))
    })
}
