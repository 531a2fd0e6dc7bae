//! The facts of `invariants` about octrees, on clouds that aim at trouble.

use glam::{DVec3, Vec3, dvec3};
use pointillist_surfel::invariants::{self, MOST_OVERHEAD, OwnedPoints, cloud};
use proptest::prelude::*;

/// Coordinates with trouble: equal, on lines, 1e-30 apart, far from 0, huge.
fn coordinate() -> BoxedStrategy<f64> {
    prop_oneof![
        6 => -1.0..1.0,
        4 => (-2..=2).prop_map(|i| 0.5 * f64::from(i)),
        1 => (-4..=4).prop_map(|i| 1e-30 * f64::from(i)),
        1 => (-1.0..1.0f64).prop_map(|x| 1e6 + x),
        1 => (-1.0..1.0f64).prop_map(|x| 1e12 * x),
        1 => (-1.0..1.0f64, -320..300).prop_map(|(x, e)| x * 10f64.powi(e)),
    ]
    .boxed()
}

fn point() -> BoxedStrategy<DVec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array).boxed()
}

/// A spiral of `n` points about each of some places, of sizes that differ by powers of 10: deep trees.
fn clusters() -> BoxedStrategy<Vec<DVec3>> {
    let cluster = (point(), -12..3i32, 1..900u32).prop_map(|(centre, e, n)| {
        let at = |i: u32| {
            let (t, size) = (f64::from(i), 10f64.powi(e));
            centre + dvec3((0.7 * t).cos(), (0.7 * t).sin(), 0.01 * (t % 37.0)) * (size * t.sqrt())
        };
        (0..n).map(at).collect::<Vec<_>>()
    });
    prop::collection::vec(cluster, 1..4).prop_map(|all| all.concat()).boxed()
}

fn line() -> BoxedStrategy<Vec<DVec3>> {
    (point(), point(), 1..3000i32)
        .prop_map(|(a, b, n)| (0..n).map(|t| a + b * (0.125 * f64::from(t))).collect())
        .boxed()
}

/// Each of some places many times.
fn repeated() -> BoxedStrategy<Vec<DVec3>> {
    let place = (point(), 1..1500usize).prop_map(|(p, n)| vec![p; n]);
    prop::collection::vec(place, 1..4).prop_map(|all| all.concat()).boxed()
}

fn normal() -> BoxedStrategy<Vec3> {
    let component = || prop_oneof![-1.0..1.0f32, Just(0.0), Just(1.0), Just(-1.0)];
    [component(), component(), component()]
        .prop_map(|n| if n == [0.0; 3] { Vec3::Z } else { Vec3::from_array(n) })
        .boxed()
}

fn points() -> BoxedStrategy<OwnedPoints> {
    let positions = prop_oneof![2 => prop::collection::vec(point(), 1..60), 3 => clusters(), 1 => line(), 1 => repeated()];
    let normals = prop::option::of(prop::collection::vec(normal(), 1..9));
    let radius =
        prop_oneof![3 => 0.01..2.0f32, 1 => (1.0..9.0f32, -37..38).prop_map(|(r, e)| r * 10f32.powi(e))];
    let radii = prop::option::of(prop::collection::vec(radius, 1..4));
    let opacities = prop::option::of(prop::collection::vec(0.0..=1.0f32, 1..4));
    (positions, normals, radii, opacities, any::<[bool; 2]>())
        .prop_map(|(positions, normals, radii, opacities, [colored, lit])| {
            let n = positions.len();
            let lit = normals.clone().filter(|_| lit);
            OwnedPoints {
                shading_normals: lit.map(|some| some.into_iter().rev().cycle().take(n).collect()),
                normals: normals.map(|some| some.into_iter().cycle().take(n).collect()),
                radii: radii.map(|some| some.into_iter().cycle().take(n).collect()),
                colors: colored.then(|| (0..n).map(|i| [i as f32, 0.5, 1.0 / (i + 1) as f32]).collect()),
                opacities: opacities.map(|some| some.into_iter().cycle().take(n).collect()),
                positions,
            }
        })
        .boxed()
}

proptest! {
    #![proptest_config(testkit::config(24))]

    #[test]
    fn any_points_have_a_sound_octree(points in points()) {
        invariants::octrees_are_sound(&points).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn the_order_of_points_does_not_change_the_octree(points in points(), seed: u64) {
        match (cloud(&points), cloud(&points.shuffled(seed))) {
            (Ok(a), Ok(b)) => prop_assert!(a == b, "the order matters"),
            (a, b) => prop_assert!(a.is_err() && b.is_err()),
        }
    }
}

/// Large ones: a sphere, a thin sheet with two sides, a plane without normals, all with colors.
fn surfaces() -> Vec<OwnedPoints> {
    let (right, up) = (DVec3::X * 0.01, DVec3::Y * 0.01);
    let sheet = OwnedPoints::plane(DVec3::ZERO, right, up, 70, 70).and(&OwnedPoints::plane(
        DVec3::Z * -1e-3,
        up,
        right,
        100,
        100,
    ));
    let loose =
        OwnedPoints { normals: None, radii: None, ..OwnedPoints::plane(DVec3::ZERO, right, up, 90, 90) };
    [OwnedPoints::sphere(DVec3::ONE, 2.0, 8000), sheet, loose]
        .map(|points| points.painted(|p| p.abs().as_vec3().to_array()))
        .into()
}

#[test]
fn octrees_of_surfaces_are_sound_and_small() {
    for points in surfaces() {
        let cloud = cloud(&points).unwrap();
        invariants::octree_is_sound(&cloud).unwrap();
        println!("{:.2} bytes per point", cloud.overhead_per_point());
        invariants::overhead_is_at_most(&cloud, MOST_OVERHEAD).unwrap();
    }
}

#[test]
#[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
fn threads_do_not_change_an_octree() {
    for points in surfaces() {
        let by = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| cloud(&points).unwrap())
        };
        let one = by(1);
        assert!(one == by(2) && one == by(8));
    }
}

#[test]
fn a_single_point_is_a_cloud() {
    let points = OwnedPoints::loose(vec![dvec3(1.0, -2.0, 3e5)]);
    let cloud = cloud(&points).unwrap();
    invariants::octree_is_sound(&cloud).unwrap();
    assert_eq!((cloud.len(), cloud.has_colors(), cloud.has_estimated_normals()), (1, false, true));
    let off = cloud.positions().next().unwrap() - points.positions[0];
    assert!(off.abs().max_element() <= 2f64.powi(-32), "{off}");
}

#[test]
fn positions_are_kept_to_a_share_of_the_extent() {
    for size in [1e-200, 1e-30, 1.0, 1e12, 1e300] {
        let points = OwnedPoints::sphere(DVec3::splat(0.3), 1.0, 500).moved(|p| p * size);
        let cloud = cloud(&points).unwrap();
        let nearest = |q: DVec3| {
            let away = |p: &DVec3| ((*p - q) / size).abs().max_element();
            points.positions.iter().map(away).fold(f64::INFINITY, f64::min)
        };
        let worst = cloud.positions().map(nearest).fold(0.0, f64::max);
        // An extent of 2 is in a cube of at most 4, and half a cell off.
        assert!(worst <= 4.0 * 2f64.powi(-32), "{size:e}: {worst:e}");
    }
}

#[test]
fn spacing_is_that_of_the_points() {
    let points = OwnedPoints::sphere(DVec3::ZERO, 1.0, 5000);
    let wanted = (4.0 * std::f64::consts::PI / 5000.0f64).sqrt();
    let spacing = cloud(&points).unwrap().spacing();
    assert!((spacing / wanted - 1.0).abs() < 0.02, "{spacing}, not {wanted}");
}
