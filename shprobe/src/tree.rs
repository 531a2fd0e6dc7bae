//! The probes nearest to a position, in a metric that makes some of them farther than they are.

use glam::DVec3;

/// Probes in a k-d tree: sorted along alternating axes, the middle one first.
///
/// The tree is implicit: the root of a range is its middle, what is before it lies below along the axis, what is after
/// it above.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    /// Position and number of each probe.
    nodes: Vec<(DVec3, u32)>,
    /// The axis that each node divides along.
    axes: Vec<u8>,
    /// The box of all, with a margin.
    low: DVec3,
    high: DVec3,
}

/// A probe that was found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    /// Its effective distance: [`Extent::effective`].
    pub(crate) distance: f64,
    /// How much it sees of the position, 0 to 1.
    pub(crate) seen: f64,
    /// From the position to the probe.
    pub(crate) offset: DVec3,
    pub(crate) probe: u32,
}

/// What is found: all within the [`Extent::limit`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) count: usize,
    pub(crate) rim: f64,
    pub(crate) most: usize,
    /// What the distance of a probe that sees nothing of the position is divided by: above 0, at most 1.
    pub(crate) unseen: f64,
}

impl Extent {
    /// The distance of a probe that is farther the less it sees of the position.
    pub(crate) fn effective(&self, distance: f64, seen: f64) -> f64 {
        distance / (self.unseen + (1.0 - self.unseen) * seen)
    }

    /// The effective distance up to which probes are found: `rim` times that of the `count`-th, but not more than that of
    /// the one after `most`. Infinite if there are fewer than `count` in this list, by rising distance.
    pub(crate) fn limit(&self, found: &[Found]) -> f64 {
        let at = |rank: usize| found.get(rank).map_or(f64::INFINITY, |f| f.distance);
        (self.rim * at(self.count - 1)).min(at(self.most))
    }
}

impl Tree {
    /// Of probes at the same position the first counts. Positions are clamped to the box of all with this `margin` before
    /// distances are taken: far away all would be equally far.
    pub(crate) fn new(positions: impl Iterator<Item = (DVec3, u32)>, margin: f64) -> Self {
        // Adding 0 turns −0 into 0.
        let mut nodes: Vec<_> = positions.map(|(p, i)| (p + 0.0, i)).collect();
        let order = |a: &(DVec3, u32), b: &(DVec3, u32)| {
            let [x, y, z] = [0, 1, 2].map(|k| a.0[k].total_cmp(&b.0[k]));
            x.then(y).then(z).then(a.1.cmp(&b.1))
        };
        nodes.sort_unstable_by(order);
        nodes.dedup_by(|later, first| later.0 == first.0);
        let mut axes = vec![0; nodes.len()];
        divide(&mut nodes, &mut axes);
        let (low, high) = box_of(&nodes);
        Self { nodes, axes, low: low - margin, high: high + margin }
    }

    /// Probes by rising effective distance, those of equal distance by their number. `seen` is 0 to 1: no probe is nearer
    /// than it is, so that a part of the tree that is too far as it is need not be asked. An empty tree has none.
    pub(crate) fn nearest(&self, p: DVec3, extent: Extent, seen: impl Fn(u32, DVec3) -> f64) -> Vec<Found> {
        if self.nodes.is_empty() {
            return vec![];
        }
        let p = p.clamp(self.low, self.high);
        let found = Vec::with_capacity(extent.most + 2);
        let mut search = Search { p, extent, seen, found, limit: f64::INFINITY };
        self.visit(&mut search, 0, self.nodes.len(), DVec3::ZERO);
        search.found
    }

    /// `beyond` leads from `p` to the box of a range, as far as the planes above it tell.
    fn visit<F: Fn(u32, DVec3) -> f64>(
        &self,
        search: &mut Search<F>,
        low: usize,
        high: usize,
        beyond: DVec3,
    ) {
        if low >= high || beyond.length() > search.limit {
            return;
        }
        let middle = low + (high - low) / 2;
        let (position, probe) = self.nodes[middle];
        search.consider(position, probe);
        let axis = usize::from(self.axes[middle]);
        let offset = search.p[axis] - position[axis];
        let mut other = beyond;
        other[axis] = if offset.abs() > beyond[axis].abs() { offset } else { beyond[axis] };
        let (near, far) = if offset < 0.0 {
            ((low, middle), (middle + 1, high))
        } else {
            ((middle + 1, high), (low, middle))
        };
        self.visit(search, near.0, near.1, beyond);
        self.visit(search, far.0, far.1, other);
    }
}

struct Search<F> {
    p: DVec3,
    extent: Extent,
    seen: F,
    /// By rising distance.
    found: Vec<Found>,
    /// Nothing farther than this is wanted.
    limit: f64,
}

impl<F: Fn(u32, DVec3) -> f64> Search<F> {
    fn consider(&mut self, position: DVec3, probe: u32) {
        let offset = position - self.p;
        let plain = offset.length();
        if plain > self.limit {
            return;
        }
        let seen = (self.seen)(probe, position);
        let distance = self.extent.effective(plain, seen);
        if distance > self.limit {
            return;
        }
        let before = |f: &Found| f.distance < distance || f.distance == distance && f.probe < probe;
        let at = self.found.partition_point(before);
        self.found.insert(at, Found { distance, seen, offset, probe });
        self.limit = self.extent.limit(&self.found);
        while self.found.last().is_some_and(|f| f.distance > self.limit) {
            self.found.pop();
        }
        self.found.truncate(self.extent.most + 1);
    }
}

/// Sorts so that the middle of every range divides it along the longest axis of its box.
fn divide(nodes: &mut [(DVec3, u32)], axes: &mut [u8]) {
    if nodes.len() < 2 {
        return;
    }
    let (low, high) = box_of(nodes);
    let axis = (high - low).max_position();
    let middle = nodes.len() / 2;
    nodes.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    axes[middle] = axis as u8;
    let (first, rest) = nodes.split_at_mut(middle);
    let (first_axes, rest_axes) = axes.split_at_mut(middle);
    divide(first, first_axes);
    divide(&mut rest[1..], &mut rest_axes[1..]);
}

fn box_of(nodes: &[(DVec3, u32)]) -> (DVec3, DVec3) {
    let infinite = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    nodes.iter().fold(infinite, |(l, h), (p, _)| (l.min(*p), h.max(*p)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place;

    #[test]
    fn what_is_found_is_what_a_search_of_all_finds() {
        let positions = place::random(DVec3::ZERO, DVec3::ONE, 300, 3);
        let tree = Tree::new(positions.iter().copied().zip(0..), 1.0);
        let extent = Extent { count: 6, rim: 1.3, most: 20, unseen: 0.1 };
        // Every third probe is ten times as far.
        let seen = |probe: u32| if probe.is_multiple_of(3) { 0.0 } else { 1.0 };
        let factor = |probe: u32| 0.1 + 0.9 * seen(probe);
        for p in place::random(DVec3::splat(-0.5), DVec3::splat(1.5), 200, 4) {
            let mut all: Vec<(f64, u32)> =
                (0..300).map(|i| ((positions[i as usize] - p).length() / factor(i), i)).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            let rim = (1.3 * all[5].0).min(all[20].0);
            let wanted: Vec<u32> = all.iter().filter(|a| a.0 <= rim).map(|a| a.1).collect();
            let found: Vec<u32> = tree.nearest(p, extent, |i, _| seen(i)).iter().map(|f| f.probe).collect();
            assert_eq!(found, wanted, "at {p}");
        }
    }
}
