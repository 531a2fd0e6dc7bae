//! Symmetric 3×3 matrices.

use glam::{DMat3, DVec3};

/// Sweeps after which only rounding errors are left: Jacobi's method converges quadratically.
const SWEEPS: usize = 8;

/// Eigenvalues, rising, with orthonormal eigenvectors, by Jacobi's method.
pub(crate) fn eigen(matrix: DMat3) -> [(f64, DVec3); 3] {
    let (mut a, mut vectors) = (matrix, DMat3::IDENTITY);
    for _ in 0..SWEEPS {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let rest = a.col(j)[i];
            if rest == 0.0 {
                continue;
            }
            let tau = (a.col(j)[j] - a.col(i)[i]) / (2.0 * rest);
            let tan = f64::copysign(1.0, tau) / (tau.abs() + tau.hypot(1.0));
            let cos = tan.hypot(1.0).recip();
            let sin = tan * cos;
            let mut turn = DMat3::IDENTITY;
            (turn.col_mut(i)[i], turn.col_mut(j)[j]) = (cos, cos);
            (turn.col_mut(j)[i], turn.col_mut(i)[j]) = (sin, -sin);
            a = turn.transpose() * a * turn;
            vectors *= turn;
        }
    }
    let mut pairs = [0, 1, 2].map(|i| (a.col(i)[i], vectors.col(i)));
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
    pairs
}
