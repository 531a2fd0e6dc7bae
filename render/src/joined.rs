//! Triangles of one plane joined to convex polygons, so that a flat lamp is one light and not one for each of its triangles.
//!
//! All triangles of a plane that hang together are one polygon if their border is a convex outline of no more than [`LARGEST_OUTLINE`]
//! corners. Otherwise a polygon begins with the first triangle that is left, and takes neighbours across its edges, in order, as long as it stays
//! such an outline.

use crate::scene::Scene;
use glam::DVec3;
use pointillist_shade::LARGEST_OUTLINE;
use pointillist_shadow::check_outline;
use std::collections::{HashMap, HashSet};

/// A corner lies on the line between its neighbours if they span less than this times the square of their distances.
const COLLINEAR: f64 = 1e-9;

/// Triangles may be of one plane if the cosine between their normals is this close to 1; [`check_outline`] decides.
const FLAT: f64 = 1e-6;

type Triangles = HashMap<u32, [DVec3; 3]>;
type Edge = [[u64; 3]; 2];

/// Some triangles of a mesh as one convex polygon.
#[derive(Clone, Debug)]
pub(crate) struct JoinedPolygon {
    /// Counter-clockwise as seen from the front of its triangles.
    pub(crate) vertices: Vec<DVec3>,
    /// Positions in the mesh.
    pub(crate) triangles: Vec<u32>,
}

/// Bits of a position; −0 is 0.
pub(crate) fn place(p: DVec3) -> [u64; 3] {
    (p + 0.0).to_array().map(f64::to_bits)
}

/// Joins these triangles of a scene where they share edges and `alike` holds; those without an area are left out.
pub(crate) fn joined_polygons(
    scene: &Scene,
    triangles: &[u32],
    alike: impl Fn(u32, u32) -> bool,
) -> Vec<JoinedPolygon> {
    let mut left: Triangles = triangles.iter().map(|&t| (t, scene.corners(t))).collect();
    left.retain(|_, corners| check_outline(corners).is_ok());
    let mut by_edge = HashMap::new();
    for t in triangles.iter().filter(|t| left.contains_key(t)) {
        edges(&scene.corners(*t)).for_each(|edge| {
            by_edge.entry(edge).or_insert(*t);
        });
    }
    let mut found = vec![];
    for &first in triangles {
        let Some(&corners) = left.get(&first) else { continue };
        let neighbour = |edge, left: &Triangles| {
            let t = *by_edge.get(&edge)?;
            Some((t, *left.get(&t).filter(|_| alike(first, t))?))
        };
        let joined = whole_plane((first, corners), |edge| neighbour(edge, &left));
        let joined = joined.unwrap_or_else(|| greedy((first, corners), |edge| neighbour(edge, &left)));
        joined.triangles.iter().for_each(|t| {
            left.remove(t);
        });
        found.push(joined);
    }
    found
}

/// The directed edges of a ring.
fn edges(ring: &[DVec3]) -> impl Iterator<Item = Edge> + '_ {
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(&a, &b)| [place(a), place(b)])
}

/// All triangles in the plane of the first that can be reached over edges, if they are one convex polygon.
fn whole_plane(
    (first, corners): (u32, [DVec3; 3]),
    neighbour: impl Fn(Edge) -> Option<(u32, [DVec3; 3])>,
) -> Option<JoinedPolygon> {
    let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let front = normal(corners).normalize();
    let mut found = vec![(first, corners)];
    let mut known = HashSet::from([first]);
    let mut next = 0;
    while let Some(&(_, ring)) = found.get(next) {
        next += 1;
        for [a, b] in edges(&ring) {
            if let Some((t, corners)) = neighbour([b, a])
                && front.dot(normal(corners).normalize()) > 1.0 - FLAT
                && known.insert(t)
            {
                found.push((t, corners));
            }
        }
    }
    let all: HashSet<Edge> = found.iter().flat_map(|(_, ring)| edges(ring).collect::<Vec<_>>()).collect();
    let mut after: HashMap<[u64; 3], DVec3> = HashMap::new();
    for (_, ring) in &found {
        for (edge, &to) in edges(ring).zip(ring.iter().cycle().skip(1)) {
            let [a, b] = edge;
            if !all.contains(&[b, a]) && after.insert(a, to).is_some() {
                return None;
            }
        }
    }
    let start = *found.iter().flat_map(|(_, ring)| ring).find(|&&p| after.contains_key(&place(p)))?;
    let mut border = vec![start];
    while let Some(to) =
        after.remove(&place(border[border.len() - 1])).filter(|&to| place(to) != place(start))
    {
        border.push(to);
    }
    let vertices = without_collinear(&border);
    let is_one = after.is_empty() && is_outline(&vertices);
    let area = |ring: &[DVec3]| {
        (2..ring.len()).map(|i| normal([ring[0], ring[i - 1], ring[i]]).dot(front)).sum::<f64>()
    };
    // Triangles that lie on one another have a larger area than their outline.
    let covers = || area(&vertices) >= (1.0 - FLAT) * found.iter().map(|(_, ring)| area(ring)).sum::<f64>();
    (is_one && covers())
        .then(|| JoinedPolygon { triangles: found.iter().map(|f| f.0).collect(), vertices: vertices.clone() })
}

fn is_outline(vertices: &[DVec3]) -> bool {
    (3..=LARGEST_OUTLINE).contains(&vertices.len()) && check_outline(vertices).is_ok()
}

/// A polygon that takes neighbours across its edges as long as it stays convex.
fn greedy(
    (first, corners): (u32, [DVec3; 3]),
    neighbour: impl Fn(Edge) -> Option<(u32, [DVec3; 3])>,
) -> JoinedPolygon {
    let mut ring = corners.to_vec();
    let mut joined = JoinedPolygon { vertices: ring.clone(), triangles: vec![first] };
    loop {
        let free = |edge| neighbour(edge).filter(|(t, _)| !joined.triangles.contains(t));
        let Some((grown, outline, t)) = grown(&ring, free) else { return joined };
        joined.triangles.push(t);
        (ring, joined.vertices) = (grown, outline);
    }
}

/// A ring with the first triangle that can be added to it: all its corners, those of its outline, and the triangle.
fn grown(
    ring: &[DVec3],
    neighbour: impl Fn(Edge) -> Option<(u32, [DVec3; 3])>,
) -> Option<(Vec<DVec3>, Vec<DVec3>, u32)> {
    (0..ring.len()).find_map(|i| {
        let [a, b] = [ring[i], ring[(i + 1) % ring.len()]];
        // The neighbour runs along the edge the other way.
        let (t, corners) = neighbour([place(b), place(a)])?;
        let new = corners.into_iter().find(|&c| place(c) != place(a) && place(c) != place(b))?;
        let mut grown = ring.to_vec();
        grown.insert(i + 1, new);
        // A triangle in a corner of the ring has a second edge in common with it, which goes.
        without_spikes(&mut grown);
        let outline = without_collinear(&grown);
        is_outline(&outline).then_some((grown, outline, t))
    })
}

/// Removes corners at which a ring turns back to where it came from.
fn without_spikes(ring: &mut Vec<DVec3>) {
    let mut i = 0;
    while i < ring.len() && ring.len() > 2 {
        let n = ring.len();
        if place(ring[(i + n - 1) % n]) == place(ring[(i + 1) % n]) {
            ring.remove(i);
            ring.remove(i % (n - 1));
            i = 0;
        } else {
            i += 1;
        }
    }
}

/// The corners at which a ring turns.
fn without_collinear(ring: &[DVec3]) -> Vec<DVec3> {
    let n = ring.len();
    let turns = |i: usize| {
        let (before, after) = (ring[i] - ring[(i + n - 1) % n], ring[(i + 1) % n] - ring[i]);
        let span = before.length_squared().max(after.length_squared());
        before.cross(after).length() > COLLINEAR * span || before.dot(after) < 0.0
    };
    (0..n).filter(|&i| turns(i)).map(|i| ring[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Part};
    use glam::dvec3;

    fn joined(corners: &[DVec3], triangles: &[[u32; 3]]) -> Vec<JoinedPolygon> {
        let camera = Camera::perspective(DVec3::Z, DVec3::ZERO, 1.0);
        let mut scene = Scene::new(camera, [1, 1]);
        scene.mesh.add(&Part::new("lamp", corners, triangles)).unwrap();
        let all: Vec<u32> = (0..triangles.len() as u32).collect();
        joined_polygons(&scene, &all, |_, _| true)
    }

    fn ring(n: u32) -> Vec<DVec3> {
        (0..n)
            .map(|i| f64::from(i) / f64::from(n) * std::f64::consts::TAU)
            .map(|a| dvec3(a.cos(), a.sin(), 2.0))
            .collect()
    }

    #[test]
    fn a_fan_around_a_middle_is_one_polygon() {
        for n in 3..=LARGEST_OUTLINE as u32 {
            let mut corners = ring(n);
            corners.push(DVec3::Z * 2.0);
            let triangles: Vec<[u32; 3]> = (0..n).map(|i| [i, (i + 1) % n, n]).collect();
            let found = joined(&corners, &triangles);
            assert_eq!(
                (found.len(), found[0].vertices.len(), found[0].triangles.len()),
                (1, n as usize, n as usize)
            );
        }
    }

    #[test]
    fn what_has_more_corners_is_divided_into_polygons_of_the_same_area() {
        let corners = ring(40);
        let triangles: Vec<[u32; 3]> = (2..40).map(|i| [0, i - 1, i]).collect();
        let found = joined(&corners, &triangles);
        assert!(found.len() <= 4, "{}", found.len());
        let area = |ring: &[DVec3]| {
            (2..ring.len()).map(|i| (ring[i - 1] - ring[0]).cross(ring[i] - ring[0]).z).sum::<f64>()
        };
        let sum: f64 = found.iter().map(|p| area(&p.vertices)).sum();
        assert!((sum - area(&corners)).abs() < 1e-12, "{sum}");
    }

    #[test]
    fn folded_and_reflex_neighbours_stay_apart() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, dvec3(1.0, 1.0, 0.1), dvec3(0.2, 0.2, 0.0)];
        assert_eq!(joined(&corners, &[[0, 1, 2], [2, 1, 3]]).len(), 2);
        // An arrow head: the new corner bends inward.
        assert_eq!(joined(&corners, &[[1, 2, 4], [4, 2, 0]]).len(), 2);
        // A triangle without area is none.
        assert_eq!(joined(&corners, &[[0, 1, 1]]).len(), 0);
    }
}
