//! The facts of `invariants`, on polygons that aim at trouble.

mod common;

use common::room;
use glam::{DQuat, DVec3, EulerRot, dvec3};
use pointillist_radiosity::invariants::{factors, scenes};
use pointillist_radiosity::{Polygon, PolygonError, Scene, SceneOptions, Surface};
use proptest::prelude::*;

/// A coordinate on a lattice, where polygons touch, or anywhere.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![3 => (-4_i32..=4).prop_map(|i| 0.25 * f64::from(i)), 2 => -1.0..1.0]
}

fn point() -> impl Strategy<Value = DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| dvec3(x, y, z))
}

/// Triangles and parallelograms: of any shape, slivers, and down to a millionth of the area.
fn polygon() -> BoxedStrategy<Polygon> {
    let size = prop_oneof![4 => Just(1.0), 1 => (-3.0..0.0).prop_map(|e| 10f64.powf(e))];
    let plain = (point(), point(), point(), size, any::<bool>()).prop_map(|(o, u, v, size, triangle)| {
        let (u, v) = (u * size, v * size);
        if triangle { vec![o, o + u, o + v] } else { vec![o, o + u, o + u + v, o + v] }
    });
    let sliver = (point(), point(), point(), -6.0..-1.0)
        .prop_map(|(o, u, v, e)| vec![o, o + u, o + u + v * 10f64.powf(e)]);
    prop_oneof![4 => plain, 1 => sliver].prop_filter_map("an area", |v| Polygon::new(&v).ok()).boxed()
}

/// Two polygons that look at each other, if they can.
fn pair() -> impl Strategy<Value = (Polygon, Polygon)> {
    (polygon(), polygon()).prop_map(|(a, b)| {
        let a = if a.height(b.centre()) < 0.0 { a.flipped() } else { a };
        let b = if b.height(a.centre()) < 0.0 { b.flipped() } else { b };
        (a, b)
    })
}

fn turn() -> impl Strategy<Value = DQuat> {
    (0.0..6.3, 0.0..6.3, 0.0..6.3).prop_map(|(x, y, z)| DQuat::from_euler(EulerRot::XYZ, x, y, z))
}

fn fails(message: String) -> TestCaseError {
    TestCaseError::fail(message)
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 100, ..testkit::config(128) })]

    #[test]
    fn a_form_factor_is_a_share((a, b) in pair(), occluders in prop::collection::vec(polygon(), 0..3)) {
        factors::is_a_share(&a, &b, &occluders).map_err(fails)?;
    }

    #[test]
    fn halves_hide_what_the_whole_hides((a, b) in pair(), occluder in polygon()) {
        factors::halves_hide_what_the_whole_hides(&a, &b, &occluder).map_err(fails)?;
    }

    #[test]
    fn form_factors_are_reciprocal((a, b) in pair(), occluders in prop::collection::vec(polygon(), 0..2)) {
        factors::is_reciprocal(&a, &b, &occluders).map_err(fails)?;
    }

    #[test]
    fn form_factors_do_not_depend_on_place(
        (a, b) in pair(),
        turn in turn(),
        by in (-3.0..3.0, -3.0..3.0, -3.0..3.0),
        power in -12.0..12.0,
    ) {
        let by = DVec3::from(by);
        factors::does_not_depend_on_place(&a, &b, turn, by, 10f64.powf(power)).map_err(fails)?;
    }

    #[test]
    fn whatever_is_no_polygon_is_refused(coordinates in prop::collection::vec(any::<[f64; 3]>(), 0..6)) {
        let vertices: Vec<DVec3> = coordinates.iter().map(|&c| DVec3::from_array(c)).collect();
        if let Ok(polygon) = Polygon::new(&vertices) {
            prop_assert!(polygon.area() > 0.0 && polygon.normal().is_normalized());
        }
    }
}

proptest! {
    // The slow integral takes some milliseconds.
    #![proptest_config(ProptestConfig { max_shrink_iters: 50, ..testkit::config(24) })]

    #[test]
    fn bounds_hold_against_the_slow_integral((a, b) in pair(), digits in 4.0_f64..13.0) {
        factors::agrees_with_contours(&a, &b, 10f64.powf(-digits)).map_err(fails)?;
    }

    #[test]
    fn scenes_are_refused_or_solved(
        list in prop::collection::vec((polygon(), 0.0..1.0, 0.0..2.0, any::<bool>()), 1..6),
        tolerance in prop::option::of(0.01..0.5),
    ) {
        let surface = |(polygon, reflectance, emission, both): &(Polygon, f64, f64, bool)| {
            let one = Surface::new(polygon.vertices(), [*reflectance; 3]).emitting([*emission; 3]);
            if *both { one.two_sided() } else { one }
        };
        let surfaces: Vec<Surface> = list.iter().map(surface).collect();
        let options = SceneOptions::DEFAULT.with_patch(1.0).with_tolerance(tolerance);
        scenes::is_refused_or_solved(&surfaces, &options).map_err(fails)?;
        scenes::is_refused_or_solved_by_rays(&surfaces, &options).map_err(fails)?;
    }

    #[test]
    fn rows_of_closed_boxes_add_up_to_1(
        size in (0.05..4.0, 0.05..4.0, 0.05..4.0),
        turn in turn(),
    ) {
        let surfaces = room(DVec3::from(size), turn, 0.5, 1.0);
        let scene = Scene::new(&surfaces, &SceneOptions::DEFAULT).expect("a room");
        let transport = scene.transport(&[]).expect("a room");
        for sum in transport.row_sums() {
            prop_assert!((sum - 1.0).abs() < 1e-8, "{sum}");
        }
    }
}

#[test]
fn every_fault_of_a_polygon_is_named() {
    let of = |v: &[[f64; 3]]| Polygon::new(&v.iter().map(|&p| DVec3::from_array(p)).collect::<Vec<_>>());
    let (o, x, y) = ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    assert_eq!(of(&[o, x, [f64::NAN, 0.0, 0.0]]), Err(PolygonError::NotFinite { index: 2 }));
    assert_eq!(of(&[o, x, x, o]), Err(PolygonError::TooFewVertices { count: 2 }));
    assert_eq!(of(&[o, x, [2.0, 0.0, 0.0]]), Err(PolygonError::NoArea));
    let bent = of(&[o, x, [1.0, 1.0, 0.1], y]);
    assert!(matches!(bent, Err(PolygonError::NotPlanar { .. })), "{bent:?}");
    let dart = of(&[o, x, [0.2, 0.2, 0.0], y]);
    assert!(matches!(dart, Err(PolygonError::NotConvex { .. })), "{dart:?}");
    assert!(of(&[o, x, [1.0, 1.0, 0.0], y]).is_ok());
}
