//! Which of many points to keep so that those that are left are far from one another: \[2\].

use crate::SurfacePoint;
use crate::rows::Rows;
use glam::DVec3;
use pointillist_parallel as parallel;

/// \[2\], eq. 4, β and γ: distances below `β·(1 − (count/candidates)^γ)` of the lattice's spacing crowd no more than
/// that one.
const BETA: f64 = 0.65;
const GAMMA: f64 = 1.5;

/// Points whose normals are more than 120° apart lie on the two sides of a thin sheet: neither fills the other's place.
/// (Across the edge of a box or a roof they do.)
pub(crate) const OTHER_SIDE: f64 = -0.5;

/// Weight function of sample elimination.
struct Crowding {
    /// Points farther apart than this, world units, add no weight to one another.
    reach: f64,
    /// Distances below this count as this, world units (\[2\], eq. 4).
    nearest: f64,
}

impl Crowding {
    /// \[2\], eq. 3 with α = 8.
    fn weight(&self, distance2: f64) -> f64 {
        let distance = distance2.sqrt().max(self.nearest);
        let rest = (1.0 - distance / self.reach).max(0.0);
        let square = rest * rest;
        let fourth = square * square;
        fourth * fourth
    }
}

/// Points by weight, heaviest first, to within `1 / STEPS` of the largest.
///
/// A departure from the heap of \[2\], for speed: a point whose weight has fallen stays where it is until its turn
/// comes, and then moves down in constant time. The patterns are as good, since weights differ by much more than a
/// step.
struct Queue {
    steps_per_weight: f64,
    /// The point inserted last into each step.
    first: Vec<u32>,
    /// For each point, the one inserted before it into the same step.
    next: Vec<u32>,
    /// All steps above this one are empty.
    top: usize,
}

impl Queue {
    const STEPS: usize = 1 << 16;
    const NONE: u32 = u32::MAX;

    fn new(weights: &[f64]) -> Self {
        let largest = weights.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let top = Self::STEPS - 1;
        let mut queue = Self {
            steps_per_weight: top as f64 / largest,
            first: vec![Self::NONE; Self::STEPS],
            next: vec![Self::NONE; weights.len()],
            top,
        };
        weights.iter().enumerate().for_each(|(place, &weight)| queue.put(place, weight));
        queue
    }

    fn step(&self, weight: f64) -> usize {
        ((weight * self.steps_per_weight) as usize).min(Self::STEPS - 1)
    }

    fn put(&mut self, place: usize, weight: f64) {
        let step = self.step(weight);
        self.next[place] = std::mem::replace(&mut self.first[step], place as u32);
    }

    /// Takes out the heaviest point by the weights that they have now.
    fn take(&mut self, weights: &[f64]) -> Option<usize> {
        loop {
            let first = self.first[self.top];
            if first == Self::NONE {
                self.top = self.top.checked_sub(1)?;
                continue;
            }
            let place = first as usize;
            self.first[self.top] = self.next[place];
            // Weights only fall: a point of the highest step whose weight is up to date is the heaviest.
            if self.step(weights[place]) == self.top {
                return Some(place);
            }
            self.put(place, weights[place]);
        }
    }
}

/// Numbers of the `count` points (at most all) to keep, in order. `spacing` is that of a lattice of as many. `done` is
/// told shares of the work.
pub(crate) fn kept(points: &[SurfacePoint], count: usize, spacing: f64, done: &dyn Fn(f64)) -> Vec<u32> {
    let share = count as f64 / points.len() as f64;
    let crowding = Crowding { reach: spacing, nearest: spacing * BETA * (1.0 - share.powf(GAMMA)) };
    let rows = Rows::new(points.len(), spacing, |i| points[i].position);
    let normals: Vec<DVec3> = rows.order().iter().map(|&i| points[i as usize].normal).collect();
    let mut weights = parallel::map(points.len(), |place| {
        let mut sum = 0.0;
        rows.near(rows.at(place), spacing, |other, distance2| {
            if other != place && normals[place].dot(normals[other]) > OTHER_SIDE {
                sum += crowding.weight(distance2);
            }
        });
        sum
    });
    let mut queue = Queue::new(&weights);
    let goes = points.len().saturating_sub(count);
    for gone in 0..goes {
        if gone % TOLD == 0 {
            done(WEIGHED + (1.0 - WEIGHED) * gone as f64 / goes as f64);
        }
        let place = queue.take(&weights).expect("every point that is left is in the queue");
        weights[place] = GONE;
        rows.near(rows.at(place), spacing, |other, distance2| {
            if weights[other] != GONE && normals[place].dot(normals[other]) > OTHER_SIDE {
                weights[other] = (weights[other] - crowding.weight(distance2)).max(0.0);
            }
        });
    }
    let places = (0..points.len()).filter(|&place| weights[place] != GONE);
    let mut kept: Vec<u32> = places.map(|place| rows.order()[place]).collect();
    kept.sort_unstable();
    kept
}

/// Share of the time after which all weights are known, about, and points that go between two calls of `done`.
const WEIGHED: f64 = 0.3;
const TOLD: usize = 1 << 14;

/// The weight of a point that was taken away.
const GONE: f64 = -1.0;
