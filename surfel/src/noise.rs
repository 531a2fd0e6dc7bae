//! Normals of noisy points.
//!
//! A paraboloid through few places follows their noise.
//!
//! 1. How far places are off their paraboloids is the noise of a neighbourhood, if it is as much everywhere in it: at an edge or a tight bend only
//!    some are, and the harmonic mean counts the others.
//! 2. Normals that differ by no more than noise explains are averaged with those around (T. R. Jones, F. Durand, M. Zwicker, *Normal improvement for
//!    point rendering*, IEEE CG&A 2004; C. Tomasi, R. Manduchi, *Bilateral filtering for gray and color images*, ICCV 1998), as a linear
//!    function of place, which on a bent surface they are.
//!
//! Where there is less noise than [`BENDS`] normals stay as they are, to the bit.

use crate::neighbours::Places;
use crate::orient::Around;
use glam::{DMat3, DVec3, dvec3};
use pointillist_parallel as parallel;

/// Deviations from paraboloids up to this, in spacings, are what surfaces leave that bend: 0.007 at half of the places of the Stanford Bunny
/// (97,000 points). Noise of up to ±0.1 spacings leaves 0.046.
const BENDS: f64 = 0.012;

/// How many times precisions are averaged with those around. Mean error of 97,000 points of the Stanford Dragon without noise: 2.85° as fitted,
/// 2.90° with 1, 2.88° with 2, 2.87° with 3.
const SPREADS: u32 = 3;

/// Normals farther apart than this, in rad for a deviation of one spacing, do not count, round by round. By noise alone, two of them are up to 0.9
/// apart (root mean square) before the first. Mean errors as at `FITTED`: 0.68°, 1.51°, 2.22° and 3.03°. Among 14 and with all rounds as the first
/// 0.68°, 1.7°, 2.4° and 3.1°. Of five paraboloids through 14 to 60 the one of least estimated error has 0.69°, 1.42°, 2.18° and 3.16°, in 8 times the
/// time. Means of all neighbours, as many rounds as give the least estimated error, have 0.68°, 1.50°, 2.28° and 3.21°, but 5.3° and not 4.4° on a cube
/// with ±0.5.
const REACHES: [f64; 3] = [3.0, 1.5, 0.75];

/// The square of a bend of normals over a neighbourhood that counts as much as the squares of all normals: where all places lie on a line, the bend
/// across it is 0.
const BEND_COST: f64 = 0.02;

/// The squared noise about each place, in squares of the spacing, from the squared deviations of `FITTED` places from their paraboloids.
pub(crate) fn levels(deviations2: &[f64], around: &[Around]) -> Vec<f64> {
    // Infinite where there is none.
    let precisions = deviations2.iter().map(|d| d.recip()).collect();
    let precisions = (0..SPREADS).fold(precisions, |values: Vec<f64>, _| means(&values, around));
    precisions.into_iter().map(|p| (p.recip() - BENDS * BENDS).max(0.0)).collect()
}

/// The mean of each place and those around.
fn means(values: &[f64], around: &[Around]) -> Vec<f64> {
    let mean = |i: usize| {
        let others: f64 = around[i].iter().map(|&j| values[j as usize]).sum();
        (values[i] + others) / (1 + around[i].len()) as f64
    };
    parallel::map(values.len(), mean)
}

/// Normals averaged as far as the squared noise about them allows, on the sides on which they were.
pub(crate) fn averaged(
    places: &Places,
    mut normals: Vec<DVec3>,
    around: &[Around],
    noise2: &[f64],
) -> Vec<DVec3> {
    for reach in REACHES {
        normals = parallel::map(places.len(), |i| match noise2[i] * reach * reach {
            0.0 => normals[i],
            reach2 => average(places, &normals, i, &around[i], reach2),
        });
    }
    normals
}

/// The linear function of place that fits the normals about this one, there.
fn average(places: &Places, normals: &[DVec3], place: usize, around: &Around, reach2: f64) -> DVec3 {
    let own = normals[place];
    let (right, up) = own.any_orthonormal_pair();
    let offset = |i: usize| places.at(i) - places.at(place);
    let farthest = around.last().map_or(0.0, |&i| offset(i as usize).length());
    let (mut squares, mut products) = (DMat3::ZERO, DMat3::ZERO);
    for i in std::iter::once(place).chain(around.iter().map(|&i| i as usize)) {
        let other = normals[i];
        let weight = (1.0 - other.distance_squared(own) / reach2).max(0.0).powi(2);
        let terms = dvec3(1.0, offset(i).dot(right) / farthest, offset(i).dot(up) / farthest);
        squares += outer(terms * weight, terms);
        products += outer(other * weight, terms);
    }
    squares.y_axis.y += BEND_COST * squares.x_axis.x;
    squares.z_axis.z += BEND_COST * squares.x_axis.x;
    // The first column of the inverse but for its length: what is fitted at offset 0.
    (products * squares.y_axis.cross(squares.z_axis)).normalize_or(own)
}

/// a bᵀ.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orient::VOTERS;

    /// A row of places, the number of each in the row, and those around each.
    fn row() -> (Places, Vec<usize>, Vec<Around>) {
        let positions: Vec<DVec3> = (0..60).map(|i| DVec3::X * f64::from(i)).collect();
        let places = Places::new(&positions);
        let mut found = vec![];
        let mut near = |place| {
            places.nearest(place, VOTERS + 1, f64::INFINITY, &mut found);
            std::array::from_fn(|k| found[k + 1].place as u32)
        };
        let around = (0..60).map(&mut near).collect();
        let numbers = (0..60).map(|place| places.points(place)[0] as usize).collect();
        (places, numbers, around)
    }

    #[test]
    fn an_edge_is_no_noise() {
        let (_, numbers, around) = row();
        let at_edge = |i: &usize| if (28..32).contains(i) { 0.04 } else { 0.0 };
        let deviations2: Vec<f64> = numbers.iter().map(at_edge).collect();
        assert_eq!(levels(&deviations2, &around), [0.0; 60]);
        let everywhere = levels(&[0.04; 60], &around);
        assert!(everywhere.iter().all(|level| (level - 0.04 + BENDS * BENDS).abs() < 1e-12));
    }

    #[test]
    fn only_what_noise_explains_is_averaged() {
        let (places, numbers, around) = row();
        let bent: Vec<DVec3> = numbers.iter().map(|&i| if i < 30 { DVec3::Y } else { DVec3::Z }).collect();
        let mean = averaged(&places, bent.clone(), &around, &[0.01; 60]);
        assert!(mean.iter().zip(&bent).all(|(a, b)| a.distance(*b) < 1e-12));
        let slope = |i: &usize| dvec3(0.0, 0.01 * (i % 3) as f64, 1.0).normalize();
        let uneven: Vec<DVec3> = numbers.iter().map(slope).collect();
        assert_eq!(averaged(&places, uneven.clone(), &around, &[0.0; 60]), uneven);
        let mean = averaged(&places, uneven, &around, &[0.01; 60]);
        let inside = mean.iter().zip(&numbers).filter(|(_, i)| (12..48).contains(*i));
        assert!(inside.clone().count() == 36 && inside.clone().all(|(n, _)| (n.y - 0.01).abs() < 1e-3));
    }
}
