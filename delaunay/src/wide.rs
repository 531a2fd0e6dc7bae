//! Signs of determinants of any finite coordinates, by integers of any size. Slow, and hardly ever needed: only where
//! coordinates of one input differ by more than fifty orders of magnitude.

use glam::DVec3;
use num_bigint::{BigInt, Sign};

pub(crate) type Vector = [BigInt; 3];

/// 2^1074 times a coordinate: an integer for every finite one.
pub(crate) fn to_integer(x: f64) -> BigInt {
    let bits = x.to_bits();
    let (field, fraction) = (bits >> 52 & 0x7ff, bits & ((1 << 52) - 1));
    let (mantissa, shift) = if field == 0 { (fraction, 0) } else { (fraction | 1 << 52, field - 1) };
    let magnitude = BigInt::from(mantissa) << shift;
    if x < 0.0 { -magnitude } else { magnitude }
}

pub(crate) fn difference(p: DVec3, q: DVec3) -> Vector {
    std::array::from_fn(|k| to_integer(p[k]) - to_integer(q[k]))
}

pub(crate) fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

pub(crate) fn dot(a: &Vector, b: &Vector) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

pub(crate) fn det(a: &Vector, b: &Vector, c: &Vector) -> BigInt {
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
pub(crate) fn orient([a, b, c, d]: [DVec3; 4]) -> f64 {
    sign(&det(&difference(b, a), &difference(c, a), &difference(d, a)))
}

/// Positive inside the sphere through the corners of a positive tetrahedron.
pub(crate) fn sphere(corners: [DVec3; 4], p: DVec3) -> f64 {
    let [a, b, c, d] = corners.map(|v| difference(v, p));
    let lift = |v: &Vector| dot(v, v);
    let sum = lift(&a) * det(&b, &c, &d) - lift(&b) * det(&a, &c, &d) + lift(&c) * det(&a, &b, &d)
        - lift(&d) * det(&a, &b, &c);
    sign(&sum)
}

/// Signs of the components of (b−a)×(c−a).
pub(crate) fn normal_signs([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    cross(&difference(b, a), &difference(c, a)).each_ref().map(sign)
}

/// A quotient of integers, in the unit of [`to_integer`], within an ulp; infinite if `f64` does not hold it. The
/// denominator is not 0.
pub(crate) fn to_f64(numerator: &BigInt, denominator: &BigInt) -> f64 {
    let (n, d) = (numerator.magnitude(), denominator.magnitude());
    if numerator.sign() == Sign::NoSign {
        return 0.0;
    }
    // So many bits that the quotient has 65 or more, of which the first 64 are kept.
    let lift = (66 + d.bits()).saturating_sub(n.bits());
    let q = (n << lift) / d;
    let dropped = q.bits().saturating_sub(64);
    let first = (&q >> dropped).iter_u64_digits().next().unwrap_or(0);
    let exponent = dropped as i64 - lift as i64 - 1074;
    // In two steps, since the power alone may overflow.
    let half = exponent.clamp(-2000, 2000) as i32 / 2;
    let size = first as f64 * 2.0_f64.powi(half) * 2.0_f64.powi(exponent.clamp(-2000, 2000) as i32 - half);
    if numerator.sign() == denominator.sign() { size } else { -size }
}
