//! The facts of `invariants`, on clouds that aim at trouble.

use std::sync::LazyLock;

use glam::{DMat3, DVec3, dvec3};
use pointillist_ibpr::invariants::{
    self, OwnedScan, cloud, frame, frames_are_identical, frames_are_identical_but_for_size,
};
use pointillist_ibpr::{
    Culling, EyeDome, Frame, Light, Normals, Options, Passes, PixelRect, Projection, Renderer, Scale,
    Translucency, View, Weighting,
};
use proptest::prelude::*;
use testkit::holds;

/// Any number, or one on a coarse grid.
fn coordinate() -> BoxedStrategy<f64> {
    prop_oneof![3 => -1.0..1.0, 1 => (-4..=4).prop_map(|i| 0.25 * f64::from(i))].boxed()
}

fn point() -> BoxedStrategy<DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| dvec3(x, y, z)).boxed()
}

fn direction() -> BoxedStrategy<DVec3> {
    (-1.0..1.0, -1.0..1.0, -1.0..1.0)
        .prop_filter_map("a direction", |(x, y, z)| dvec3(x, y, z).try_normalize())
        .boxed()
}

/// Planes, spheres, loose points, lines, one point many times.
fn scan() -> BoxedStrategy<OwnedScan> {
    let plane = (point(), direction(), 0.01..0.1f64, 1..30u32, 1..30u32).prop_map(|(c, n, step, w, h)| {
        let (right, up) = n.any_orthonormal_pair();
        OwnedScan::plane(c, right * step, up * step, w, h)
    });
    let noisy = (plane.clone(), direction(), 0.0..0.1f64, any::<u64>())
        .prop_map(|(s, d, amount, seed)| s.jittered(d * amount, seed));
    let sphere =
        (point(), 0.1..0.8f64, direction()).prop_map(|(c, r, d)| OwnedScan::sphere(c, r, r / 20.0, d));
    let loose = prop::collection::vec(point(), 0..40).prop_map(OwnedScan::new);
    let line = (point(), direction(), 1..40u32)
        .prop_map(|(c, d, n)| OwnedScan::plane(c, d * 0.03, DVec3::ZERO, n, 1));
    let repeated = (point(), 1..40usize).prop_map(|(p, n)| OwnedScan::new(vec![p; n]));
    let shape = prop_oneof![3 => plane, 3 => noisy, 3 => sphere, 2 => loose, 1 => line, 1 => repeated];
    let paints = (any::<bool>(), any::<bool>());
    (shape, paints, prop::option::of(direction()), prop::option::of(0.001..0.2f64))
        .prop_map(|(scan, (colored, has_opacities), towards_scanner, spacing)| {
            let n = scan.positions.len();
            let color = |i: usize| [i as f32 / n as f32, 0.5, (i % 7) as f32];
            let colors = colored.then(|| (0..n).map(color).collect());
            let opacities = has_opacities.then(|| (0..n).map(|i| (i % 5) as f32 / 4.0).collect());
            OwnedScan { colors, opacities, towards_scanner, spacing, ..scan }
        })
        .boxed()
}

fn scans() -> impl Strategy<Value = Vec<OwnedScan>> {
    prop::collection::vec(scan(), 1..5)
}

/// Views from outside and from among the points, of up to 90 pixels: more than a strip and a band.
fn view() -> BoxedStrategy<View> {
    let size = || (1..90u32, 1..90u32);
    let perspective = (direction(), 0.1..4.0, point(), 0.2..2.2f64, size()).prop_filter_map(
        "eye and target differ",
        |(towards, distance, target, fov_y_rad, (w, h))| {
            let camera = Projection::Perspective { fov_y_rad };
            View::look_at(target + towards * distance, target, DVec3::Y, camera, w, h).ok()
        },
    );
    let orthographic =
        (direction(), 0.2..4.0f64, size()).prop_filter_map("not along y", |(towards, height, (w, h))| {
            let camera = Projection::Orthographic { height };
            View::look_at(towards * 5.0, DVec3::ZERO, DVec3::Y, camera, w, h).ok()
        });
    prop_oneof![3 => perspective, 1 => orthographic].boxed()
}

/// Also beyond the picture, and without a pixel.
fn window() -> impl Strategy<Value = PixelRect> {
    (0..80u32, 0..80u32, 0..50u32, 0..50u32).prop_map(|(x0, y0, w, h)| PixelRect {
        x0,
        y0,
        x1: x0 + w,
        y1: y0 + h,
    })
}

fn passes() -> impl Strategy<Value = Passes> {
    prop_oneof![2 => Just(Passes::One), 1 => (0.3..=1.0f32).prop_map(|finer| Passes::Two { finer })]
}

fn scale() -> impl Strategy<Value = Scale> {
    prop_oneof![
        (0.3..4.0f32).prop_map(Scale::Auto),
        (1.0..9.0f32).prop_map(Scale::Fixed),
        (0.5..4.0f32, 0.1..3.0f32).prop_map(|(factor, spacing_px)| Scale::Spaced { factor, spacing_px })
    ]
}

fn weighting() -> impl Strategy<Value = Weighting> {
    prop_oneof![
        Just(Weighting::Printed),
        Just(Weighting::Falling),
        Just(Weighting::Even),
        Just(Weighting::Symmetric),
    ]
}

fn culling() -> impl Strategy<Value = Culling> {
    prop_oneof![Just(Culling::None), Just(Culling::Printed), Just(Culling::Scans), Just(Culling::Blocks)]
}

fn translucency() -> impl Strategy<Value = Option<Translucency>> {
    let some =
        (0.0..=1.0f32, 1..=Translucency::MOST_LAYERS, 0.1..20.0f32).prop_map(|(alpha, layers, threshold)| {
            Translucency::new(alpha).with_layers(layers).with_threshold(threshold)
        });
    prop_oneof![2 => Just(None), 1 => some.prop_map(Some)]
}

fn options() -> impl Strategy<Value = Options> {
    let picture = (scale(), passes(), translucency(), culling(), any::<bool>());
    let surface = (0.3..4.0f32, weighting(), any::<bool>(), 0.0..=1.0f32, 0..4u32);
    let light = (prop::option::of(direction()), 0.0..=1.0f32, any::<bool>());
    (picture, surface, light).prop_map(|(picture, surface, light)| {
        let mut o = Options::default();
        let plane;
        (o.scale, o.passes, o.translucency, o.culling, o.surface_layers) = picture;
        (o.gamma, o.weighting, plane, o.outline, o.fill) = surface;
        o.normals = if plane { Normals::Plane } else { Normals::Triangles };
        o.light = light.0.map_or(Light::Eye, Light::Towards);
        o.ambient = light.1;
        o.eye_dome = light.2.then_some(EyeDome::new(1.0, 2));
        o
    })
}

proptest! {
    #![proptest_config(testkit::config(192))]

    #[test]
    fn frames_are_sound(s in scans(), v in view(), o in options()) {
        holds!(invariants::frames_are_sound(&s, &v, &o));
    }

    #[test]
    fn a_frame_does_not_depend_on_the_order_of_scans_and_points(s in scans(), v in view(), o in options(), seed: u64) {
        holds!(invariants::order_does_not_matter(&s, &v, &o, seed));
    }

    #[test]
    fn a_cloud_does_not_depend_on_how_it_came_to_hold_its_scans(s in scans(), v in view(), o in options(), seed: u64) {
        holds!(invariants::history_does_not_matter(&s, &v, &o, seed));
    }

    #[test]
    fn a_renderer_keeps_nothing_from_frame_to_frame(
        s in scans(), v in view(), o in options(), before_v in view(), before_o in options(),
    ) {
        holds!(invariants::use_before_does_not_matter(&s, (&before_v, &before_o), (&v, &o)));
    }

    #[test]
    fn a_window_is_a_part_of_the_picture(s in scans(), v in view(), o in options(), w in window()) {
        holds!(invariants::a_window_is_a_part_of_the_picture(&s, &v, &o, w));
    }

    #[test]
    fn a_pixel_that_nothing_projects_near_stays_background(s in scans(), v in view(), o in options()) {
        holds!(invariants::far_pixels_stay_empty(&s, &v, &o));
    }

    #[test]
    fn constant_color_stays_constant(
        s in scans(), v in view(), o in options(), color in [0.0..2.0f32, 0.0..2.0f32, 0.0..2.0f32],
    ) {
        holds!(invariants::one_color_stays_one_color(&s, &v, &o, color));
    }

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
    fn a_frame_does_not_depend_on_threads(s in scans(), v in view(), o in options()) {
        let frames: Vec<_> = POOLS.iter().map(|p| p.install(|| frame(&s, &v, &o))).collect();
        for other in &frames[1..] {
            match (&frames[0], other) {
                (Some(a), Some(b)) => holds!(frames_are_identical(a, b)),
                (a, b) => prop_assert!(a.is_none() && b.is_none()),
            }
        }
    }
}

static POOLS: LazyLock<Vec<rayon::ThreadPool>> = LazyLock::new(|| {
    [1, 2, 8].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap()).into()
});

/// A sphere of radius 1 seen by six scanners, points 0.02 apart.
fn six_scans() -> Vec<OwnedScan> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let turn = DMat3::from_rotation_y(0.3) * DMat3::from_rotation_x(0.2);
    let towards = axes.into_iter().flat_map(|a| [a, -a]).map(|d| turn * d);
    towards.map(|d| OwnedScan::sphere(DVec3::ZERO, 1.0, STEP, d)).collect()
}

const STEP: f64 = 0.02;

static SPHERE: LazyLock<Vec<OwnedScan>> = LazyLock::new(six_scans);

/// Pixels are a few points wide, so that no surface has gaps.
fn view_of_sphere() -> impl Strategy<Value = View> {
    (direction(), 2.5..20.0f64, 40..200u32, any::<bool>()).prop_filter_map(
        "not along y",
        |(towards, distance, size, flat)| {
            let camera = match flat {
                true => Projection::Orthographic { height: 2.5 },
                false => Projection::Perspective {
                    fov_y_rad: 2.0 * (1.2 / (distance * distance - 1.0).sqrt()).atan(),
                },
            };
            View::look_at(towards * distance, DVec3::ZERO, DVec3::Y, camera, size, size).ok()
        },
    )
}

/// A scan that faces away by 165° may still touch pixels of the rim from behind, where its steepest points are averaged
/// with those in front, or stand alone: the outline moves there by a part of a buffer pixel, in single places. Nothing
/// else changes, and the coverage of all pixels on the outline by no more than a twentieth on average.
fn only_the_rim_differs(all: &Frame, culled: &Frame) -> Result<(), String> {
    let reach = (2.0 * all.counts().scale).ceil() as usize + 1;
    let (mut changed, mut outline) = (0.0, 0);
    for i in 0..all.color().len() {
        let (a, b) = (all.color()[i], culled.color()[i]);
        outline += usize::from(a[3] > 0.0 && a[3] < 1.0);
        if a == b {
            continue;
        }
        changed += f64::from((a[3] - b[3]).abs());
        let (x, y) = (i % all.width(), i / all.width());
        let columns = x.saturating_sub(reach)..(x + reach + 1).min(all.width());
        let mut rows = y.saturating_sub(reach)..(y + reach + 1).min(all.height());
        if !rows.any(|r| all.depth()[r * all.width()..][columns.clone()].contains(&f32::INFINITY)) {
            return Err(format!("pixel ({x}, {y}) is not at the rim: {a:?} and {b:?}"));
        }
    }
    if changed > 0.05 * outline as f64 {
        return Err(format!("{outline} pixels of the outline change by {changed} altogether"));
    }
    Ok(())
}

proptest! {
    #![proptest_config(testkit::config(40))]

    #[test]
    fn culling_what_faces_away_never_changes_a_smooth_closed_surface(
        v in view_of_sphere(), gamma in 1.0..=3.0f32, factor in 1.2..2.5f32, normals: bool, weighting in weighting(),
    ) {
        // The radius of curvature is far above 2γ: 1 > 2 · 3 · 0.02.
        let cloud = cloud(&SPHERE).unwrap();
        let mut o = Options::default();
        // Pixels of the buffer as wide as two points of one scan, from any distance.
        let pixel = 2.4 / f64::from(v.height());
        o.scale = Scale::Fixed((2.0 * factor * (STEP / pixel) as f32).max(1.0));
        (o.gamma, o.weighting, o.surface_layers) = (gamma, weighting, true);
        o.normals = if normals { Normals::Plane } else { Normals::Triangles };
        let mut renderer = Renderer::new();
        let mut draw = |culling: Culling| {
            let (mut o, mut frame) = (o, Frame::default());
            o.culling = culling;
            renderer.draw(&cloud, &v, &o, &mut frame).unwrap();
            frame
        };
        let [all, blocks, scans] = [Culling::None, Culling::Blocks, Culling::Scans].map(&mut draw);
        holds!(frames_are_identical(&all, &blocks).map_err(|e| format!("blocks: {e}")));
        holds!(only_the_rim_differs(&all, &scans));
    }

    #[test]
    fn culling_does_not_change_the_size_of_buffer_pixels(v in view_of_sphere()) {
        let mut sizes = [Culling::None, Culling::Scans, Culling::Blocks].map(|culling| {
            let mut o = Options::default();
            o.culling = culling;
            frame(&SPHERE, &v, &o).unwrap().counts().scale
        });
        sizes.sort_by(f64::total_cmp);
        prop_assert_eq!(sizes[0], sizes[2]);
    }

    #[test]
    fn a_scene_far_from_the_origin_gives_the_same_frame_bit_for_bit(
        s in scans(), v in view(), o in options(), shift in [-1..=1i32, -1..=1, -1..=1],
    ) {
        // Where f64 holds the moved points exactly: steps of 2⁻²⁰, moved by 2²⁰.
        let snap = |p: DVec3| (p * 1_048_576.0).round() / 1_048_576.0;
        let far = DVec3::from_array(shift.map(f64::from)) * 1_048_576.0;
        let near: Vec<_> = s.iter().map(|s| s.moved(snap)).collect();
        let moved: Vec<_> = near.iter().map(|s| s.moved(|p| p + far)).collect();
        let look = |shift: DVec3| {
            let eye = snap(v.eye());
            View::look_at(eye + shift, eye + snap(v.forward()) + shift, DVec3::Y, Projection::Perspective { fov_y_rad: 0.7 }, v.width(), v.height())
        };
        let (Ok(here), Ok(there)) = (look(DVec3::ZERO), look(far)) else { return Ok(()) };
        if let (Some(a), Some(b)) = (frame(&near, &here, &o), frame(&moved, &there, &o)) {
            holds!(frames_are_identical(&a, &b));
        }
    }

    #[test]
    fn a_scene_of_any_size_gives_the_same_frame(s in scans(), v in view(), o in options(), power in -99..=99i32) {
        // Powers of two change no digit; depth scales with the scene.
        let k = f64::from(power).exp2();
        let resized: Vec<_> = s
            .iter()
            .map(|s| OwnedScan { spacing: s.spacing.map(|d| d * k), ..s.moved(|p| p * k) })
            .collect();
        let look = |k: f64| View::look_at(v.eye() * k, (v.eye() + v.forward()) * k, DVec3::Y, Projection::Perspective { fov_y_rad: 0.7 }, v.width(), v.height());
        let (Ok(here), Ok(there)) = (look(1.0), look(k)) else { return Ok(()) };
        if let (Some(a), Some(b)) = (frame(&s, &here, &o), frame(&resized, &there, &o)) {
            holds!(frames_are_identical_but_for_size(&a, &b, k));
        }
    }
}

#[test]
fn blocks_that_face_away_are_skipped() {
    let camera = Projection::Orthographic { height: 2.5 };
    let view = View::look_at(dvec3(3.0, 2.0, 9.0), DVec3::ZERO, DVec3::Y, camera, 80, 80).unwrap();
    let frame = frame(&SPHERE, &view, &Options::default()).unwrap();
    assert!(frame.counts().blocks_facing_away > 0, "{:?}", frame.counts());
}
