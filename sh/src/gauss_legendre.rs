//! Gauss–Legendre quadrature.

use std::f64::consts::PI;

/// Nodes in (−1, 1) and weights of Gauss–Legendre quadrature, exact for polynomials of degree 2·`count` − 1.
#[must_use]
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let node = |i: usize| {
        // Newton's method from Tricomi's estimate converges quadratically; after six steps rounding is all that is left.
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..6 {
            let (mut last, mut p) = (0.0, 1.0);
            for l in 0..count {
                let l = l as f64;
                (last, p) = (p, ((2.0 * l + 1.0) * x * p - l * last) / (l + 1.0));
            }
            slope = n * (last - x * p) / (1.0 - x * x);
            x -= p / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).collect()
}
