//! glTF 2.0, text and binary: meshes placed by their nodes, materials, textures, cameras and lights.
//!
//! Read with the schema checked by the `gltf` crate; buffers, accessors and images are read here, where every index is
//! checked again against the bytes that are there.

mod accessor;
mod bytes;
mod check;
mod material;
mod primitive;
mod walk;

pub use bytes::GltfBytes;
pub use material::{AlphaMode, GltfMaterial, GltfTexture};
pub use walk::{GltfCamera, GltfLight};

use super::FileMesh;
use crate::input;
use crate::input_error::InputError;
use crate::json_words::plain;
use ::gltf::json::Root;
use ::gltf::{Document, Gltf};
use bytes::Buffers;

/// What a glTF file holds beside its triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GltfModel {
    /// What [`FileMesh::material_names`] names, in the same order.
    pub materials: Vec<GltfMaterial>,
    /// The pictures, each as bytes or as a path relative to the file.
    pub images: Vec<GltfBytes>,
    /// Cameras in the order of their nodes.
    pub cameras: Vec<GltfCamera>,
    /// Lights in the order of their nodes.
    pub lights: Vec<GltfLight>,
    /// What was odd but not wrong.
    pub warnings: Vec<String>,
}

/// Extensions that change the picture and are understood.
const KNOWN: [&str; 5] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_materials_ior",
    material::TRANSFORM,
];

/// Reads a glTF; `name` is how messages call it, and `open` gives the bytes of a file that it names.
///
/// # Errors
///
/// Not a glTF, something that the specification forbids, an index out of range, a number that is not finite: with the
/// element at fault.
pub fn read_gltf(
    name: &str,
    bytes: &[u8],
    open: &dyn Fn(&str) -> Result<Vec<u8>, String>,
) -> Result<FileMesh, InputError> {
    input::not_empty(name, bytes)?;
    let fault = |message: String| InputError::of_file(name, message);
    check_header(bytes).map_err(fault)?;
    let gltf = parse(bytes).map_err(fault)?;
    let buffers = Buffers::read(&gltf, open).map_err(fault)?;
    let mut model = GltfModel::default();
    for extension in gltf.extensions_used().filter(|used| !KNOWN.contains(used)) {
        model.warnings.push(format!("{name}: the extension {extension} is not understood; ignored"));
    }
    for image in gltf.images() {
        model.images.push(bytes::image(&image, &buffers).map_err(fault)?);
    }
    material::read_all(&gltf, name, &mut model);
    let mut mesh = FileMesh::default();
    walk::walk(&gltf, &buffers, name, &mut mesh, &mut model).map_err(fault)?;
    mesh.material_names = model.materials.iter().map(|m| m.name.clone()).collect();
    mesh.gltf = Some(std::sync::Arc::new(model));
    Ok(mesh)
}

/// The lengths that a binary file states must be those that it has.
fn check_header(bytes: &[u8]) -> Result<(), String> {
    if !bytes.starts_with(b"glTF") {
        return Ok(());
    }
    let word =
        |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    match (word(8), word(12)) {
        (Some(whole), Some(json)) if whole <= bytes.len() && whole >= 20 && json <= whole - 20 => Ok(()),
        _ => Err("not a glTF: the file is cut off, or its header is wrong".to_owned()),
    }
}

/// Reads the document and checks it, first for what the schema's own check takes for granted.
fn parse(bytes: &[u8]) -> Result<Gltf, String> {
    let wrong = |error: &dyn std::fmt::Display| format!("not a glTF: {error}");
    let not_json = |error: ::gltf::json::Error| {
        let what = plain(&error.to_string());
        let subject = if what.starts_with("is ") { "what stands there " } else { "" };
        format!("not a glTF: line {}, column {}: {subject}{what}", error.line(), error.column())
    };
    let (json, blob) = if bytes.starts_with(b"glTF") {
        let glb = ::gltf::Glb::from_slice(bytes).map_err(|e| wrong(&e))?;
        (glb.json, glb.bin.map(std::borrow::Cow::into_owned))
    } else {
        (bytes.into(), None)
    };
    let root: Root = ::gltf::json::deserialize::from_slice(&json).map_err(not_json)?;
    check::check(&root)?;
    let document = Document::from_json(root).map_err(|e| wrong(&e))?;
    Ok(Gltf { document, blob })
}
