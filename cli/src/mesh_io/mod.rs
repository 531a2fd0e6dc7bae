//! Meshes from files: OBJ with MTL, PLY, and glTF.
//!
//! Readers take bytes and give a [`FileMesh`] or an error with its line; they open no files.

pub mod gltf;
mod mtl;
mod mtl_keys;
mod mtl_map;
mod names;
mod obj;
mod obj_index;
mod obj_lines;
mod obj_plain;
mod ply;
mod ply_records;
mod triangulate;

pub use mtl::{MtlMaterial, read_mtl};
pub use mtl_keys::{Reading, mtl_keys, mtl_options};
pub use mtl_map::MtlMap;
pub use names::names_of;
pub use obj::read_obj;
pub use ply::read_ply;
pub use triangulate::triangulate;

use glam::{DVec2, DVec3, Vec3};

/// A mesh as its file has it, cut into triangles. Indices are within range; [`crate::scene::NONE`] means "none".
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileMesh {
    /// All finite.
    pub positions: Vec<DVec3>,
    /// Corners.
    pub triangles: Vec<[u32; 3]>,
    /// As in the file; not always of unit length.
    pub normals: Vec<Vec3>,
    /// For each triangle.
    pub normal_of: Vec<[u32; 3]>,
    /// Texture coordinates, v upward.
    pub uvs: Vec<DVec2>,
    /// For each triangle.
    pub uv_of: Vec<[u32; 3]>,
    /// A second set of coordinates, among `uvs`: empty, or for each triangle.
    pub second_uv_of: Vec<[u32; 3]>,
    /// For each triangle, an index into `material_names`.
    pub material_of: Vec<u32>,
    /// Names of materials in the order of their first use.
    pub material_names: Vec<String>,
    /// Files that should define them.
    pub material_files: Vec<String>,
    /// Linear colours that multiply the diffuse albedo: none, or one for each position.
    pub colors: Vec<Vec3>,
    /// What a glTF holds besides.
    pub gltf: Option<std::sync::Arc<gltf::GltfModel>>,
}
