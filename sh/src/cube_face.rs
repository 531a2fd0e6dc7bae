//! Directions of the six faces.

use glam::{DVec3, dvec3};

/// A position on a cube map: a face, and coordinates on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubePoint {
    /// 0 to 5: +X, −X, +Y, −Y, +Z, −Z.
    pub face: usize,
    /// From −1 at the left edge of the face to 1 at the right.
    pub s: f64,
    /// From −1 at the top to 1 at the bottom.
    pub t: f64,
}

/// The vector from the middle of the cube to a position on a face, with largest component ±1: +X (1, −t, −s), −X (−1,
/// −t, s), +Y (s, 1, t), −Y (s, −1, −t), +Z (s, −t, 1), −Z (−s, −t, −1). Faces above 5 are taken for −Z.
#[must_use]
pub const fn cube_direction(point: CubePoint) -> DVec3 {
    let CubePoint { face, s, t } = point;
    match face {
        0 => dvec3(1.0, -t, -s),
        1 => dvec3(-1.0, -t, s),
        2 => dvec3(s, 1.0, t),
        3 => dvec3(s, -1.0, -t),
        4 => dvec3(s, -t, 1.0),
        _ => dvec3(-s, -t, -1.0),
    }
}

/// Where a direction of any length meets the cube; on an edge, the first of the faces. `None` for 0 and what is not
/// finite.
#[must_use]
pub fn cube_point(direction: DVec3) -> Option<CubePoint> {
    let size = direction.abs().max_element();
    if !direction.is_finite() || size == 0.0 {
        return None;
    }
    // Not times 1/size: that overflows for the smallest directions.
    let d = direction / size;
    let DVec3 { x, y, z } = d;
    let is_on = |v: f64| v.abs() == 1.0;
    let (face, s, t) = match d {
        _ if is_on(x) && x > 0.0 => (0, -z, -y),
        _ if is_on(x) => (1, z, -y),
        _ if is_on(y) && y > 0.0 => (2, x, z),
        _ if is_on(y) => (3, x, -z),
        _ if z > 0.0 => (4, x, -y),
        _ => (5, -x, -y),
    };
    Some(CubePoint { face, s, t })
}
