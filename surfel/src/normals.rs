//! Normals of a cloud that has none.
//!
//! The plane through a point's neighbours that is nearest to them in the sense of least squares: its normal is the
//! direction in which they vary least, the eigenvector of their covariance for its smallest eigenvalue (H. Hoppe et
//! al., *Surface reconstruction from unorganized points*, SIGGRAPH 1992, §3.2).

use crate::error::SurfelError;
use crate::lattice::Lattice;
use crate::neighbours::Places;
use crate::points::Points;
use glam::{DVec3, Vec3};
use pointillist_parallel as parallel;

/// Places that a plane is fitted to, the point's own among them. Mean angle to the true normal on a sphere of 4000
/// points of blue noise, and with noise of 0.1 spacings along the normal: 0.70° and 3.5° with 8, 0.50° and 2.0° with
/// 14, 0.42° and 1.0° with 28, which round off what is thinner.
const FITTED: usize = 14;

/// Most rotations of all three pairs of axes. Each squares what is left off the diagonal: about 5 are needed.
const SWEEPS: usize = 8;

/// The unit normal of every point as [`Cloud`](crate::Cloud) estimates it, in the caller's order, for those who know on which side of it the outside is.
///
/// Its largest component is positive, which says nothing about sides. Does not depend on the order of points.
///
/// # Errors
/// [`SurfelError::NoPoints`], [`SurfelError::TooManyPoints`], [`SurfelError::PointNotFinite`], [`SurfelError::PointTooFar`].
pub fn estimate_normals(positions: &[DVec3]) -> Result<Vec<Vec3>, SurfelError> {
    Points::new(positions).check()?;
    let lattice = Lattice::around(positions);
    let places: Vec<DVec3> = positions.iter().map(|p| (*p - lattice.low) / lattice.side).collect();
    Ok(estimate(&Places::new(&places)))
}

/// The unit normal of every point, in the caller's order; the side on which it stands is arbitrary: its largest
/// component is positive. On a smooth surface the angle to the true one falls with the spacing, and with noise across
/// the surface it is about 0.35 of the noise per spacing, rad.
///
/// Points that coincide have the same normal. Where all neighbours lie on a line the normal is some direction across
/// it, and that of a lone place is +Z. Does not depend on the order of points.
pub(crate) fn estimate(places: &Places) -> Vec<Vec3> {
    let of_places = parallel::map(places.len(), |place| {
        let mut found = Vec::with_capacity(FITTED);
        places.nearest(place, FITTED, f64::INFINITY, &mut found);
        let farthest = found.last().map_or(0.0, |n| n.distance2.sqrt());
        // In parts of the farthest distance, so that no square of an offset is lost.
        let offset = |i: usize| (places.at(found[i].place) - places.at(place)) / farthest;
        if farthest > 0.0 { towards_largest(least_variation(found.len(), offset)).as_vec3() } else { Vec3::Z }
    });
    let mut normals = vec![Vec3::Z; places.point_count()];
    for (place, normal) in of_places.into_iter().enumerate() {
        places.points(place).iter().for_each(|&i| normals[i as usize] = normal);
    }
    normals
}

/// The normal or its opposite: the one with its largest component (the first of equals) positive.
fn towards_largest(normal: DVec3) -> DVec3 {
    if normal[normal.abs().max_position()] < 0.0 { -normal } else { normal }
}

/// The unit vector along which these offsets vary least.
fn least_variation(count: usize, offset: impl Fn(usize) -> DVec3) -> DVec3 {
    let mean = (0..count).map(&offset).sum::<DVec3>() / count as f64;
    let mut covariance = [[0.0; 3]; 3];
    for i in 0..count {
        let d = offset(i) - mean;
        for (row, column) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
            covariance[row][column] += d[row] * d[column];
        }
    }
    let (values, vectors) = eigenvectors(covariance);
    vectors[DVec3::from(values).min_position()].normalize_or(DVec3::Z)
}

/// Eigenvalues and eigenvectors of a symmetric matrix, of which the upper triangle is given, by Jacobi's rotations
/// (G. H. Golub, C. F. Van Loan, *Matrix computations*, §8.5): unlike the closed form by cosines, exact to rounding of
/// the largest eigenvalue where two of them are equal.
fn eigenvectors(mut m: [[f64; 3]; 3]) -> ([f64; 3], [DVec3; 3]) {
    let mut vectors = DVec3::AXES;
    for _ in 0..SWEEPS {
        let off_diagonal = m[0][1].abs() + m[0][2].abs() + m[1][2].abs();
        if off_diagonal <= f64::EPSILON * f64::EPSILON * (m[0][0] + m[1][1] + m[2][2]) {
            break;
        }
        for (p, q, other) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            rotate(&mut m, &mut vectors, p, q, other);
        }
    }
    ([m[0][0], m[1][1], m[2][2]], vectors)
}

/// Turns axes `p < q` so that their element vanishes.
fn rotate(m: &mut [[f64; 3]; 3], vectors: &mut [DVec3; 3], p: usize, q: usize, other: usize) {
    let element = m[p][q];
    if element == 0.0 {
        return;
    }
    // t = tan of the angle, the smaller of the two: t² + 2 t cot(2φ) = 1. A cotangent beyond the range of numbers
    // gives t = 0.
    let cot2 = (m[q][q] - m[p][p]) / (2.0 * element);
    let t = f64::copysign(1.0, cot2) / (cot2.abs() + (cot2 * cot2 + 1.0).sqrt());
    let cos = 1.0 / (t * t + 1.0).sqrt();
    let sin = t * cos;
    m[p][p] -= t * element;
    m[q][q] += t * element;
    m[p][q] = 0.0;
    let upper = |a: usize, b: usize| (a.min(b), a.max(b));
    let (ip, iq) = (upper(p, other), upper(q, other));
    let (mp, mq) = (m[ip.0][ip.1], m[iq.0][iq.1]);
    m[ip.0][ip.1] = cos * mp - sin * mq;
    m[iq.0][iq.1] = sin * mp + cos * mq;
    (vectors[p], vectors[q]) = (cos * vectors[p] - sin * vectors[q], sin * vectors[p] + cos * vectors[q]);
}
