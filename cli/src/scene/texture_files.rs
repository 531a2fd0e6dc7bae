//! Textures that a scene file names.

use super::description::{Description, TextureReference};
use super::textures::{Purpose, TextureTable};
use crate::input_error::InputError;
use std::path::Path;

/// Loads a texture that the scene file names.
pub(super) fn load_texture(
    textures: &mut TextureTable,
    description: &Description,
    folder: &Path,
    reference: &TextureReference,
    purpose: Purpose,
) -> Result<usize, InputError> {
    let path = reference.file.path_from(folder);
    textures.load(&path, purpose).map_err(|fault| {
        let message = format!("texture `{}` {fault}", path.display());
        let error = description.document.error(reference.file.span, message);
        error.with_help(format!("{}; PNG, JPEG, HDR and EXR can be read", reference.file.relative_to()))
    })
}
