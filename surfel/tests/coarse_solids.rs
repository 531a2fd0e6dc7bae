//! Coarse meshes with interpolated normals: the surface on which points lie turns away elsewhere than light is told.

use glam::{DVec2, DVec3, Vec3, dvec2, dvec3};
use pointillist_surfel::invariants::{OwnedPoints, cloud, drawn, look_at};
use pointillist_surfel::{Cloud, Options, Projection, SampleOptions, View, sample};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

const SIZE: u32 = 100;
const HEIGHT: f64 = 2.3;

/// A point for each pixel or so.
const POINTS: usize = 40_000;

/// Pixels between the outline and those that must be covered: an edge of a sum of kernels is about two wide.
const EDGE_PX: f64 = 2.0;

/// The corners of a unit sphere of five bands, of ten quadrilaterals each.
fn corners() -> Vec<DVec3> {
    let corner = |i: u32| {
        let (s, z) = (PI * f64::from(i / 10) / 5.0).sin_cos();
        let (y, x) = (TAU * f64::from(i % 10) / 10.0).sin_cos();
        dvec3(s * x, s * y, z)
    };
    (0..60).map(corner).collect()
}

/// Points of that solid with the normals of its triangles, and for light those of the sphere.
fn solid() -> OwnedPoints {
    let at = |r: u32, c: u32| r * 10 + c % 10;
    let quads = (0..5).flat_map(|r| (0..10).map(move |c| (r, c)));
    let triangles: Vec<[u32; 3]> = quads
        .flat_map(|(r, c)| {
            let [a, b, d, e] = [at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)];
            [[a, b, d], [a, d, e]]
        })
        .collect();
    let corners = corners();
    let points = sample(&corners, &triangles, &SampleOptions::DEFAULT.with_count(POINTS)).unwrap();
    let of = |triangle: u32| triangles[triangle as usize].map(|i| corners[i as usize]);
    let smooth = points.iter().map(|p| p.interpolate(of(p.triangle)));
    OwnedPoints {
        positions: points.iter().map(|p| p.position).collect(),
        normals: Some(points.iter().map(|p| p.normal.as_vec3()).collect()),
        shading_normals: Some(smooth.map(|n| n.normalize().as_vec3()).collect()),
        radii: Some(points.iter().map(|p| p.radius).collect()),
        ..OwnedPoints::default()
    }
}

/// Whether a pixel's middle lies this far inside of the solid's outline, which is the hull of its corners.
fn is_inside(view: &View, pixel: DVec2) -> bool {
    let px = HEIGHT / f64::from(SIZE);
    let seen = |p: DVec3| dvec2(p.dot(view.right()), -p.dot(view.up()));
    let place = (pixel - 0.5 * f64::from(SIZE)) * px;
    let outline: Vec<DVec2> = corners().into_iter().map(seen).collect();
    (0..180).all(|i| {
        let direction = DVec2::from_angle(TAU * f64::from(i) / 180.0);
        let reach = outline.iter().map(|corner| corner.dot(direction)).fold(f64::MIN, f64::max);
        place.dot(direction) < reach - EDGE_PX * px
    })
}

static SOLID: LazyLock<Cloud> = LazyLock::new(|| cloud(&solid()).unwrap());

/// The least opacity of the pixels inside.
fn least_inside(cloud: &Cloud, towards: DVec3) -> f32 {
    let camera = Projection::Orthographic { height: HEIGHT };
    let view = look_at(towards * 5.0, DVec3::ZERO, camera, SIZE, SIZE).unwrap();
    let frame = drawn(cloud, &view, &Options::default()).unwrap();
    let pixels = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)));
    pixels
        .filter(|&(x, y)| is_inside(&view, dvec2(f64::from(x) + 0.5, f64::from(y) + 0.5)))
        .map(|(x, y)| frame.color()[(y * SIZE + x) as usize][3])
        .fold(1.0, f32::min)
}

#[test]
fn a_coarse_solid_has_no_holes_beside_its_outline() {
    // Drawn with interpolated normals alone, which is what normals for light are there to avoid.
    let points = solid();
    let smooth_alone =
        cloud(&OwnedPoints { normals: points.shading_normals.clone(), shading_normals: None, ..points })
            .unwrap();
    for towards in [dvec3(1.0, 0.2, 0.3), dvec3(-0.4, 0.5, 0.9), dvec3(0.3, -0.9, 0.1)].map(DVec3::normalize)
    {
        let least = least_inside(&SOLID, towards);
        assert!(least > 0.97, "{towards}: {least}");
        let least = least_inside(&smooth_alone, towards);
        assert!(least < 0.6, "{towards}: the test sees nothing: {least}");
    }
}

#[test]
fn light_sees_the_normals_that_it_is_given() {
    let camera = Projection::Orthographic { height: HEIGHT };
    let view = look_at(dvec3(5.0, 0.0, 0.0), DVec3::ZERO, camera, SIZE, SIZE).unwrap();
    let mut options = Options::default();
    options.surface_layers = true;
    for level in [0.0, 1.27, 6.0] {
        options.level = level;
        let drawn = drawn(&SOLID, &view, &options).unwrap();
        // Along the middle row from -0.8 to 0.8, where the sphere's normal has the pixel's place in it; links are means of cells of up to a fifth.
        let slack = if level > 2.0 { 0.2 } else { 0.07 };
        for x in 15..85 {
            let i = (SIZE / 2 * SIZE + x) as usize;
            let across = (f64::from(x) + 0.5 - 50.0) * HEIGHT / 100.0;
            let (normal, light) = (drawn.normal()[i], drawn.color()[i][0] / drawn.color()[i][3]);
            let found = Vec3::from(normal).as_dvec3().dot(view.right());
            assert!((found - across).abs() < slack, "level {level}, column {x}: {found}, not {across}");
            let facing = Vec3::from(normal).as_dvec3().dot(-view.forward()) as f32;
            let expected = options.base.x * (options.ambient + (1.0 - options.ambient) * facing);
            assert!((light - expected).abs() < 0.03, "level {level}, column {x}: {light}, not {expected}");
        }
    }
}

proptest! {
    #![proptest_config(testkit::config(12))]

    #[test]
    fn no_view_of_a_coarse_solid_shows_holes(x in -1.0..1.0f64, y in -1.0..1.0f64, z in -1.0..1.0f64) {
        let towards = dvec3(x, y, z).try_normalize().filter(|t| t.y.abs() < 0.99);
        prop_assume!(towards.is_some());
        let least = least_inside(&SOLID, towards.unwrap_or(DVec3::X));
        prop_assert!(least > 0.97, "{}", least);
    }
}
