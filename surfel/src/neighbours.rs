//! Which points of a cloud are near, at any density, and which are in the same place.
//!
//! [`Rows`](crate::rows::Rows) is for searches of one reach; a cloud from a scanner may have a thousand points in the
//! reach of one of its sparse places. Here the places are split in halves again and again (a k-d tree: J. L. Bentley,
//! *Multidimensional binary search trees used for associative searching*, CACM 1975), so that a search for a number of
//! neighbours costs the same everywhere. Points that coincide are one place: no search depends on how many they are.

use glam::{DVec3, Vec3};
use pointillist_parallel as parallel;
use std::cmp::Ordering;

/// Places that are not split any further: from 6 to 16, the time of searches is the same to within what can be
/// measured.
const LEAF: usize = 8;

/// Halves with fewer places are not worth the cost of a thread.
const PARALLEL_LEAST: usize = 1 << 12;

/// How a range of places is split: the lower half comes first.
struct Split {
    axis: u8,
    /// How many splits of the lower half stand between this one and the first of the upper half.
    skip: u32,
    /// The lower half has nothing above, the upper half nothing below.
    at: f64,
}

/// The distinct places of a cloud.
///
/// Coordinates are those of the cloud times a power of two that brings the largest to about 1: exact, and squares and
/// products of distances neither overflow nor vanish. (Distances below 1e-150 of the largest coordinate do.)
pub(crate) struct Places {
    /// Our units per unit of the cloud.
    scale: f64,
    /// In the order of the splits.
    positions: Vec<DVec3>,
    splits: Vec<Split>,
    /// Where the points of each place begin in `points`, and the end.
    starts: Vec<u32>,
    /// Numbers of the points, place by place, ascending.
    points: Vec<u32>,
}

/// A place that a search found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    /// Square of the distance, our units.
    pub(crate) distance2: f64,
    pub(crate) place: usize,
}

/// A place while they are being sorted: where it is, and which of the sorted points are there.
type Item = (DVec3, std::ops::Range<u32>);

impl Places {
    /// The places of these finite positions, fewer than 2³² of them. None for none.
    pub(crate) fn new(positions: &[DVec3]) -> Self {
        debug_assert!(positions.iter().all(|p| p.is_finite()), "positions are checked at the door");
        let largest = positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let exponent = if largest > 0.0 { largest.log2().floor().clamp(-1000.0, 1000.0) as i32 } else { 0 };
        let scale = 2f64.powi(-exponent);
        // Adding zero makes -0 a 0: they are the same place.
        let mut sorted = parallel::map(positions.len(), |i| (positions[i] * scale + DVec3::ZERO, i as u32));
        parallel::sort_by(&mut sorted, |a, b| by_coordinates(a.0, b.0).then(a.1.cmp(&b.1)));
        let mut items: Vec<Item> = vec![];
        for (i, &(p, _)) in sorted.iter().enumerate() {
            match items.last_mut() {
                Some(last) if last.0 == p => last.1.end += 1,
                _ => items.push((p, i as u32..i as u32 + 1)),
            }
        }
        let splits = split(&mut items);
        let mut starts = Vec::with_capacity(items.len() + 1);
        let mut points = Vec::with_capacity(sorted.len());
        for (_, range) in &items {
            starts.push(points.len() as u32);
            points.extend(sorted[range.start as usize..range.end as usize].iter().map(|s| s.1));
        }
        starts.push(points.len() as u32);
        Self { scale, positions: items.into_iter().map(|item| item.0).collect(), splits, starts, points }
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.positions.len()
    }

    /// How many points there are in all of them.
    pub(crate) fn point_count(&self) -> usize {
        self.points.len()
    }

    /// Our units per unit of the cloud: a power of two.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Where a place is, our units.
    pub(crate) fn at(&self, place: usize) -> DVec3 {
        self.positions[place]
    }

    /// Numbers of the points in a place, ascending; at least one.
    pub(crate) fn points(&self, place: usize) -> &[u32] {
        &self.points[self.starts[place] as usize..self.starts[place + 1] as usize]
    }

    /// Puts into `found` the `count` places nearest to `place`, itself first, that are at most `reach` away; nearest
    /// first, of equally near ones the one with the smaller coordinates: whatever the order of points.
    pub(crate) fn nearest(&self, place: usize, count: usize, reach: f64, found: &mut Vec<Near>) {
        found.clear();
        let mut search =
            Search { places: self, from: self.positions[place], count, limit2: reach * reach, found };
        search.visit(&self.splits, 0..self.len(), DVec3::ZERO);
    }
}

fn by_coordinates(a: DVec3, b: DVec3) -> Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
}

/// Sorts the items by halves, each across the longest side of its box.
fn split(items: &mut [Item]) -> Vec<Split> {
    if items.len() <= LEAF {
        return vec![];
    }
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = items.iter().fold(none, |(low, high), i| (low.min(i.0), high.max(i.0)));
    let axis = (high - low).max_position();
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        a.0[axis].total_cmp(&b.0[axis]).then_with(|| by_coordinates(a.0, b.0))
    });
    let at = items[middle].0[axis];
    let worth_it = items.len() >= PARALLEL_LEAST;
    let (lower, upper) = items.split_at_mut(middle);
    let (lower, upper) = if worth_it {
        parallel::join(|| split(lower), || split(upper))
    } else {
        (split(lower), split(upper))
    };
    let mut splits = Vec::with_capacity(1 + lower.len() + upper.len());
    splits.push(Split { axis: axis as u8, skip: lower.len() as u32, at });
    splits.extend(lower);
    splits.extend(upper);
    splits
}

/// A search for the nearest places.
struct Search<'a> {
    places: &'a Places,
    from: DVec3,
    count: usize,
    /// Squared distance beyond which places are ignored: that of the reach or, once `count` places are found, of the
    /// last one.
    limit2: f64,
    found: &'a mut Vec<Near>,
}

impl Search<'_> {
    /// Searches a range of places whose box is at these distances along the axes.
    ///
    /// Rounding cannot make it miss a place: differences, squares and sums are made in the same order as for a place's
    /// distance, and each of them rounds a smaller number to no larger one.
    fn visit(&mut self, splits: &[Split], range: std::ops::Range<usize>, away: DVec3) {
        let Some((split, rest)) = splits.first().zip(splits.get(1..)).filter(|_| range.len() > LEAF) else {
            range.for_each(|place| self.look_at(place));
            return;
        };
        let middle = range.start + range.len() / 2;
        let axis = usize::from(split.axis);
        let beyond = self.from[axis] - split.at;
        let (lower, upper) = rest.split_at(split.skip as usize);
        let halves = [(lower, range.start..middle), (upper, middle..range.end)];
        let [near, far] = if beyond < 0.0 {
            halves
        } else {
            let [lower, upper] = halves;
            [upper, lower]
        };
        self.visit(near.0, near.1, away);
        let mut away = away;
        away[axis] = beyond;
        if away.length_squared() <= self.limit2 {
            self.visit(far.0, far.1, away);
        }
    }

    fn look_at(&mut self, place: usize) {
        let position = self.places.positions[place];
        let distance2 = (self.from - position).length_squared();
        if distance2 > self.limit2 {
            return;
        }
        let positions = &self.places.positions;
        let before = |n: &Near| {
            n.distance2 < distance2
                || n.distance2 == distance2 && by_coordinates(positions[n.place], position).is_lt()
        };
        let rank = self.found.iter().rposition(before).map_or(0, |last| last + 1);
        if self.found.len() == self.count {
            if rank == self.count {
                return;
            }
            self.found.pop();
        }
        self.found.insert(rank, Near { distance2, place });
        if self.found.len() == self.count {
            self.limit2 = self.found[self.count - 1].distance2;
        }
    }
}

/// Points of a place that face about the same way, as one: those whose normals are nearest to the same axis and, on
/// one-sided surfaces, the same end of it. A place has up to six sides, nearly always one.
pub(crate) struct Sides {
    /// Where the sides of each place begin, and the end.
    starts: Vec<u32>,
    /// Place of each side.
    pub(crate) places: Vec<u32>,
    /// Unit normal of each side, that of one of its points.
    pub(crate) normals: Vec<DVec3>,
    /// Side of each point, in the caller's order.
    pub(crate) of_points: Vec<u32>,
    /// Whether a normal and its opposite are equivalent.
    two_sided: bool,
}

impl Sides {
    /// Sorts the points of all places by their normals, one for each point.
    pub(crate) fn new(places: &Places, normals: &[Vec3], two_sided: bool) -> Self {
        let mut sides = Self {
            starts: vec![0],
            places: Vec::with_capacity(places.len()),
            normals: Vec::with_capacity(places.len()),
            of_points: vec![0; places.point_count()],
            two_sided,
        };
        for place in 0..places.len() {
            let facing = places.points(place).iter().map(|&i| facing(normals[i as usize], two_sided));
            // Of the points that count as one, the normal with the smallest coordinates: it must not depend on their
            // order.
            let mut first = [None; 6];
            for (class, normal) in facing.clone() {
                let old = first[class].get_or_insert(normal);
                if by_coordinates(normal, *old).is_lt() {
                    *old = normal;
                }
            }
            let mut numbers = [0; 6];
            for (class, normal) in first.iter().enumerate().filter_map(|(class, n)| n.map(|n| (class, n))) {
                numbers[class] = sides.normals.len() as u32;
                sides.normals.push(normal);
                sides.places.push(place as u32);
            }
            for (&i, (class, _)) in places.points(place).iter().zip(facing) {
                sides.of_points[i as usize] = numbers[class];
            }
            sides.starts.push(sides.normals.len() as u32);
        }
        sides
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.normals.len()
    }

    /// The sides of a place, each with its normal, turned to face like `normal` where the surface has no sides.
    pub(crate) fn seen_from(&self, normal: DVec3, place: usize) -> impl Iterator<Item = (usize, DVec3)> + '_ {
        let range = self.starts[place] as usize..self.starts[place + 1] as usize;
        range.map(move |side| {
            let other = self.normals[side];
            (side, if self.two_sided && other.dot(normal) < 0.0 { -other } else { other })
        })
    }
}

/// Which of six sides (three if they have no front) a normal shows, and the normal in full length.
fn facing(normal: Vec3, two_sided: bool) -> (usize, DVec3) {
    let normal = normal.as_dvec3().normalize_or(DVec3::Z);
    let axis = normal.abs().max_position();
    match (normal[axis] < 0.0, two_sided) {
        (false, _) => (axis, normal),
        (true, true) => (axis, -normal),
        (true, false) => (axis + 3, normal),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_finds_the_nearest_of_all() {
        let mut random = 7u64;
        let mut next = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 40) as f64 / f64::from(1 << 24)
        };
        for scale in [DVec3::ONE, DVec3::new(1.0, 30.0, 0.0), DVec3::ZERO, DVec3::splat(1e6)] {
            // Many of them equally far, and some of them twice.
            let steps = 8.0;
            let mut points: Vec<DVec3> =
                (0..400).map(|_| (DVec3::new(next(), next(), next()) * steps).floor() * scale).collect();
            points.extend((0..50).map(|_| DVec3::new(next(), next(), next()) * scale));
            let places = Places::new(&points);
            let at = |i: usize| places.at(i);
            let mut found = vec![];
            for place in 0..places.len() {
                for (count, reach) in [(5, f64::INFINITY), (17, f64::INFINITY), (40, 0.1)] {
                    places.nearest(place, count, reach, &mut found);
                    let distance2 = |i: usize| (at(place) - at(i)).length_squared();
                    let mut slow: Vec<usize> =
                        (0..places.len()).filter(|&i| distance2(i) <= reach * reach).collect();
                    slow.sort_by(|&a, &b| {
                        distance2(a).total_cmp(&distance2(b)).then_with(|| by_coordinates(at(a), at(b)))
                    });
                    slow.truncate(count);
                    assert_eq!(found.iter().map(|n| n.place).collect::<Vec<_>>(), slow);
                }
            }
        }
    }
}
