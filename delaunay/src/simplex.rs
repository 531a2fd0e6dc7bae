//! One cell, prepared for queries: the map from a position to barycentric coordinates, and what lies beyond each side.

use crate::vertices::Vertices;
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
    /// Barycentric coordinate k is `rows[k] · (p − origin)`; the last is what is left of 1. All NaN in a flat cell.
    rows: [DVec3; 3],
    /// What lies beyond the side opposite each corner: a cell, or with [`HULL`] set a facet.
    pub(crate) neighbours: [u32; 4],
    /// Points.
    pub(crate) corners: [u32; 4],
}

impl Simplex {
    /// Of four corners, `neighbours[k]` opposite corner k.
    pub(crate) fn tetrahedron(vertices: &Vertices, corners: [u32; 4], neighbours: [u32; 4]) -> Self {
        let origin = vertices.at(corners[3]);
        let ([a, b, c], unscale) = edges([0, 1, 2].map(|k| vertices.at(corners[k]) - origin));
        let volume = a.dot(b.cross(c));
        let areas = [b.cross(c), c.cross(a), a.cross(b)];
        let rows = unless_flat(areas.map(|area| area / volume), areas, unscale, vertices);
        Self { origin, rows, neighbours, corners }
    }

    /// Of three corners; positions off its plane count as their projections.
    pub(crate) fn triangle(vertices: &Vertices, [i, j, k]: [u32; 3], [ni, nj, nk]: [u32; 3]) -> Self {
        let origin = vertices.at(k);
        let ([a, b, _], unscale) = edges([vertices.at(i) - origin, vertices.at(j) - origin, DVec3::ZERO]);
        let normal = a.cross(b);
        let (across_a, across_b) = (b.cross(normal), normal.cross(a));
        let rows = [across_a / a.dot(across_a), across_b / b.dot(across_b), DVec3::ZERO];
        Self {
            origin,
            rows: unless_flat(rows, [normal; 3], unscale, vertices),
            neighbours: [ni, nj, HULL, nk],
            corners: [i, j, i, k],
        }
    }

    /// Of two corners; positions off its line count as their projections.
    pub(crate) fn segment(vertices: &Vertices, [i, j]: [u32; 2], [ni, nj]: [u32; 2]) -> Self {
        let origin = vertices.at(j);
        let ([a, ..], unscale) = edges([vertices.at(i) - origin, DVec3::ZERO, DVec3::ZERO]);
        let rows = [a / a.length_squared() * unscale, DVec3::ZERO, DVec3::ZERO];
        Self { origin, rows, neighbours: [ni, HULL, HULL, nj], corners: [i, i, i, j] }
    }

    /// Whether all its coordinates are NaN.
    #[inline]
    pub(crate) fn is_flat(&self) -> bool {
        self.rows[0].x.is_nan()
    }

    /// What lies beyond each of its sides.
    pub(crate) fn beyond(&self) -> impl Iterator<Item = u32> {
        // Corners of triangles and segments that repeat the first are opposite no side.
        let has_side = |k: &usize| *k == 0 || self.corners[*k] != self.corners[0];
        (0..4).filter(has_side).map(|k| self.neighbours[k])
    }

    /// Barycentric coordinates; they sum to 1 and are all at least 0 inside.
    #[inline]
    pub(crate) fn coordinates(&self, p: DVec3) -> [f64; 4] {
        let d = p - self.origin;
        let [a, b, c] = self.rows.map(|r| r.dot(d));
        [a, b, c, 1.0 - (a + b + c)]
    }
}

/// Rows of a cell whose longest edge is about 1, for its true size; NaN if it is flat. `areas` are vectors as long as its sides are large.
fn unless_flat(rows: [DVec3; 3], areas: [DVec3; 3], unscale: f64, vertices: &Vertices) -> [DVec3; 3] {
    let least = vertices.flat_below(1.0 / unscale) * unscale;
    let with_last = |of: [DVec3; 3]| [of[0], of[1], of[2], of[0] + of[1] + of[2]];
    // The inverse of a row's length is a height. Where a side is a line up to rounding, its direction, and so the height, is none.
    let has_height = |row: DVec3| row.length_squared() * (least * least) < 1.0;
    let has_area = |area: DVec3| area.length_squared() > least * least;
    let is_sound = with_last(rows).into_iter().all(has_height) && with_last(areas).into_iter().all(has_area);
    rows.map(|row| if is_sound { row * unscale } else { DVec3::NAN })
}

/// Edges resized by a power of two to about 1, so that products of three of them keep their digits, and that power.
fn edges(edges: [DVec3; 3]) -> ([DVec3; 3], f64) {
    let longest = edges.iter().fold(0.0_f64, |m, e| m.max(e.abs().max_element()));
    let scale = crate::scale::power_of_two_to_one(longest);
    (edges.map(|e| e * scale), scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A corner over the middle of the other three: its height is the least, a third of theirs.
    #[test]
    fn a_cell_is_flat_if_any_one_height_is() {
        let flat = |middle: usize, height: f64| {
            let (x, y) = (-0.5, 0.75_f64.sqrt());
            let mut corners = vec![[1.0, 0.0], [x, y], [x, -y]].into_iter();
            let position = |k| {
                if k == middle {
                    DVec3::Z * height
                } else {
                    corners.next().map_or(DVec3::NAN, |[x, y]| DVec3::new(x, y, 0.0))
                }
            };
            let positions: Vec<DVec3> = (0..4).map(position).collect();
            Simplex::tetrahedron(&Vertices::new(&positions, DVec3::ZERO, 1.0), [0, 1, 2, 3], [HULL; 4])
                .is_flat()
        };
        for middle in 0..4 {
            assert!(flat(middle, 0.6e-9) && flat(middle, -0.6e-9), "{middle}");
            assert!(!flat(middle, 2.4e-9) && !flat(middle, -2.4e-9), "{middle}");
        }
    }
}
