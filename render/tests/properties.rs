//! Facts that hold for every scene.

mod scenes;

use glam::{DAffine3, DQuat, Vec3, dvec3};
use pointillist_render::{DrawOptions, PixelRect, invariants, render};
use proptest::prelude::*;
use scenes::scene;
use std::sync::LazyLock;
use testkit::holds;

fn window() -> impl Strategy<Value = PixelRect> {
    (0..12u32, 0..10u32, 1..14u32, 1..12u32).prop_map(|(x0, y0, w, h)| PixelRect {
        x0,
        y0,
        x1: x0 + w,
        y1: y0 + h,
    })
}

/// Moved, turned, scaled or mirrored, so that nothing comes to lie where it was or touches what it touched.
fn place() -> impl Strategy<Value = DAffine3> {
    let factor = prop_oneof![3 => 0.2..1.5f64, 1 => -1.5..-0.2f64];
    ([factor.clone(), factor.clone(), factor], 0.1..3.0f64, [-1.5..1.5f64, -1.5..1.5, -1.5..1.5]).prop_map(
        |(scale, angle, to)| {
            let turn = DQuat::from_axis_angle(dvec3(0.48, 0.6, 0.64), angle);
            DAffine3::from_scale_rotation_translation(scale.into(), turn, to.into())
        },
    )
}

/// One thread and three.
static POOLS: LazyLock<[rayon::ThreadPool; 2]> =
    LazyLock::new(|| [1, 3].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("a pool")));

proptest! {
    #![proptest_config(testkit::config(96))]

    #[test]
    fn pixels_are_sound(s in scene()) {
        holds!(invariants::pixels_are_sound(&s));
    }

    #[test]
    fn a_window_has_the_pixels_of_the_whole_picture(s in scene(), w in window()) {
        holds!(invariants::windows_do_not_matter(&s, w));
    }

    #[test]
    fn a_colour_is_direct_light_and_ambient_light_and_background(s in scene()) {
        holds!(invariants::light_adds_up(&s));
    }

    #[test]
    fn white_surfaces_show_even_light_as_it_is(s in scene(), light in [0.0..2.0f32, 0.0..2.0f32, 0.0..2.0f32]) {
        holds!(invariants::white_surfaces_show_even_light_as_it_is(&s, Vec3::from_array(light)));
    }

    #[test]
    fn instances_are_drawn_as_their_triangles(s in scene(), places in prop::collection::vec(place(), 1..4)) {
        if let Some(s) = invariants::with_instances(&s, &places) {
            holds!(invariants::instances_are_drawn_as_their_triangles(&s));
        }
    }

    #[test]
    fn pictures_do_not_depend_on_those_before(s in scene()) {
        holds!(invariants::pictures_do_not_depend_on_those_before(&s));
    }

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
    fn a_picture_does_not_depend_on_threads(s in scene()) {
        let [one, three] = [0, 1].map(|i| POOLS[i].install(|| render(&s, &DrawOptions::DEFAULT, &())));
        match (one, three) {
            (Ok(one), Ok(three)) => holds!(invariants::frames_are_identical(&one, &three)),
            (one, three) => prop_assert!(one.is_err() && three.is_err()),
        }
    }
}

#[test]
fn most_scenes_of_these_tests_can_be_drawn_and_show_something() {
    use proptest::strategy::ValueTree as _;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let shown = (0..50).filter(|_| {
        let scene = scene().new_tree(&mut runner).expect("a scene").current();
        invariants::picture(&scene).is_some_and(|f| f.color.iter().any(|c| c[3] > 0.0))
    });
    assert!(shown.count() > 25);
}

#[test]
fn most_scenes_of_these_tests_can_stand_in_several_places() {
    use proptest::strategy::ValueTree as _;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let shown = (0..50).filter(|_| {
        let scene = scene().new_tree(&mut runner).expect("a scene").current();
        let place = place().new_tree(&mut runner).expect("a place").current();
        invariants::with_instances(&scene, &[place]).is_some_and(|s| invariants::picture(&s).is_some())
    });
    assert!(shown.count() > 25);
}
