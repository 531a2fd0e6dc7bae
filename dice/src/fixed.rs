//! Fixed-point cell coordinates: 32 bits of cell number, 96 bits of place within the cell.
//!
//! Why not `f64`: the resolution is 2⁻⁹⁶ of a cell everywhere on the grid, so that subtraction, comparison and the number of the cell are
//! exact, sums do not depend on their order, and adding the slope of an edge row by row is as accurate as evaluating it anew.
//! A vertex within ±2³⁰ cells is exact if it is 0 or at least 2⁻⁴³ of a cell from the grid's origin lines.

/// A coordinate, length or ratio in units of 2⁻⁹⁶ cells.
pub(crate) type Fixed = i128;

/// Bits behind the binary point.
pub(crate) const BITS: u32 = 96;
/// One cell.
pub(crate) const ONE: Fixed = 1 << BITS;
/// 2⁻⁹⁶, the value of the last bit.
const LAST_BIT: f64 = 1.0 / (ONE as f64);

/// Number of the cell that holds `x`; a coordinate on a line belongs to the cell that begins there.
#[inline]
pub(crate) fn floor(x: Fixed) -> i32 {
    (x >> BITS) as i32
}

/// Number of the first line at or after `x`.
#[inline]
pub(crate) fn ceil(x: Fixed) -> i32 {
    ((x + (ONE - 1)) >> BITS) as i32
}

/// The coordinate of line `i`.
#[inline]
pub(crate) fn line(i: i32) -> Fixed {
    Fixed::from(i) << BITS
}

/// The nearest multiple of 2⁻⁹⁶ towards zero, for |v| < 2³¹.
#[inline]
pub(crate) fn from_f64(v: f64) -> Fixed {
    let bits = v.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32;
    if exponent == 0 {
        return 0; // zero and subnormal numbers, far below 2⁻⁹⁶
    }
    debug_assert!(exponent < 1023 + 31, "the public door lets nothing this large in: {v}");
    let mantissa = Fixed::from((bits & ((1 << 52) - 1)) | (1 << 52));
    let shift = exponent - 1075 + BITS as i32;
    let magnitude = if shift >= 0 { mantissa << shift } else { mantissa >> (-shift).min(127) };
    if v.is_sign_negative() { -magnitude } else { magnitude }
}

/// `x` as a number of cells, for |x| < 2¹⁵ cells: two exact halves and one rounding, so that small lengths keep all their digits.
#[inline]
pub(crate) fn to_f64(x: Fixed) -> f64 {
    const HALF: f64 = (1u64 << 48) as f64;
    let high = (x >> 48) as i64 as f64;
    let low = (x as u64 & ((1 << 48) - 1)) as i64 as f64;
    (high * HALF + low) * LAST_BIT
}

/// The product of two magnitudes, towards zero; the caller knows that it fits.
#[inline]
fn multiply_magnitudes(a: u128, b: u128) -> u128 {
    let (a1, a0) = (a >> 64, u128::from(a as u64));
    let (b1, b0) = (b >> 64, u128::from(b as u64));
    // The two middle products are below 2¹²⁷: neither high half reaches 2⁶³.
    let low = (a0 * b0) >> 64;
    let middle = (a1 * b0) + low;
    let middle2 = (a0 * b1) + u128::from(middle as u64);
    let high = (a1 * b1) + (middle >> 64) + (middle2 >> 64);
    (high << 32) | (u128::from(middle2 as u64) >> 32)
}

/// The product, rounded towards zero so that it is odd in both factors.
#[inline]
pub(crate) fn multiply(a: Fixed, b: Fixed) -> Fixed {
    let magnitude = multiply_magnitudes(a.unsigned_abs(), b.unsigned_abs()) as Fixed;
    if (a < 0) != (b < 0) { -magnitude } else { magnitude }
}

/// A magnitude as a sum of two `f64` that do not overlap: 106 leading bits.
#[inline]
fn to_pair(x: Fixed) -> (f64, f64) {
    const MASK: u128 = (1 << 40) - 1;
    let x = x.unsigned_abs();
    let top = (x >> 80) as i64 as f64 * (1u128 << 80) as f64;
    let middle = ((x >> 40) & MASK) as i64 as f64 * (1u64 << 40) as f64;
    let bottom = (x & MASK) as i64 as f64;
    let upper = top + middle;
    let rest = (middle - (upper - top)) + bottom;
    let high = upper + rest;
    (high, rest - (high - upper))
}

/// The rounding error of the product `a·b`, by Veltkamp's splitting [2]. Not `mul_add`: without the instruction that is slow.
#[inline]
pub(crate) fn product_error(a: f64, b: f64) -> f64 {
    const SPLITTER: f64 = 134_217_729.0; // 2²⁷ + 1
    let split = |v: f64| {
        let c = SPLITTER * v;
        let high = c - (c - v);
        (high, v - high)
    };
    let (a1, a0) = split(a);
    let (b1, b0) = split(b);
    a0 * b0 - (((a * b - a1 * b1) - a0 * b1) - a1 * b0)
}

/// `a / b` to about 2⁻¹⁰⁰ of itself or 2⁻⁹⁶, whichever is larger, for b > 0 and |a / b| < 2³¹. Odd in `a`.
#[inline]
pub(crate) fn divide(a: Fixed, b: Fixed) -> Fixed {
    debug_assert!(b > 0, "an edge is divided by only when it crosses a line");
    let (a1, a0) = to_pair(a);
    let (b1, b0) = to_pair(b);
    let q1 = a1 / b1;
    // Exact: the remainder of a correctly rounded quotient is a double.
    let rest = (a1 - q1 * b1) - product_error(q1, b1);
    let q0 = (rest + (a0 - q1 * b0)) / b1;
    let q = from_f64(q1) + from_f64(q0);
    if a < 0 { -q } else { q }
}
