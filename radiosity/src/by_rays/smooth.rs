//! Averages over neighbouring places where light comes from far away: their rays count for one another (\[8\]'s test for interpolation).
//! Places behind a wall and places in front of it are no neighbours, however close they are: a surface that reaches into a wall has both.

use glam::DVec3;

use super::gather::Gathered;
use crate::rgb::{Rgb, add};
use pointillist_parallel as parallel;

/// How much the split-sphere model may say that irradiance differs between places that are averaged.
const APART: f64 = 0.15;
/// Weight of normals in that model.
const TURN: f64 = 1.5;
/// Neighbours of a place, about, at most.
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
        parallel::map_with(which.len(), Vec::new, |near, k| {
            let i = which[k];
            let (at, reach) = (self.positions[i], gathered[i].reach());
            let (mut sum, mut weights, mut errors) = ([0.0; 3], 0.0, 0.0);
            self.within(at, APART * reach, near);
            for &(distance2, j) in &*near {
                let (j, other) = (j as usize, &gathered[j as usize]);
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

    /// Places nearer than a radius, with their squared distances; nearer than less if these are more than [`MOST`].
    fn within(&self, point: DVec3, radius: f64, near: &mut Vec<(f64, u32)>) {
        near.clear();
        self.visit((1, 0, self.order.len()), point, radius * radius, near);
        if near.len() > MOST {
            // On a surface they are as many as the square of the radius.
            let within2 = radius * radius * MOST as f64 / near.len() as f64;
            near.retain(|&(distance2, _)| distance2 <= within2);
        }
    }

    fn visit(
        &self,
        (cell, from, to): (usize, usize, usize),
        point: DVec3,
        within2: f64,
        near: &mut Vec<(f64, u32)>,
    ) {
        let (low, high) = self.cells[cell];
        if from == to || (point - point.clamp(low, high)).length_squared() > within2 {
            return;
        }
        if 2 * cell >= self.cells.len() {
            for &i in &self.order[from..to] {
                let distance2 = (self.positions[i as usize] - point).length_squared();
                if distance2 <= within2 {
                    near.push((distance2, i));
                }
            }
            return;
        }
        let middle = from + (to - from) / 2;
        self.visit((2 * cell, from, middle), point, within2, near);
        self.visit((2 * cell + 1, middle, to), point, within2, near);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

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
