//! Signs of determinants without rounding, for coordinates of moderate size.

use glam::DVec3;
use robust::{Coord, Coord3D};

/// The arithmetic that decides where `f64` cannot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Exact {
    /// None is needed: coordinates are integers so small that `f64` does not round.
    Small,
    /// Integers whose determinants fit `i128`.
    Integer,
    /// Sums of `f64` that do not overlap (Shewchuk's).
    Expansion,
    /// Integers of any size, of the coordinates as given: where products of five could underflow.
    Wide,
}

/// Determinants below this fit `i128`, 2¹²⁷, with all their partial sums.
pub(super) const INTEGER_BELOW: f64 = 1.7e38;

/// With coordinates that are multiples of 2 to this power, products of five, and what Shewchuk's expansions split
/// off them, are multiples of 2⁻¹⁰⁰⁰: none underflows.
pub(super) const LEAST_UNIT: i32 = -200;

fn to_f64(sign: std::cmp::Ordering) -> f64 {
    f64::from(sign as i8)
}

/// Differences to `to`, which `f64` holds exactly.
fn differences<const N: usize>(points: [DVec3; N], to: DVec3) -> [[i64; 3]; N] {
    points.map(|p| (p - to).to_array().map(|x| x as i64))
}

/// a × b · c, where products of two fit `i64`.
fn integer_det(a: [i64; 3], b: [i64; 3], c: [i64; 3]) -> i128 {
    let minor = |i: usize, j: usize| i128::from(a[i] * b[j] - a[j] * b[i]);
    minor(1, 2) * i128::from(c[0]) + minor(2, 0) * i128::from(c[1]) + minor(0, 1) * i128::from(c[2])
}

/// The sign of (b−a)×(c−a)·(d−a).
pub(super) fn integer_orient([a, b, c, d]: [DVec3; 4]) -> f64 {
    let [b, c, d] = differences([b, c, d], a);
    to_f64(integer_det(b, c, d).cmp(&0))
}

/// Positive inside the sphere through the corners of a positive tetrahedron.
pub(super) fn integer_sphere(corners: [DVec3; 4], p: DVec3) -> f64 {
    let [a, b, c, d] = differences(corners, p);
    let lift = |v: [i64; 3]| i128::from(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    let det = lift(a) * integer_det(b, c, d) - lift(b) * integer_det(a, c, d)
        + lift(c) * integer_det(a, b, d)
        - lift(d) * integer_det(a, b, c);
    to_f64(det.cmp(&0))
}

fn coord(p: DVec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// As [`integer_orient`].
pub(super) fn expansion_orient([a, b, c, d]: [DVec3; 4]) -> f64 {
    -robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// As [`integer_sphere`].
pub(super) fn expansion_sphere([a, b, c, d]: [DVec3; 4], p: DVec3) -> f64 {
    -robust::insphere(coord(a), coord(b), coord(c), coord(d), coord(p))
}

/// Signs of the components of (b−a)×(c−a): the senses in which its shadows turn.
pub(super) fn normal_signs([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
        let shadow = |p: DVec3| Coord { x: p[i], y: p[j] };
        let area = robust::orient2d(shadow(a), shadow(b), shadow(c));
        if area == 0.0 { 0.0 } else { area.signum() }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn signs_agree_with_their_definition() {
        let tetrahedron = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        assert!(integer_orient(tetrahedron) > 0.0 && expansion_orient(tetrahedron) > 0.0);
        for (p, sign) in
            [(dvec3(1.0, 1.0, 1.0), 0.0), (dvec3(1.0, 1.0, 0.0), 0.0), (dvec3(2.0, 1.0, 1.0), -1.0)]
        {
            assert_eq!(integer_sphere(tetrahedron, p), sign);
            assert_eq!(expansion_sphere(tetrahedron, p).partial_cmp(&0.0), sign.partial_cmp(&0.0));
        }
        let wide = tetrahedron.map(|p| p * 4.0);
        assert!(integer_sphere(wide, DVec3::ONE) > 0.0 && expansion_sphere(wide, DVec3::ONE) > 0.0);
    }
}
