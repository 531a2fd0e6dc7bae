//! Signs of determinants of any finite coordinates, by integers of any size. Slow, and hardly ever needed: only where coordinates of
//! one input differ by more than fifty orders of magnitude.

use glam::DVec3;
use num_bigint::{BigInt, Sign};

type Vector = [BigInt; 3];

/// 2^1074 times a coordinate: an integer for every finite one.
fn to_integer(x: f64) -> BigInt {
    let bits = x.to_bits();
    let (field, fraction) = (bits >> 52 & 0x7ff, bits & ((1 << 52) - 1));
    let (mantissa, shift) = if field == 0 { (fraction, 0) } else { (fraction | 1 << 52, field - 1) };
    let magnitude = BigInt::from(mantissa) << shift;
    if x < 0.0 { -magnitude } else { magnitude }
}

fn difference(p: DVec3, q: DVec3) -> Vector {
    std::array::from_fn(|k| to_integer(p[k]) - to_integer(q[k]))
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

fn dot(a: &Vector, b: &Vector) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn det(a: &Vector, b: &Vector, c: &Vector) -> BigInt {
    dot(&cross(a, b), c)
}

fn sign(x: &BigInt) -> f64 {
    match x.sign() {
        Sign::Minus => -1.0,
        Sign::NoSign => 0.0,
        Sign::Plus => 1.0,
    }
}

/// The sign of (b−a)×(c−a)·(d−a).
pub(super) fn orient([a, b, c, d]: [DVec3; 4]) -> f64 {
    sign(&det(&difference(b, a), &difference(c, a), &difference(d, a)))
}

/// Positive inside the sphere through the corners of a positive tetrahedron.
pub(super) fn sphere(corners: [DVec3; 4], p: DVec3) -> f64 {
    let [a, b, c, d] = corners.map(|v| difference(v, p));
    let lift = |v: &Vector| dot(v, v);
    let sum = lift(&a) * det(&b, &c, &d) - lift(&b) * det(&a, &c, &d) + lift(&c) * det(&a, &b, &d)
        - lift(&d) * det(&a, &b, &c);
    sign(&sum)
}

/// Signs of the components of (b−a)×(c−a).
pub(super) fn normal_signs([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    cross(&difference(b, a), &difference(c, a)).each_ref().map(sign)
}
