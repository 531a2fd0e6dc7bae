//! Places where what is seen changes: doorways, corners, the rims of pillars.

use super::random;
use crate::delaunay::Partition;
use crate::field::spacing;
use crate::tree::{Extent, Tree};
use crate::{DistanceMap, ProbeError, parallel};
use glam::{DVec3, dvec3};

/// Neighbours whose sight of each other is compared, and the place itself.
const NEIGHBOURS: Extent = Extent { count: 41, rim: 1.0, most: 40, unseen: 1.0 };

/// How much of an opening each of the `positions` lies in, 0 to 1: the mean, over pairs of its neighbours, of how much it
/// sees both of them while they do not see each other. 0 in a convex room, most in a doorway.
///
/// # Errors
/// [`ProbeError::CountMismatch`] if there is not one map for each, and those of [`Field::new`](crate::Field::new) for
/// positions.
pub fn openings(positions: &[DVec3], distances: &[DistanceMap]) -> Result<Vec<f64>, ProbeError> {
    Ok(scored(positions, distances)?.into_iter().map(|s| s.0).collect())
}

/// Up to `count` further candidates in and about openings, at random, the more the more of an opening is there: none where
/// there is no opening. They may lie in solids.
///
/// # Errors
/// As [`openings`].
pub fn near_openings(
    positions: &[DVec3],
    distances: &[DistanceMap],
    count: usize,
    seed: u64,
) -> Result<Vec<DVec3>, ProbeError> {
    let scored = scored(positions, distances)?;
    let mut sum = 0.0;
    let sums: Vec<f64> = scored
        .iter()
        .map(|(score, _)| {
            sum += score;
            sum
        })
        .collect();
    if sum <= 0.0 {
        return Ok(vec![]);
    }
    let drawn = random(DVec3::ZERO, DVec3::ONE, 2 * count, seed);
    let place = |pair: &[DVec3]| {
        let index = sums.partition_point(|s| *s < pair[0].x * sum).min(positions.len() - 1);
        // Anywhere up to half of the way to the neighbours.
        positions[index] + (pair[1] - dvec3(0.5, 0.5, 0.5)) * scored[index].1
    };
    Ok(drawn.chunks_exact(2).map(place).collect())
}

/// The score of each position, and how far its neighbours are.
fn scored(positions: &[DVec3], distances: &[DistanceMap]) -> Result<Vec<(f64, f64)>, ProbeError> {
    if positions.len() != distances.len() {
        return Err(ProbeError::CountMismatch { probes: positions.len(), given: distances.len() });
    }
    let margin = spacing(positions, &Partition::up_to_rounding(positions)?);
    let tree = Tree::new(positions.iter().copied().zip(0..), margin);
    // Whether one sees another, from −1 to 1: half seen is what coarse maps say of positions along a wall, and counts as
    // neither. So does, for those that are said to see each other, what is not certain.
    let look = |a: u32, b: u32| distances[a as usize].seen(positions[b as usize] - positions[a as usize]);
    let sees = |a: u32, b: u32| 2.0 * look(a, b).into_iter().product::<f64>() - 1.0;
    let apart = |a: u32, b: u32| 1.0 - 2.0 * look(a, b)[0].max(look(b, a)[0]);
    let score = |i: usize| {
        let near = tree.nearest(positions[i], NEIGHBOURS, |_, _| 1.0);
        let around: Vec<(u32, f64)> =
            near.iter().filter(|f| f.probe != i as u32).map(|f| (f.probe, sees(i as u32, f.probe))).collect();
        let pairs = around.iter().enumerate().flat_map(|(k, a)| around[..k].iter().map(move |b| (a, b)));
        let (mut sum, mut count) = (0.0, 0.0);
        for (&(a, sees_a), &(b, sees_b)) in pairs {
            sum += sees_a.max(0.0) * sees_b.max(0.0) * apart(a, b).max(0.0);
            count += 1.0;
        }
        let reach = near.last().map_or(0.0, |f| f.distance);
        (if count > 0.0 { sum / count } else { 0.0 }, reach)
    };
    Ok(parallel::map_heavy(positions.len(), score))
}
