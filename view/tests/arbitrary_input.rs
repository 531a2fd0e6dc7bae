//! Any numbers at all: a view is refused, or all facts hold for it, at the ends of the range of `f64`, too.

use glam::{DAffine3, DMat3, DVec3, dvec2, dvec3};
use pointillist_view::{Projection, View, invariants};
use proptest::prelude::*;
use testkit::Rate;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => -10.0..10.0f64,
        1 => (-3..=3_i32).prop_map(f64::from),
        2 => any::<f64>(),
        1 => (-1.0..1.0f64, -1074..1024_i32).prop_map(|(m, e)| m * 2f64.powi(e)),
        1 => prop::sample::select(vec![f64::MAX, f64::MIN_POSITIVE, f64::from_bits(1), 1e300, -1e300, f64::NAN, f64::INFINITY]),
    ]
}

fn vector() -> impl Strategy<Value = DVec3> {
    (number(), number(), number()).prop_map(|(x, y, z)| dvec3(x, y, z))
}

/// All coordinates of one size, so that more views are accepted.
fn even_vector() -> impl Strategy<Value = DVec3> {
    let component = || -1.0..1.0f64;
    (component(), component(), component(), -1074..1000_i32)
        .prop_map(|(x, y, z, e)| dvec3(x, y, z) * 2f64.powi(e / 2) * 2f64.powi(e - e / 2))
}

fn point() -> impl Strategy<Value = DVec3> {
    prop_oneof![vector(), even_vector()]
}

fn projection() -> impl Strategy<Value = Projection> {
    prop_oneof![
        number().prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        (1e-9..std::f64::consts::PI).prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        number().prop_map(|height| Projection::Orthographic { height: height.abs() }),
    ]
}

fn facts(view: &View, point: DVec3, [x, y, depth]: [f64; 3]) -> Result<(), TestCaseError> {
    let all = invariants::axes_are_orthonormal(view)
        .and_then(|()| invariants::the_matrix_gives_the_view(view))
        .and_then(|()| invariants::unprojecting_gives_the_point(view, point))
        .and_then(|()| invariants::projecting_gives_the_pixel(view, dvec2(x, y), depth))
        .and_then(|()| invariants::rays_hit_what_is_seen(view, point));
    all.map_err(TestCaseError::fail)
}

proptest! {
    #![proptest_config(testkit::config(8000))]

    #[test]
    fn a_view_from_anywhere_is_refused_or_keeps_all_facts(
        (eye, target, up) in (point(), point(), point()),
        projection in projection(),
        (w, h) in (0..3000_u32, 0..3000_u32),
        seen in point(),
        place in [number(), number(), number()],
    ) {
        static ACCEPTED: Rate = Rate::of_at_least(0.3);
        let view = View::look_at(eye, target, up, projection, w, h);
        ACCEPTED.count(view.is_ok())?;
        if let Ok(view) = view {
            facts(&view, seen, place)?;
            // Also near where it looks.
            facts(&view, target, [0.3 * f64::from(w), 0.9 * f64::from(h), (target - eye).length()])?;
        }
    }

    #[test]
    fn a_matrix_of_anything_is_refused_or_keeps_all_facts(
        columns in [vector(), vector(), vector()],
        (towards, up) in (even_vector(), even_vector()),
        (shift, error) in (point(), prop_oneof![Just(0.0), -1e-6..1e-6f64]),
        seen in point(),
        place in [number(), number(), number()],
    ) {
        let camera = Projection::Perspective { fov_y_rad: 0.7 };
        let any = DAffine3::from_mat3_translation(DMat3::from_cols(columns[0], columns[1], columns[2]), shift);
        let mut rigid = any;
        if let Ok(view) = View::look_at(DVec3::ZERO, towards, up, camera, 1, 1) {
            rigid.matrix3 = view.view_from_world().matrix3;
            rigid.matrix3.y_axis.x += error;
        }
        static ACCEPTED: Rate = Rate::of_at_least(0.3);
        let views = [any, rigid].map(|matrix| View::from_matrix(matrix, camera, 30, 20));
        ACCEPTED.count(views[1].is_ok())?;
        for view in views.into_iter().flatten() {
            facts(&view, seen, place)?;
        }
    }
}
