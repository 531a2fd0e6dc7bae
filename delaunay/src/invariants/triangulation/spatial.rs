//! Tetrahedra.

use super::{across, check, check_links};
use crate::invariants::exact::{Points, zero};
use crate::{OUTSIDE, Tetrahedra};
use num_bigint::BigInt;
use std::collections::{BTreeMap, BTreeSet};

/// The corners of the face opposite each corner, counterclockwise as seen from outside.
const OUTWARD: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// None is flat, neighbours do not hold each other's corners in their spheres, the hull is convex, and all of it is
/// filled.
///
/// That inner faces are locally Delaunay makes all spheres empty (Delaunay's lemma).
pub(super) fn check_tetrahedra(points: &Points, t: &Tetrahedra, distinct: &[u32]) -> Result<(), String> {
    check_links(&t.corners, &t.neighbours, distinct)?;
    for corners in &t.corners {
        check(points.orientation(*corners) > zero(), || format!("{corners:?} is not positive"))?;
    }
    for (cell, _, opposite) in across(&t.corners, &t.neighbours) {
        let corners = t.corners[cell];
        check(!points.is_inside(corners, opposite), || {
            format!("{opposite} lies in the sphere of {corners:?}")
        })?;
    }
    let hull = hull(t);
    hull_is_convex(points, &hull)?;
    let volume: BigInt = t.corners.iter().map(|c| points.orientation(*c)).sum();
    let enclosed: BigInt = hull.iter().map(|[a, b, c]| points.orientation([distinct[0], *a, *c, *b])).sum();
    check(volume == -enclosed, || "the tetrahedra do not fill the hull once".into())?;
    euler_characteristic_is_that_of_a_ball(t, distinct.len())
}

/// Faces without a neighbour, counterclockwise as seen from outside.
fn hull(t: &Tetrahedra) -> Vec<[u32; 3]> {
    let cells = t.corners.iter().zip(&t.neighbours);
    cells
        .flat_map(|(corners, neighbours)| {
            let open = (0..4).filter(|k| neighbours[*k] == OUTSIDE);
            open.map(|k| OUTWARD[k].map(|j| corners[j]))
        })
        .collect()
}

/// Each edge of the hull is met twice, once each way, and does not bend inward.
fn hull_is_convex(points: &Points, hull: &[[u32; 3]]) -> Result<(), String> {
    let edges = hull.iter().flat_map(|&[a, b, c]| [([a, b], c), ([b, c], a), ([c, a], b)]);
    let third: BTreeMap<[u32; 2], u32> = edges.clone().collect();
    check(third.len() == 3 * hull.len(), || "an edge of the hull is met twice the same way".into())?;
    for ([a, b], c) in edges {
        let Some(&d) = third.get(&[b, a]) else { return Err(format!("the hull is open at {a} {b}")) };
        check(points.orientation([a, b, c, d]) <= zero(), || format!("the hull bends inward at {a} {b}"))?;
    }
    Ok(())
}

/// Vertices − edges + faces − cells.
fn euler_characteristic_is_that_of_a_ball(t: &Tetrahedra, vertices: usize) -> Result<(), String> {
    let sorted = |mut of: Vec<u32>| {
        of.sort_unstable();
        of
    };
    let (mut edges, mut faces) = (BTreeSet::new(), BTreeSet::new());
    for c in &t.corners {
        OUTWARD.iter().for_each(|f| _ = faces.insert(sorted(f.map(|j| c[j]).to_vec())));
        (0..4).for_each(|i| (0..i).for_each(|j| _ = edges.insert(sorted(vec![c[i], c[j]]))));
    }
    let even = vertices + faces.len();
    let odd = edges.len() + t.corners.len();
    check(even == odd + 1, || format!("Euler's characteristic is {}", even as i64 - odd as i64))
}
