//! Clouds in parts: the facts of `invariants`, and pictures across the ends of parts.

use glam::{DVec3, Vec3, dvec3};
use pointillist_surfel::invariants::{self, OwnedPoints, cloud};
use pointillist_surfel::{
    Cloud, Division, Frame, NO_PART, Options, Points, Projection, Renderer, SurfelError, View,
};
use proptest::prelude::*;
use testkit::holds;

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -1.0..1.0f64,
        2 => (-2..=2).prop_map(|i| 0.5 * f64::from(i)),
        1 => (-1.0..1.0f64).prop_map(|x| 1e6 + x),
        1 => (-1.0..1.0f64, -30..30).prop_map(|(x, e)| x * 10f64.powi(e)),
    ]
}

fn normal(i: usize) -> Vec3 {
    let turn = i as f32;
    Vec3::new(turn.sin(), turn.cos(), 0.3).normalize()
}

fn points() -> impl Strategy<Value = OwnedPoints> {
    let place = [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array);
    let spiral = (1u32..1500, -3..2i32).prop_map(|(n, e)| {
        let at =
            |t: f64| dvec3((0.7 * t).cos(), (0.7 * t).sin(), 0.01 * (t % 37.0)) * (10f64.powi(e) * t.sqrt());
        (0..n).map(|i| at(f64::from(i))).collect::<Vec<_>>()
    });
    let positions = prop_oneof![prop::collection::vec(place, 1..80), spiral];
    (positions, any::<[bool; 5]>()).prop_map(|(positions, [normals, lit, radii, colors, opacities])| {
        let n = positions.len();
        OwnedPoints {
            normals: normals.then(|| (0..n).map(normal).collect()),
            shading_normals: (normals && lit).then(|| (0..n).map(|i| normal(i / 2)).collect()),
            radii: radii.then(|| (0..n).map(|i| 0.01 + 0.02 * (i % 5) as f32).collect()),
            colors: colors.then(|| (0..n).map(|i| [i as f32, 0.5, 0.1]).collect()),
            opacities: opacities.then(|| (0..n).map(|i| if i % 3 == 0 { 0.5 } else { 1.0 }).collect()),
            positions,
        }
    })
}

proptest! {
    #![proptest_config(testkit::config(24))]

    #[test]
    fn parts_among_all_others_are_the_whole(points in points()) {
        holds!(invariants::parts_are_the_whole(&points));
    }

    #[test]
    fn parts_of_any_points_are_sound(
        points in points(),
        numbers in prop::collection::vec(prop_oneof![0u8..9, Just(NO_PART)], 1..40),
        low in prop::array::uniform3(-2.0..2.0f64),
        side in prop_oneof![1e-3..10.0f64, Just(0.0), Just(f64::NAN), Just(1e300)],
        spacing in prop_oneof![1e-6..1.0f64, Just(-1.0), Just(1e-300), Just(f64::INFINITY)],
    ) {
        let numbers: Vec<u8> = numbers.into_iter().cycle().take(points.positions.len()).collect();
        let division = Division { low: DVec3::from_array(low), side, spacing };
        holds!(invariants::parts_are_sound(&points, &numbers, &division));
    }
}

/// A bumpy sheet over a square without anything but positions, seen from above at an angle.
fn sheet(side: u32) -> OwnedPoints {
    let mut state = 5u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1u64 << 24) as f64
    };
    let mut at = |i: u32| {
        let (x, y) = (f64::from(i % side) + 0.6 * next(), f64::from(i / side) + 0.6 * next());
        let (x, y) = (x / f64::from(side), y / f64::from(side));
        dvec3(x, y, 0.5 + 0.05 * (9.0 * x).sin() * (7.0 * y).cos() + 2e-4 * next())
    };
    OwnedPoints::loose((0..side * side).map(&mut at).collect())
}

fn drawn(cloud: &Cloud) -> Frame {
    let lens = Projection::Perspective { fov_y_rad: 0.8 };
    let view = View::look_at(dvec3(0.5, -0.5, 1.4), dvec3(0.5, 0.5, 0.5), DVec3::Z, lens, 300, 200).unwrap();
    let mut frame = Frame::new();
    Renderer::new().draw(cloud, &view, &Options::default(), &mut frame).unwrap();
    frame
}

#[test]
fn where_parts_meet_nothing_is_seen_of_it() {
    const SIDE: u32 = 120;
    let sheet = sheet(SIDE);
    let whole = drawn(&cloud(&sheet).unwrap());
    let difference = |margin: f64| {
        let parts = drawn(&invariants::in_octants(&sheet, 1.0 / f64::from(SIDE), margin).unwrap());
        let off = |(a, b): (&[f32; 4], &[f32; 4])| (0..4).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max);
        let mut off: Vec<f32> = whole.color().iter().zip(parts.color()).map(off).collect();
        off.sort_unstable_by(|a, b| b.total_cmp(a));
        (off[0], off[60])
    };
    // The picture differs in that links end where parts do, all over the picture by less than a step of 8 bits.
    let (worst, usual) = difference(6.0 / f64::from(SIDE));
    assert!(worst < 0.02 && usual < 0.004, "{worst} {usual}");
    // The test can fail: without the points around them, parts have seams.
    let (worst, usual) = difference(0.0);
    assert!(worst > 0.2 && usual > 0.004, "{worst} {usual}");
}

#[test]
fn what_is_no_division_is_refused() {
    let position = [DVec3::ONE];
    let points = Points::new(&position);
    let division = Division { low: DVec3::ZERO, side: 2.0, spacing: 0.1 };
    assert!(matches!(
        Cloud::parts(&points, &[], &division),
        Err(SurfelError::LengthMismatch { length: 0, .. })
    ));
    let flat = Division { side: 0.0, ..division };
    assert!(matches!(Cloud::parts(&points, &[0], &flat), Err(SurfelError::BadCube { .. })));
    let dense = Division { spacing: 0.0, ..division };
    assert!(matches!(Cloud::parts(&points, &[0], &dense), Err(SurfelError::BadSpacing { .. })));
    assert!(matches!(Cloud::join(&[]), Err(SurfelError::NoPoints)));
    let part = |division: &Division, normals: bool| {
        let points = if normals { points.with_normals(&[Vec3::X]) } else { points };
        Cloud::parts(&points, &[0], division).unwrap().remove(0).unwrap()
    };
    let (one, elsewhere) = (part(&division, false), part(&Division { side: 3.0, ..division }, false));
    assert_eq!(Cloud::join(&[&one, &elsewhere]), Err(SurfelError::NotOfOneKind { index: 1 }));
    assert_eq!(
        Cloud::join(&[&one, &one, &part(&division, true)]),
        Err(SurfelError::NotOfOneKind { index: 2 })
    );
    assert_eq!(Cloud::parts(&points, &[NO_PART], &division), Ok(vec![]));
    // A lone point has three quarters of the spacing for a radius.
    assert!((one.bytes() > 0) && one.len() == 1);
}
