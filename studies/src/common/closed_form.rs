//! Pictures that can be written down.

use glam::{DVec2, DVec3, dvec2};
use pointillist_render::Scene;

use crate::common::picture::Picture;
use crate::common::point_sampling::Pinhole;

/// A picture that has `color` on one side of the line through two points of the world, and nothing on the other.
///
/// The side is the one of `inside`.
pub(crate) fn half_plane(scene: &Scene, line: [DVec3; 2], inside: DVec3, color: DVec3) -> Picture {
    let camera = Pinhole::new(scene);
    let [a, b, c] = [line[0], line[1], inside].map(|p| camera.pixel(p));
    let normal = (b - a).perp();
    let normal = if normal.dot(c - a) < 0.0 { -normal } else { normal };
    let mut picture = Picture::black(scene.image.width, scene.image.height);
    for (i, pixel) in picture.pixels.iter_mut().enumerate() {
        let corner = dvec2((i as u32 % scene.image.width).into(), (i as u32 / scene.image.width).into());
        *pixel = color * area_beyond(corner, a, normal);
    }
    picture
}

/// Area of a unit square beyond a line through `on`.
fn area_beyond(corner: DVec2, on: DVec2, normal: DVec2) -> f64 {
    let square = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
    let side = |p: DVec2| normal.dot(corner - on + p);
    let mut ring = vec![];
    for (i, &p) in square.iter().enumerate() {
        let q = square[(i + 1) % 4];
        if side(p) >= 0.0 {
            ring.push(p);
        }
        if (side(p) >= 0.0) != (side(q) >= 0.0) {
            ring.push(p + (q - p) * (side(p) / (side(p) - side(q))));
        }
    }
    let twice: f64 = (0..ring.len()).map(|i| ring[i].perp_dot(ring[(i + 1) % ring.len()])).sum();
    0.5 * twice.abs()
}
