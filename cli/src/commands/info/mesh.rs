//! Meshes.

use super::bounds;
use super::ply;
use super::survey::Survey;
use crate::cloud_io;
use crate::input;
use crate::input_error::InputError;
use crate::memory;
use crate::mesh_io::gltf::read_gltf;
use crate::mesh_io::{FileMesh, read_ply};
use serde_json::{Value, json};
use std::path::Path;

pub(super) fn of_mesh(format: &str, mesh: &FileMesh) -> Value {
    json!({
        "kind": "mesh",
        "format": format,
        "vertices": mesh.positions.len(),
        "triangles": mesh.triangles.len(),
        "normals": mesh.normals.len(),
        "texture_coordinates": mesh.uvs.len(),
        "materials": mesh.material_names.iter().filter(|name| !name.is_empty()).collect::<Vec<_>>(),
        "material_files": mesh.material_files,
        "bounds": bounds(mesh.positions.iter().copied()),
    })
}

pub(super) fn of_gltf(format: &str, name: &str, path: &Path, bytes: &[u8]) -> Result<Value, InputError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let open =
        |file: &str| memory::read(&folder.join(file)).map_err(|error| format!("cannot be read: {error}"));
    let mesh = read_gltf(name, bytes, &open)?;
    let mut value = of_mesh(format, &mesh);
    if let Some(model) = &mesh.gltf {
        value["images"] = json!(model.images.len());
        value["cameras"] = json!(model.cameras.len());
        value["lights"] = json!(model.lights.len());
        value["warnings"] = json!(model.warnings);
    }
    Ok(value)
}

/// A mesh if it has faces, a cloud if it has only points; of any other PLY, what its header says.
pub(super) fn of_ply(path: &Path, name: &str) -> Result<Value, InputError> {
    let mut bytes = input::read(path)?;
    if bytes.starts_with(b"\x1f\x8b") {
        bytes = cloud_io::unpack(name, &bytes)?;
    }
    let elements = ply::elements(name, &bytes)?;
    let mut value = if ply::has_positions(&elements) {
        let survey = Survey::of(path)?;
        if survey.summary.faces == 0 { survey.to_json() } else { of_mesh("ply", &read_ply(name, &bytes)?) }
    } else {
        json!({ "kind": "ply", "format": "ply", "warnings": ["it has no positions, so no command draws it"] })
    };
    value["elements"] = elements;
    Ok(value)
}
