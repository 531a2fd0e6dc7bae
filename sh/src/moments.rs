//! From moments of a cube's faces to coefficients.
//!
//! With r = |(s, t, 1)|, a basis function of band l is on a face a polynomial in s and t of degree l over r^l. As
//! r² = s² + t² + 1, it is also one of degree l + 2 over r^(l+2). So for order L the polynomials of degree L over r^L
//! and of degree L − 1 over r^(L−1) are enough: (L+1)² of them, as many as there are coefficients.

use crate::basis::{MAX_COUNT, MAX_ORDER, coefficient_count, fill_basis};
use crate::legendre::legendre;
use crate::{CubePoint, cube_direction, gauss_legendre};

/// The moments of a face, in order: P_a(s)·P_b(t)/r^degree of degree L, then of degree L − 1.
pub(crate) struct Moment {
    pub(crate) degree: usize,
    pub(crate) a: usize,
    pub(crate) b: usize,
}

/// All moments of order L, by degree, then a, then b ≤ degree − a.
pub(crate) fn moments(order: usize) -> impl Iterator<Item = Moment> {
    let of_degree = |degree: usize| {
        (0..=degree).flat_map(move |a| (0..=degree - a).map(move |b| Moment { degree, a, b }))
    };
    [Some(order), order.checked_sub(1)].into_iter().flatten().flat_map(of_degree)
}

/// Per face the matrix, in columns, that makes coefficients of its moments.
pub(crate) fn coefficients_from_moments(order: usize) -> Vec<f64> {
    (0..6).flat_map(|face| of_face(order, face)).collect()
}

/// Expands each basis function times r^degree in products of Legendre polynomials, by quadrature that is exact for
/// them.
fn of_face(order: usize, face: usize) -> Vec<f64> {
    let count = coefficient_count(order);
    let mut matrix = vec![0.0; count * count];
    let nodes = gauss_legendre(order + 1);
    for (&(s, ws), &(t, wt)) in nodes.iter().flat_map(|s| nodes.iter().map(move |t| (s, t))) {
        let way = cube_direction(CubePoint { face, s, t });
        let r = way.length();
        let mut values = [0.0; MAX_COUNT];
        fill_basis(order, way / r, &mut values);
        let (mut ps, mut pt) = ([0.0; MAX_ORDER + 1], [0.0; MAX_ORDER + 1]);
        legendre(s, &mut ps);
        legendre(t, &mut pt);
        for (column, Moment { degree, a, b }) in moments(order).enumerate() {
            // ∫ P_a² = 2/(2a + 1).
            let norm = ((2 * a + 1) * (2 * b + 1)) as f64 / 4.0;
            let factor = ws * wt * norm * ps[a] * pt[b] * r.powi(degree as i32);
            for l in (degree % 2..=order).step_by(2) {
                for i in l * l..(l + 1) * (l + 1) {
                    matrix[column * count + i] += factor * values[i];
                }
            }
        }
    }
    matrix
}
