//! The cells of one half that may not be cells of the whole.

use super::cell::{Cell, CellId, Vertex};
use super::mesh::Mesh;
use super::sites::Sites;
use glam::DVec3;

/// Spheres of flatter cells than this (six times the volume over the longest side cubed) are taken to reach everywhere.
const FLAT: f64 = 1e-6;

/// Radii are taken this much larger. Rounding moves what a sphere that is not [`FLAT`] reaches by about 1e-8 of its
/// radius.
const SLACK: f64 = 1e-6;

/// All cells whose sphere may hold a point of a box that lies outside the hull.
///
/// Those that do hold a given point are connected, and there is a ghost among them: so all are reached from ghosts.
pub(super) fn find(mesh: &Mesh, sites: &Sites, lo: DVec3, hi: DVec3) -> Vec<CellId> {
    let mut seen = vec![false; mesh.cells.len()];
    let mut found: Vec<CellId> = vec![];
    for (id, _) in mesh.live().filter(|(_, cell)| cell.is_ghost()) {
        if reaches(mesh, sites, id, lo, hi) {
            seen[id.slot()] = true;
            found.push(id);
        }
    }
    let mut next = 0;
    while let Some(&id) = found.get(next) {
        next += 1;
        for link in mesh.cell(id).links {
            let beyond = link.cell();
            if !std::mem::replace(&mut seen[beyond.slot()], true) && reaches(mesh, sites, beyond, lo, hi) {
                found.push(beyond);
            }
        }
    }
    found
}

/// Notes on which side the corners of these cells are.
pub(super) fn mark_corners(mesh: &Mesh, cells: &[CellId], sides: &mut [u8], side: u8) {
    cells.iter().flat_map(|&id| mesh.cell(id).corners).for_each(|v| sides[v.slot()] = side);
    sides[Vertex::INFINITE.slot()] = 0;
}

/// Whether the sphere of a cell may hold a point of a box.
fn reaches(mesh: &Mesh, sites: &Sites, id: CellId, lo: DVec3, hi: DVec3) -> bool {
    let Cell { corners, links } = *mesh.cell(id);
    let [a, b, c, d] = corners;
    if d != Vertex::INFINITE {
        return sphere_reaches(corners.map(|v| sites.position(v)), lo, hi);
    }
    let (beyond, error) = sites.reach_beyond([a, b, c], lo, hi);
    // With exact integers a box that touches the plane is told from one that does not; then the tetrahedron behind
    // decides.
    if beyond == 0.0 && error == 0.0 {
        return reaches(mesh, sites, links[3].cell(), lo, hi);
    }
    beyond >= -error
}

/// Whether the sphere through four points may reach a box.
fn sphere_reaches([a, b, c, d]: [DVec3; 4], lo: DVec3, hi: DVec3) -> bool {
    let (b, c, d) = (b - a, c - a, d - a);
    let longest = b.abs().max(c.abs()).max(d.abs()).max_element();
    let volume = b.cross(c).dot(d);
    if volume <= FLAT * longest.powi(3) {
        return true;
    }
    let sum =
        b.length_squared() * c.cross(d) + c.length_squared() * d.cross(b) + d.length_squared() * b.cross(c);
    let to_centre = sum / (2.0 * volume);
    // All relative to a corner: cells may be as small as the last bit of their coordinates.
    let gap = ((lo - a) - to_centre).max(to_centre - (hi - a)).max(DVec3::ZERO);
    gap.length() <= to_centre.length() * (1.0 + SLACK)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    /// The centre of this sphere, rounded to the last bit of a coordinate, lies elsewhere than within its radius.
    #[test]
    fn spheres_as_small_as_the_last_bit_reach_what_they_hold() {
        let (one, two) = (1.0 + f64::EPSILON, 2.0 + 2.0 * f64::EPSILON);
        let a = dvec3(2.0, 9.00809793360029e-17, one);
        let b = dvec3(2.0, 8.543192150432817e-16, 1.0);
        let c = dvec3(two, 3.2932228074385277e-16, 1.0 + 4.0 * f64::EPSILON);
        let d = dvec3(two, 8.347697525911008e-16, one);
        let held = dvec3(2.0, 6.121358947948824e-16, 1.0);
        assert!((b - a).cross(c - a).dot(d - a) > 0.0);
        assert!(sphere_reaches([a, b, c, d], held, held));
    }
}
