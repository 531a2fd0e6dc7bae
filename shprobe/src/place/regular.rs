//! Placement by geometry alone: grids, random positions, and spread subsets.

use glam::{DVec3, dvec3};

/// Distance of a grid's outer probes from the box, over the spacing of a grid that fills it: probes should not lie in
/// walls.
const INSET: f64 = 0.1;

/// `nx · ny · nz` probes evenly in a box, x fastest; the outer ones a tenth of a cell inside of it. One along an axis
/// lies in the middle.
///
/// # Panics
/// If there are more than `usize` can count, or than memory holds.
#[must_use]
pub fn grid(low: DVec3, high: DVec3, [nx, ny, nz]: [usize; 3]) -> Vec<DVec3> {
    let at = |i: usize, n: usize, axis: usize| {
        let inset = INSET * (high[axis] - low[axis]) / n as f64;
        let t = if n > 1 { i as f64 / (n - 1) as f64 } else { 0.5 };
        (low[axis] + inset) * (1.0 - t) + (high[axis] - inset) * t
    };
    let count = nx
        .checked_mul(ny)
        .and_then(|n| n.checked_mul(nz))
        .expect("a grid has as many probes as can be counted");
    let mut probes = Vec::with_capacity(count);
    for z in 0..nz {
        for y in 0..ny {
            probes.extend((0..nx).map(|x| dvec3(at(x, nx, 0), at(y, ny, 1), at(z, nz, 2))));
        }
    }
    probes
}

/// `count` positions at random, uniformly distributed in a box.
#[must_use]
pub fn random(low: DVec3, high: DVec3, count: usize, seed: u64) -> Vec<DVec3> {
    let mut state = seed;
    let mut unit = || {
        // SplitMix64 (Steele et al. 2014): any seed gives a good sequence.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * 2.0_f64.powi(-53)
    };
    let mut place = || low + (high - low) * dvec3(unit(), unit(), unit());
    (0..count).map(|_| place()).collect()
}

/// Up to `count` of the candidates, each as far as possible from those before it (Gonzalez 1985); the first is the one
/// nearest to the middle. Of equal candidates one is taken, and candidates that are not finite are never taken.
#[must_use]
pub fn spread(candidates: &[DVec3], count: usize) -> Vec<usize> {
    let finite = || candidates.iter().copied().filter(|p| p.is_finite());
    let middle = finite().sum::<DVec3>() / finite().count().max(1) as f64;
    let nearest = |a: &usize, b: &usize| {
        candidates[*a].distance_squared(middle).total_cmp(&candidates[*b].distance_squared(middle))
    };
    // A distance of 0 is never chosen.
    let start = |p: &DVec3| if p.is_finite() { f64::INFINITY } else { 0.0 };
    let mut dist2: Vec<f64> = candidates.iter().map(start).collect();
    let mut chosen = vec![];
    let mut next = (0..candidates.len()).filter(|&i| candidates[i].is_finite()).min_by(nearest);
    while let Some(new) = next.filter(|&n| chosen.len() < count && dist2[n] > 0.0) {
        chosen.push(new);
        for (d, p) in dist2.iter_mut().zip(candidates) {
            *d = d.min(p.distance_squared(candidates[new]));
        }
        // The first of the farthest, so that the result does not depend on how ties are broken.
        next = (0..candidates.len()).reduce(|a, b| if dist2[b] > dist2[a] { b } else { a });
    }
    chosen
}
