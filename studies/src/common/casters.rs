//! Scenes for shadows.

use std::f64::consts::TAU;
use std::num::NonZeroU32;

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::Scene;
use pointillist_shade::{self as shade, Falloff, Light};

use crate::common::scenes::Sketch;

/// GGX roughness of the glossy material of [`area_light`].
const GLOSSY_ROUGHNESS: f32 = 0.35;

/// Where the casting half-plane of [`half_plane`] ends: x = this, any z, one unit above the ground.
const EDGE: f64 = 0.4;

/// The way the light of [`half_plane`] travels.
const SLANT: DVec3 = DVec3::new(0.5, -1.0, 0.2);

/// A ground half in the shadow of a plate that the camera does not see.
pub(crate) fn half_plane(size: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.8, 0.8, 1.6), dvec3(0.9, 0.0, 0.0), 36.0, size);
    let white = s.matt(1.0, 1.0);
    let plate = |x0: f64, x1: f64, y: f64, h: f64| {
        [dvec3(x0, y, h), dvec3(x1, y, h), dvec3(x1, y, -h), dvec3(x0, y, -h)]
    };
    s.polygon(&plate(-8.0, 8.0, 0.0, 8.0), white);
    s.polygon(&plate(-9.0, EDGE, 1.0, 9.0), white);
    s.scene.camera.up = dvec3(0.07, 1.0, 0.0);
    s.sun(SLANT);
    s.scene
}

/// The line in which the shadow of [`half_plane`] ends, and a lit point.
pub(crate) fn half_plane_edge() -> ([DVec3; 2], DVec3) {
    let fall = |z: f64| dvec3(EDGE, 1.0, z) - SLANT * (1.0 / SLANT.y);
    ([fall(-1.0), fall(0.5)], fall(0.0) + DVec3::X)
}

/// Radiance of the lit ground.
pub(crate) fn half_plane_color() -> DVec3 {
    DVec3::splat(-SLANT.normalize().y)
}

fn ground(s: &mut Sketch, half: f64) -> u32 {
    let white = s.matt(0.8, 1.0);
    let h = half;
    s.polygon(&[dvec3(-h, 0.0, h), dvec3(h, 0.0, h), dvec3(h, 0.0, -h), dvec3(-h, 0.0, -h)], white);
    white
}

/// Spheres that stand on the ground.
pub(crate) fn spheres(size: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.5, 2.6, 6.0), dvec3(0.0, 0.5, 0.0), 36.0, size);
    let white = ground(&mut s, 6.0);
    for i in 0..5 {
        let angle = TAU * f64::from(i) / 5.0;
        s.sphere(dvec3(1.4 * angle.cos(), 0.5, 1.4 * angle.sin()), 0.5, 4, white);
    }
    s.lamp(dvec3(3.0, 5.0, 2.0), 6.0);
    s.scene
}

/// The fence under a lamp behind it.
pub(crate) fn fence(size: u32) -> Scene {
    let mut s = pales(size);
    s.lamp(dvec3(-2.0, 3.0, -4.0), 5.0);
    s.scene
}

/// The fence in the sun.
pub(crate) fn fence_in_the_sun(size: u32) -> Scene {
    let mut s = pales(size);
    s.sun(dvec3(0.35, -0.5, 0.8));
    s.scene
}

/// A fence of thin pales: casters thinner than a pixel's shadow.
fn pales(size: u32) -> Sketch {
    let mut s = Sketch::new(dvec3(0.6, 2.4, 5.0), dvec3(0.0, 0.3, 0.0), 36.0, size);
    let white = ground(&mut s, 6.0);
    for i in 0..60 {
        let x = -2.4 + 0.08 * f64::from(i);
        s.cuboid(dvec3(x, 0.0, -1.0), dvec3(x + 0.012, 1.0, -0.99), white);
    }
    s.cuboid(dvec3(-2.5, 0.8, -1.01), dvec3(2.5, 0.82, -0.98), white);
    s
}

/// A round cage about a sphere under a spot light whose beam fades within the picture.
pub(crate) fn cage(size: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.5, 2.6, 5.0), dvec3(0.0, 0.4, 0.0), 36.0, size);
    let white = ground(&mut s, 6.0);
    s.sphere(dvec3(0.0, 0.45, 0.0), 0.35, 4, white);
    let (bars, radius, half) = (32, 0.9, 0.008);
    for i in 0..bars {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(bars)).sin_cos();
        let foot = dvec3(radius * cos, 0.0, radius * sin);
        s.cuboid(foot - dvec3(half, 0.0, half), foot + dvec3(half, 1.1, half), white);
    }
    // Thinner than the bars that they end in, and one above the other: where faces coincide, what is in shadow is not defined.
    let thin = 0.006;
    for y in [0.35, 0.7, 1.05] {
        s.cuboid(dvec3(-radius, y, -thin), dvec3(radius, y + 0.012, thin), white);
        let above = y + 0.03;
        s.cuboid(dvec3(-thin, above, -radius), dvec3(thin, above + 0.012, radius), white);
    }
    s.light(Light::Spot {
        position: dvec3(1.5, 4.0, 1.5),
        direction: dvec3(-1.5, -3.6, -1.5),
        intensity: Vec3::splat(64.0),
        beam_rad: 0.25,
        cutoff_rad: 0.45,
        exponent: 0.0,
        falloff: Falloff::InverseSquare,
    });
    s.scene
}

/// Hills under a light five degrees above the ground.
pub(crate) fn terrain(size: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.0, 3.2, 7.0), dvec3(0.0, 0.0, 0.5), 40.0, size);
    let white = s.matt(0.8, 1.0);
    let (positions, triangles) = hills(96, 4.0);
    s.triangles(&positions, &triangles, white);
    s.sun(dvec3(1.0, -(5f64.to_radians().tan()), 0.3));
    s.scene
}

/// A height field of `2 · n²` triangles, `2 · half` wide.
pub(crate) fn hills(n: u32, half: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let height = |x: f64, z: f64| {
        0.18 * (1.7 * x + 0.4).sin() * (1.3 * z).cos()
            + 0.07 * (4.1 * x - 2.9 * z).sin()
            + 0.02 * (13.0 * z + 9.0 * x).cos()
    };
    let at = |k: u32| (2.0 * f64::from(k) / f64::from(n) - 1.0) * half;
    let vertex = |i: u32| {
        let (x, z) = (at(i % (n + 1)), at(i / (n + 1)));
        dvec3(x, height(x, z), z)
    };
    let positions = (0..(n + 1) * (n + 1)).map(vertex).collect();
    let cell = |k: u32| {
        let a = k / n * (n + 1) + k % n;
        let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
        [[a, c, b], [a, d, c]]
    };
    (positions, (0..n * n).flat_map(cell).collect())
}

/// Translucent panes above a ground.
pub(crate) fn panes(size: u32) -> Scene {
    let mut s = Sketch::new(dvec3(0.5, 3.2, 5.0), dvec3(0.0, 0.3, 0.0), 36.0, size);
    ground(&mut s, 6.0);
    for i in 0..4 {
        let pane = s.matt(0.5, 0.3 + 0.15 * i as f32);
        let k = f64::from(i);
        let corner = |j: usize| {
            let angle = 0.5 * k + j as f64 * TAU / 4.0;
            dvec3(0.9 * angle.cos() + 0.4 * (k - 1.5), 0.5 + 0.3 * k, 0.9 * angle.sin())
        };
        s.polygon(&[corner(0), corner(1), corner(2), corner(3)], pane);
    }
    s.lamp(dvec3(1.0, 6.0, 1.5), 6.0);
    s.scene
}

/// Spheres and a board under a rectangular light of `samples` points; 0 for the whole of it. Everything is matt, or glossy.
pub(crate) fn area_light(size: u32, samples: u32, glossy: bool) -> Scene {
    let mut s = Sketch::new(dvec3(0.5, 2.6, 5.0), dvec3(0.0, 0.4, 0.0), 36.0, size);
    let white = ground(&mut s, 6.0);
    if glossy {
        s.scene.materials[white as usize].surface =
            shade::Material::ggx(Vec3::splat(0.4), Vec3::splat(0.3), GLOSSY_ROUGHNESS);
    }
    s.sphere(dvec3(0.6, 0.5, 0.2), 0.5, 4, white);
    s.sphere(dvec3(-0.2, 0.25, 1.1), 0.25, 4, white);
    s.cuboid(dvec3(-1.3, 0.0, -0.2), dvec3(-0.3, 1.1, -0.15), white);
    s.light(Light::Rect {
        corner: dvec3(-0.6, 4.0, -0.6),
        edge_u: dvec3(1.2, 0.0, 0.0),
        edge_v: dvec3(0.0, 0.0, 1.2),
        radiance: Vec3::splat(30.0),
        samples: NonZeroU32::new(samples),
        falloff: Falloff::InverseSquare,
    });
    s.scene
}
