//! Points and weights of Gauss–Legendre quadrature on [0, 1].
//!
//! `sh/src/gauss_legendre.rs` says why `pointillist-sh` has rules of its own.

use std::sync::OnceLock;

/// The highest order there is.
pub(crate) const MAX_ORDER: usize = 24;

/// Points and weights of one order, on [0, 1]; the weights add up to 1.
#[derive(Clone, Debug)]
pub(crate) struct Rule {
    pub(crate) points: Vec<f64>,
    pub(crate) weights: Vec<f64>,
}

impl Rule {
    /// Pairs of point and weight.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (f64, f64)> + Clone + '_ {
        self.points.iter().copied().zip(self.weights.iter().copied())
    }
}

/// The rule with `order` points, 1 to [`MAX_ORDER`]: exact for polynomials of degree 2·order − 1.
pub(crate) fn rule(order: usize) -> &'static Rule {
    static RULES: OnceLock<Vec<Rule>> = OnceLock::new();
    &RULES.get_or_init(|| (1..=MAX_ORDER).map(computed).collect())[order - 1]
}

/// Roots of the Legendre polynomial by Newton's method from Chebyshev's points.
fn computed(n: usize) -> Rule {
    let order = n as f64;
    let (mut points, mut weights) = (vec![], vec![]);
    for i in 0..n {
        let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (order + 0.5)).cos();
        // Six steps: quadratic convergence from two digits.
        for _ in 0..6 {
            let (p, slope) = legendre(n, x);
            x -= p / slope;
        }
        let (_, slope) = legendre(n, x);
        points.push(0.5 * (1.0 + x));
        weights.push(1.0 / ((1.0 - x * x) * slope * slope));
    }
    Rule { points, weights }
}

/// The Legendre polynomial of degree `n` and its slope.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
    }
    (p, n as f64 * (before - x * p) / (1.0 - x * x))
}

/// The point of a quadrangle at (u, v) and the Jacobian's length there: bilinear between the corners.
pub(crate) fn on_quad(quad: &[glam::DVec3; 4], u: f64, v: f64) -> (glam::DVec3, f64) {
    let [a, b, c, d] = *quad;
    let (low, high) = (a + (b - a) * u, d + (c - d) * u);
    let along = (b - a) * (1.0 - v) + (c - d) * v;
    let across = high - low;
    (low + across * v, along.cross(across).length())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_integrates_its_polynomials() {
        for n in 1..=MAX_ORDER {
            for degree in 0..2 * n {
                let sum: f64 = rule(n).iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
                let exact = 1.0 / (degree as f64 + 1.0);
                assert!((sum - exact).abs() < 1e-15 * 4.0, "order {n} degree {degree}: {sum} for {exact}");
            }
        }
    }
}
