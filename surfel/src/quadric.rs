//! The normal of a surface that bends, at one of its points.
//!
//! A paraboloid over a plane near the surface, `h = a + b·u + c·v + d·u² + e·uv + f·v²`, fitted by weighted least squares: its normal above
//! the point (F. Cazals, M. Pouget, *Estimating differential quantities using polynomial fitting of osculating jets*, CAGD 2005). Where points lie
//! unevenly, a plane follows the bend between them; this does not.

use glam::DVec3;

/// The weight of an offset falls to zero at this length: (1 − length²/REACH²)².
const REACH: f64 = 1.1;

/// Squares of slopes and of curvatures that count as much as the squares of all heights: without points that tell them (on a
/// line, on two lines), they are 0. Curvatures of all others fall short by about as much.
const SLOPE_COST: f64 = 1e-9;
const CURVATURE_COST: f64 = 1e-4;

/// Numbers of the paraboloid.
const TERMS: usize = 6;

/// The unit normal of the paraboloid at offset 0, on the side of `plane`, the unit normal of a plane near these offsets, and the mean square of what
/// heights are off. Offsets have lengths up to 1, and one of them is 0.
pub(crate) fn fitted(offsets: impl Iterator<Item = DVec3>, plane: DVec3) -> (DVec3, f64) {
    let (right, up) = plane.any_orthonormal_pair();
    let (mut squares, mut products, mut heights2) = ([[0.0; TERMS]; TERMS], [0.0; TERMS], 0.0);
    for offset in offsets {
        let (u, v, h) = (offset.dot(right), offset.dot(up), offset.dot(plane));
        let weight = (1.0 - offset.length_squared() / (REACH * REACH)).max(0.0).powi(2);
        heights2 += weight * h * h;
        let terms = [1.0, u, v, u * u, u * v, v * v];
        for i in 0..TERMS {
            products[i] += weight * terms[i] * h;
            for j in 0..=i {
                squares[i][j] += weight * terms[i] * terms[j];
            }
        }
    }
    let weights = squares[0][0];
    for (i, row) in squares.iter_mut().enumerate().skip(1) {
        row[i] += weights * if i < 3 { SLOPE_COST } else { CURVATURE_COST };
    }
    let solution = solved(squares, products);
    let [_, b, c, ..] = solution;
    let explained: f64 = solution.iter().zip(products).map(|(x, product)| x * product).sum();
    ((plane - right * b - up * c).normalize(), (heights2 - explained).max(0.0) / weights)
}

/// Solves a positive definite system, of which the lower triangle is given, by Cholesky's factors.
fn solved(mut m: [[f64; TERMS]; TERMS], mut x: [f64; TERMS]) -> [f64; TERMS] {
    for i in 0..TERMS {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| m[i][k] * m[j][k]).sum();
            let rest = m[i][j] - sum;
            // Above 0 but for rounding, which the costs outweigh.
            m[i][j] = if i == j { rest.max(f64::MIN_POSITIVE).sqrt() } else { rest / m[j][j] };
        }
    }
    for i in 0..TERMS {
        let sum: f64 = (0..i).map(|k| m[i][k] * x[k]).sum();
        x[i] = (x[i] - sum) / m[i][i];
    }
    for i in (0..TERMS).rev() {
        let sum: f64 = (i + 1..TERMS).map(|k| m[k][i] * x[k]).sum();
        x[i] = (x[i] - sum) / m[i][i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    /// Offsets of a point from the others of a paraboloid with this slope along x, unevenly spread.
    fn paraboloid(slope: f64) -> Vec<DVec3> {
        let at = |i: u32| {
            let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
            let (x, y) = (0.2 * f64::from(i).sqrt() * cos + 0.1, 0.2 * f64::from(i).sqrt() * sin);
            dvec3(x, y, slope * x + 0.3 * x * x - 0.2 * x * y + 0.1 * y * y)
        };
        std::iter::once(DVec3::ZERO).chain((1..14).map(at)).collect()
    }

    #[test]
    fn a_paraboloid_has_its_normal() {
        for slope in [0.0, 0.05, -0.3] {
            let (found, deviation2) = fitted(paraboloid(slope).into_iter(), DVec3::Z);
            let wanted = dvec3(-slope, 0.0, 1.0).normalize();
            assert!(found.angle_between(wanted) < 2e-3, "{found}, not {wanted}");
            // What curvatures cost, and that they fall short for it.
            assert!(deviation2 < 2e-5, "{deviation2}");
        }
    }

    #[test]
    fn what_heights_are_off_is_told() {
        // One place in 14 is off by 0.1, and the paraboloid follows it by some.
        let mut offsets = paraboloid(0.05);
        offsets[5].z += 0.1;
        let (_, deviation2) = fitted(offsets.into_iter(), DVec3::Z);
        assert!((0.01 / 14.0 * 0.2..0.01 / 14.0 * 1.5).contains(&deviation2), "{deviation2}");
    }

    #[test]
    fn points_that_tell_nothing_keep_the_plane() {
        let on_line: Vec<DVec3> = (0..9).map(|i| DVec3::X * (0.1 * f64::from(i))).collect();
        for offsets in [vec![DVec3::ZERO], vec![DVec3::ZERO, DVec3::Y], on_line] {
            assert!((fitted(offsets.into_iter(), DVec3::Z).0 - DVec3::Z).length() < 1e-6);
        }
    }
}
