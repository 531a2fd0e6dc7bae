//! Places along Hilbert's curve through a cube, and the order in which vertices are inserted.
//!
//! Points near each other on the curve are near in space, so that each is found in a few steps from the one before. The
//! order along a curve alone has bad worst cases, so vertices are inserted in rounds, each a random choice about as
//! large as all before it several times over (Amenta, Choi and Rote's biased randomised insertion order), and along the
//! curve within a round.

use super::scale::Scale;
use crate::parallel;
use glam::DVec3;

/// Levels of the curve: with three bits each and the round above them, a key fills 64 bits.
const LEVELS: u32 = 19;
const ROUND_SHIFT: u32 = 3 * LEVELS;

/// A round has about 2 to this power times the points of all before it.
const ROUND_BITS: u32 = 3;
const LAST_ROUND: u32 = 6;

/// Up to this many points in one cell of the curve are not sorted further.
const CROWD: usize = 16;

const fn rotate_left(w: usize, by: usize) -> usize {
    (w << by | w >> (3 - by)) & 7
}

const fn rotate_right(w: usize, by: usize) -> usize {
    rotate_left(w, (3 - by) % 3)
}

/// One level of the curve, by state (the corner where it enters the cube, and its main axis) and octant: three bits of
/// the place, and eight times the state in the octant. After Hamilton's *Compact Hilbert indices* (2006), §2.
const STEPS: [u16; 8 * 24] = {
    let mut steps = [0; 8 * 24];
    let mut state = 0;
    while state < 24 {
        let (entry, axis) = (state / 3, state % 3);
        let mut octant = 0;
        while octant < 8 {
            let gray = rotate_right(octant ^ entry, (axis + 1) % 3);
            let w = gray ^ gray >> 1 ^ gray >> 2;
            let sub_entry = if w == 0 { 0 } else { ((w - 1) & !1) ^ ((w - 1) >> 1) };
            let turn = match w {
                0 => 0,
                _ if w & 1 == 0 => (w - 1).trailing_ones() as usize,
                _ => w.trailing_ones() as usize,
            };
            let next_entry = entry ^ rotate_left(sub_entry, (axis + 1) % 3);
            let next_axis = (axis + turn + 1) % 3;
            steps[state * 8 + octant] = (((next_entry * 3 + next_axis) * 8) << 3 | w) as u16;
            octant += 1;
        }
        state += 1;
    }
    steps
};

/// Place on the curve through a cube of 2^19 cells a side.
fn hilbert_index([x, y, z]: [u32; 3]) -> u64 {
    let (mut state, mut place) = (0, 0);
    for level in (0..LEVELS).rev() {
        let bit = |v: u32| (v >> level & 1) as usize;
        let step = STEPS[state + (bit(x) | bit(y) << 1 | bit(z) << 2)];
        place = place << 3 | u64::from(step & 7);
        state = usize::from(step >> 3);
    }
    place
}

/// Places of points in the cube that holds them all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve {
    scale: Scale,
    lo: DVec3,
    cells_per_length: f64,
}

impl Curve {
    /// Through these points.
    pub(super) fn new(points: impl Iterator<Item = DVec3> + Clone) -> Self {
        let scale = Scale::new(points.clone());
        let (lo, hi) = points
            .map(|p| scale.apply(p))
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let side = (hi - lo).max_element();
        let cells_per_length = if side > 0.0 { f64::from((1 << LEVELS) - 1) / side } else { 0.0 };
        Self { scale, lo, cells_per_length }
    }

    /// Where on the curve a point lies; many may share a place.
    #[inline]
    pub(super) fn index(&self, p: DVec3) -> u64 {
        let cell = (self.scale.apply(p) - self.lo) * self.cells_per_length;
        hilbert_index([cell.x as u32, cell.y as u32, cell.z as u32])
    }
}

/// Mixes the bits of an index (SplitMix64's last steps).
fn scrambled(index: u32) -> u64 {
    let mut z = u64::from(index).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

/// The indices in the order in which to insert them.
pub(super) fn insertion_order(points: &[DVec3], indices: &[u32]) -> Vec<u32> {
    let curve = Curve::new(indices.iter().map(|&i| points[i as usize]));
    let mut keyed = parallel::map(indices.len(), |k| {
        let i = indices[k];
        let early = (scrambled(i).trailing_zeros() / ROUND_BITS).min(LAST_ROUND);
        (u64::from(LAST_ROUND - early) << ROUND_SHIFT | curve.index(points[i as usize]), i)
    });
    parallel::sort_by(&mut keyed, |a, b| a.cmp(b));
    sort_crowded(points, &mut keyed);
    keyed.into_iter().map(|(_, i)| i).collect()
}

/// Sorts points that share a place along a curve through the cube of their own, and so on: clusters may be far smaller
/// than a cell of the curve through all.
fn sort_crowded(points: &[DVec3], keyed: &mut [(u64, u32)]) {
    let mut unsorted = vec![(0, keyed.len())];
    while let Some((mut start, end)) = unsorted.pop() {
        for run in keyed[start..end].chunk_by_mut(|a, b| a.0 == b.0) {
            let end = start + run.len();
            if run.len() > CROWD {
                let curve = Curve::new(run.iter().map(|(_, i)| points[*i as usize]));
                run.iter_mut().for_each(|(place, i)| *place = curve.index(points[*i as usize]));
                run.sort_unstable();
                // Unless all are in one place.
                if run[0].0 != run[run.len() - 1].0 {
                    unsorted.push((start, end));
                }
            }
            start = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_from_each_cell_to_one_beside_it() {
        let side = 8;
        let shift = LEVELS - 3;
        let all = (0..side).flat_map(|x| (0..side).flat_map(move |y| (0..side).map(move |z| [x, y, z])));
        let mut cells: Vec<[u32; 3]> = all.collect();
        cells.sort_by_key(|c| hilbert_index(c.map(|v| v << shift)));
        for pair in cells.windows(2) {
            let apart: u32 = (0..3).map(|k| pair[0][k].abs_diff(pair[1][k])).sum();
            assert_eq!(apart, 1, "{pair:?}");
        }
    }
}
