//! Irradiance at a point by rays, to which more can be added.

use glam::DVec3;

use super::links::NONE;
use super::solution::RaySolution;
use crate::rays::sequence::{Hemisphere, Sequence, shift_of};
use crate::rgb::{Rgb, add};

/// Rays that are judged together: each block is evenly spread over the hemisphere by itself.
const BLOCK: u32 = 16;
/// Rays of a place at first.
pub(crate) const FIRST: u32 = 32;
/// Places that have seen less than this share of [`Gatherer::floor`] by their first rays stay dark.
pub(crate) const BLACK: f64 = 0.1;
/// Places darker than this share of what a mean part of the light meets need no smaller error than one of that brightness.
const DARK: f64 = 0.1;
/// Rays shorter than this share of the scene's size count as so long, when distances are averaged.
const SHORT: f64 = 1e-5;

/// Gathers for one solution.
pub(crate) struct Gatherer<'s> {
    solution: &'s RaySolution<'s>,
    /// Irradiance below which errors are judged as if it were this.
    pub(crate) floor: f64,
}

/// What arrives at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gathered {
    /// From emitters that are looked at one by one.
    emitted: Rgb,
    /// Sum over rays.
    sum: Rgb,
    near: f64,
    of_blocks: f64,
    squares: f64,
    blocks: u32,
}

pub(crate) fn mean(v: Rgb) -> f64 {
    v.iter().sum::<f64>() / 3.0
}

impl Gathered {
    pub(crate) fn rays(&self) -> u32 {
        self.blocks * BLOCK
    }

    pub(crate) fn light(&self) -> Rgb {
        add(self.emitted, 1.0 / f64::from(self.rays().max(1)), self.sum)
    }

    /// Squared standard error of the mean of the bands.
    pub(crate) fn variance(&self) -> f64 {
        let count = f64::from(self.blocks.max(2));
        let average = self.of_blocks / count;
        (self.squares / count - average * average).max(0.0) / (count - 1.0)
    }

    /// Harmonic mean of the distances of what rays meet.
    pub(crate) fn reach(&self) -> f64 {
        if self.near > 0.0 { f64::from(self.rays()) / self.near } else { 1.0 }
    }
}

impl<'s> Gatherer<'s> {
    pub(crate) fn new(solution: &'s RaySolution<'s>) -> Self {
        let transport = solution.transport;
        let (mut squares, mut light) = (0.0, 0.0);
        for (patch, &leaf) in transport.leaves.iter().enumerate() {
            let area = transport.scene.tree.elements[leaf as usize].polygon.area();
            let gathered = solution.gathered[patch];
            let own = mean(gathered) + mean(transport.emitted[patch]);
            squares += area * own * own;
            light += area * own;
        }
        let floor = if light > 0.0 { DARK * squares / light } else { f64::MIN_POSITIVE };
        Self { solution, floor }
    }

    /// Irradiance at a point, in internal coordinates, that lies in front of its surface. `place` chooses the rays.
    pub(crate) fn start(&self, point: DVec3, normal: DVec3, place: u64) -> Gathered {
        let transport = self.solution.transport;
        let emitted = transport.emitters.at(&transport.around, point, normal, shift_of(place ^ 0x1a39));
        Gathered { emitted, ..Gathered::default() }
    }

    /// The same with as many rays as this; `start` gives the point, the normal and the place as before.
    pub(crate) fn go_on(
        &self,
        (point, normal, place): (DVec3, DVec3, u64),
        rays: u32,
        gathered: &mut Gathered,
    ) {
        let transport = self.solution.transport;
        let hemisphere = Hemisphere::new(normal);
        let sequence = Sequence::new(place);
        while gathered.rays() < rays {
            let mut block = [0.0; 3];
            for k in gathered.rays()..gathered.rays() + BLOCK {
                let direction = hemisphere.direction(sequence.pair(k));
                let met = transport.around.patch(point, direction);
                let Some((patch, distance)) = met else { continue };
                gathered.near += 1.0 / distance.max(SHORT);
                if patch != NONE {
                    block = add(block, 1.0, self.solution.seen[patch as usize]);
                }
            }
            let light = mean(block) / f64::from(BLOCK);
            gathered.of_blocks += light;
            gathered.squares += light * light;
            gathered.sum = add(gathered.sum, 1.0, block);
            gathered.blocks += 1;
        }
    }
}
