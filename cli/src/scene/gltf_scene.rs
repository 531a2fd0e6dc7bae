//! A glTF file as part of a scene, or as the whole of it.

use super::description::CameraDescription;
use super::{LightSource, Projection};
use crate::input_error::InputError;
use crate::mesh_io::FileMesh;
use crate::mesh_io::gltf::{GltfModel, read_gltf};
use std::path::Path;

/// Reads a glTF and the buffers that it names, from its own folder.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<FileMesh, InputError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let open = |name: &str| {
        crate::memory::read(&folder.join(name)).map_err(|error| format!("cannot be read: {error}"))
    };
    read_gltf(&path.display().to_string(), bytes, &open)
}

/// The file's first camera, where neither a place nor a direction is given.
pub(super) fn camera(given: &CameraDescription, model: Option<&GltfModel>) -> CameraDescription {
    let first = model.and_then(|model| model.cameras.first());
    let Some(camera) = first.filter(|_| given.eye.is_none() && given.target.is_none()) else { return *given };
    let own = match camera.fov_y_rad {
        Some(fov_y_rad) if fov_y_rad > 0.0 && fov_y_rad < std::f64::consts::PI => {
            Some(Projection::Perspective { fov_y_rad })
        }
        None if camera.height > 0.0 => Some(Projection::Orthographic { height: camera.height }),
        _ => None,
    };
    CameraDescription {
        eye: Some(camera.eye),
        target: Some(camera.eye + camera.forward),
        up: camera.up,
        projection: given.projection.or(own),
    }
}

/// The file's lights, all with shadows.
pub(super) fn lights(model: &GltfModel) -> Vec<LightSource> {
    let name = |i: usize, name: &str| {
        let allowed = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        let twice = model.lights.iter().filter(|light| light.name == name).count() > 1;
        let usable = !name.is_empty() && name.chars().all(allowed) && !twice;
        if usable { name.to_owned() } else { format!("light{i}") }
    };
    let source = |(i, found): (usize, &crate::mesh_io::gltf::GltfLight)| {
        LightSource::new(name(i, &found.name), found.light)
    };
    model.lights.iter().enumerate().map(source).collect()
}
