//! Every public function with arbitrary values: it returns an answer or a typed error, never a panic or NaN.

use glam::{DAffine3, DMat3, DVec3, Vec3, dvec3};
use pointillist_ibpr::invariants::{self, OwnedScan, cloud};
use pointillist_ibpr::{
    Cloud, EyeDome, Frame, IbprError, Light, Options, Passes, Projection, Renderer, Scale, Scan,
    Translucency, View, Weighting,
};
use proptest::prelude::*;
use testkit::Rate;
use testkit::numbers::{finite, number, of_one_size, vector};

fn projection() -> impl Strategy<Value = Projection> {
    prop_oneof![
        1 => number().prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        9 => (0.01..3.1f64).prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        1 => number().prop_map(|height| Projection::Orthographic { height }),
        9 => (0.01..9.0f64).prop_map(|height| Projection::Orthographic { height }),
    ]
}

fn share() -> impl Strategy<Value = f32> {
    prop_oneof![40 => 0.0..=1.0f32, 1 => any::<f32>()]
}

fn positive() -> impl Strategy<Value = f32> {
    prop_oneof![40 => 0.1..4.0f32, 1 => any::<f32>(), 1 => Just(1e30f32), 1 => Just(1e-30f32)]
}

fn options() -> impl Strategy<Value = Options> {
    let size = (positive(), any::<bool>(), prop::option::of(share()), 0..8u32);
    let surface = (positive(), share(), any::<bool>(), vector(number));
    let layers = prop::option::of((share(), 0..10usize, positive()));
    let dome = prop::option::of((positive(), 0..70u32));
    (size, surface, layers, dome).prop_map(|(size, surface, layers, dome)| {
        let mut o = Options::default();
        o.scale = if size.1 { Scale::Auto(size.0) } else { Scale::Fixed(size.0) };
        o.passes = size.2.map_or(Passes::One, |finer| Passes::Two { finer });
        o.fill = size.3;
        (o.gamma, o.outline, o.surface_layers) = (surface.0, surface.1, surface.2);
        o.weighting = if surface.2 { Weighting::Symmetric } else { Weighting::Even };
        o.light = if surface.2 { Light::Towards(surface.3) } else { Light::Eye };
        o.translucency = layers.map(|(alpha, layers, threshold)| {
            Translucency::new(alpha).with_layers(layers).with_threshold(threshold)
        });
        o.eye_dome = dome.map(|(strength, radius)| EyeDome::new(strength, radius));
        o
    })
}

proptest! {
    #![proptest_config(testkit::config(512))]

    #[test]
    fn scans_become_a_cloud_or_are_refused(
        positions in prop::collection::vec(vector(number), 0..6), colors in prop::option::of(prop::collection::vec(any::<[f32; 3]>(), 0..6)),
        opacities in prop::option::of(prop::collection::vec(any::<f32>(), 0..6)),
        spacing in prop::option::of(number()), towards in prop::option::of(vector(number)),
    ) {
        let scan = OwnedScan { positions, colors, opacities, spacing, towards_scanner: towards };
        let result = cloud(std::slice::from_ref(&scan));
        let near = |p: &DVec3| p.abs().cmple(DVec3::splat(Scan::FARTHEST)).all();
        match result {
            Ok(cloud) => {
                prop_assert!(scan.positions.iter().all(near) && cloud.len() == scan.positions.len());
                prop_assert!(cloud.spacing() >= 0.0 && cloud.density_spacing() >= 0.0, "{cloud:?}");
                prop_assert!(cloud.spacing().is_finite() && cloud.density_spacing().is_finite(), "{cloud:?}");
            }
            Err(IbprError::PointNotFinite { index, .. }) => prop_assert!(!scan.positions[index].is_finite()),
            Err(IbprError::PointTooFar { index, .. }) => {
                prop_assert!(scan.positions[index].is_finite() && !near(&scan.positions[index]));
            }
            Err(IbprError::BadOpacity { index, .. }) => {
                let opacities = scan.opacities.unwrap_or_default();
                prop_assert!(!(0.0..=1.0).contains(&opacities[index]));
            }
            Err(_) => {}
        }
    }

    #[test]
    fn views_are_made_or_refused(
        eye in vector(number), target in vector(number), up in vector(number), p in projection(), w: u32, h: u32,
        columns in [vector(number), vector(number), vector(number)],
    ) {
        let matrix = DAffine3 { matrix3: DMat3::from_cols(columns[0], columns[1], columns[2]), translation: eye };
        for view in [View::look_at(eye, target, up, p, w, h), View::from_matrix(matrix, p, w, h)].into_iter().flatten() {
            prop_assert!(view.eye().is_finite() && (view.forward().length() - 1.0).abs() < 1e-6, "{view:?}");
        }
    }

    #[test]
    fn anything_that_is_accepted_can_be_drawn(
        positions in prop::collection::vec(vector(finite), 1..12), spacing in prop::option::of(positive()),
        eye in vector(finite), target in vector(finite), p in projection(), w in 1..20u32, h in 1..20u32, o in options(),
    ) {
        static ACCEPTED: Rate = Rate::of_at_least(0.3);
        let scan = OwnedScan { spacing: spacing.map(f64::from), ..OwnedScan::new(positions) };
        if let Ok(view) = View::look_at(eye, target, DVec3::Y, p, w, h) {
            ACCEPTED.count(invariants::frame(std::slice::from_ref(&scan), &view, &o).is_some())?;
            invariants::frames_are_sound(&[scan], &view, &o).map_err(TestCaseError::fail)?;
        }
    }

    #[test]
    fn clouds_of_any_size_can_be_drawn(
        positions in prop::collection::vec(vector(of_one_size), 1..40), power in -1000..1000i32,
        flat in 0..8u8, eye in vector(of_one_size), target in vector(of_one_size), perspective: bool, o in options(),
    ) {
        let k = f64::from(power).exp2();
        // On a plane, a line or a point.
        let squash = dvec3(f64::from(flat & 1), f64::from(flat >> 1 & 1), f64::from(flat >> 2));
        let scan = OwnedScan::new(positions).moved(|p| p * squash * k);
        let projection = match perspective {
            true => Projection::Perspective { fov_y_rad: 1.0 },
            false => Projection::Orthographic { height: 2.0 * k },
        };
        static ACCEPTED: Rate = Rate::of_at_least(0.3);
        if let Ok(view) = View::look_at(eye * k, target * k, DVec3::Y, projection, 24, 17) {
            ACCEPTED.count(invariants::frame(std::slice::from_ref(&scan), &view, &o).is_some())?;
            invariants::frames_are_sound(&[scan], &view, &o).map_err(TestCaseError::fail)?;
        }
    }
}

#[test]
fn as_many_points_as_cannot_be_numbered_are_refused() {
    let points = vec![DVec3::ZERO; 1 << 16];
    let scans = vec![Scan::new(&points); 1 << 16];
    assert_eq!(
        Cloud::new(&scans, Vec3::ONE).err(),
        Some(IbprError::TooManyPoints {
            count: points.len().saturating_mul(scans.len()),
            limit: u32::MAX as usize
        })
    );
}

#[test]
fn a_renderer_that_refused_goes_on() {
    let scan = OwnedScan::plane(DVec3::ZERO, DVec3::X * 0.1, DVec3::Y * 0.1, 9, 9);
    let cloud = cloud(&[scan]).unwrap();
    let camera = Projection::Orthographic { height: 1.0 };
    let view = View::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, camera, 9, 9).unwrap();
    let (mut renderer, mut frame) = (Renderer::new(), Frame::default());
    let mut bad = Options::default();
    bad.gamma = f32::NAN;
    assert!(renderer.draw(&cloud, &view, &bad, &mut frame).is_err());
    renderer.draw(&cloud, &view, &Options::default(), &mut frame).unwrap();
    assert!(frame.color()[40][3] == 1.0);
}
