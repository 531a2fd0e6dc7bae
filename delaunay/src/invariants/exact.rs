//! Coordinates as integers, and determinants of them.

use glam::DVec3;
use num_bigint::BigInt;

/// A vector of integers.
pub(super) type Triple = [BigInt; 3];

pub(super) fn zero() -> BigInt {
    BigInt::ZERO
}

pub(super) fn dot(a: &[BigInt], b: &[BigInt]) -> BigInt {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

pub(super) fn cross(a: &Triple, b: &Triple) -> Triple {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

/// Six times the signed volume that three vectors span.
pub(super) fn volume(a: &Triple, b: &Triple, c: &Triple) -> BigInt {
    dot(&cross(a, b), c)
}

/// Determinant of four rows, by the first column.
fn det4(rows: [[BigInt; 4]; 4]) -> BigInt {
    let minor = |skip: usize| {
        let tail = |k: &usize| -> Triple { [1, 2, 3].map(|j| rows[*k][j].clone()) };
        let kept: Vec<Triple> = (0..4).filter(|k| *k != skip).map(|k| tail(&k)).collect();
        volume(&kept[0], &kept[1], &kept[2])
    };
    (0..4).map(|k| if k % 2 == 0 { &rows[k][0] * minor(k) } else { -(&rows[k][0] * minor(k)) }).sum()
}

/// Points, in units of which all coordinates are multiples.
pub(super) struct Points(Vec<Triple>);

impl Points {
    /// Of finite coordinates.
    pub(super) fn new(points: &[DVec3]) -> Self {
        // x = mantissa · 2^(exponent − 1075)
        let split = |x: f64| {
            let (exponent, fraction) = ((x.to_bits() >> 52 & 0x7ff) as i64, x.to_bits() << 12 >> 12);
            let mantissa = if exponent == 0 { fraction } else { fraction | 1 << 52 };
            (if x < 0.0 { -(mantissa as i64) } else { mantissa as i64 }, exponent.max(1))
        };
        let all = || points.iter().flat_map(|p| p.to_array());
        let least = all().filter(|x| *x != 0.0).map(|x| split(x).1).min().unwrap_or(1);
        let whole = |x: f64| BigInt::from(split(x).0) << (split(x).1 - least).max(0) as u64;
        Self(points.iter().map(|p| p.to_array().map(whole)).collect())
    }

    /// From one point to another.
    pub(super) fn difference(&self, to: u32, from: u32) -> Triple {
        let (to, from) = (&self.0[to as usize], &self.0[from as usize]);
        std::array::from_fn(|k| &to[k] - &from[k])
    }

    /// (b−a)×(c−a)·(d−a).
    pub(super) fn orientation(&self, [a, b, c, d]: [u32; 4]) -> BigInt {
        volume(&self.difference(b, a), &self.difference(c, a), &self.difference(d, a))
    }

    /// (b−a)×(c−a).
    pub(super) fn normal(&self, [a, b, c]: [u32; 3]) -> Triple {
        cross(&self.difference(b, a), &self.difference(c, a))
    }

    /// Whether a point lies strictly inside the sphere through the corners of a positive tetrahedron.
    ///
    /// With the first corner as origin, the determinant of the other three and the point, each with its squared length
    /// in front, is six times the volume times how far the point is lifted below the plane of the lifted corners.
    pub(super) fn is_inside(&self, [a, b, c, d]: [u32; 4], p: u32) -> bool {
        let row = |v: u32| {
            let [x, y, z] = self.difference(v, a);
            [&x * &x + &y * &y + &z * &z, x, y, z]
        };
        det4([row(b), row(c), row(d), row(p)]) > zero()
    }

    /// Of the span of distinct points.
    pub(super) fn dimension(&self, distinct: &[u32]) -> usize {
        let a = distinct[0];
        let Some(&b) = distinct.get(1) else { return 0 };
        let is_zero = |v: &Triple| v.iter().all(|x| *x == zero());
        let Some(&c) = distinct.iter().find(|&&c| !is_zero(&self.normal([a, b, c]))) else { return 1 };
        if distinct.iter().any(|&d| self.orientation([a, b, c, d]) != zero()) { 3 } else { 2 }
    }
}
