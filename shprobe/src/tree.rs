//! The probes nearest to a position, in a metric that makes some of them farther than they are.

use crate::parallel;
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
    /// What is near each part of the box; none without [`Tree::with_lists`].
    lists: Lists,
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
        Self { nodes, axes, low: low - margin, high: high + margin, lists: Lists::default() }
    }

    /// Probes by rising effective distance, those of equal distance by their number. `seen` is 0 to 1: no probe is nearer
    /// than it is, so that a part of the tree that is too far as it is need not be asked. An empty tree has none.
    pub(crate) fn nearest(&self, p: DVec3, extent: Extent, seen: impl Fn(u32, DVec3) -> f64) -> Vec<Found> {
        if self.nodes.is_empty() {
            return vec![];
        }
        let p = p.clamp(self.low, self.high);
        let mut search = Search::new(p, extent, seen);
        if !self.nearest_of_list(&mut search) {
            search = Search::new(p, extent, search.seen);
            self.visit(&mut search, 0, self.nodes.len(), DVec3::ZERO);
        }
        search.finish()
    }

    /// Makes lists of what is near, for many searches: most find all in one list, the nearest first.
    pub(crate) fn with_lists(mut self) -> Self {
        let mut parts = vec![];
        self.parts(0, self.nodes.len(), (self.low, self.high), &mut parts);
        let lists = parallel::map(parts.len(), |i| {
            let (_, low, high) = parts[i];
            let mut near = Near { low, high, list: Vec::with_capacity(LIST + 2) };
            self.list(&mut near, 0, self.nodes.len(), (self.low, self.high));
            near.list
        });
        let mut made = Lists { of_range: vec![0; self.nodes.len() + 1], ..Lists::default() };
        for (list, (range, ..)) in lists.into_iter().zip(parts) {
            made.of_range[range] = made.parts.len() as u32;
            let start = made.all.len();
            let beyond = list.get(LIST).map_or(f32::INFINITY, |l| l.least);
            made.all.extend(list.into_iter().take(LIST));
            made.parts.push(Part { start, end: made.all.len(), beyond });
        }
        self.lists = made;
        self
    }

    /// The parts of the box that are not divided any further: where their range of nodes starts, and their corners.
    fn parts(&self, low: usize, high: usize, space: (DVec3, DVec3), parts: &mut Vec<(usize, DVec3, DVec3)>) {
        if high - low <= LEAF {
            parts.push((low, space.0, space.1));
            return;
        }
        let (middle, below, above) = self.halves(low, high, space);
        self.parts(low, middle, below, parts);
        self.parts(middle + 1, high, above, parts);
    }

    /// The node that divides a range, and the space below and above it.
    fn halves(&self, low: usize, high: usize, space: (DVec3, DVec3)) -> (usize, Space, Space) {
        let middle = low + (high - low) / 2;
        let axis = usize::from(self.axes[middle]);
        let (mut below, mut above) = (space, space);
        below.1[axis] = self.nodes[middle].0[axis];
        above.0[axis] = self.nodes[middle].0[axis];
        (middle, below, above)
    }

    /// Lists what is nearest to a part of the box.
    fn list(&self, near: &mut Near, low: usize, high: usize, space: Space) {
        if low >= high || near.distance(space) > near.limit() {
            return;
        }
        let (middle, below, above) = self.halves(low, high, space);
        near.consider(self.nodes[middle].0, middle as u32);
        let mut halves = [(low, middle, below), (middle + 1, high, above)];
        if near.distance(above) < near.distance(below) {
            halves.reverse();
        }
        halves.into_iter().for_each(|(low, high, space)| self.list(near, low, high, space));
    }

    /// Searches the list of the part that the position is in. Whether that was enough.
    fn nearest_of_list<F: Fn(u32, DVec3) -> f64>(&self, search: &mut Search<F>) -> bool {
        if self.lists.parts.is_empty() {
            return false;
        }
        let (mut low, mut high) = (0, self.nodes.len());
        while high - low > LEAF {
            let middle = low + (high - low) / 2;
            let axis = usize::from(self.axes[middle]);
            if search.p[axis] < self.nodes[middle].0[axis] {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        let part = self.lists.parts[self.lists.of_range[low] as usize];
        let list = &self.lists.all[part.start..part.end];
        // What is within the rim as if all were seen is asked in any case; what is left, up to the rim that results.
        let mut sure = Smallest::new(search.extent.count);
        let mut within2 = f64::INFINITY;
        let mut distances2 = [0.0; LIST];
        let mut close = 0;
        for listed in list {
            if f64::from(listed.least).powi(2) > within2 {
                break;
            }
            let distance2 = (self.nodes[listed.node as usize].0 - search.p).length_squared();
            distances2[close] = distance2;
            close += 1;
            if distance2 < sure.last() {
                sure.add(distance2);
                within2 = search.extent.rim * search.extent.rim * sure.last();
            }
        }
        let (near, far) = list.split_at(close);
        for is_sure in [true, false] {
            for (listed, d) in near.iter().zip(distances2).filter(|(_, d)| (*d <= within2) == is_sure) {
                if d <= search.limit * search.limit {
                    search.consider(&self.nodes[listed.node as usize]);
                }
            }
        }
        for listed in far {
            if f64::from(listed.least) > search.limit {
                return true;
            }
            search.consider(&self.nodes[listed.node as usize]);
        }
        f64::from(part.beyond) > search.limit
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
        let position = self.nodes[middle].0;
        search.consider(&self.nodes[middle]);
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

type Space = (DVec3, DVec3);

/// Nodes in a part of the box that is not divided any further.
const LEAF: usize = 1;

/// Most probes in a list. Where more are within reach, all are searched.
const LIST: usize = 128;

/// For the rounding of distances between boxes and positions: what is listed as so far is not nearer.
const ROUNDING: f64 = 1.0 - 1e-6;

/// The largest `f32` that is not above a distance.
fn at_most(distance: f64) -> f32 {
    // Beyond its range it rounds to infinity, and below the least of full precision up by as much as half.
    let rounded = distance as f32;
    if f64::from(rounded) > distance { rounded.next_down() } else { rounded }
}

/// For each part of the box the nearest probes.
#[derive(Clone, Debug, Default)]
struct Lists {
    /// The part whose range of nodes starts at a node.
    of_range: Vec<u32>,
    parts: Vec<Part>,
    all: Vec<Listed>,
}

#[derive(Clone, Copy, Debug)]
struct Part {
    start: usize,
    end: usize,
    /// How far at least what is not listed is.
    beyond: f32,
}

#[derive(Clone, Copy, Debug)]
struct Listed {
    node: u32,
    /// How far it is at least from any position in the part.
    least: f32,
}

/// The probes nearest to a box, by rising distance.
struct Near {
    low: DVec3,
    high: DVec3,
    list: Vec<Listed>,
}

impl Near {
    fn distance(&self, space: Space) -> f32 {
        at_most((space.0 - self.high).max(self.low - space.1).max(DVec3::ZERO).length() * ROUNDING)
    }

    fn limit(&self) -> f32 {
        self.list.get(LIST).map_or(f32::INFINITY, |l| l.least)
    }

    fn consider(&mut self, position: DVec3, node: u32) {
        let least = self.distance((position, position));
        if least <= self.limit() {
            let at = self.list.partition_point(|l| (l.least, l.node) < (least, node));
            self.list.insert(at, Listed { node, least });
            self.list.truncate(LIST + 1);
        }
    }
}

/// The smallest of some numbers, by size.
struct Smallest {
    values: [f64; MOST_COUNT],
    count: usize,
}

/// Most that [`Extent::count`] may be.
const MOST_COUNT: usize = 72;

impl Smallest {
    fn new(count: usize) -> Self {
        Self { values: [f64::INFINITY; MOST_COUNT], count: count.min(MOST_COUNT) }
    }

    fn add(&mut self, value: f64) {
        let mut at = self.count;
        while at > 0 && value < self.values[at - 1] {
            if at < self.count {
                self.values[at] = self.values[at - 1];
            }
            at -= 1;
        }
        if at < self.count {
            self.values[at] = value;
        }
    }

    /// The largest of them; infinite if there are too few.
    fn last(&self) -> f64 {
        self.values[self.count - 1]
    }
}

struct Search<F> {
    p: DVec3,
    extent: Extent,
    seen: F,
    /// In no order.
    found: Vec<Found>,
    /// The smallest effective distances.
    nearest: Smallest,
    /// Nothing farther than this is wanted.
    limit: f64,
}

impl<F: Fn(u32, DVec3) -> f64> Search<F> {
    fn new(p: DVec3, extent: Extent, seen: F) -> Self {
        let found = Vec::with_capacity(extent.most + 2);
        Self { p, extent, seen, found, nearest: Smallest::new(extent.count), limit: f64::INFINITY }
    }

    fn consider(&mut self, &(position, probe): &(DVec3, u32)) {
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
        self.nearest.add(distance);
        self.limit = self.extent.rim * self.nearest.last();
        self.found.push(Found { distance, seen, offset, probe });
    }

    /// What is within the limit, by rising distance.
    fn finish(mut self) -> Vec<Found> {
        self.found.retain(|f| f.distance <= self.limit);
        self.found.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.probe.cmp(&b.probe)));
        let limit = self.extent.limit(&self.found);
        self.found.truncate(self.extent.most + 1);
        self.found.retain(|f| f.distance <= limit);
        self.found
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
        // Lists hold distances in single precision: beyond its range, and where it has few digits.
        for scale in [1.0, 2.0_f64.powi(130), 2.0_f64.powi(-146)] {
            lists_are_complete(scale);
        }
    }

    fn lists_are_complete(scale: f64) {
        let random = |low: f64, high: f64, count: usize, seed: u64| -> Vec<DVec3> {
            let places = place::random(DVec3::splat(low), DVec3::splat(high), count, seed);
            places.into_iter().map(|p| p * scale).collect()
        };
        let positions = random(0.0, 1.0, 300, 3);
        let bare = Tree::new(positions.iter().copied().zip(0..), scale);
        let listed = bare.clone().with_lists();
        let extent = Extent { count: 6, rim: 1.3, most: 20, unseen: 0.1 };
        // Every third probe is ten times as far.
        let seen = |probe: u32| if probe.is_multiple_of(3) { 0.0 } else { 1.0 };
        let factor = |probe: u32| 0.1 + 0.9 * seen(probe);
        for p in random(-0.5, 1.5, 200, 4) {
            let mut all: Vec<(f64, u32)> =
                (0..300).map(|i| ((positions[i as usize] - p).length() / factor(i), i)).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            let rim = (1.3 * all[5].0).min(all[20].0);
            let wanted: Vec<u32> = all.iter().filter(|a| a.0 <= rim).map(|a| a.1).collect();
            for tree in [&bare, &listed] {
                let found = tree.nearest(p, extent, |i, _| seen(i));
                let found: Vec<u32> = found.iter().map(|f| f.probe).collect();
                assert_eq!(found, wanted, "at {p}, scaled by {scale:e}");
            }
        }
    }
}
