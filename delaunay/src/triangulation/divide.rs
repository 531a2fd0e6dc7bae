//! Meshes built in halves on several threads, then joined (after Funke and Sanders).
//!
//! 1. The vertices are divided by a plane, and both halves are triangulated at the same time. A cell of either half
//!    whose sphere holds no vertex of the other half is a cell of the whole.
//! 2. The other cells are the *border*. Their vertices are triangulated once more, together.
//! 3. A cell of that triangulation with corners in both halves is a cell of the whole: if its sphere were not empty,
//!    inserting one half into the other would not have touched all of its corners. One with all corners in one half is
//!    a cell of the whole if it was a cell of the border before.
//!
//! The parts fit together because there is one triangulation only, also of points on a common sphere. Triangulating the
//! border takes an eighth of the whole work more at a million points, and a third more at a hundred thousand.

use super::border;
use super::cell::{CellId, Vertex};
use super::incremental::{self, Same};
use super::mesh::Mesh;
use super::seam::Seam;
use super::simplex::Simplex;
use super::sites::Sites;
use crate::{DelaunayError, parallel};
use glam::DVec3;
use std::cmp::Ordering;

/// Parts of fewer vertices are not divided: too many of them would be border.
const MIN_VERTICES: usize = 20_000;

/// How often this number of vertices is divided: at most until there is a part for each thread.
pub(super) fn depth(vertices: usize) -> u32 {
    let parts = parallel::threads().next_power_of_two().min((vertices / MIN_VERTICES).max(1));
    parts.ilog2()
}

/// Vertices of which the median divides all.
const SAMPLES: usize = 1023;

/// Half of the vertices, its mesh, and the box that holds it.
struct Half {
    mesh: Mesh,
    same: Same,
    lo: DVec3,
    hi: DVec3,
}

/// The mesh of these vertices, which span space if there are first ones, in up to 2 to the power of `depth` parts.
pub(super) fn mesh(
    sites: &Sites,
    vertices: &[Vertex],
    first: Option<[Vertex; 4]>,
    depth: u32,
) -> Result<Option<(Mesh, Same)>, DelaunayError> {
    let whole = || {
        let found = first.or_else(|| match Simplex::new(sites, vertices) {
            Simplex::Space(first) => Some(first),
            _ => None,
        });
        found.map(|first| incremental::mesh(sites, vertices, first)).transpose()
    };
    // Fewer than four points span no space.
    if depth == 0 || vertices.len() < 4 || !sites.are_positions_exact() {
        return whole();
    }
    let (below, above) = split(sites, vertices);
    let half = |part: &[Vertex]| -> Result<Option<Half>, DelaunayError> {
        let (lo, hi) = bounds(sites, part);
        let built = mesh(sites, part, None, depth - 1)?;
        Ok(built.map(|(mesh, same)| Half { mesh, same, lo, hi }))
    };
    let (below, above) = parallel::join(|| half(&below), || half(&above));
    let joined = match (below?, above?) {
        (Some(below), Some(above)) => join(sites, below, above)?,
        // A half that lies in a plane has no cells of its own.
        _ => None,
    };
    joined.map_or_else(whole, |joined| Ok(Some(joined)))
}

fn bounds(sites: &Sites, vertices: &[Vertex]) -> (DVec3, DVec3) {
    let positions = vertices.iter().map(|&v| sites.position(v));
    positions.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

/// Lexicographic order from this axis on: that along a line which is hardly tilted from the axis, so that a plane
/// divides what comes before a point from what does not.
fn compare_from(axis: usize, a: DVec3, b: DVec3) -> Ordering {
    let turned = |p: DVec3| [p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]];
    turned(a).partial_cmp(&turned(b)).expect("positions are finite")
}

/// Those before some median along the longest axis, and the rest, each in the same order as all.
fn split(sites: &Sites, vertices: &[Vertex]) -> (Vec<Vertex>, Vec<Vertex>) {
    let (lo, hi) = bounds(sites, vertices);
    let axis = (hi - lo).max_position();
    let mut sample: Vec<DVec3> =
        vertices.iter().step_by(vertices.len().div_ceil(SAMPLES)).map(|&v| sites.position(v)).collect();
    sample.sort_unstable_by(|a, b| compare_from(axis, *a, *b));
    let median = sample[sample.len() / 2];
    vertices.iter().partition(|v| compare_from(axis, sites.position(**v), median).is_lt())
}

/// Both halves as one mesh, if the border spans space.
fn join(sites: &Sites, below: Half, above: Half) -> Result<Option<(Mesh, Same)>, DelaunayError> {
    let (mut mesh, mut same) = (below.mesh, below.same);
    let mut border = border::find(&mesh, sites, above.lo, above.hi);
    let above_border = border::find(&above.mesh, sites, below.lo, below.hi);
    let mut sides = vec![0; sites.len()];
    border::mark_corners(&mesh, &border, &mut sides, 1);
    border::mark_corners(&above.mesh, &above_border, &mut sides, 2);
    let vertices: Vec<Vertex> =
        (0..).map(Vertex).zip(&sides).filter(|(_, side)| **side != 0).map(|(v, _)| v).collect();
    let Simplex::Space(first) = Simplex::new(sites, &vertices) else { return Ok(None) };
    let (patch, _) = incremental::mesh(sites, &vertices, first)?;

    let offset = mesh.append(above.mesh)?;
    border.extend(above_border.into_iter().map(|id| CellId(id.0 + offset)));
    Seam::cut(&mut mesh, &border).sew(&mut mesh, &patch, &sides)?;
    same.extend(above.same);
    Ok(Some((mesh, same)))
}

#[cfg(test)]
mod tests {
    use super::super::cell::Cell;
    use super::*;
    use glam::dvec3;

    /// Cells by corners, in the same sense, in order.
    fn cells(mesh: &Mesh) -> Vec<[u32; 4]> {
        let rotated = |cell: &Cell| {
            let corners = cell.corners.map(|v| v.0);
            let mut order = [0, 1, 2, 3];
            order.sort_unstable_by_key(|&k| corners[k]);
            let swaps = (0..4)
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .filter(|&(i, j)| order[j] > order[i])
                .count();
            // An odd permutation is made even: the last two change places.
            if swaps % 2 == 1 {
                order.swap(2, 3);
            }
            order.map(|k| corners[k])
        };
        let mut cells: Vec<_> = mesh.live().map(|(_, cell)| rotated(cell)).collect();
        cells.sort_unstable();
        cells
    }

    fn check(points: &[DVec3]) {
        let sites = Sites::new(points.iter().copied());
        let vertices: Vec<Vertex> = (1..=points.len() as u32).map(Vertex).collect();
        let whole = mesh(&sites, &vertices, None, 0).unwrap();
        for depth in 1..4 {
            let parts = mesh(&sites, &vertices, None, depth).unwrap();
            assert_eq!(whole.is_some(), parts.is_some());
            let (Some((whole, _)), Some((parts, _))) = (&whole, &parts) else { continue };
            assert_eq!(cells(whole), cells(parts), "{depth} {points:?}");
            for (id, cell) in parts.live() {
                let leads_back =
                    |k: usize| parts.cell(cell.links[k].cell()).links[cell.links[k].face()].cell() == id;
                assert!((0..4).all(leads_back), "{depth} {points:?}");
            }
        }
    }

    #[test]
    fn parts_join_to_the_whole() {
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        for round in 0..150 {
            let count = 4 + (random() * 60.0) as usize;
            let mut coordinate = |axis: usize| match (round % 5, axis) {
                (0, _) => random(),
                (1, _) => (random() * 4.0).floor(),
                (2, _) => (random() * 4.0).floor() * 0.1,
                (3, 0) => (random() * 2.0).floor(),
                (3, _) => random() * 1e-3,
                _ => (random() * 3.0).floor() + random() * 1e-15,
            };
            // Each position once: which of several coincident points is the vertex depends on the order of insertion.
            let mut points: Vec<DVec3> =
                (0..count).map(|_| dvec3(coordinate(0), coordinate(1), coordinate(2))).collect();
            points.sort_unstable_by(|a, b| compare_from(0, *a, *b));
            points.dedup();
            check(&points);
        }
    }
}
