//! Bugs that were fixed, each with its smallest input.

use glam::{DVec3, dvec3};
use pointillist_micropoint::invariants::Soup;
use pointillist_micropoint::{Projection, View};
use pointillist_shadow::invariants::line::agrees_with_rays;
use pointillist_shadow::invariants::{
    light_on, lit_picture, lit_regions_make_up_the_fraction, tiles_do_not_matter,
};
use pointillist_shadow::{Emitter, ShadowOptions};

/// Only faces turned away from the light cast the shadow of a solid, so that what is in a closed room was lit from outside.
#[test]
fn a_light_outside_a_closed_room_does_not_light_it() {
    let mut s = Soup::default();
    let (walls, table) = (s.surface(1.0), s.surface(1.0));
    s.cuboid(DVec3::splat(-1.1), DVec3::splat(1.1), walls);
    s.polygon(
        &[dvec3(-0.3, -0.5, 0.3), dvec3(0.3, -0.5, 0.3), dvec3(0.3, -0.5, -0.3), dvec3(-0.3, -0.5, -0.3)],
        table,
    );
    let view = View::look_at(
        dvec3(0.0, 0.5, 1.0),
        DVec3::ZERO,
        DVec3::Y,
        Projection::Perspective { fov_y_rad: 1.2 },
        4,
        4,
    )
    .unwrap();
    for emitter in [
        Emitter::Point { position: dvec3(0.1, 8.0, 0.2), axis: DVec3::NEG_Y },
        Emitter::Directional { direction: dvec3(0.1, -1.0, 0.2) },
    ] {
        let picture = lit_picture(&s, view, emitter, ShadowOptions::default()).unwrap();
        let worst = picture.iter().flatten().map(|p| p.lit).fold(0.0, f64::max);
        assert!(worst < 1e-12, "{worst}");
    }
}

/// Depths vary by a factor of two over a pixel of the ground: a fraction weighted by the depth at its middle was off by 0.002.
#[test]
fn large_pixels_near_a_lamp_get_their_exact_share() {
    let mut s = Soup::default();
    let (ground, plate) = (s.surface(1.0), s.surface(1.0));
    let square = |half: f64, y: f64| {
        [dvec3(-half, y, half), dvec3(half, y, half), dvec3(half, y, -half), dvec3(-half, y, -half)]
    };
    s.polygon(&square(20.0, 0.0), ground);
    s.polygon(&square(0.25, 0.6), plate);
    let view = View::look_at(
        DVec3::Y * 0.5,
        DVec3::ZERO,
        DVec3::NEG_Z,
        Projection::Orthographic { height: 5.0 },
        5,
        5,
    )
    .unwrap();
    let emitter = Emitter::Point { position: DVec3::Y * 1.2, axis: DVec3::NEG_Z };
    let lit: f64 =
        light_on(&lit_picture(&s, view, emitter, ShadowOptions::default()).unwrap(), ground).iter().sum();
    // The plate is at half the height of the lamp: its shadow is 1 × 1.
    assert!((lit - 24.0).abs() < 1e-9, "{lit}");
}

/// A caster that reaches out of its screen was clipped into an outline with one corner twice. The edge between the two has no
/// inside, so that it "separated" the caster from receivers right behind it, and only some tiles had a shortcut around that.
#[test]
fn a_light_in_the_plane_of_a_wall_does_not_shine_through_the_lid() {
    let mut s = Soup::default();
    let walls = s.surface(1.0);
    s.cuboid(DVec3::splat(-1.0 / 64.0), DVec3::splat(31.0 / 64.0), walls);
    let [eye, target, position] = [dvec3(6.0, 0.0, 0.0), dvec3(0.0, 41.0, 4.0), dvec3(-1.0, -1.0, 33.0)];
    let camera = Projection::Perspective { fov_y_rad: 1.0 };
    let view = View::look_at(eye / 64.0, target / 64.0, DVec3::Y, camera, 5, 4).unwrap();
    let emitter = Emitter::Point { position: position / 64.0, axis: dvec3(41.0, 41.0, 64.0) };
    let picture = lit_picture(&s, view, emitter, ShadowOptions::default()).unwrap();
    assert!(picture.iter().flatten().all(|p| p.lit == 0.0), "{picture:?}");
    tiles_do_not_matter(&s, view, emitter, ShadowOptions::default()).unwrap();
}

/// The seam between the two triangles of a translucent sheet passed 3e-5 of a pixel from a pixel's corner: the sliver beyond it, below a
/// billionth of the pixel, was lost when the pixel was cut, and 6e-10 of the light with it.
#[test]
fn a_seam_of_a_translucent_sheet_close_to_a_corner_takes_no_light() {
    let mut s = Soup::default();
    let alpha = 0.148_555_41_f32;
    let (ground, sheet) = (s.surface(1.0), s.surface(alpha));
    let square = |half: f64, y: f64| {
        [dvec3(-half, y, half), dvec3(half, y, half), dvec3(half, y, -half), dvec3(-half, y, -half)]
    };
    s.polygon(&square(20.0, 0.0), ground);
    s.polygon(&square(100.0, 1.0), sheet);
    let camera = Projection::Orthographic { height: 2.0 };
    let view = View::look_at(DVec3::Y * 0.5, DVec3::ZERO, DVec3::NEG_Z, camera, 4, 4).unwrap();
    let position = dvec3(0.449_142_830_747_038_8, 5.0, -0.449_218_082_410_036_8);
    let direction = dvec3(position.x, -1.0, position.z);
    for emitter in [Emitter::Point { position, axis: DVec3::NEG_Y }, Emitter::Directional { direction }] {
        for lit in light_on(&lit_picture(&s, view, emitter, ShadowOptions::default()).unwrap(), ground) {
            assert!((lit - (1.0 - f64::from(alpha))).abs() < 1e-12, "{lit}");
        }
    }
}

/// Every coincident receiver asked every coincident caster: the shadows of 1000 copies of a triangle took 1000² questions a pixel.
#[test]
fn copies_of_a_translucent_caster_shade_as_one() {
    let copies = 500;
    let alpha = 0.002_f32;
    let passed = (1.0 - f64::from(alpha)).powi(copies);
    let corners = [dvec3(-0.6, 0.5, 0.5), dvec3(0.7, 0.5, 0.4), dvec3(0.1, 0.6, -0.7)];
    let square = |half: f64| {
        [[-half, half], [half, half], [half, -half], [-half, -half]].map(|[x, z]| dvec3(x, 0.0, z))
    };
    let scene = |opacity: f32, copies: i32| {
        let mut s = Soup::default();
        let (ground, sheet) = (s.surface(1.0), s.surface(opacity));
        s.polygon(&square(20.0), ground);
        (0..copies).for_each(|_| s.polygon(&corners, sheet));
        s
    };
    let camera = Projection::Orthographic { height: 2.0 };
    let view = View::look_at(DVec3::Y * 2.0, DVec3::ZERO, DVec3::NEG_Z, camera, 8, 8).unwrap();
    let emitter = Emitter::Point { position: dvec3(0.4, 3.0, 0.9), axis: DVec3::NEG_Y };
    let lit = |s: &Soup| light_on(&lit_picture(s, view, emitter, ShadowOptions::default()).unwrap(), 0);
    let many = lit(&scene(alpha, copies));
    let one = lit(&scene((1.0 - passed) as f32, 1));
    let mut shaded = 0;
    for (pixel, (m, o)) in many.iter().zip(&one).enumerate() {
        // The single sheet's opacity is rounded to single precision.
        assert!((m - o).abs() < 1e-6, "pixel {pixel}: {m} for {o}");
        shaded += usize::from(*o < 0.999);
    }
    assert!(shaded > 4, "{shaded} pixels are in the shadow");
}

/// The eye is in the plane of the box's lower face: what the viewer sees of it has no area, and a region of it no place in the picture.
#[test]
fn a_face_seen_edge_on_has_no_lit_regions() {
    let mut s = Soup::default();
    let (low, surface) = (dvec3(0.0, 0.0, 3.0 / 64.0), s.surface(1.0));
    s.cuboid(low, low + 0.5, surface);
    let camera = Projection::Perspective { fov_y_rad: 1.0 };
    let view = View::look_at(DVec3::ZERO, dvec3(45.0, 24.0, 24.0) / 64.0, DVec3::Y, camera, 5, 4).unwrap();
    let emitter = Emitter::Point { position: dvec3(0.0, -1.0, -1.0) / 64.0, axis: DVec3::NEG_Y };
    lit_regions_make_up_the_fraction(&s, view, emitter, 1e-6).unwrap();
}

/// A line that shines lies on an edge of a triangle: rounding decided which of the fact's rays end before it.
#[test]
fn what_a_caster_hides_along_its_edge_is_in_doubt() {
    let mut s = Soup::default();
    let (sheet, caster) = (s.surface(112.0 / 255.0), s.surface(1.0));
    let at = |x: f64, y: f64, z: f64| dvec3(x, y, z) / 64.0;
    s.polygon(&[at(-89.0, 50.0, 104.0), at(117.0, -86.0, -110.0), at(-110.0, 102.0, -7.0)], sheet);
    s.polygon(&[at(102.0, -7.0, 112.0), at(-66.0, -66.0, -66.0), at(-1.0, -1.0, -1.0)], caster);
    let camera = Projection::Perspective { fov_y_rad: 1.0 };
    let view = View::look_at(at(0.0, -1.0, -1.0), at(-1.0, -1.0, -1.0), DVec3::Y, camera, 5, 4).unwrap();
    agrees_with_rays(&s, view, [at(-1.0, -1.0, -1.0), at(-2.0, -2.0, -2.0)], 1600, 0.25).unwrap();
}
