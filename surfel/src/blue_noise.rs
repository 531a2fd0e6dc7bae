//! Samples by elimination: random points, evenly by area, of which the most crowded are taken away.

use crate::mesh::Mesh;
use crate::{SurfacePoint, eliminate};
use glam::DVec3;
use pointillist_parallel as parallel;

/// Random points for each point that is asked for: \[2\], §4, finds that more than 5 gain little.
const OVERSAMPLING: usize = 5;

/// No point of a smooth surface is farther than this many [`lattice_spacing`]s from the nearest sample. Found by
/// experiment: corners of cubes are the worst, where points of other faces take the place
/// (`discs_of_blue_noise_leave_no_gap` in `tests/properties.rs`).
pub(crate) const COVER: f64 = 3.0;

/// Radius on a border, in the same unit: the surface reaches at most this far there.
pub(crate) const ON_BORDER: f64 = 2.0;

/// Area that a point has to itself in a hexagonal lattice of unit spacing: √3/2.
const HEXAGON: f64 = 0.866_025_403_784_438_6;

/// Spacing of the hexagonal lattice with this number of points on this area: `2·r_max` of \[2\], eq. 2.
pub(crate) fn lattice_spacing(area: f64, count: usize) -> f64 {
    (area / (HEXAGON * count as f64)).sqrt()
}

/// Points of the hexagonal lattice of this spacing on this area, at least 1.
pub(crate) fn count_for(area: f64, spacing: f64) -> f64 {
    (area / spacing / spacing / HEXAGON).round().max(1.0)
}

/// Exactly `count` samples in the order of their triangles. `done` is called with the share of the work that is done, 0
/// to 1.
pub(crate) fn points(mesh: &Mesh<'_>, count: usize, seed: u64, done: &dyn Fn(f64)) -> Vec<SurfacePoint> {
    let candidates = parallel::map(count * OVERSAMPLING, |i| candidate(mesh, i, count * OVERSAMPLING, seed));
    let kept = eliminate::kept(&candidates, count, lattice_spacing(mesh.area(), count), done);
    kept.into_iter().map(|i| candidates[i as usize]).collect()
}

/// Random point `i` of `count`. Each comes from its own slice of the area, which spreads them more evenly than chance;
/// it depends on nothing but its number and the seed.
fn candidate(mesh: &Mesh<'_>, i: usize, count: usize, seed: u64) -> SurfacePoint {
    let [slice, u, v] = [0, 1, 2].map(|dimension| unit(seed, 3 * i as u64 + dimension));
    let triangle = mesh.triangle_at((i as f64 + slice) / count as f64 * mesh.area());
    // The square root maps the unit square to the triangle uniformly by area.
    let u = u.sqrt();
    mesh.point(triangle, DVec3::new(1.0 - u, u * (1.0 - v), u * v))
}

/// Number `i` of a sequence in [0, 1). The seed is mixed first, so that sequences of neighbouring seeds do not overlap.
fn unit(seed: u64, i: u64) -> f64 {
    let bits = split_mix(split_mix(seed, 0), i);
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// Number `i` of the sequence SplitMix64 that begins at `start` (Steele, Lea, Flood 2014).
fn split_mix(start: u64, i: u64) -> u64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    let x = start.wrapping_add(i.wrapping_add(1).wrapping_mul(GOLDEN));
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_is_split_mix() {
        // The first numbers of its published test vector.
        let expected = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        assert_eq!([0, 1, 2].map(|i| split_mix(1_234_567, i)), expected);
    }

    #[test]
    fn a_lattice_of_as_many_points_has_the_spacing() {
        assert!((lattice_spacing(HEXAGON, 1) - 1.0).abs() < 1e-15);
        assert_eq!(count_for(HEXAGON * 49.0, 1.0), 49.0);
        assert_eq!(count_for(1.0, 1e9), 1.0);
    }
}
