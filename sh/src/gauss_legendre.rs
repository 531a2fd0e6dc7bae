//! Gauss–Legendre quadrature.
//!
//! `radiosity/src/kernel/gauss.rs` has rules of its own, on [0, 1] and kept by order: the two crates have no crate
//! below both that is about numbers, and twenty lines do not pay for one. The crate `gauss-quad` brings `nalgebra`, and
//! 272 of the 300 weights of its rules of up to 24 nodes differ from these in the last bits.

use std::f64::consts::PI;

/// Nodes in (−1, 1) and weights of Gauss–Legendre quadrature, exact for polynomials of degree 2·`count` − 1.
#[must_use]
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let node = |i: usize| {
        // Newton's method from Tricomi's estimate converges quadratically; after six steps rounding is all that is
        // left.
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
