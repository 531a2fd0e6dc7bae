//! Texture coordinates for triangles that need them and have none.

use super::{Material, Mesh, NONE, UvSet};
use crate::mesh_io::FileMesh;
use glam::DVec3;
use pointillist_shade::{AutoUv, face_normal};

/// Which texture coordinates a mesh does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lacking {
    /// Any.
    All,
    /// A second set.
    Second,
}

/// Gives the triangles from `first_triangle` on coordinates made from the file's own positions (before they are placed in
/// the world), where their material asks for it. Where it only has maps and the file has no coordinates, the box's are made
/// and `warn` is told the material's name, once for each; likewise
/// where a map asks for a second set and there is none, in whose place the first counts.
pub(super) fn fill(
    mesh: &mut Mesh,
    file: &FileMesh,
    first_triangle: usize,
    materials: &[Material],
    mut warn: impl FnMut(&str, Lacking),
) {
    let mut warned: Vec<u32> = Vec::new();
    if file.second_uv_of.is_empty() {
        for &number in &mesh.material_of[first_triangle..] {
            let material = &materials[number as usize];
            if material.uses(UvSet::Second) && !warned.contains(&number) {
                warned.push(number);
                warn(&material.name, Lacking::Second);
            }
        }
        warned.clear();
    }
    let mut bounds = None;
    for t in first_triangle..mesh.triangles.len() {
        let number = mesh.material_of[t];
        let material = &materials[number as usize];
        let bare = mesh.uv_of[t].contains(&NONE);
        let kind = match material.details.uv {
            Some(kind) => kind,
            None if bare && material.has_maps() => AutoUv::Box,
            None => continue,
        };
        if material.details.uv.is_none() && !warned.contains(&number) {
            warned.push(number);
            warn(&material.name, Lacking::All);
        }
        let corners = file.triangles[t - first_triangle].map(|v| file.positions[v as usize]);
        let (low, high) = *bounds.get_or_insert_with(|| box_of(file));
        let normal = face_normal(corners[0], corners[1], corners[2]);
        let uv = kind.corners(low, high, corners, normal);
        let base = mesh.uvs.len() as u32;
        // A mirrored object has its corners in another order than its file.
        let file_order = file.triangles[t - first_triangle];
        let offset = mesh.triangles[t][0] - file_order[0];
        mesh.uv_of[t] = mesh.triangles[t].map(|v| {
            let k = file_order.iter().position(|&f| f + offset == v).unwrap_or(0);
            base + k as u32
        });
        mesh.uvs.extend(uv);
    }
}

fn box_of(file: &FileMesh) -> (DVec3, DVec3) {
    let corners = file.triangles.iter().flatten().map(|&v| file.positions[v as usize]);
    corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}
