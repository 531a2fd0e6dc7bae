//! Normals of a cloud that has none.
//!
//! 1. The plane through a point's neighbours that is nearest to them in the sense of least squares: its normal is the
//!    direction in which they vary least, the eigenvector of their covariance for its smallest eigenvalue (H. Hoppe et
//!    al., *Surface reconstruction from unorganized points*, SIGGRAPH 1992, §3.2).
//! 2. A paraboloid over it, because surfaces bend (`quadric.rs`).
//! 3. The same side for all normals of a surface (`orient.rs`), and the outside, where there is one (`outside.rs`).
//! 4. The mean of neighbouring normals, as far as they differ by noise (`noise.rs`).

use crate::error::SurfelError;
use crate::lattice::Lattice;
use crate::neighbours::Places;
use crate::orient::{Around, Orientation, VOTERS};
use crate::points::Points;
use crate::{noise, outside, quadric};
use glam::{DVec3, Vec3};
use pointillist_parallel as parallel;
use std::f64::consts::PI;

/// Places that a surface is fitted to, the point's own among them. Mean angle to the smooth normals of the Stanford Bunny (97,000 points of blue noise)
/// without noise and with up to ±0.1, ±0.25 and ±0.5 spacings of it along them, before means are taken (`noise.rs`): 0.68°, 1.7°, 3.7° and 7.1°. Through
/// 24 it is 1.17°, 1.4°, 2.3° and 4.0°, through 40 1.79°, 1.9°, 2.2° and 3.0°, which round off what is thinner; with cubic terms through 40 0.69°, 1.4°, 3.1°
/// and 6.0°; of a plane through 14 1.30°, 1.7°, 3.0° and 5.5°.
const FITTED: usize = 14;

/// Most rotations of all three pairs of axes. Each squares what is left off the diagonal: about 5 are needed.
const SWEEPS: usize = 8;

/// What is known of a point without a normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate {
    /// Unit normal.
    pub(crate) way: Vec3,
    /// Whether it stands on the outside of a closed surface.
    pub(crate) has_outside: bool,
}

/// The unit normal of every point as [`Cloud`](crate::Cloud) estimates it, in the caller's order.
///
/// Normals of one surface stand on one side of it: on the outside if it is closed, or bent enough to say. Those of a flat one face along
/// the positive axis that most of them are nearest to. Does not depend on the order of points.
///
/// # Errors
/// [`SurfelError::NoPoints`], [`SurfelError::TooManyPoints`], [`SurfelError::PointNotFinite`], [`SurfelError::PointTooFar`].
pub fn estimate_normals(positions: &[DVec3]) -> Result<Vec<Vec3>, SurfelError> {
    Points::new(positions).check()?;
    let lattice = Lattice::around(positions);
    let places: Vec<DVec3> = positions.iter().map(|p| (*p - lattice.low) / lattice.side).collect();
    Ok(estimate(&Places::new(&places)).into_iter().map(|of_point| of_point.way).collect())
}

/// The normal of every point, in the caller's order.
///
/// Points that coincide have the same normal. Where all neighbours lie on a line the normal is some direction across
/// it, and that of a lone place is +Z. Does not depend on the order of points.
pub(crate) fn estimate(places: &Places) -> Vec<Estimate> {
    let fits = parallel::map(places.len(), |place| Fit::of(places, place));
    let mut normals: Vec<DVec3> = fits.iter().map(|fit| fit.normal).collect();
    let around: Vec<Around> = fits.iter().map(|fit| fit.around).collect();
    let deviations2: Vec<f64> = fits.iter().map(|fit| fit.deviation2).collect();
    let areas: Vec<f64> = fits.into_iter().map(|fit| fit.area).collect();
    let orientation = Orientation::of(places, &normals, &around);
    let have_outside = outside::face_outwards(places, &mut normals, &areas, &orientation);
    // Last: means across fingers and fins have lost what tells their sides.
    let normals = noise::averaged(places, normals, &around, &noise::levels(&deviations2, &around));
    let mut estimates = vec![Estimate { way: Vec3::Z, has_outside: false }; places.point_count()];
    for (place, (normal, &has_outside)) in normals.iter().zip(&have_outside).enumerate() {
        let estimate = Estimate { way: normal.as_vec3(), has_outside };
        places.points(place).iter().for_each(|&i| estimates[i as usize] = estimate);
    }
    estimates
}

/// The surface about a place.
struct Fit {
    /// Its largest component is positive.
    normal: DVec3,
    /// Mean square of what places are off, in squares of the spacing; 0 where there are too few to say.
    deviation2: f64,
    /// The nearest neighbours.
    around: Around,
    /// About the area of the surface that the place stands for.
    area: f64,
}

impl Fit {
    fn of(places: &Places, place: usize) -> Self {
        let mut found = Vec::with_capacity(FITTED);
        places.nearest(place, FITTED, f64::INFINITY, &mut found);
        let farthest = found.last().map_or(0.0, |n| n.distance2.sqrt());
        // In parts of the farthest distance, so that no square of an offset is lost.
        let offset = |i: usize| (places.at(found[i].place) - places.at(place)) / farthest;
        let (normal, deviation2) = if farthest > 0.0 {
            let plane = towards_largest(least_variation(found.len(), offset));
            quadric::fitted((0..found.len()).map(offset), plane)
        } else {
            (DVec3::Z, 0.0)
        };
        // n neighbours lie on a disc of n areas: the mean of what four of them say, which is right for lattices as well as for random points.
        let says = |n: usize| found.get(n).map(|near| PI * near.distance2 / n as f64);
        let said = || (VOTERS / 2 + 1..=VOTERS).map_while(says);
        Self {
            normal,
            // They lie on a disc of as many squares of the spacing.
            deviation2: if found.len() == FITTED { deviation2 * FITTED as f64 / PI } else { 0.0 },
            around: std::array::from_fn(|i| found.get(i + 1).map_or(place as u32, |n| n.place as u32)),
            area: said().sum::<f64>() / said().count().max(1) as f64,
        }
    }
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
