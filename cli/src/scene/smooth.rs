//! Vertex normals for triangles whose file has none.

use super::{Mesh, NONE};
use pointillist_shade::{CornerNormals, Weighting, corner_normals, vertex_normals};
use std::collections::HashMap;

/// Gives the triangles from `first_triangle` on that have no normals the means of the faces at their corners, on this side
/// of edges that are folded by more than `crease_rad`.
///
/// Whether there were such triangles comes back.
///
/// Corners at the same position are one vertex: files repeat positions where the material changes, and there the
/// surface goes on. (A file that repeats them to mark a crease has normals, or should.)
pub(super) fn fill(
    mesh: &mut Mesh,
    first_triangle: usize,
    first_position: usize,
    weighting: Weighting,
    crease_rad: Option<f64>,
) -> bool {
    if !mesh.normal_of[first_triangle..].contains(&[NONE; 3]) {
        return false;
    }
    let positions = &mesh.positions[first_position..];
    let mut vertex_at: HashMap<[u64; 3], u32> = HashMap::with_capacity(positions.len());
    let mut places = Vec::new();
    let vertex_of: Vec<u32> = positions
        .iter()
        .map(|&p| {
            // Adding zero makes −0 and 0 the same bits.
            let bits = (p + 0.0).to_array().map(f64::to_bits);
            *vertex_at.entry(bits).or_insert_with(|| {
                places.push(p);
                places.len() as u32 - 1
            })
        })
        .collect();
    let vertex = |position: u32| vertex_of[position as usize - first_position];
    let bare: Vec<usize> =
        (first_triangle..mesh.triangles.len()).filter(|&t| mesh.normal_of[t] == [NONE; 3]).collect();
    let triangles: Vec<[u32; 3]> = bare.iter().map(|&t| mesh.triangles[t].map(vertex)).collect();
    let CornerNormals { normals, normal_of } = match crease_rad {
        Some(crease) => corner_normals(&places, &triangles, weighting, crease),
        None => vertex_normals(&places, &triangles, weighting)
            .map(|normals| CornerNormals { normals, normal_of: triangles }),
    }
    .expect("positions and indices were checked when the mesh was read");
    let base = mesh.normals.len() as u32;
    mesh.normals.extend(normals);
    for (&t, corners) in bare.iter().zip(&normal_of) {
        mesh.normal_of[t] = corners.map(|corner| base + corner);
    }
    true
}
