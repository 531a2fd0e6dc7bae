//! Triangles of points in a plane are those of the crate `spade`, which shares nothing with this one but the predicates
//! of `robust`.

use glam::{DVec3, dvec3};
use pointillist_delaunay::{Delaunay, Partition};
use proptest::prelude::*;
use spade::{DelaunayTriangulation, Point2, Triangulation as _};
use std::collections::BTreeSet;

/// The triangles of points in the plane z = 0, each with its corners in order. No triangles of points on a line.
fn ours(points: &[DVec3]) -> BTreeSet<[u32; 3]> {
    match Delaunay::new(points).expect("points are finite").partition() {
        Partition::Triangles(triangles) => triangles.corners.iter().map(|&c| sorted(c)).collect(),
        Partition::Tetrahedra(_) => panic!("the points lie in a plane"),
        _ => BTreeSet::new(),
    }
}

fn spades(points: &[DVec3]) -> BTreeSet<[u32; 3]> {
    let mut triangulation = DelaunayTriangulation::<Point2<f64>>::new();
    let mut index = vec![];
    for (i, p) in (0..).zip(points) {
        let vertex =
            triangulation.insert(Point2::new(p.x, p.y)).expect("coordinates are neither huge nor tiny");
        // The first of those that coincide keeps its place.
        if vertex.index() == index.len() {
            index.push(i);
        }
    }
    let corners = triangulation.inner_faces().map(|face| face.vertices().map(|v| index[v.index()]));
    corners.map(sorted).collect()
}

fn sorted(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}

fn points(coordinate: impl Strategy<Value = f64> + Clone) -> impl Strategy<Value = Vec<DVec3>> {
    let point = (coordinate.clone(), coordinate).prop_map(|(x, y)| dvec3(x, y, 0.0));
    prop::collection::vec(point, 3..80)
}

proptest! {
    #![proptest_config(testkit::config(64))]

    /// No four of these lie on a circle, so there is one triangulation.
    #[test]
    fn of_points_anywhere(points in points(-1.0..1.0)) {
        prop_assert_eq!(ours(&points), spades(&points));
    }

    /// Many of these lie on circles and lines, or coincide: which diagonal is drawn differs, how many triangles there
    /// are does not.
    #[test]
    fn of_points_of_a_grid(points in points((-4..4).prop_map(f64::from))) {
        prop_assert_eq!(ours(&points).len(), spades(&points).len());
    }
}
