//! Masked triangles that coincide: the two sides of a leaf that is modelled as two cards back to back.
//!
//! Where one of them has a hole the other has it, too: together they hide as much as one. As two layers that know nothing of each other they
//! would hide `1 − (1 − a)²` of what is behind, for a mean opacity of a. So only the first of them is kept, and from behind it shows the
//! normals of the one that is turned the other way.

use crate::scene::Mesh;
use glam::DVec2;
use std::collections::HashMap;

/// Three corners as bits of their positions and texture coordinates, sorted: the same for both sides of a card.
type Corners = [[u64; 7]; 3];

/// A triangle that has the place, texture coordinates and surface of an earlier one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaskedCopy {
    pub(crate) triangle: u32,
    /// The first of its kind.
    pub(crate) original: u32,
}

/// All copies among a mesh's own triangles, rising. `uvs` tells a triangle's texture coordinates in both sets, `surface` its surface if it is
/// masked and seen from both sides; other triangles have no copies.
pub(crate) fn masked_copies(
    mesh: &Mesh,
    uvs: impl Fn(usize) -> [[DVec2; 3]; 2],
    surface: impl Fn(usize) -> Option<u32>,
) -> Vec<MaskedCopy> {
    let mut first: HashMap<(u32, Corners), u32> = HashMap::new();
    let mut copies = vec![];
    for t in 0..mesh.triangles.len() {
        let Some(surface) = surface(t) else { continue };
        let triangle = t as u32;
        let original = *first.entry((surface, corners(mesh, uvs(t), t))).or_insert(triangle);
        if original != triangle {
            copies.push(MaskedCopy { triangle, original });
        }
    }
    copies
}

/// The other side of a card.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OtherSide {
    /// How much larger its number is than that of the first side.
    pub(crate) ahead: u32,
    /// For each corner of the first side, the corner of this one that is in its place.
    pub(crate) corners: [usize; 3],
}

/// The triangles that are turned the other way, by those whose copies they are.
pub(crate) fn other_sides(mesh: &Mesh, copies: &[MaskedCopy]) -> HashMap<u32, OtherSide> {
    let places = |t: u32| mesh.triangles[t as usize].map(|v| mesh.positions[v as usize]);
    let side = |&MaskedCopy { triangle, original }: &MaskedCopy| {
        let there = places(triangle);
        let [a, b, c] = places(original).map(|p| there.iter().position(|&q| q == p));
        let corners = [a?, b?, c?];
        let turned = matches!(corners, [0, 2, 1] | [2, 1, 0] | [1, 0, 2]);
        turned.then_some((original, OtherSide { ahead: triangle - original, corners }))
    };
    copies.iter().filter_map(side).collect()
}

fn corners(mesh: &Mesh, [first, second]: [[DVec2; 3]; 2], triangle: usize) -> Corners {
    let vertices = mesh.triangles[triangle];
    let mut corners = [0, 1, 2].map(|k: usize| {
        let (p, a, b) = (mesh.positions[vertices[k] as usize], first[k], second[k]);
        // −0 is 0.
        [p.x, p.y, p.z, a.x, a.y, b.x, b.y].map(|v| (v + 0.0).to_bits())
    });
    corners.sort_unstable();
    corners
}
