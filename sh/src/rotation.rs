//! Rotation of spherical harmonics.

use crate::ShError;
use crate::basis::{checked_order, coefficient_count};
use crate::{Channel, Sh};
use glam::{DMat3, DQuat};

/// By how much a matrix or quaternion may differ from a rotation's, in any entry of RᵀR.
const ROTATION_TOLERANCE: f64 = 1e-6;

/// A rotation of functions on the sphere: per band a matrix, by the recurrence of Ivanic and Ruedenberg \[4\].
#[derive(Clone, Debug, PartialEq)]
pub struct Rotation {
    /// Band after band, each in rows.
    bands: Vec<Vec<f64>>,
}

impl Rotation {
    /// The rotation R for bands 0 to `order`: what was seen along d is seen along R·d afterwards.
    ///
    /// # Errors
    /// `OrderTooHigh`; `NotARotation` if the columns are not orthonormal within 1e-6, or mirror. Errors that small are
    /// kept: the result is exact for exact rotations.
    pub fn new(order: usize, rotation: DMat3) -> Result<Self, ShError> {
        checked_order(order)?;
        let rest = rotation.transpose() * rotation - DMat3::IDENTITY;
        let error = rest.to_cols_array().iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        // Written so that NaN, which compares false, is refused.
        if !(rotation.is_finite() && error < ROTATION_TOLERANCE && rotation.determinant() > 0.0) {
            return Err(ShError::NotARotation);
        }
        // Band 1 is y, z, x.
        let axes = [1, 2, 0];
        let first = axes.iter().flat_map(|&i| axes.map(|j| rotation.col(j)[i])).collect();
        let mut bands = vec![vec![1.0], first];
        for l in 2..=order {
            bands.push(next_band(l, &bands[1], &bands[l - 1]));
        }
        bands.truncate(order + 1);
        Ok(Self { bands })
    }

    /// The highest band that it turns.
    #[must_use]
    pub const fn order(&self) -> usize {
        self.bands.len() - 1
    }

    /// The turned function.
    ///
    /// # Errors
    /// `MixedOrders` if it has more bands than this.
    pub fn of<T: Channel>(&self, sh: &Sh<T>) -> Result<Sh<T>, ShError> {
        let (left, right) = (self.order(), sh.order());
        if right > left {
            return Err(ShError::MixedOrders { left, right });
        }
        let mut turned = Vec::with_capacity(coefficient_count(right));
        for (l, matrix) in self.bands.iter().enumerate().take(right + 1) {
            let row =
                |row: &[f64]| row.iter().zip(sh.band(l)).fold(T::default(), |sum, (&a, &c)| sum + c * a);
            turned.extend(matrix.chunks_exact(2 * l + 1).map(row));
        }
        Ok(Sh::from_parts(turned, right))
    }
}

impl<T: Channel> Sh<T> {
    /// The rotated function: what was seen along d is seen along R·d. For many functions with the same rotation, see
    /// [`Rotation`].
    ///
    /// # Errors
    /// `NotARotation` unless the quaternion has unit length.
    pub fn rotated(&self, rotation: DQuat) -> Result<Self, ShError> {
        // Not `from_quat`: with glam's own assertions on, that panics.
        let [x, y, z] = glam::DVec3::AXES.map(|axis| turn(rotation, axis));
        Rotation::new(self.order(), DMat3::from_cols(x, y, z))?.of(self)
    }
}

/// q·v·q*, for any q.
fn turn(rotation: DQuat, v: glam::DVec3) -> glam::DVec3 {
    let u = rotation.xyz();
    let w = rotation.w;
    u * (2.0 * u.dot(v)) + v * (w * w - u.dot(u)) + u.cross(v) * (2.0 * w)
}

/// The matrix of band l from those of band 1 and l − 1.
fn next_band(l: usize, first: &[f64], last: &[f64]) -> Vec<f64> {
    let l = l as isize;
    let step = Step { l, first, last };
    (-l..=l).flat_map(|m| (-l..=l).map(move |n| (m, n))).map(|(m, n)| step.entry(m, n)).collect()
}

/// Names as in the paper: its table 1 with the coefficients u, v, w, its table 2 with U, V, W in terms of P.
struct Step<'a> {
    l: isize,
    first: &'a [f64],
    last: &'a [f64],
}

impl Step<'_> {
    fn entry(&self, m: isize, n: isize) -> f64 {
        let l = self.l;
        let below = if n.abs() == l { 2 * l * (2 * l - 1) } else { (l + n) * (l - n) } as f64;
        let root = |above: isize| (above as f64 / below).sqrt();
        let a = m.abs();
        let u = root((l + m) * (l - m));
        let v = root((l + a - 1) * (l + a)) * if m == 0 { -std::f64::consts::FRAC_1_SQRT_2 } else { 0.5 };
        let w = root((l - a - 1) * (l - a)) * if m == 0 { 0.0 } else { -0.5 };
        // Factors of 0 stand before terms that do not exist.
        let mut sum = if u == 0.0 { 0.0 } else { u * self.p(0, m, n) };
        sum += v * self.v(m, n);
        sum + if w == 0.0 { 0.0 } else { w * self.w(m, n) }
    }

    fn v(&self, m: isize, n: isize) -> f64 {
        let sqrt2 = std::f64::consts::SQRT_2;
        match m {
            0 => self.p(1, 1, n) + self.p(-1, -1, n),
            1 => sqrt2 * self.p(1, 0, n),
            -1 => sqrt2 * self.p(-1, 0, n),
            2.. => self.p(1, m - 1, n) - self.p(-1, 1 - m, n),
            _ => self.p(1, m + 1, n) + self.p(-1, -m - 1, n),
        }
    }

    fn w(&self, m: isize, n: isize) -> f64 {
        if m > 0 {
            self.p(1, m + 1, n) + self.p(-1, -m - 1, n)
        } else {
            self.p(1, m - 1, n) - self.p(-1, 1 - m, n)
        }
    }

    fn p(&self, i: isize, a: isize, n: isize) -> f64 {
        let l = self.l;
        let first = |j: isize| self.first[((i + 1) * 3 + j + 1) as usize];
        let last = |n: isize| self.last[((a + l - 1) * (2 * l - 1) + n + l - 1) as usize];
        if n == l {
            first(1) * last(l - 1) - first(-1) * last(1 - l)
        } else if n == -l {
            first(1) * last(1 - l) + first(-1) * last(l - 1)
        } else {
            first(0) * last(n)
        }
    }
}
