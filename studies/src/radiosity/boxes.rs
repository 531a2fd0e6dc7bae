//! Scenes of boxes.

use glam::{DQuat, DVec3, dvec3};
use pointillist_radiosity::Surface;

/// A parallelogram.
pub(crate) fn quad(o: DVec3, u: DVec3, v: DVec3) -> [DVec3; 4] {
    [o, o + u, o + u + v, o + v]
}

/// The six rectangles of a box turned about its middle, seen from outside.
pub(crate) fn faces(low: DVec3, high: DVec3, angle: f64) -> Vec<Vec<DVec3>> {
    let (centre, turn) = (0.5 * (low + high), DQuat::from_rotation_y(angle));
    let corner = |i: usize| {
        let pick = |axis: usize| if i >> axis & 1 == 1 { high[axis] } else { low[axis] };
        centre + turn * (dvec3(pick(0), pick(1), pick(2)) - centre)
    };
    let rings = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    rings.iter().map(|ring| ring.iter().map(|&i| corner(i)).collect()).collect()
}

/// A closed box seen from inside.
pub(crate) fn room(size: DVec3, reflectance: f64, emission: f64) -> Vec<Surface> {
    let inside = |ring: Vec<DVec3>| {
        let ring: Vec<DVec3> = ring.into_iter().rev().collect();
        Surface::new(&ring, [reflectance; 3]).emitting([emission; 3])
    };
    faces(DVec3::ZERO, size, 0.0).into_iter().map(inside).collect()
}

/// A room with a lamp, coloured walls and two turned boxes.
pub(crate) fn cornell() -> Vec<Surface> {
    let mut surfaces = room(DVec3::ONE, 0.7, 0.0);
    surfaces[0].reflectance = [0.63, 0.06, 0.05];
    surfaces[1].reflectance = [0.15, 0.48, 0.09];
    let lamp = quad(dvec3(0.4, 0.999, 0.4), DVec3::X * 0.2, DVec3::Z * 0.2);
    surfaces.push(Surface::new(&lamp, [0.0; 3]).emitting([10.0; 3]));
    for (low, high, angle) in [
        (dvec3(0.1, 0.0, 0.1), dvec3(0.4, 0.6, 0.4), 0.3),
        (dvec3(0.6, 0.0, 0.5), dvec3(0.9, 0.3, 0.8), -0.3),
    ] {
        surfaces.extend(faces(low, high, angle).iter().map(|f| Surface::new(f, [0.7; 3])));
    }
    surfaces
}
