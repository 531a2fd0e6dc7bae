//! What patches see: links to other patches, each by a ray.

use glam::DVec3;

use super::surroundings::{LIFT, Surroundings};
use crate::polygon::Polygon;
use crate::rays::sequence::{Hemisphere, Sequence, lattice, point_of, shift_of};
use crate::scene::Scene;
use crate::tree::ElementId;
use pointillist_parallel as parallel;

/// No patch.
pub(crate) const NONE: u32 = u32::MAX;
/// Links of the smallest patches.
pub(crate) const LEAST: u32 = 16;
/// Patches between two reports of progress.
const BLOCK: usize = 8192;

/// For each patch the patches that its rays meet, all of the same weight.
#[derive(Clone, Debug, Default)]
pub(crate) struct Links {
    /// Indices of patches, patch by patch; [`NONE`] where a ray leaves the scene or meets a black back.
    pub(crate) hits: Vec<u32>,
    /// Where each patch's begin; one more at the end.
    starts: Vec<usize>,
}

impl Links {
    /// Patches of the area `area` or more get `most` links, smaller ones fewer. `done` is told the share of the work that is done.
    pub(crate) fn new(
        scene: &Scene,
        around: &Surroundings,
        leaves: &[ElementId],
        (area, most): (f64, u32),
        done: &(dyn Fn(f64) + Sync),
    ) -> Self {
        let mut links = Self { hits: vec![], starts: Vec::with_capacity(leaves.len() + 1) };
        links.starts.push(0);
        for (number, block) in leaves.chunks(BLOCK).enumerate() {
            let first = number * BLOCK;
            let rows: Vec<Vec<u32>> = parallel::map_heavy(block.len(), |i| {
                let patch = &scene.tree.elements[block[i] as usize].polygon;
                let wanted = (f64::from(most) * patch.area() / area).min(f64::from(most)) as u32;
                let rays = wanted.next_power_of_two().clamp(LEAST, most);
                let met = |(origin, direction)| around.patch(origin, direction).map_or(NONE, |(hit, _)| hit);
                rays_from(patch, (first + i) as u64, rays).map(met).collect()
            });
            for row in rows {
                links.hits.extend(row);
                links.starts.push(links.hits.len());
            }
            done((first + block.len()) as f64 / leaves.len() as f64);
        }
        links
    }

    pub(crate) fn row(&self, patch: usize) -> &[u32] {
        &self.hits[self.starts[patch]..self.starts[patch + 1]]
    }
}

/// Rays off a patch: from points that are spread over it, by the cosine.
fn rays_from(patch: &Polygon, number: u64, rays: u32) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    let (sequence, shift) = (Sequence::new(number), shift_of(!number));
    let hemisphere = Hemisphere::new(patch.normal());
    (0..rays).map(move |k| {
        let origin = point_of(patch.vertices(), lattice(k, shift)) + patch.normal() * LIFT;
        (origin, hemisphere.direction(sequence.pair(k)))
    })
}
