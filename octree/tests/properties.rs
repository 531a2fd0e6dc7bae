//! The facts of `invariants`, and cuts of trees.

use glam::{DVec3, dvec3};
use pointillist_octree::{Cube, CutOptions, OctreeError, TreeReader, cut, invariants};
use pointillist_view::{Projection, View};
use proptest::prelude::*;
use std::io::Cursor;
use testkit::holds;

/// Clouds that are hard to divide: dense clusters, points at one place, far from the origin, on the faces of cells. Larger than a leaf, most of them.
fn clouds() -> impl Strategy<Value = Vec<DVec3>> {
    let cluster =
        (any::<u64>(), 1usize..30_000, prop_oneof![Just(0.0), Just(1e-9), Just(1e-3), Just(1.0)], 0u32..3);
    let offset = prop_oneof![Just(0.0), Just(5e6), Just(-1e12)];
    (prop::collection::vec(cluster, 1..4), offset).prop_map(|(clusters, offset)| {
        let points = clusters.into_iter().flat_map(|(seed, count, extent, flat)| {
            let mut state = seed | 1;
            let mut next = move || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 40) as f64 / (1u64 << 24) as f64
            };
            let middle = dvec3(next(), next(), next());
            (0..count).map(move |_| {
                let p = dvec3(next(), next(), if flat > 0 { 0.0 } else { next() });
                // On a grid, so that many are at one place.
                let p = if flat == 2 { (p * 256.0).floor() / 256.0 } else { p };
                middle + p * extent
            })
        });
        points.map(|p| p + offset).collect()
    })
}

proptest! {
    #![proptest_config(testkit::config(24))]

    #[test]
    fn every_point_is_there_once(points in clouds(), in_memory in prop_oneof![Just(1u64), Just(25_000), Just(1 << 30)]) {
        holds!(invariants::every_point_is_there_once(&points, in_memory));
    }

    #[test]
    fn order_and_memory_do_not_matter(points in clouds(), in_memory in 20_000u64..40_000) {
        holds!(invariants::order_and_memory_do_not_matter(&points, in_memory));
    }

    #[test]
    fn a_changed_byte_or_a_missing_end_is_found(points in clouds(), at in any::<usize>(), change in any::<u8>()) {
        let names: Vec<u32> = (0..points.len() as u32).collect();
        if let Ok(file) = invariants::file_of(&points, &names, 25_000) {
            holds!(invariants::changes_are_found(&file, at, change));
            prop_assert!(TreeReader::new(Cursor::new(&file[..at % file.len()])).is_err());
            // The last bytes, and the table.
            holds!(invariants::changes_are_found(&file, file.len() - 1 - at % 80, change));
        }
    }

    #[test]
    fn any_bytes_can_be_read(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        holds!(invariants::any_file_can_be_read(&bytes));
    }

    #[test]
    fn a_cut_is_within_its_budget_and_the_beginning_of_a_larger_one(
        points in clouds(),
        eye in prop::array::uniform3(-2.0..2.0f64),
        most in 0u64..60_000,
    ) {
        let names: Vec<u32> = (0..points.len() as u32).collect();
        let Ok(file) = invariants::file_of(&points, &names, 1 << 30) else { return Ok(()) };
        let reader = TreeReader::new(Cursor::new(file)).unwrap();
        let tree = reader.tree();
        let cube = tree.cube();
        let eye = cube.low + DVec3::from_array(eye) * cube.side;
        let perspective = Projection::Perspective { fov_y_rad: 0.8 };
        let Ok(view) = View::look_at(eye, cube.low + 0.5 * cube.side, dvec3(0.1, 0.9, 0.3), perspective, 300, 200) else {
            return Ok(());
        };
        let options = CutOptions::default().with_spacing_px(0.5).with_most_points(most);
        let small = cut(&[tree], &view, &options);
        let large = cut(&[tree], &view, &options.with_most_points(2 * most));
        prop_assert!(small.points <= most);
        prop_assert_eq!(&large.nodes[..small.nodes.len()], &small.nodes[..]);
        let taken: std::collections::HashSet<u32> = large.nodes.iter().map(|&(_, node)| node).collect();
        for &(_, node) in &large.nodes {
            if let Some(parent) = tree.nodes()[node as usize].key.parent() {
                prop_assert!(tree.nodes().iter().position(|n| n.key == parent).is_some_and(|p| taken.contains(&(p as u32))));
            }
        }
        // What is left out although there was room is out of the picture, or in a node that is fine enough.
        let all = cut(&[tree], &view, &options.with_most_points(u64::MAX));
        prop_assert!(!all.is_limited && all.spacing_px <= 0.5);
    }
}

proptest! {
    #![proptest_config(testkit::config(16))]

    #[test]
    fn regions_have_every_point_in_view_once_among_its_neighbours(
        points in clouds(),
        eye in prop::array::uniform3(-1.5..1.5f64),
        most in 0u64..60_000,
        spacing_px in prop_oneof![Just(0.3), Just(1.0), Just(6.0)],
    ) {
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let Ok(cube) = Cube::around(low, high) else { return Ok(()) };
        let eye = cube.low + DVec3::from_array(eye) * cube.side;
        let perspective = Projection::Perspective { fov_y_rad: 0.6 };
        let target = cube.low + 0.4 * cube.side;
        let Ok(view) = View::look_at(eye, target, dvec3(0.1, 0.9, 0.3), perspective, 300, 200) else {
            return Ok(());
        };
        let options = CutOptions::default().with_spacing_px(spacing_px).with_most_points(most);
        holds!(invariants::regions_have_every_point_once(&points, &view, &options));
    }
}

#[test]
fn points_at_one_place_are_a_leaf_or_refused() {
    let same = vec![dvec3(3.0, 4.0, 5.0); 20_000];
    invariants::every_point_is_there_once(&same, 1).unwrap();
    let more = vec![dvec3(3.0, 4.0, 5.0); 20_001];
    let names = vec![0; 20_001];
    let error = invariants::file_of(&more, &names, 1 << 30).unwrap_err();
    assert!(matches!(error, OctreeError::TooDense { count: 20_001, most: 20_000, .. }), "{error}");
}

#[test]
fn points_outside_of_the_bounds_are_refused() {
    // Found by fuzzing: minima pass over NaN, and bounds were then those of the points behind it.
    let points = [dvec3(-1.0, 0.0, 0.0), dvec3(f64::NAN, 0.0, 0.0), dvec3(1.0, 1.0, 1.0)];
    let error = invariants::file_of(&points, &[0, 1, 2], 1 << 30).unwrap_err();
    assert!(matches!(error, OctreeError::Outside { .. } | OctreeError::BadBounds { .. }), "{error}");
}
