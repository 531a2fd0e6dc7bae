//! Weights and location: the facts of `invariants::weights`, and what went wrong once.

use glam::{DQuat, DVec3, EulerRot, dvec3};
use pointillist_delaunay::invariants::weights;
use pointillist_delaunay::{Delaunay, DelaunayError, Hint, Locator, OUTSIDE, Partition, Triangles};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use testkit::points::{lattice_points, query};

fn fail(message: String) -> TestCaseError {
    TestCaseError::fail(message)
}

fn turn() -> impl Strategy<Value = DQuat> {
    (0.0..6.3, 0.0..6.3, 0.0..6.3).prop_map(|(x, y, z)| DQuat::from_euler(EulerRot::XYZ, x, y, z))
}

/// Some points of a set, and their shares: of few points, places on edges and sides of cells and, with shares below 0, beyond the hull.
fn mixture() -> impl Strategy<Value = Vec<(prop::sample::Index, f64)>> {
    let share = prop_oneof![4 => Just(1.0), 1 => -1.0..3.0];
    prop::collection::vec((any::<prop::sample::Index>(), share), 1..5)
}

fn mixed(points: &[DVec3], mixture: &[(prop::sample::Index, f64)]) -> DVec3 {
    let sum: f64 = mixture.iter().map(|(_, share)| share).sum();
    let mean: DVec3 = mixture.iter().map(|(index, share)| points[index.index(points.len())] * *share).sum();
    if sum.abs() > 0.1 { mean / sum } else { mean }
}

proptest! {
    #![proptest_config(testkit::config(96))]

    #[test]
    fn weights_reproduce_linear_functions_and_are_those_of_the_nearest_point_beyond_the_hull(
        points in lattice_points(), queries in prop::collection::vec(query(), 1..20)
    ) {
        weights::weights_find_the_nearest_point(&points, &queries, 1e-9).map_err(fail)?;
    }

    #[test]
    fn far_away_and_resized_points_are_weighted_alike(
        points in lattice_points(), queries in prop::collection::vec(query(), 1..8), power in -200..200_i32
    ) {
        let scale = 2.0_f64.powi(power);
        let resized = |list: &[DVec3]| list.iter().map(|p| *p * scale).collect::<Vec<_>>();
        weights::weights_find_the_nearest_point(&resized(&points), &resized(&queries), 1e-9).map_err(fail)?;
        let moved = |list: &[DVec3]| list.iter().map(|p| *p + dvec3(1e8, -2e8, 3e8)).collect::<Vec<_>>();
        weights::weights_find_the_nearest_point(&moved(&points), &moved(&queries), 1e-6).map_err(fail)?;
    }

    /// Squares of a turned lattice have tetrahedra as flat as the rounding of their corners, and its edges triangles that are lines.
    #[test]
    fn turned_lattices_are_weighted_as_they_lie(
        points in lattice_points(), turn in turn(), parts in prop::collection::vec(mixture(), 1..20)
    ) {
        let turned: Vec<DVec3> = points.iter().map(|&p| turn * p).collect();
        let queries: Vec<DVec3> = parts.iter().map(|mixture| mixed(&turned, mixture)).collect();
        weights::weights_find_the_nearest_point(&turned, &queries, 1e-7).map_err(fail)?;
        weights::hints_do_not_matter(&turned, &queries, 1e-7).map_err(fail)?;
    }

    #[test]
    fn hints_change_nothing(points in lattice_points(), queries in prop::collection::vec(query(), 1..20)) {
        weights::hints_do_not_matter(&points, &queries, 1e-9).map_err(fail)?;
    }

    #[test]
    fn values_do_not_jump_on_the_way_through_cells_and_out_of_the_hull(
        points in lattice_points(), values in prop::collection::vec(-1.0..1.0_f64, 24), a in query(), b in query()
    ) {
        weights::nothing_jumps(&points, &values, a, b, 1e-6).map_err(fail)?;
    }

    #[test]
    fn location_ends_for_any_query(points in lattice_points(), raw in prop::array::uniform3(any::<f64>())) {
        let locator = Locator::new(&points, &Delaunay::new(&points).unwrap().partition()).unwrap();
        let p = DVec3::from_array(raw);
        match locator.locate_anywhere(p) {
            Ok(blend) => prop_assert!((blend.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12),
            Err(error) => {
                prop_assert!(!p.is_finite());
                prop_assert_eq!(error, DelaunayError::QueryNotFinite { index: 0 });
            }
        }
    }
}

#[test]
fn the_middle_of_a_cell_is_found_in_it_and_what_is_beyond_the_hull_in_none() {
    let corner = |i: u32| dvec3(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9));
    let space: Vec<DVec3> = (0..27).map(corner).collect();
    for (points, beyond) in
        [(&space[..], DVec3::splat(2.1)), (&space[..9], dvec3(2.1, 1.0, 0.0)), (&space[..3], -DVec3::X)]
    {
        let partition = Delaunay::new(points).unwrap().partition();
        let locator = Locator::new(points, &partition).unwrap();
        let mut hint = Hint::START;
        for cell in partition.cells() {
            let corners = cell.corners();
            let middle = corners.iter().map(|&c| points[c as usize]).sum::<DVec3>() / corners.len() as f64;
            assert_eq!(locator.cell(middle, &mut hint), Ok(Some(cell.index())));
        }
        assert_eq!(locator.cell(beyond, &mut hint), Ok(None));
        assert_eq!(locator.cell(DVec3::NAN, &mut hint), Err(DelaunayError::QueryNotFinite { index: 0 }));
    }
}

/// Found by fuzzing: from 1e31 sizes away the distances of all facets of the hull are the same number.
#[test]
fn the_nearest_point_is_found_from_very_far_away() {
    let scale = 2.0_f64.powi(-111);
    let points = [[5.0, 5.0, 5.0], [-6.0, -6.0, -6.0], [3.0, 7.0, 3.0], [3.0, 3.0, 3.0]]
        .map(|p| DVec3::from_array(p) * scale);
    let queries = [dvec3(-2.3e-28, -2.3e-28, 0.0462), dvec3(11.9, 9.1e-44, 0.0), dvec3(0.0, -1e5, 1.0)];
    weights::weights_find_the_nearest_point(&points, &queries, 1e-9).unwrap();
}

/// Found by fuzzing: two of three points coincide once the third is scaled to 1; their cell is flat and its barycentric
/// coordinates are NaN.
#[test]
fn cells_that_are_flat_to_the_last_digit_have_weights() {
    let points = [dvec3(-2.2e-272, -1.1e-204, 0.0), DVec3::splat(-2.2e-272), dvec3(-1.8e267, -2.3e305, 0.0)];
    let locator = Locator::new(&points, &Delaunay::new(&points).unwrap().partition()).unwrap();
    for query in [DVec3::ZERO, DVec3::Y, points[2] * 0.5] {
        let weights = locator.locate_anywhere(query).unwrap().weights;
        assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "{weights:?}");
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{weights:?}");
    }
}

/// A partition with an index beyond the points used to panic, and one without mutual neighbours may send a walk in
/// circles.
#[test]
fn a_partition_that_is_not_of_these_points_is_refused_by_cell() {
    let points: Vec<DVec3> = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]]
        .map(DVec3::from_array)
        .to_vec();
    let Partition::Tetrahedra(good) = Delaunay::new(&points).unwrap().partition() else { panic!("flat") };
    assert!(Locator::new(&points, &Partition::Tetrahedra(good.clone())).is_ok());
    let bad_cell = |partition: &Partition| match Locator::new(&points, partition) {
        Err(DelaunayError::BadCell { cell, .. }) => cell,
        other => panic!("{other:?}"),
    };
    let mut beyond = good.clone();
    beyond.corners[1][2] = 5;
    assert_eq!(bad_cell(&Partition::Tetrahedra(beyond)), 1);
    let mut one_way = good.clone();
    let side = one_way.neighbours[0].iter().position(|&n| n != OUTSIDE).expect("two cells");
    let other = one_way.neighbours[0][side] as usize;
    for n in &mut one_way.neighbours[other] {
        *n = OUTSIDE;
    }
    assert_eq!(bad_cell(&Partition::Tetrahedra(one_way)), 0);
    let mut short = good;
    short.neighbours.pop();
    assert_eq!(bad_cell(&Partition::Tetrahedra(short.clone())), short.neighbours.len());
    assert_eq!(bad_cell(&Partition::Point(9)), 0);
    assert_eq!(bad_cell(&Partition::Line(vec![0, 1, 7])), 2);
    assert_eq!(bad_cell(&Partition::Line(vec![0])), 0);
    assert_eq!(bad_cell(&Partition::Triangles(Triangles::default())), 0);
    let mut nowhere = points.clone();
    nowhere[3].y = f64::NAN;
    let refused = Locator::new(&nowhere, &Partition::Point(0));
    assert!(matches!(refused, Err(DelaunayError::PointNotFinite { index: 3 })));
}

/// Of rounded points of a tilted line or plane, weights were those of points far away.
#[test]
fn tilted_lines_and_planes_are_weighted_as_they_lie() {
    let along = |i: u32| dvec3(0.1, 0.3, 0.7) * f64::from(i % 15);
    let across = |i: u32| dvec3(0.3, -0.1, 0.7) * f64::from(i / 15);
    for (count, dimension) in [(15, 1), (225, 2)] {
        for shift in [0.0, 1e3, 1e5, 1e6, 1e8].map(DVec3::splat) {
            let points: Vec<DVec3> = (0..count).map(|i| along(i) + across(i) + shift).collect();
            assert_eq!(Partition::up_to_rounding(&points).unwrap().dimension(), dimension);
            let queries: Vec<DVec3> = points.windows(2).map(|pair| pair[0].lerp(pair[1], 0.3)).collect();
            let tolerance = 1e-8 + 16.0 * f64::EPSILON * shift.x;
            weights::weights_find_the_nearest_point(&points, &queries, tolerance).unwrap();
            weights::hints_do_not_matter(&points, &queries, tolerance).unwrap();
            // Cells that are exactly Delaunay's are flat, and all queries go to the hull.
            let locator = Locator::new(&points, &Delaunay::new(&points).unwrap().partition()).unwrap();
            for query in queries {
                let blend = locator.locate_anywhere(query).unwrap();
                let found: DVec3 = blend.parts().map(|(i, weight)| points[i as usize] * weight).sum();
                assert!(found.distance(query) < tolerance, "{query} is not {found}");
            }
        }
    }
}

/// A whole turned lattice, at places on its edges, squares and cubes, where flat cells lie beside one another.
#[test]
fn places_between_the_points_of_a_turned_lattice_are_found() {
    let lattice: Vec<DVec3> =
        (0..216).map(|i| dvec3(f64::from(i % 6), f64::from(i / 6 % 6), f64::from(i / 36))).collect();
    for angle in [0.1, 0.5, 1.0, 2.3] {
        let turn = DQuat::from_axis_angle(dvec3(0.48, -0.6, 0.64), angle);
        let turned: Vec<DVec3> = lattice.iter().map(|&p| turn * p).collect();
        let locator = Locator::new(&turned, &Partition::up_to_rounding(&turned).unwrap()).unwrap();
        let mut hint = Hint::START;
        for p in &lattice {
            for part in
                [0.5 * DVec3::X, 0.5 * DVec3::ONE, dvec3(0.5, 0.0, 0.5), dvec3(0.25, 0.75, 0.0), DVec3::ZERO]
            {
                let query = turn * (*p + part).min(DVec3::splat(5.0));
                for blend in [locator.locate(query, &mut hint), locator.locate_anywhere(query)] {
                    let found: DVec3 =
                        blend.unwrap().parts().map(|(i, weight)| turned[i as usize] * weight).sum();
                    assert!(found.distance(query) < 1e-9, "{query} is not {found}, turned by {angle}");
                }
            }
        }
    }
}
