//! Facts of `invariants` over arbitrary views and places, in scenes of every size and far from the origin, and what
//! must be refused for every view.

use glam::{DAffine3, DMat3, DQuat, DVec3, dvec2, dvec3};
use pointillist_view::{PixelRect, Projection, View, ViewError, invariants};
use proptest::prelude::*;

fn holds(fact: Result<(), String>) -> Result<(), TestCaseError> {
    fact.map_err(TestCaseError::fail)
}

/// Units of length of scenes: from the bottom of the range of `f64` to its top.
fn unit() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => Just(1.0),
        1 => Just(1e-299),
        1 => Just(1e-160),
        1 => Just(1e-20),
        1 => Just(1e160),
        1 => Just(1e299),
        2 => (-990..990_i32).prop_map(|e| 2f64.powi(e)),
    ]
}

/// Some coordinates are on a coarse lattice: axes, diagonals, equal points.
fn vector() -> impl Strategy<Value = DVec3> {
    let number = || prop_oneof![3 => -1.0..1.0f64, 1 => (-3..=3_i32).prop_map(|n| 0.25 * f64::from(n))];
    (number(), number(), number()).prop_map(|(x, y, z)| dvec3(x, y, z))
}

/// Scenes at the origin, and a million units away from it.
fn offset() -> impl Strategy<Value = DVec3> {
    prop_oneof![3 => Just(DVec3::ZERO), 1 => vector().prop_map(|v| v * 1e6), 1 => vector()]
}

fn projection(unit: f64) -> BoxedStrategy<Projection> {
    prop_oneof![
        4 => (0.01..3.1f64).prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        1 => (1e-9..1e-3f64).prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        4 => (0.01..4.0f64).prop_map(move |height| Projection::Orthographic { height: 10.0 * height * unit.min(1e298) }),
    ]
    .boxed()
}

fn side() -> impl Strategy<Value = u32> {
    prop_oneof![4 => 1..2000_u32, 1 => Just(View::LARGEST_SIDE), 1 => Just(1)]
}

/// A view, and the unit and offset of its scene.
fn view() -> impl Strategy<Value = (View, f64, DVec3)> {
    (unit(), offset()).prop_flat_map(|(unit, offset)| {
        let offset = if unit > 1e290 { DVec3::ZERO } else { offset };
        let up = (vector(), prop_oneof![2 => Just(1.0), 1 => Just(1e-310), 1 => Just(1e290)]);
        (vector(), vector(), up, projection(unit), side(), side()).prop_filter_map(
            "no camera",
            move |(eye, target, (up, length), p, w, h)| {
                let at = |v: DVec3| (v + offset) * unit;
                let view = View::look_at(at(eye), at(target), up * length, p, w, h).ok()?;
                Some((view, unit, offset))
            },
        )
    })
}

proptest! {
    #![proptest_config(testkit::config(2000))]

    #[test]
    fn projecting_and_unprojecting_invert_each_other(
        (view, unit, offset) in view(),
        point in vector(),
        (x, y) in (-0.5..1.5f64, -0.5..1.5f64),
        depth in prop_oneof![0.01..2.0f64, -1.0..0.0f64],
    ) {
        holds(invariants::unprojecting_gives_the_point(&view, (point + offset) * unit))?;
        let pixel = dvec2(x * f64::from(view.width()), y * f64::from(view.height()));
        holds(invariants::projecting_gives_the_pixel(&view, pixel, depth * unit))?;
    }

    #[test]
    fn a_ray_hits_what_is_seen_at_its_pixel((view, unit, offset) in view(), point in vector()) {
        holds(invariants::rays_hit_what_is_seen(&view, (point + offset) * unit))?;
    }

    #[test]
    fn axes_are_orthonormal((view, _, _) in view(), (direction, off) in (vector(), vector()), tilt in -13..0_i32) {
        holds(invariants::axes_are_orthonormal(&view))?;
        // Also if up is nearly parallel to the view direction.
        let up = direction + off * 10f64.powi(tilt);
        if let Ok(steep) = View::look_at(DVec3::ZERO, direction, up, view.projection(), 1, 1) {
            holds(invariants::axes_are_orthonormal(&steep))?;
        }
    }

    #[test]
    fn the_matrix_of_a_view_gives_the_view((view, _, _) in view()) {
        holds(invariants::the_matrix_gives_the_view(&view))?;
    }

    /// As from a file or a GPU: rounded matrices pass, and their axes are made orthonormal.
    #[test]
    fn rotations_rounded_to_f32_are_accepted((view, _, _) in view()) {
        let rotation = view.view_from_world().matrix3.as_mat3().as_dmat3();
        let rounded = DAffine3::from_mat3_translation(rotation, view.view_from_world().translation);
        let again = View::from_matrix(rounded, view.projection(), view.width(), view.height());
        let again = again.map_err(|error| TestCaseError::fail(error.to_string()))?;
        holds(invariants::axes_are_orthonormal(&again))?;
        prop_assert!((again.forward() - view.forward()).length() < 1e-6);
        prop_assert!((again.up() - view.up()).length() < 1e-6);
    }

    /// A power of two rounds nothing: axes and pixels are the same bits.
    #[test]
    fn a_scaled_scene_is_the_same_picture(
        (eye, target, up, point) in (vector(), vector(), vector(), vector()),
        fov_y_rad in 0.01..3.1f64,
        exponent in -900..900_i32,
    ) {
        let at = |k: f64| View::look_at(eye * k, target * k, up * k, Projection::Perspective { fov_y_rad }, 60, 40);
        let k = 2f64.powi(exponent);
        if let Ok(view) = at(1.0) {
            let scaled = at(k).unwrap();
            prop_assert_eq!((scaled.right(), scaled.up(), scaled.forward()), (view.right(), view.up(), view.forward()));
            prop_assert_eq!(scaled.project(point * k).map(|p| p.pixel), view.project(point).map(|p| p.pixel));
        }
    }

    #[test]
    fn mirrored_scaled_sheared_and_broken_matrices_are_refused(
        (view, _, _) in view(),
        axis in 0..3_usize,
        (factor, shear) in (prop_oneof![-3.0..0.99f64, 1.01..3.0f64], prop_oneof![-1.0..-0.01f64, 0.01..1.0f64]),
        entry in 0..12_usize,
        bad in prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY)],
    ) {
        let good = view.view_from_world();
        let from = |m: DAffine3| View::from_matrix(m, view.projection(), view.width(), view.height());
        let along = |f: f64| {
            let mut diagonal = DVec3::ONE;
            diagonal[axis] = f;
            DAffine3::from_scale(diagonal)
        };
        for mirrored in [along(-1.0) * good, good * along(-1.0)] {
            prop_assert!(matches!(from(mirrored), Err(ViewError::Mirrored { .. })), "{:?}", from(mirrored));
        }
        prop_assume!((factor + 1.0).abs() > 0.01);
        let mut sheared = DMat3::IDENTITY;
        sheared.col_mut(axis)[(axis + 1) % 3] = shear;
        for skewed in [along(factor) * good, DAffine3::from_mat3(sheared) * good] {
            prop_assert!(matches!(from(skewed), Err(ViewError::NotRigid { .. })), "{:?}", from(skewed));
        }
        let mut broken = good.to_cols_array();
        broken[entry] = bad;
        let refused = from(DAffine3::from_cols_array(&broken));
        let expected = matches!(refused, Err(ViewError::NotRigid { .. } | ViewError::BadEye { .. }));
        prop_assert!(expected, "{refused:?}");
    }

    #[test]
    fn any_rotation_and_shift_is_a_camera(
        (axis, angle) in (vector(), -7.0..7.0f64),
        shift in vector(),
        unit in unit(),
    ) {
        let Some(axis) = axis.try_normalize() else { return Ok(()) };
        let matrix = DAffine3::from_rotation_translation(DQuat::from_axis_angle(axis, angle), shift * unit);
        let camera = Projection::Perspective { fov_y_rad: 1.0 };
        let view = View::from_matrix(matrix, camera, 8, 8).map_err(|e| TestCaseError::fail(e.to_string()))?;
        let eye = matrix.transform_point3(view.eye());
        prop_assert!(eye.abs().max_element() <= 64.0 * f64::EPSILON * unit, "{eye}");
        prop_assert!((matrix.transform_vector3(view.forward()) - DVec3::NEG_Z).length() < 1e-14);
        prop_assert!((matrix.transform_vector3(view.right()) - DVec3::X).length() < 1e-14);
    }

    #[test]
    fn tiles_partition_a_rectangle(
        (x0, y0) in (0..200_u32, 0..200_u32),
        (width, height) in (-3..90_i32, -3..90_i32),
        size in 0..70_u32,
    ) {
        let end = |from: u32, side: i32| from.saturating_add_signed(side);
        let rect = PixelRect { x0, y0, x1: end(x0, width), y1: end(y0, height) };
        holds(invariants::tiles_partition(rect, size))?;
    }

    #[test]
    fn an_intersection_holds_the_pixels_of_both(corners in prop::array::uniform8(0..12_u32)) {
        let [a, b, c, d, e, f, g, h] = corners;
        let (one, two) = (PixelRect { x0: a, y0: b, x1: c, y1: d }, PixelRect { x0: e, y0: f, x1: g, y1: h });
        let both = one.intersection(&two);
        let holds = |r: &PixelRect, x: u32, y: u32| (r.x0..r.x1).contains(&x) && (r.y0..r.y1).contains(&y);
        for (x, y) in (0..12).flat_map(|y| (0..12).map(move |x| (x, y))) {
            prop_assert_eq!(holds(&both, x, y), holds(&one, x, y) && holds(&two, x, y));
        }
        prop_assert!(both.x0 <= both.x1 && both.y0 <= both.y1);
        prop_assert_eq!(both.pixels(), u64::from(both.width()) * u64::from(both.height()));
        prop_assert_eq!(both.is_empty(), both.pixels() == 0);
    }
}
