//! Every public function for clouds with arbitrary values: it returns an answer or a typed error, never a panic or NaN,
//! in bounded time.

use glam::{DAffine3, DMat3, Vec3, dvec3};
use pointillist_surfel::invariants::{self, OwnedPoints, cloud, look_at};
use pointillist_surfel::{
    Focus, Light, Options, Procedure, Projection, SurfelError, View, field_of_view_rad,
};
use proptest::prelude::*;
use std::time::{Duration, Instant};
use testkit::Rate;
use testkit::numbers::{finite, number, of_one_size, vector};

fn normal() -> BoxedStrategy<Vec3> {
    prop_oneof![4 => vector(of_one_size).prop_map(|v| v.as_vec3()), 1 => any::<[f32; 3]>().prop_map(Vec3::from_array)]
        .boxed()
}

fn projection() -> BoxedStrategy<Projection> {
    prop_oneof![
        1 => number().prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        9 => (0.01..3.1f64).prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        1 => number().prop_map(|height| Projection::Orthographic { height }),
        9 => (0.01..9.0f64).prop_map(|height| Projection::Orthographic { height }),
    ]
    .boxed()
}

fn share() -> BoxedStrategy<f32> {
    prop_oneof![40 => 0.0..=1.0f32, 1 => any::<f32>()].boxed()
}

fn positive() -> BoxedStrategy<f32> {
    prop_oneof![40 => 0.1..4.0f32, 1 => any::<f32>(), 1 => Just(1e30f32), 1 => Just(1e-30f32)].boxed()
}

/// Most values of a kind are good, so that frames are drawn.
fn amount() -> BoxedStrategy<f64> {
    prop_oneof![40 => 0.01..4.0f64, 1 => number(), 1 => Just(1e300), 1 => Just(1e-300)].boxed()
}

fn focus() -> BoxedStrategy<Focus> {
    prop_oneof![
        Just(Focus::Everywhere),
        (amount(), amount()).prop_map(|(depth, focus)| Focus::Depth { depth, focus }),
        (amount(), amount()).prop_map(|(aperture, focus)| Focus::Lens { aperture, focus }),
        (amount(), amount(), amount())
            .prop_map(|(length, stop, focus)| Focus::photographic(length, stop, focus)),
    ]
    .boxed()
}

fn options() -> BoxedStrategy<Options> {
    let picture = (focus(), any::<[bool; 3]>(), positive(), share());
    (picture, prop::option::of(vector(finite)), prop::option::of([share(), share(), share()]))
        .prop_map(|((focus, [paper, culling, normals], level, ambient), light, base)| {
            let mut o = Options::default();
            (o.focus, o.culling, o.surface_layers, o.level, o.ambient) =
                (focus, culling, normals, level, ambient);
            o.procedure = if paper { Procedure::Paper } else { Procedure::Blended };
            o.light = light.map_or(Light::Eye, Light::Towards);
            o.base = base.map_or(o.base, Vec3::from_array);
            o
        })
        .boxed()
}

/// No frame here has 500 pixels or 50 points.
const MOST_TIME: Duration = Duration::from_secs(5);

fn frames_are_sound(points: &OwnedPoints, view: &View, o: &Options) -> Result<(), TestCaseError> {
    let start = Instant::now();
    invariants::frames_are_sound(points, view, o).map_err(TestCaseError::fail)?;
    prop_assert!(start.elapsed() < MOST_TIME, "took {:?}", start.elapsed());
    Ok(())
}

proptest! {
    #![proptest_config(testkit::config(512))]

    #[test]
    fn points_become_a_cloud_or_are_refused(
        positions in prop::collection::vec(vector(number), 0..6), normals in prop::option::of(prop::collection::vec(normal(), 0..6)),
        shading_normals in prop::option::of(prop::collection::vec(normal(), 0..6)),
        colors in prop::option::of(prop::collection::vec(any::<[f32; 3]>(), 0..6)), radii in prop::option::of(prop::collection::vec(positive(), 0..6)),
        opacities in prop::option::of(prop::collection::vec(share(), 0..6)),
    ) {
        let points = OwnedPoints { positions, normals, shading_normals, colors, radii, opacities };
        match cloud(&points) {
            Ok(cloud) => {
                prop_assert!(cloud.len() == points.positions.len());
                prop_assert!(cloud.spacing() > 0.0 && cloud.spacing().is_finite(), "{}", cloud.spacing());
                prop_assert!(cloud.positions().all(|p| p.is_finite()));
                invariants::octree_is_sound(&cloud).map_err(TestCaseError::fail)?;
            }
            Err(SurfelError::PointNotFinite { index, .. }) => prop_assert!(!points.positions[index].is_finite()),
            Err(SurfelError::PointTooFar { index, .. }) => {
                prop_assert!(points.positions[index].abs().max_element() > pointillist_surfel::Points::FARTHEST);
            }
            Err(_) => {}
        }
    }

    #[test]
    fn views_are_made_or_refused(
        eye in vector(number), target in vector(number), p in projection(), w: u32, h: u32,
        columns in [vector(number), vector(number), vector(number)],
    ) {
        let matrix = DAffine3 { matrix3: DMat3::from_cols(columns[0], columns[1], columns[2]), translation: eye };
        for view in [look_at(eye, target, p, w, h), View::from_matrix(matrix, p, w, h).ok()].into_iter().flatten() {
            prop_assert!(view.eye().is_finite() && (view.forward().length() - 1.0).abs() < 1e-6, "{view:?}");
        }
    }

    #[test]
    fn anything_that_is_accepted_can_be_drawn(
        positions in prop::collection::vec(vector(finite), 1..12),
        [normals, shading_normals] in prop::array::uniform2(prop::option::of(prop::collection::vec(normal(), 12))),
        radii in prop::option::of(prop::collection::vec(positive(), 12)), colored: bool,
        opacities in prop::option::of(prop::collection::vec(0.0..=1.0f32, 12)),
        eye in vector(finite), target in vector(finite), p in projection(), w in 1..20u32, h in 1..20u32, o in options(),
    ) {
        let n = positions.len();
        let points = OwnedPoints {
            shading_normals: shading_normals.filter(|_| normals.is_some()).map(|all| all[..n].to_vec()),
            normals: normals.map(|all| all[..n].to_vec()),
            radii: radii.map(|all| all[..n].to_vec()),
            colors: colored.then(|| (0..n).map(|i| [i as f32, 1e30, 0.0]).collect()),
            opacities: opacities.map(|all| all[..n].to_vec()),
            positions,
        };
        static ACCEPTED: Rate = Rate::of_at_least(0.8);
        if let Some(view) = look_at(eye, target, p, w, h) {
            ACCEPTED.count(invariants::frame(&points, &view, &o).is_some())?;
            frames_are_sound(&points, &view, &o)?;
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
        let points = OwnedPoints::loose(positions).moved(|p| p * squash * k);
        let projection = match perspective {
            true => Projection::Perspective { fov_y_rad: 1.0 },
            false => Projection::Orthographic { height: 2.0 * k },
        };
        static ACCEPTED: Rate = Rate::of_at_least(0.8);
        if let Some(view) = look_at(eye * k, target * k, projection, 24, 17) {
            ACCEPTED.count(invariants::frame(&points, &view, &o).is_some())?;
            frames_are_sound(&points, &view, &o)?;
        }
    }

    #[test]
    fn a_field_of_view_is_an_angle_or_none(length in amount(), sensor in amount(), focus in amount()) {
        if let Some(fov) = field_of_view_rad(length, sensor, focus) {
            prop_assert!((0.0..=std::f64::consts::PI).contains(&fov), "{fov}");
        }
    }
}
