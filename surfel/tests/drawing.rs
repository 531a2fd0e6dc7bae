//! The facts of `invariants` about frames, on clouds that aim at trouble.

use glam::{DAffine3, DMat3, DVec3, dvec3};
use pointillist_surfel::invariants::{
    self, OwnedPoints, drawn, frame, frames_are_identical, frames_are_identical_but_for_size, look_at,
};
use pointillist_surfel::{Cloud, Focus, Light, Options, PixelRect, Procedure, Projection, View};
use proptest::prelude::*;
use std::sync::LazyLock;
use testkit::holds;

/// Any number, or one on a coarse grid.
fn coordinate() -> BoxedStrategy<f64> {
    prop_oneof![3 => -1.0..1.0, 1 => (-4..=4).prop_map(|i| 0.25 * f64::from(i))].boxed()
}

fn point() -> BoxedStrategy<DVec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array).boxed()
}

fn direction() -> BoxedStrategy<DVec3> {
    (-1.0..1.0, -1.0..1.0, -1.0..1.0)
        .prop_filter_map("a direction", |(x, y, z)| dvec3(x, y, z).try_normalize())
        .boxed()
}

/// Planes, spheres, loose points, lines, one point many times.
fn shape() -> BoxedStrategy<OwnedPoints> {
    let plane = (point(), direction(), 0.01..0.1f64, 1..30u32, 1..30u32).prop_map(|(c, n, step, w, h)| {
        let (right, up) = n.any_orthonormal_pair();
        OwnedPoints::plane(c, right * step, up * step, w, h)
    });
    let noisy = (plane.clone(), direction(), 0.0..0.1f64, any::<u64>())
        .prop_map(|(s, d, amount, seed)| s.jittered(d * amount, seed));
    let sphere = (point(), 0.1..0.8f64, 1..900u32).prop_map(|(c, r, n)| OwnedPoints::sphere(c, r, n));
    let loose = prop::collection::vec(point(), 0..40).prop_map(OwnedPoints::loose);
    let line = (point(), direction(), 1..40u32)
        .prop_map(|(c, d, n)| OwnedPoints::plane(c, d * 0.03, DVec3::ZERO, n, 1));
    let repeated = (point(), 1..40usize).prop_map(|(p, n)| OwnedPoints::loose(vec![p; n]));
    prop_oneof![3 => plane, 2 => noisy, 4 => sphere, 2 => loose, 1 => line, 1 => repeated].boxed()
}

fn points() -> BoxedStrategy<OwnedPoints> {
    let radius = prop_oneof![3 => 0.005..0.2f32, 1 => 1e-6..3.0f32];
    let opacities = prop::option::weighted(
        0.4,
        prop::collection::vec(prop_oneof![2 => 0.0..=1.0f32, 1 => Just(1.0), 1 => Just(0.0)], 1..5),
    );
    let lit = prop::option::weighted(0.4, prop::collection::vec(direction(), 1..5));
    let sizes = (prop::option::weighted(0.3, radius), opacities);
    (shape(), prop::option::of(shape()), any::<[bool; 2]>(), sizes, lit)
        .prop_map(|(first, second, [colored, two_sided], (radius, opacities), lit)| {
            let mut all = second.map_or(first.clone(), |s| first.and(&s));
            let n = all.positions.len();
            let color = |i: usize| [i as f32 / n as f32, 0.5, (i % 7) as f32];
            all.colors = colored.then(|| (0..n).map(color).collect());
            all.normals = all.normals.filter(|_| !two_sided);
            let lit = lit.filter(|_| all.normals.is_some());
            all.shading_normals = lit.map(|some| (0..n).map(|i| some[i % some.len()].as_vec3()).collect());
            all.radii = radius.map(|r| (0..n).map(|i| r * (1.0 + (i % 3) as f32)).collect()).or(all.radii);
            all.opacities = opacities.map(|some| (0..n).map(|i| some[i % some.len()]).collect());
            all
        })
        .boxed()
}

/// Views from outside and from among the points, of up to 150 pixels: more than a tile.
fn view() -> BoxedStrategy<View> {
    let size = || prop_oneof![4 => (1..60u32, 1..50u32), 1 => (1..150u32, 1..90u32)];
    let perspective = (direction(), 0.1..4.0, point(), 0.2..2.2f64, size()).prop_filter_map(
        "eye and target differ",
        |(towards, distance, target, fov_y_rad, (w, h))| {
            look_at(target + towards * distance, target, Projection::Perspective { fov_y_rad }, w, h)
        },
    );
    let orthographic =
        (direction(), 0.2..4.0f64, size()).prop_filter_map("not along y", |(towards, height, (w, h))| {
            look_at(towards * 5.0, DVec3::ZERO, Projection::Orthographic { height }, w, h)
        });
    prop_oneof![3 => perspective, 1 => orthographic].boxed()
}

fn focus() -> BoxedStrategy<Focus> {
    let depth = prop_oneof![3 => 0.0..0.3f64, 1 => 0.0..1.0f64];
    prop_oneof![
        2 => Just(Focus::Everywhere),
        3 => (depth, 0.05..6.0f64).prop_map(|(depth, focus)| Focus::Depth { depth, focus }),
        1 => (0.0..0.3f64, 0.05..6.0f64).prop_map(|(aperture, focus)| Focus::Lens { aperture, focus }),
    ]
    .boxed()
}

fn options() -> BoxedStrategy<Options> {
    let level = prop_oneof![2 => Just(1.27f32), 1 => Just(0.0), 2 => 0.0..9.0f32];
    let light = (prop::option::of(direction()), 0.0..=1.0f32);
    (focus(), any::<[bool; 3]>(), level, light)
        .prop_map(|(focus, [culling, normals, paper], level, (light, ambient))| {
            // The paper's filter takes a time that grows with the square of the blur.
            let paper = paper && matches!(focus, Focus::Everywhere | Focus::Depth { depth: ..0.02, .. });
            let mut o = Options::default();
            (o.focus, o.culling, o.surface_layers, o.level, o.ambient) =
                (focus, culling, normals, level, ambient);
            o.procedure = if paper { Procedure::Paper } else { Procedure::Blended };
            o.light = light.map_or(Light::Eye, Light::Towards);
            o
        })
        .boxed()
}

fn with(mut options: Options, change: impl Fn(&mut Options)) -> Options {
    change(&mut options);
    options
}

proptest! {
    #![proptest_config(testkit::config(28))]

    #[test]
    fn a_window_holds_what_the_whole_picture_does(p in points(), v in view(), o in options(), ends in any::<[u32; 4]>()) {
        let Some(whole) = frame(&p, &v, &o) else { return Ok(()) };
        let (x0, y0) = (ends[0] % v.width(), ends[1] % v.height());
        let (x1, y1) = (x0 + 1 + ends[2] % (v.width() - x0), y0 + 1 + ends[3] % (v.height() - y0));
        let part = frame(&p, &v, &o.with_window(PixelRect { x0, y0, x1, y1 })).expect("the same input");
        for i in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (y * v.width() + x) as usize)) {
            prop_assert_eq!(whole.color()[i].map(f32::to_bits), part.color()[i].map(f32::to_bits));
            prop_assert_eq!(whole.depth()[i].to_bits(), part.depth()[i].to_bits());
        }
    }

    #[test]
    fn frames_are_sound(p in points(), v in view(), o in options()) {
        holds!(invariants::frames_are_sound(&p, &v, &o));
    }

    #[test]
    fn opaque_points_need_no_opacities(p in points(), v in view(), o in options()) {
        holds!(invariants::opaque_points_need_no_opacities(&p, &v, &o));
    }

    #[test]
    fn normals_for_light_change_no_coverage(p in points(), v in view(), o in options()) {
        holds!(invariants::shading_normals_only_shade(&p, &v, &o));
    }

    #[test]
    fn a_frame_does_not_depend_on_the_order_of_points(p in points(), v in view(), o in options(), seed: u64) {
        holds!(invariants::order_does_not_matter(&p, &v, &o, seed));
    }

    #[test]
    fn a_renderer_keeps_nothing_from_frame_to_frame(
        p in points(), v in view(), o in options(), before_v in view(), before_o in options(),
    ) {
        holds!(invariants::use_before_does_not_matter(&p, (&before_v, &before_o), (&v, &o)));
    }

    #[test]
    fn culling_does_not_change_a_bit(p in points(), v in view(), o in options()) {
        holds!(invariants::culling_changes_nothing(&p, &v, &o));
    }

    #[test]
    fn no_blur_is_no_depth_of_field(p in points(), v in view(), o in options(), focus in 0.01..9.0f64) {
        holds!(invariants::no_blur_is_no_depth_of_field(&p, &v, &o, focus));
    }

    #[test]
    fn a_lens_is_a_depth(p in points(), v in view(), o in options(), aperture in 0.0..0.1f64, focus in 1.0..9.0f64) {
        holds!(invariants::a_lens_is_a_depth(&p, &v, &o, aperture, focus));
    }

    #[test]
    fn constant_color_stays_constant(
        p in points(), v in view(), o in options(), color in [0.0..2.0f32, 0.0..2.0f32, 0.0..2.0f32], kept: bool,
    ) {
        let short = |c: f32| (c * 64.0).round() / 64.0;
        holds!(invariants::one_color_stays_one_color(&p, &v, &o, if kept { color.map(short) } else { color }));
    }

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
    fn a_frame_does_not_depend_on_threads(p in points(), v in view(), o in options()) {
        let frames: Vec<_> = POOLS.iter().map(|pool| pool.install(|| frame(&p, &v, &o))).collect();
        for other in &frames[1..] {
            match (&frames[0], other) {
                (Some(a), Some(b)) => holds!(frames_are_identical(a, b)),
                (a, b) => prop_assert!(a.is_none() && b.is_none()),
            }
        }
    }

    #[test]
    fn a_scene_far_from_the_origin_gives_the_same_frame_bit_for_bit(
        p in points(), eye in point(), axis in 0..3usize, turns in 0..4u8, fov_y_rad in 0.2..2.2f64, o in options(),
        shift in [-1..=1i32, -1..=1, -1..=1],
    ) {
        // Where f64 holds the moved points exactly: steps of 2⁻²⁰, moved by 2²⁰, and a camera along the axes.
        let snap = |p: DVec3| (p * 1_048_576.0).round() / 1_048_576.0;
        let far = DVec3::from_array(shift.map(f64::from)) * 1_048_576.0;
        let near = p.moved(snap);
        let quarter = |v: DVec3| dvec3(v.x, -v.z, v.y);
        let turn = |v: DVec3| (0..turns).fold(DVec3::from_array([0, 1, 2].map(|i| v[(i + axis) % 3])), |v, _| quarter(v));
        let rows = DMat3::from_cols(turn(DVec3::X), turn(DVec3::Y), turn(DVec3::Z));
        let look = |shift: DVec3| {
            let map = DAffine3::from_mat3_translation(rows, -(rows * (snap(eye) * 2.0 + shift)));
            View::from_matrix(map, Projection::Perspective { fov_y_rad }, 60, 40).unwrap()
        };
        let moved = near.moved(|p| p + far);
        match (frame(&near, &look(DVec3::ZERO), &o), frame(&moved, &look(far), &o)) {
            (Some(a), Some(b)) => holds!(frames_are_identical(&a, &b)),
            (a, b) => prop_assert!(a.is_none() && b.is_none()),
        }
    }

    #[test]
    fn a_scene_of_any_size_gives_the_same_frame(p in points(), v in view(), o in options(), power in -99..=99i32) {
        // Powers of two change no digit; depth scales with the scene. A cloud in one place has no size.
        prop_assume!(p.positions.iter().any(|q| *q != p.positions[0]));
        let k = f64::from(power).exp2();
        let camera = Projection::Perspective { fov_y_rad: 0.7 };
        let look = |k: f64| look_at(v.eye() * k, (v.eye() + v.forward()) * k, camera, v.width(), v.height());
        let (Some(here), Some(there)) = (look(1.0), look(k)) else { return Ok(()) };
        let focus = match o.focus {
            Focus::Depth { depth, focus } => Focus::Depth { depth, focus: focus * k },
            Focus::Lens { aperture, focus } => Focus::Lens { aperture: aperture * k, focus: focus * k },
            other => other,
        };
        if let (Some(a), Some(b)) = (frame(&p, &here, &o), frame(&p.resized(k), &there, &with(o, |o| o.focus = focus))) {
            holds!(frames_are_identical_but_for_size(&a, &b, k));
        }
    }
}

proptest! {
    #![proptest_config(testkit::config(24))]

    #[test]
    fn culling_of_solids_does_not_change_a_bit(v in view_of_sphere(), o in options(), level in 0.5..3.0f32, depth in 0.0..0.03f64, which in 0..2usize) {
        // Little blur, and not all points, to save time.
        let o = with(o, |o| o.level = level);
        let o = with(o, |o| if o.focus != Focus::Everywhere { o.focus = Focus::Depth { depth, focus: 4.0 } });
        // Hidden nodes, and nodes that face away.
        let by = |culling| drawn([&*BALLS, &*SPHERE][which], &v, &with(o, |o| o.culling = culling)).unwrap();
        holds!(frames_are_identical(&by(true), &by(false)));
    }
}

static POOLS: LazyLock<Vec<rayon::ThreadPool>> = LazyLock::new(|| {
    [1, 2, 8].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap()).into()
});

fn sphere() -> OwnedPoints {
    OwnedPoints::sphere(DVec3::ZERO, 1.0, 8000)
}

static SPHERE: LazyLock<Cloud> = LazyLock::new(|| invariants::cloud(&sphere()).unwrap());

/// Some behind others.
static BALLS: LazyLock<Cloud> = LazyLock::new(|| {
    let ball = |x: f64, y: f64, z: f64| OwnedPoints::sphere(dvec3(x, y, z) * 0.6, 0.3, 2000);
    let balls = [ball(0.0, 0.0, -1.0), ball(0.0, 0.1, 1.0), ball(1.0, 0.0, 0.0), ball(-1.0, -0.2, 0.1)];
    let all = balls[1..].iter().fold(balls[0].clone(), |all, ball| all.and(ball));
    invariants::cloud(&all.painted(|p| p.abs().as_vec3().to_array())).unwrap()
});

fn view_of_sphere() -> impl Strategy<Value = View> {
    (direction(), 2.0..12.0f64, 40..140u32, any::<bool>()).prop_filter_map(
        "not along y",
        |(towards, distance, size, flat)| {
            let camera = match flat {
                true => Projection::Orthographic { height: 2.5 },
                false => Projection::Perspective {
                    fov_y_rad: 2.0 * (1.2 / (distance * distance - 1.0).sqrt()).atan(),
                },
            };
            look_at(towards * distance, DVec3::ZERO, camera, size, size)
        },
    )
}
