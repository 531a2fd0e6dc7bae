//! The basis functions and their order.

use crate::ShError;
use glam::DVec3;
use std::sync::LazyLock;

/// The highest order (band) that this crate computes.
pub const MAX_ORDER: usize = 8;

/// Coefficients of the highest order.
pub const MAX_COUNT: usize = coefficient_count(MAX_ORDER);

/// Y00 = √(1/4π).
pub(crate) const Y0: f64 = 0.282_094_791_773_878_14;
/// √(3/4π), of the linear functions.
pub(crate) const Y1: f64 = 0.488_602_511_902_919_9;
/// ½√(15/π), of xy, yz and xz.
pub(crate) const Y2_MIXED: f64 = 1.092_548_430_592_079_2;
/// ¼√(5/π), of 3z² − 1.
pub(crate) const Y2_AXIAL: f64 = 0.315_391_565_252_520_05;
/// ¼√(15/π), of x² − y².
pub(crate) const Y2_SQUARES: f64 = 0.546_274_215_296_039_6;

/// How many coefficients there are up to a band: (order+1)², or `usize::MAX` if that is more.
#[must_use]
pub const fn coefficient_count(order: usize) -> usize {
    order.saturating_add(1).saturating_mul(order.saturating_add(1))
}

/// Index of the coefficient of band l and −l ≤ m ≤ l: l(l+1) + m. `usize::MAX`, which is no index of any list, if m is
/// out of range or the index overflows.
#[must_use]
pub const fn coefficient_index(l: usize, m: isize) -> usize {
    let middle = l.saturating_mul(l.saturating_add(1));
    if m.unsigned_abs() > l || middle == usize::MAX {
        return usize::MAX;
    }
    middle.saturating_add_signed(m)
}

/// The order, or an error if it is above [`MAX_ORDER`].
pub(crate) fn checked_order(order: usize) -> Result<usize, ShError> {
    if order <= MAX_ORDER { Ok(order) } else { Err(ShError::OrderTooHigh { order, limit: MAX_ORDER }) }
}

/// All basis functions up to `order` in a direction of unit length. `order` is limited to [`MAX_ORDER`]; values of
/// bands above it are 0.
#[must_use]
pub fn basis(order: usize, direction: DVec3) -> [f64; MAX_COUNT] {
    let mut values = [0.0; MAX_COUNT];
    fill_basis(order.min(MAX_ORDER), direction, &mut values);
    values
}

/// The nine basis functions of bands 0 to 2 in a direction of unit length.
#[must_use]
#[inline]
pub fn basis_l2(direction: DVec3) -> [f64; 9] {
    let DVec3 { x, y, z } = direction;
    [
        Y0,
        Y1 * y,
        Y1 * z,
        Y1 * x,
        Y2_MIXED * (x * y),
        Y2_MIXED * (y * z),
        Y2_AXIAL * (3.0 * z * z - 1.0),
        Y2_MIXED * (x * z),
        Y2_SQUARES * (x * x - y * y),
    ]
}

/// Factors of the recurrence in l of the normalised associated Legendre functions without their power of sin θ:
/// `Q_l^m = rise·(z·Q_{l−1}^m − fall·Q_{l−2}^m)`.
struct Recurrence {
    /// Q_m^m, with √2 for m > 0.
    start: [f64; MAX_ORDER + 1],
    rise: [[f64; MAX_ORDER + 1]; MAX_ORDER + 1],
    fall: [[f64; MAX_ORDER + 1]; MAX_ORDER + 1],
}

static RECURRENCE: LazyLock<Recurrence> = LazyLock::new(|| {
    let empty = [[0.0; MAX_ORDER + 1]; MAX_ORDER + 1];
    let mut table = Recurrence { start: [Y0; MAX_ORDER + 1], rise: empty, fall: empty };
    let mut start = Y0;
    for m in 0..=MAX_ORDER {
        let m2 = (m * m) as f64;
        if m > 0 {
            start *= ((2 * m + 1) as f64 / (2 * m) as f64).sqrt();
            table.start[m] = std::f64::consts::SQRT_2 * start;
        }
        for l in m + 1..=MAX_ORDER {
            let (l2, below2) = ((l * l) as f64, ((l - 1) * (l - 1)) as f64);
            table.rise[m][l] = ((4.0 * l2 - 1.0) / (l2 - m2)).sqrt();
            table.fall[m][l] = ((below2 - m2) / (4.0 * below2 - 1.0)).max(0.0).sqrt();
        }
    }
    table
});

/// As [`basis`], into the first (order+1)² of `values`.
pub(crate) fn fill_basis(order: usize, direction: DVec3, values: &mut [f64]) {
    if order == 2 {
        values[..9].copy_from_slice(&basis_l2(direction));
        return;
    }
    let DVec3 { x, y, z } = direction;
    let table = &*RECURRENCE;
    // sinᵐθ·cos mφ and sinᵐθ·sin mφ are the real and the imaginary part of (x + iy)ᵐ: no angle is computed, and the
    // poles are no special case.
    let (mut cos, mut sin) = (1.0, 0.0);
    for m in 0..=order {
        let (mut last, mut q) = (0.0, table.start[m]);
        for l in m..=order {
            if l > m {
                (last, q) = (q, table.rise[m][l] * (z * q - table.fall[m][l] * last));
            }
            values[coefficient_index(l, m as isize)] = q * cos;
            if m > 0 {
                values[coefficient_index(l, -(m as isize))] = q * sin;
            }
        }
        (cos, sin) = (x * cos - y * sin, x * sin + y * cos);
    }
}
