//! The MTL files that a mesh names.

use crate::input;
use crate::input_error::InputError;
use crate::mesh_io::{FileMesh, MtlMaterial, names_of, read_mtl};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// An MTL, read.
pub(super) struct Library {
    pub(super) path: PathBuf,
    pub(super) bytes: Vec<u8>,
    pub(super) materials: Vec<MtlMaterial>,
}

/// The MTL files of a mesh; one that is not there is a warning.
pub(super) fn read_libraries(
    file: &FileMesh,
    mesh: &Path,
    warnings: &mut Vec<String>,
) -> Result<Vec<Library>, InputError> {
    let folder = mesh.parent().unwrap_or(Path::new(""));
    // By path, so that a library that is named in front of every group is read once.
    let mut libraries: BTreeMap<PathBuf, Library> = BTreeMap::new();
    for names in &file.material_files {
        // `mtllib a b` may be two files or one with a space in its name; quotes settle it.
        let whole = folder.join(names);
        let paths = if whole.exists() {
            vec![whole]
        } else {
            names_of(names).into_iter().map(|name| folder.join(name.replace('\\', "/"))).collect()
        };
        for path in paths {
            if libraries.contains_key(&path) {
                continue;
            }
            if !path.exists() {
                let message = format!("{}: `{}` is not there", mesh.display(), path.display());
                if !warnings.contains(&message) {
                    warnings.push(message);
                }
                continue;
            }
            let bytes = input::read(&path)?;
            let materials = read_mtl(&path.display().to_string(), &bytes)?;
            libraries.insert(path.clone(), Library { path, bytes, materials });
        }
    }
    Ok(libraries.into_values().collect())
}
