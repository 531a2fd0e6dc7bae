//! Errors, one by one: clouds, views, options.

use glam::{DVec3, Vec3, dvec3};
use pointillist_surfel::invariants::look_at;
use pointillist_surfel::{
    Cloud, Focus, Frame, Light, Options, Points, Projection, Renderer, SurfelError, ViewError,
    field_of_view_rad,
};

const PERSPECTIVE: Projection = Projection::Perspective { fov_y_rad: 0.7 };
const TWO: [DVec3; 2] = [DVec3::ZERO, DVec3::ONE];

fn refused(points: &Points<'_>) -> SurfelError {
    Cloud::new(points).expect_err("the points are bad")
}

#[test]
fn a_cloud_without_points_is_refused() {
    assert_eq!(refused(&Points::new(&[])), SurfelError::NoPoints);
    assert_eq!(refused(&Points::new(&[]).with_normals(&[Vec3::Z])), SurfelError::NoPoints);
}

#[test]
fn a_position_that_is_not_finite_is_named() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308] {
        for axis in 0..3 {
            let mut points = [DVec3::ZERO, DVec3::ONE, DVec3::X];
            points[2][axis] = bad;
            match refused(&Points::new(&points)) {
                SurfelError::PointNotFinite { index: 2, value } => {
                    assert!(!bad.is_finite() && value[axis].to_bits() == bad.to_bits());
                }
                SurfelError::PointTooFar { index: 2, value } => {
                    assert!(bad.is_finite() && value == points[2].to_array());
                }
                other => panic!("{other:?}"),
            }
        }
    }
    assert!(Cloud::new(&Points::new(&[DVec3::splat(-4e307), DVec3::splat(4e307)])).is_ok());
}

#[test]
fn attributes_are_as_many_as_positions() {
    let points = Points::new(&TWO);
    let mismatch = |what, length| SurfelError::LengthMismatch { what, length, count: 2 };
    assert_eq!(refused(&points.with_normals(&[Vec3::Z])), mismatch("normals", 1));
    assert_eq!(refused(&points.with_normals(&[])), mismatch("normals", 0));
    let of_discs = points.with_normals(&[Vec3::Z; 2]);
    assert_eq!(refused(&of_discs.with_shading_normals(&[Vec3::Z])), mismatch("shading normals", 1));
    assert_eq!(refused(&points.with_shading_normals(&[Vec3::Z; 2])), SurfelError::OnlyShadingNormals);
    assert_eq!(refused(&points.with_colors(&[[0.5; 3]; 3])), mismatch("colors", 3));
    assert_eq!(refused(&points.with_radii(&[1.0])), mismatch("radii", 1));
    assert_eq!(refused(&points.with_opacities(&[1.0; 3])), mismatch("opacities", 3));
}

#[test]
fn attributes_are_checked_and_named() {
    let points = Points::new(&TWO);
    for bad in [Vec3::ZERO, -Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::new(1.0, f32::NAN, 0.0)] {
        assert_eq!(refused(&points.with_normals(&[Vec3::Z, bad])), SurfelError::BadNormal { index: 1 });
        let of_discs = points.with_normals(&[Vec3::Z; 2]);
        let shading = [bad, Vec3::Z];
        assert_eq!(refused(&of_discs.with_shading_normals(&shading)), SurfelError::BadNormal { index: 0 });
    }
    for bad in [f32::NAN, f32::INFINITY, -0.1] {
        let error = refused(&points.with_colors(&[[0.5; 3], [0.1, bad, 0.2]]));
        assert_eq!(error, SurfelError::BadColor { index: 1 });
    }
    for bad in [0.0, -0.0, -1.0, f32::NAN, f32::INFINITY] {
        match refused(&points.with_radii(&[1.0, bad])) {
            SurfelError::BadRadius { index: 1, radius } => assert_eq!(radius.to_bits(), bad.to_bits()),
            other => panic!("{other:?}"),
        }
    }
    for bad in [-0.1, 1.000_001, f32::NAN, f32::INFINITY] {
        match refused(&points.with_opacities(&[1.0, bad])) {
            SurfelError::BadOpacity { index: 1, value } => assert_eq!(value.to_bits(), bad.to_bits()),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn normals_and_radii_of_any_size_are_taken() {
    for size in [1e-45, 1e-30, 1.0, 3e38] {
        let normals = [Vec3::Z * size, Vec3::ONE * size];
        assert!(Cloud::new(&Points::new(&TWO).with_normals(&normals).with_radii(&[size; 2])).is_ok());
    }
}

#[test]
fn a_picture_too_large_to_be_kept_is_refused() {
    let cloud = Cloud::new(&Points::new(&TWO).with_normals(&[Vec3::Z; 2]).with_radii(&[2.0; 2])).unwrap();
    let view = look_at(DVec3::Z * 5.0, DVec3::ZERO, PERSPECTIVE, 9, 9).unwrap();
    let (most, mut frame) = (Renderer::LARGEST_SIDE, Frame::default());
    for (width, height, fits) in
        [(most, 1, true), (1, most, true), (most + 1, 1, false), (1, most + 1, false)]
    {
        let view = view.with_size(width, height).unwrap();
        let drawn = Renderer::new().draw(&cloud, &view, &Options::default(), &mut frame);
        let expected = if fits { Ok(()) } else { Err(SurfelError::TooLarge { width, height }) };
        assert_eq!(drawn, expected);
    }
    let beyond = view.with_size(8, u32::MAX);
    assert_eq!(beyond, Err(ViewError::BadSize { width: 8, height: u32::MAX }));
}

#[test]
fn options_are_checked_by_name() {
    type Change = fn(&mut Options);
    let changes: [(&str, Change); 23] = [
        ("depth", |o| o.focus = Focus::Depth { depth: -0.1, focus: 1.0 }),
        ("depth", |o| o.focus = Focus::Depth { depth: f64::NAN, focus: 1.0 }),
        ("depth", |o| o.focus = Focus::Depth { depth: f64::INFINITY, focus: 1.0 }),
        ("focus", |o| o.focus = Focus::Depth { depth: 0.1, focus: 0.0 }),
        ("focus", |o| o.focus = Focus::Depth { depth: 0.1, focus: -2.0 }),
        ("focus", |o| o.focus = Focus::Depth { depth: 0.0, focus: f64::NAN }),
        ("focus", |o| o.focus = Focus::Depth { depth: 0.1, focus: f64::INFINITY }),
        ("aperture", |o| o.focus = Focus::Lens { aperture: -1.0, focus: 1.0 }),
        ("aperture", |o| o.focus = Focus::Lens { aperture: f64::NAN, focus: 1.0 }),
        ("aperture", |o| o.focus = Focus::photographic(0.05, 0.0, 1.0)),
        ("focus", |o| o.focus = Focus::Lens { aperture: 0.1, focus: 0.0 }),
        ("focus", |o| o.focus = Focus::Lens { aperture: 0.1, focus: -1.0 }),
        ("level", |o| o.level = -1.0),
        ("level", |o| o.level = f32::NAN),
        ("level", |o| o.level = f32::INFINITY),
        ("ambient", |o| o.ambient = -0.1),
        ("ambient", |o| o.ambient = 1.1),
        ("ambient", |o| o.ambient = f32::NAN),
        ("base", |o| o.base = Vec3::NAN),
        ("base", |o| o.base = Vec3::new(1.0, -0.5, 1.0)),
        ("light", |o| o.light = Light::Towards(DVec3::ZERO)),
        ("light", |o| o.light = Light::Towards(DVec3::NAN)),
        ("light", |o| o.light = Light::Towards(DVec3::INFINITY)),
    ];
    let cloud = Cloud::new(&Points::new(&TWO)).unwrap();
    let view = look_at(DVec3::Z * 5.0, DVec3::ZERO, PERSPECTIVE, 32, 32).unwrap();
    for (wanted, change) in changes {
        let mut options = Options::default();
        change(&mut options);
        let result = Renderer::new().draw(&cloud, &view, &options, &mut Frame::default());
        let named = matches!(result, Err(SurfelError::BadOption { name, .. }) if name == wanted);
        assert!(named, "{wanted}: {result:?}");
    }
}

#[test]
fn directions_of_light_of_any_length_are_taken() {
    let cloud = Cloud::new(&Points::new(&TWO)).unwrap();
    let view = look_at(DVec3::Z * 5.0, DVec3::ZERO, PERSPECTIVE, 32, 32).unwrap();
    let by = |length: f64| {
        let (mut options, mut frame) = (Options::default(), Frame::default());
        options.light = Light::Towards(dvec3(0.6, 0.0, 0.8) * length);
        Renderer::new().draw(&cloud, &view, &options, &mut frame).map(|()| frame.color().to_vec())
    };
    for length in [1e-320, 1e-200, 1e-3, 1e200, 1e308] {
        let lit = by(length).unwrap_or_else(|e| panic!("{length:e}: {e}"));
        let same =
            lit.iter().flatten().zip(by(1.0).unwrap().iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-3);
        assert!(same, "{length:e}");
    }
}

#[test]
fn a_lens_that_cannot_focus_has_no_field_of_view() {
    for (focal_length, sensor, focus) in
        [(0.05, 0.024, 0.05), (0.05, 0.024, 0.01), (0.0, 1.0, 1.0), (0.05, 0.0, 1.0)]
    {
        assert_eq!(field_of_view_rad(focal_length, sensor, focus), None);
    }
    assert_eq!(field_of_view_rad(f64::NAN, 0.024, 1.0), None);
    assert_eq!(field_of_view_rad(0.05, f64::NAN, 1.0), None);
    assert_eq!(field_of_view_rad(0.05, 0.024, f64::NAN), None);
}

#[test]
fn a_renderer_that_refused_goes_on() {
    let cloud = Cloud::new(&Points::new(&TWO).with_normals(&[Vec3::Z; 2]).with_radii(&[2.0; 2])).unwrap();
    let view = look_at(DVec3::Z * 5.0, DVec3::ZERO, PERSPECTIVE, 9, 9).unwrap();
    let (mut renderer, mut frame) = (Renderer::new(), Frame::default());
    let mut bad = Options::default();
    bad.level = f32::NAN;
    assert!(renderer.draw(&cloud, &view, &bad, &mut frame).is_err());
    renderer.draw(&cloud, &view, &Options::default(), &mut frame).unwrap();
    assert_eq!((frame.width(), frame.height()), (9, 9));
    assert_eq!(frame.color()[40][3], 1.0);
}

#[test]
fn every_error_says_something() {
    let errors = [
        SurfelError::NoPoints,
        SurfelError::PointNotFinite { index: 7, value: [f64::NAN; 3] },
        SurfelError::PointTooFar { index: 7, value: [1e308; 3] },
        SurfelError::VertexNotFinite { index: 7, value: [f64::NAN; 3] },
        SurfelError::VertexOutOfRange { triangle: 7, vertex: 7, count: 7 },
        SurfelError::TooManyPoints { count: 1e12, limit: Points::MOST },
        SurfelError::LengthMismatch { what: "radii", length: 3, count: 7 },
        SurfelError::BadNormal { index: 7 },
        SurfelError::OnlyShadingNormals,
        SurfelError::BadColor { index: 7 },
        SurfelError::BadRadius { index: 7, radius: -1.0 },
        SurfelError::BadOpacity { index: 7, value: 1.5 },
        SurfelError::TooLarge { width: 70_000, height: 1 },
        SurfelError::BadOption { name: "level", value: -7.0, range: "it must be at least 0" },
    ];
    for error in errors {
        let text = error.to_string();
        assert!(
            text.contains('7')
                || matches!(
                    error,
                    SurfelError::NoPoints
                        | SurfelError::OnlyShadingNormals
                        | SurfelError::TooManyPoints { .. }
                ),
            "{text}"
        );
    }
}
