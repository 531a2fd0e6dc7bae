//! Masked triangles that coincide: the two sides of a leaf that is modelled as two cards back to back.
//!
//! Where one of them has a hole the other has it, too: together they hide as much as one. As two layers that know nothing of each other they
//! would hide `1 − (1 − a)²` of what is behind, for a mean opacity of a. So only the first of them is kept.

use crate::scene::Mesh;
use crate::uvs::Uvs;
use std::collections::HashSet;

/// Three corners as bits of their positions and texture coordinates, sorted: the same for both sides of a card.
type Corners = [[u64; 5]; 3];

/// The triangles that have the place, texture coordinates and surface of an earlier one, rising. `surface` tells a triangle's surface if it is
/// masked and seen from both sides; other triangles have no copies.
pub(crate) fn masked_copies(mesh: &Mesh, uvs: &Uvs, surface: impl Fn(usize) -> Option<u32>) -> Vec<u32> {
    let mut known: HashSet<(u32, Corners)> = HashSet::new();
    let masked = (0..mesh.triangles.len()).filter_map(|t| surface(t).map(|surface| (t, surface)));
    masked.filter(|&(t, s)| !known.insert((s, corners(mesh, uvs, t)))).map(|(t, _)| t as u32).collect()
}

fn corners(mesh: &Mesh, uvs: &Uvs, triangle: usize) -> Corners {
    let uv = uvs.of(triangle as u32);
    let vertices = mesh.triangles[triangle];
    let mut corners = [0, 1, 2].map(|k: usize| {
        let (p, uv) = (mesh.positions[vertices[k] as usize], uv[k]);
        // −0 is 0.
        [p.x, p.y, p.z, uv.x, uv.y].map(|v| (v + 0.0).to_bits())
    });
    corners.sort_unstable();
    corners
}
