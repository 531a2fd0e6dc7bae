//! Averages over neighbouring places where light comes from far away: their rays count for one another (\[8\]'s test for interpolation).
//! Places behind a wall and places in front of it are no neighbours, however close they are: a surface that reaches into a wall has both.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::gather::Gathered;
use crate::rgb::{Rgb, add};
use pointillist_parallel as parallel;

/// How much the split-sphere model may say that irradiance differs between places that are averaged.
const APART: f64 = 0.15;
/// Weight of normals in that model.
const TURN: f64 = 1.5;
/// Neighbours of a place, itself included, at most.
const MOST: usize = 64;
/// Places in a cell of the tree.
const LEAF: usize = 8;

/// Places by position, halved along the longest axis.
pub(crate) struct Places<'p> {
    positions: &'p [DVec3],
    /// Different above 0 for places at one position between which something stands.
    sides: &'p [u64],
    order: Vec<u32>,
    cells: Vec<(DVec3, DVec3)>,
}

impl<'p> Places<'p> {
    pub(crate) fn new(positions: &'p [DVec3], sides: &'p [u64]) -> Self {
        let order = (0..positions.len() as u32).collect();
        let mut places = Self { positions, sides, order, cells: vec![] };
        let depth = (positions.len() / LEAF).max(1).next_power_of_two();
        places.cells = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); 2 * depth];
        places.build(1, 0, positions.len());
        places
    }

    /// Irradiance of some places, each its own and that of its neighbours, and its standard error.
    pub(crate) fn smooth(
        &self,
        normals: &[DVec3],
        gathered: &[Gathered],
        which: &[usize],
    ) -> Vec<(Rgb, f64)> {
        let room = || BinaryHeap::with_capacity(MOST);
        parallel::map_with(which.len(), room, |near, k| {
            let i = which[k];
            let (at, reach) = (self.positions[i], gathered[i].reach());
            let (mut sum, mut weights, mut errors) = ([0.0; 3], 0.0, 0.0);
            self.within(at, APART * reach, near);
            for &Near { distance2, place } in &*near {
                let (j, other) = (place as usize, &gathered[place as usize]);
                if other.is_covered() != gathered[i].is_covered()
                    || (distance2 == 0.0 && self.are_parted(i, j))
                {
                    continue;
                }
                let turn = (1.0 - normals[i].dot(normals[j])).max(0.0).sqrt();
                let apart = (at - self.positions[j]).length() / reach.min(other.reach()) + TURN * turn;
                let weight = (1.0 - apart / APART).max(0.0) * f64::from(other.rays());
                if weight > 0.0 {
                    sum = add(sum, weight, other.light());
                    weights += weight;
                    errors += weight * weight * other.variance();
                }
            }
            let whole = weights.max(f64::MIN_POSITIVE);
            (sum.map(|s| s / whole), errors.sqrt() / whole)
        })
    }

    /// Whether something stands between two places at one position.
    const fn are_parted(&self, i: usize, j: usize) -> bool {
        self.sides[i] != self.sides[j] && self.sides[i] != 0 && self.sides[j] != 0
    }

    /// Cell `n` has the cells 2n and 2n + 1 for its halves.
    fn build(&mut self, cell: usize, from: usize, to: usize) {
        let all = self.order[from..to].iter().map(|&i| self.positions[i as usize]);
        let (low, high) = all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        self.cells[cell] = (low, high);
        if 2 * cell >= self.cells.len() {
            return;
        }
        let axis = (high - low).max_position();
        let at = |i: &u32| self.positions[*i as usize][axis];
        self.order[from..to].sort_by(|a, b| at(a).total_cmp(&at(b)).then(a.cmp(b)));
        let middle = from + (to - from) / 2;
        self.build(2 * cell, from, middle);
        self.build(2 * cell + 1, middle, to);
    }

    /// The nearest [`MOST`] places within a radius, with their squared distances, in no order.
    fn within(&self, point: DVec3, radius: f64, near: &mut BinaryHeap<Near>) {
        near.clear();
        self.visit((1, 0, self.order.len()), point, &mut (radius * radius), near);
    }

    /// `within2` becomes less once there are enough.
    fn visit(
        &self,
        (cell, from, to): (usize, usize, usize),
        point: DVec3,
        within2: &mut f64,
        near: &mut BinaryHeap<Near>,
    ) {
        if 2 * cell >= self.cells.len() {
            for &place in &self.order[from..to] {
                let own =
                    Near { distance2: (self.positions[place as usize] - point).length_squared(), place };
                if own.distance2 > *within2 {
                    continue;
                }
                if near.len() < MOST {
                    near.push(own);
                } else if let Some(mut last) = near.peek_mut().filter(|last| own < **last) {
                    *last = own;
                }
                if near.len() == MOST {
                    *within2 = near.peek().map_or(*within2, |last| last.distance2);
                }
            }
            return;
        }
        let middle = from + (to - from) / 2;
        let halves = [(2 * cell, from, middle), (2 * cell + 1, middle, to)];
        let distances = halves.map(|(half, ..)| {
            let (low, high) = self.cells[half];
            (point - point.clamp(low, high)).length_squared()
        });
        let nearer = usize::from(distances[1] < distances[0]);
        for half in [nearer, 1 - nearer] {
            let (_, from, to) = halves[half];
            if from < to && distances[half] <= *within2 {
                self.visit(halves[half], point, within2, near);
            }
        }
    }
}

/// A place near another one; of two at the same distance that of the smaller number is nearer.
#[derive(Clone, Copy, PartialEq)]
struct Near {
    distance2: f64,
    place: u32,
}

impl Eq for Near {}

impl PartialOrd for Near {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Near {
    fn cmp(&self, other: &Self) -> Ordering {
        self.distance2.total_cmp(&other.distance2).then(self.place.cmp(&other.place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::sequence::mix;
    use glam::dvec3;

    #[test]
    fn the_nearest_places_are_found() {
        let number = |i: u64| (mix(i) >> 40) as f64 / (1_u64 << 24) as f64;
        // Some are at the same position.
        let positions: Vec<DVec3> = (0..3000_u64)
            .map(|i| i % 2900)
            .map(|i| dvec3(number(i), number(i + 5000), number(i + 9000)))
            .collect();
        let sides = vec![0; positions.len()];
        let places = Places::new(&positions, &sides);
        let mut near = BinaryHeap::new();
        for (&point, radius) in positions.iter().step_by(37).zip([0.05, 0.2, 0.0].into_iter().cycle()) {
            places.within(point, radius, &mut near);
            let of =
                |place: u32| Near { distance2: (positions[place as usize] - point).length_squared(), place };
            let mut all: Vec<Near> =
                (0..3000).map(of).filter(|near| near.distance2 <= radius * radius).collect();
            all.sort();
            all.truncate(MOST);
            let found: Vec<u32> = near.clone().into_sorted_vec().iter().map(|near| near.place).collect();
            assert_eq!(found, all.iter().map(|near| near.place).collect::<Vec<_>>());
        }
    }

    /// The foot of a wall that reaches into another one has vertices where its visible part has some: half of the light of both was a dark dash along the corner.
    #[test]
    fn covered_places_take_no_part_in_the_light_of_visible_ones() {
        let positions = [DVec3::ZERO, DVec3::ZERO, dvec3(0.01, 0.0, 0.0)];
        let places = Places::new(&positions, &[0; 3]);
        let seen = |light: f64| Gathered::of(64, [light; 3], 1.0);
        let smooth = |gathered: &[Gathered]| places.smooth(&[DVec3::Z; 3], gathered, &[0, 1, 2]);
        let light = smooth(&[seen(2.0), seen(0.0), seen(1.0)]);
        assert!(light[0].0[0] > 1.5 && light[2].0[0] > 1.0, "{light:?}");
        assert_eq!(light[1].0, [0.0; 3]);
        // Dim is not covered.
        let light = smooth(&[seen(2.0), seen(1e-9), seen(1.0)]);
        assert!(light[1].0[0] > 0.9, "{light:?}");
    }
}
