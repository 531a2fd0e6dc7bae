//! The facts of `invariants::triangulation`, and closed forms.

use glam::{DMat3, DVec3, dvec3};
use pointillist_delaunay::invariants::triangulation as facts;
use pointillist_delaunay::{Delaunay, DelaunayError, OUTSIDE, Partition, Tetrahedra};
use proptest::prelude::*;
use testkit::holds;
use testkit::points::{point, points, scaled};

/// Points of a grid, the last axis fastest.
fn grid(counts: [u32; 3], spacing: f64) -> Vec<DVec3> {
    let [nx, ny, nz] = counts;
    let all = (0..nx).flat_map(|x| (0..ny).flat_map(move |y| (0..nz).map(move |z| [x, y, z])));
    all.map(|c| DVec3::from_array(c.map(|v| f64::from(v) * spacing))).collect()
}

fn turned(points: Vec<DVec3>) -> Vec<DVec3> {
    let turn = DMat3::from_axis_angle(dvec3(0.48, 0.6, 0.64), 0.7);
    points.into_iter().map(|p| turn * p).collect()
}

fn tetrahedra(points: &[DVec3]) -> Tetrahedra {
    match Delaunay::new(points).unwrap().partition() {
        Partition::Tetrahedra(t) => t,
        other => panic!("not tetrahedra: {other:?}"),
    }
}

/// Determinants of integers of this size may not fit into the digits of `f64`, so that they are asked for exactly; of points on one sphere they are 0.
#[test]
fn large_integers_on_one_sphere_are_on_one_sphere() {
    for radius2 in [690 * 690, 553_349, 699_901] {
        let reach = f64::from(radius2).sqrt() as i32;
        let mut on_sphere = vec![];
        for (x, y) in (-reach..=reach).flat_map(|x| (-reach..=reach).step_by(7).map(move |y| (x, y))) {
            let z2 = radius2 - x * x - y * y;
            let z = f64::from(z2.max(0)).sqrt() as i32;
            if z * z == z2 {
                let z = if (x + y) % 2 == 0 { z } else { -z };
                on_sphere.push(dvec3(x.into(), y.into(), z.into()));
            }
        }
        let step = on_sphere.len() / 24;
        let points: Vec<DVec3> = on_sphere.iter().copied().step_by(step.max(1)).collect();
        assert!(points.len() >= 16, "{} points", points.len());
        facts::partition_is_delaunay(&points).unwrap();
        facts::insertion_is_building(&points).unwrap();
        let backward: Vec<DVec3> = points.iter().rev().copied().collect();
        let order: Vec<u32> = (0..points.len() as u32).rev().collect();
        let renamed = facts::renamed(Delaunay::new(&backward).unwrap().partition(), &order);
        assert_eq!(Delaunay::new(&points).unwrap().partition(), renamed);
    }
}

proptest! {
    #![proptest_config(testkit::config(64))]

    #[test]
    fn any_points_are_divided_as_delaunay_demands(points in points(40)) {
        holds!(facts::partition_is_delaunay(&points));
    }

    #[test]
    fn inserting_one_by_one_is_building(points in points(24)) {
        holds!(facts::insertion_is_building(&points));
    }

    #[test]
    fn removing_is_building_without(points in points(24), removed in prop::collection::vec(0..64usize, 1..24)) {
        holds!(facts::removal_is_building(&points, &removed));
    }

    #[test]
    fn the_order_of_points_does_not_matter(points in points(30), keys in prop::collection::vec(any::<u32>(), 30)) {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        order.sort_by_key(|&i| keys[i as usize]);
        let shuffled: Vec<DVec3> = order.iter().map(|&i| points[i as usize]).collect();
        let first = Delaunay::new(&points).unwrap();
        let second = facts::renamed(Delaunay::new(&shuffled).unwrap().partition(), &order);
        // Which of several points in one place stands for them is a matter of order.
        let first_of: Vec<u32> = first.representative().to_vec();
        prop_assert_eq!(first.partition(), facts::renamed(second, &first_of));
    }

    #[test]
    fn any_powers_of_two_leave_the_partition(points in prop::collection::vec(point(), 1..30), exponent in -900..900) {
        let alike = |points: &[DVec3]| Delaunay::new(points).unwrap().partition();
        prop_assert_eq!(alike(&points), alike(&scaled(points.clone(), exponent)));
    }
}

/// The triangle was built with its apex on one side of the plane, all four points with theirs on the other; triangles
/// were sorted as seen from there. Found by exploring.
#[test]
fn triangles_of_a_plane_are_sorted_alike_from_both_of_its_sides() {
    let tilted = [dvec3(1.0, 1.0, 2.0), dvec3(2.0, 0.0, 0.0), dvec3(1.0, 1.0, 1.0), dvec3(0.0, 2.0, 0.0)];
    facts::insertion_is_building(&tilted).unwrap();
}

#[test]
fn bad_input_is_refused() {
    assert_eq!(Delaunay::new::<DVec3>(&[]).unwrap_err(), DelaunayError::NoPoints);
    let not_finite = |index| DelaunayError::PointNotFinite { index };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(Delaunay::new(&[DVec3::ZERO, dvec3(0.0, bad, 0.0)]).unwrap_err(), not_finite(1));
        let mut delaunay = Delaunay::new(&[DVec3::ZERO]).unwrap();
        assert_eq!(delaunay.insert(dvec3(bad, 0.0, 0.0)), Err(not_finite(1)));
        assert_eq!(delaunay.remove(1), Err(DelaunayError::NoSuchPoint { index: 1 }));
        assert_eq!(delaunay.remove(0), Err(DelaunayError::NoPoints));
    }
}

#[test]
fn every_cube_of_a_grid_is_divided_without_flat_cells() {
    for (points, cubes) in [(grid([12, 6, 6], 1.0), 11 * 5 * 5), (grid([5, 5, 5], 0.1), 64)] {
        facts::partition_is_delaunay(&points).unwrap();
        let count = tetrahedra(&points).corners.len();
        assert!((5 * cubes..=6 * cubes).contains(&count), "{count} cells of {cubes} cubes");
    }
    facts::partition_is_delaunay(&turned(grid([5, 4, 4], 1.0))).unwrap();
    let jitter = |(i, p): (usize, DVec3)| {
        p + 1e-12 * dvec3((i as f64).sin(), (2.0 * i as f64).cos(), (3.0 * i as f64).sin())
    };
    facts::partition_is_delaunay(
        &grid([4, 4, 4], 1.0).into_iter().enumerate().map(jitter).collect::<Vec<_>>(),
    )
    .unwrap();
}

#[test]
fn dimension_rises_and_falls_with_the_points() {
    let corners = [DVec3::ZERO, DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, dvec3(0.3, 0.2, 0.0)];
    let mut delaunay = Delaunay::new(&corners[..1]).unwrap();
    for (p, dimension) in corners[1..].iter().zip([0, 1, 2, 3, 3]) {
        delaunay.insert(*p).unwrap();
        assert_eq!(delaunay.dimension(), dimension);
        facts::triangulation_is_delaunay(&delaunay).unwrap();
    }
    for (index, dimension) in [(0, 3), (4, 2), (3, 2), (5, 1), (1, 0)] {
        delaunay.remove(index).unwrap();
        assert_eq!(delaunay.dimension(), dimension);
        facts::triangulation_is_delaunay(&delaunay).unwrap();
    }
    assert_eq!(delaunay.partition(), Partition::Point(2));
    assert_eq!(delaunay.representative(), [OUTSIDE, OUTSIDE, 2, OUTSIDE, OUTSIDE, OUTSIDE]);
}

#[test]
fn triangles_of_a_tilted_plane_are_delaunay_in_it() {
    // Seen along any axis the circles of this plane are ellipses.
    let tilted: Vec<_> =
        grid([7, 6, 1], 1.0).into_iter().map(|p| dvec3(p.x, p.y, 3.0 * p.x - 5.0 * p.y)).collect();
    let delaunay = Delaunay::new(&tilted).unwrap();
    assert_eq!(delaunay.dimension(), 2);
    facts::triangulation_is_delaunay(&delaunay).unwrap();
}

#[test]
fn coordinates_of_all_magnitudes_are_told_apart() {
    let tiny: Vec<_> = turned(grid([3, 3, 3], 1e-300));
    let mixed: Vec<_> = grid([3, 3, 2], 1.0).into_iter().chain(tiny.iter().copied()).collect();
    facts::partition_is_delaunay(&mixed).unwrap();
    let extreme: Vec<_> = [1e300, 1e-300, 5e-324].iter().flat_map(|&s| grid([2, 2, 2], s)).collect();
    facts::partition_is_delaunay(&extreme).unwrap();
    facts::insertion_is_building(&extreme).unwrap();
    for exponent in [-100, -70, 70, 100, 300] {
        facts::partition_is_delaunay(&turned(grid([3, 3, 3], 10f64.powi(exponent)))).unwrap();
    }
    facts::partition_is_delaunay(&[f64::MAX, f64::MIN].map(DVec3::splat)).unwrap();
}

#[test]
fn large_rims_are_joined_as_small_ones() {
    // All points on two lines: inserting meets cavities around hundreds of vertices.
    let line = |k: i32| [dvec3(f64::from(k), 0.0, 0.0), dvec3(0.0, f64::from(k), 100.0)];
    let points: Vec<_> = (-40..40).flat_map(line).collect();
    facts::partition_is_delaunay(&points).unwrap();
    assert_eq!(tetrahedra(&points).corners.len(), 79 * 79);
}

#[test]
fn a_vertex_that_knows_all_others_can_go() {
    let on_sphere = |i: i32| {
        let (z, a) = (1.0 - (f64::from(i) + 0.5) / 100.0, 2.4 * f64::from(i));
        let r = (1.0 - z * z).sqrt();
        dvec3(r * a.cos(), r * a.sin(), z)
    };
    let points: Vec<_> = std::iter::once(DVec3::ZERO).chain((0..200).map(on_sphere)).collect();
    facts::removal_is_building(&points, &[0, 3]).unwrap();
}

/// Pseudorandom points in a unit cube.
fn scattered(count: u64) -> Vec<DVec3> {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count).map(|_| dvec3(next(), next(), next())).collect()
}

/// The partition with 1 and 2 threads, which is the same.
fn with_threads(points: &[DVec3]) -> Partition {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Delaunay::new(points).unwrap().partition())
    };
    let alone = with(1);
    assert!(alone == with(2));
    alone
}

#[test]
#[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
fn threads_do_not_change_a_byte() {
    // Twice as many as a part has at least: fewer are not divided.
    assert_eq!(with_threads(&scattered(40_000)).dimension(), 3);
}

/// What a huge point made equal in scaled coordinates was named in another order when that point had gone.
#[test]
fn a_huge_point_leaves_no_trace() {
    let points = [
        dvec3(1e-146, 0.0, 0.0),
        DVec3::ZERO,
        dvec3(0.0, 0.0, -1.5e-107),
        dvec3(0.0, -2.3e-106, 0.0),
        dvec3(7.8e216, 0.0, 5e216),
    ];
    facts::removal_is_building(&points, &[4]).unwrap();
}

#[test]
#[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
fn most_points_in_one_place_can_be_divided() {
    // The median of these is their least: nothing lies before it.
    let mut points = vec![DVec3::splat(-1.0); 40_000];
    points.extend(scattered(2_000));
    assert_eq!(with_threads(&points).dimension(), 3);
    assert_eq!(Delaunay::new(&points).unwrap().representative()[39_999], 0);
}
