//! Directions on a square: the octahedral map.
//!
//! The sphere is projected to an octahedron, whose lower half is folded outward around the upper one (Cigolle et al.,
//! *A survey of efficient representations for independent unit vectors*, JCGT 2014). Texels differ in solid angle by
//! less than a factor of 5.

use glam::{DVec2, DVec3, dvec2, dvec3};

/// Where a direction of any length but 0 lies in [0, 1]².
#[cfg(test)]
pub(crate) fn square_from_direction(d: DVec3) -> DVec2 {
    square_from_octahedron(d / d.abs().element_sum())
}

/// Where a point of the octahedron |x| + |y| + |z| = 1 lies in [0, 1]².
pub(crate) fn square_from_octahedron(p: DVec3) -> DVec2 {
    let upper = dvec2(p.x, p.z);
    let folded = if p.y >= 0.0 { upper } else { fold(upper) };
    folded * 0.5 + 0.5
}

/// The unit direction of a point in [0, 1]².
pub(crate) fn direction_from_square(s: DVec2) -> DVec3 {
    let p = s * 2.0 - 1.0;
    let y = 1.0 - p.x.abs() - p.y.abs();
    let p = if y >= 0.0 { p } else { fold(p) };
    dvec3(p.x, y, p.y).normalize()
}

fn fold(p: DVec2) -> DVec2 {
    dvec2((1.0 - p.y.abs()).copysign(p.x), (1.0 - p.x.abs()).copysign(p.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_come_back() {
        for i in 0..2000 {
            let a = f64::from(i);
            let d = dvec3((a * 0.7).sin(), (a * 1.3).cos(), (a * 2.1).sin()).normalize();
            assert!((direction_from_square(square_from_direction(d)) - d).length() < 1e-12);
        }
    }
}
