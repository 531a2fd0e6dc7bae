//! The minimum of a function over all directions.

use crate::basis::{Y1, Y2_AXIAL, Y2_MIXED, Y2_SQUARES};
use crate::eigen::eigen;
use crate::{Sh, search};
use glam::{DMat3, DVec3, dvec3};

/// Bisection steps after which no interval of `f64` can be divided further.
const HALVINGS: usize = 100;

impl Sh<f64> {
    /// The direction and value of the minimum over all directions.
    ///
    /// Up to order 2 it is that of a quadratic form on the sphere, from its secular equation: the value is within 1e-14
    /// of the largest coefficient. Above, the lowest of a search from 40 (order + 1)² even directions, refined: the
    /// value of a minimum, within 1e-12; in theory one in a narrow valley could be missed.
    #[must_use]
    pub fn minimum(&self) -> (DVec3, f64) {
        let direction = if self.order() <= 2 { quadratic_minimum(self) } else { search::minimum(self) };
        (direction, self.at(direction))
    }
}

/// Where c + 2b·n + nᵀAn is least among unit vectors n.
///
/// With multiplier μ, (A − a₀ + μ)·n = −b where a₀ is the least eigenvalue and μ ≥ 0; in the eigenbasis n_i = −b_i/(a_i
/// − a₀ + μ), and |n| decreases with μ. If |n| < 1 even at μ = 0, a multiple of the eigenvector of a₀ is added to reach
/// unit length.
fn quadratic_minimum(sh: &Sh<f64>) -> DVec3 {
    let c = |l, m| sh.coefficient(l, m);
    let b = 0.5 * Y1 * dvec3(c(1, 1), c(1, -1), c(1, 0));
    let [xy, yz, xz] = [c(2, -2), c(2, -1), c(2, 1)].map(|c| 0.5 * Y2_MIXED * c);
    let (axial, squares) = (Y2_AXIAL * c(2, 0), Y2_SQUARES * c(2, 2));
    // 3z² − 1 = 2z² − x² − y² on the sphere.
    let a = DMat3::from_cols(
        dvec3(squares - axial, xy, xz),
        dvec3(xy, -squares - axial, yz),
        dvec3(xz, yz, 2.0 * axial),
    );
    let pairs = eigen(a);
    let gaps = pairs.map(|(value, _)| value - pairs[0].0);
    let parts = pairs.map(|(_, vector)| vector.dot(b));
    let at = |mu: f64| -> [f64; 3] {
        std::array::from_fn(|i| if parts[i] == 0.0 { 0.0 } else { -parts[i] / (gaps[i] + mu) })
    };
    // Brackets the root: |n| ≥ |b₀|/μ and |n| ≤ |b|/μ.
    let (mut low, mut high) = (parts[0].abs(), DVec3::from(parts).length());
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let is_long = DVec3::from(at(middle)).length_squared() > 1.0;
        (low, high) = if is_long { (middle, high) } else { (low, middle) };
    }
    let [_, second, third] = at(high);
    let first = (1.0 - second * second - third * third).max(0.0).sqrt();
    let n = pairs[0].1 * first.copysign(-parts[0]) + pairs[1].1 * second + pairs[2].1 * third;
    n.try_normalize().unwrap_or(DVec3::X)
}
