//! One cell, prepared for queries: the map from a position to barycentric coordinates, and what lies beyond each side.

use glam::DVec3;

/// Bit that marks a neighbour's number as that of a facet of the hull.
pub(crate) const HULL: u32 = 1 << 31;

/// A tetrahedron, or a triangle or segment, whose unused corners have weight 0 everywhere.
///
/// 128 bytes, two cache lines: a step of a walk touches nothing else.
#[derive(Clone, Copy, Debug)]
#[repr(align(128))]
pub(crate) struct Simplex {
    /// The last corner.
    origin: DVec3,
    /// Barycentric coordinate k is `rows[k] · (p − origin)`; the last is what is left of 1.
    rows: [DVec3; 3],
    /// What lies beyond the side opposite each corner: a cell, or with [`HULL`] set a facet.
    pub(crate) neighbours: [u32; 4],
    /// Points.
    pub(crate) corners: [u32; 4],
}

impl Simplex {
    /// Of four corners, `neighbours[k]` opposite corner k.
    pub(crate) fn tetrahedron(points: &[DVec3], corners: [u32; 4], neighbours: [u32; 4]) -> Self {
        let origin = points[corners[3] as usize];
        let ([a, b, c], unscale) = edges([0, 1, 2].map(|k| points[corners[k] as usize] - origin));
        let volume = a.dot(b.cross(c));
        let rows = [b.cross(c), c.cross(a), a.cross(b)].map(|r| r / volume * unscale);
        Self { origin, rows, neighbours, corners }
    }

    /// Of three corners; positions off its plane count as their projections.
    pub(crate) fn triangle(points: &[DVec3], [i, j, k]: [u32; 3], [ni, nj, nk]: [u32; 3]) -> Self {
        let origin = points[k as usize];
        let ([a, b, _], unscale) =
            edges([points[i as usize] - origin, points[j as usize] - origin, DVec3::ZERO]);
        let normal = a.cross(b);
        let (across_a, across_b) = (b.cross(normal), normal.cross(a));
        let rows = [across_a / a.dot(across_a) * unscale, across_b / b.dot(across_b) * unscale, DVec3::ZERO];
        Self { origin, rows, neighbours: [ni, nj, HULL, nk], corners: [i, j, i, k] }
    }

    /// Of two corners; positions off its line count as their projections.
    pub(crate) fn segment(points: &[DVec3], [i, j]: [u32; 2], [ni, nj]: [u32; 2]) -> Self {
        let origin = points[j as usize];
        let ([a, ..], unscale) = edges([points[i as usize] - origin, DVec3::ZERO, DVec3::ZERO]);
        let rows = [a / a.length_squared() * unscale, DVec3::ZERO, DVec3::ZERO];
        Self { origin, rows, neighbours: [ni, HULL, HULL, nj], corners: [i, i, i, j] }
    }

    /// Barycentric coordinates; they sum to 1 and are all at least 0 inside.
    #[inline]
    pub(crate) fn coordinates(&self, p: DVec3) -> [f64; 4] {
        let d = p - self.origin;
        let [a, b, c] = self.rows.map(|r| r.dot(d));
        [a, b, c, 1.0 - (a + b + c)]
    }
}

/// Edges resized by a power of two to about 1, so that products of three of them keep their digits, and that power.
fn edges(edges: [DVec3; 3]) -> ([DVec3; 3], f64) {
    let longest = edges.iter().fold(0.0_f64, |m, e| m.max(e.abs().max_element()));
    let scale = crate::scale::power_of_two_to_one(longest);
    (edges.map(|e| e * scale), scale)
}
