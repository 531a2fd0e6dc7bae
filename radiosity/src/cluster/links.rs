//! What clusters see: links to patches, each by a ray.

use super::groups::Groups;
use super::surroundings::{LIFT, Surroundings};
use crate::rays::sequence::{Hemisphere, Sequence, lattice, mix, point_of};
use crate::scene::Scene;
use crate::tree::ElementId;
use pointillist_parallel as parallel;

/// No patch.
pub(crate) const NONE: u32 = u32::MAX;
/// Clusters between two reports of progress.
const BLOCK: usize = 1024;

/// For each cluster the patches that its rays meet, all of the same weight.
#[derive(Clone, Debug, Default)]
pub(crate) struct Links {
    /// Indices of patches, `rays` for each cluster; [`NONE`] where a ray leaves the scene or meets a black back.
    pub(crate) hits: Vec<u32>,
    pub(crate) rays: usize,
}

impl Links {
    /// `number` is the index of each leaf among patches, by element; `done` is told the share of the work that is done.
    pub(crate) fn new(
        scene: &Scene,
        around: &Surroundings,
        (leaves, number): (&[ElementId], &[u32]),
        groups: &Groups,
        rays: usize,
        done: &(dyn Fn(f64) + Sync),
    ) -> Self {
        let elements = scene.tree.elements.len();
        let mut hits = Vec::with_capacity(groups.len() * rays);
        for first in (0..groups.len()).step_by(BLOCK) {
            let count = BLOCK.min(groups.len() - first);
            let block: Vec<Vec<u32>> = parallel::map_heavy(count, |i| {
                let cluster = first + i;
                let mut row = Vec::with_capacity(rays);
                from_cluster(scene, leaves, groups.members(cluster), cluster, rays, |origin, direction| {
                    let met = around.patch(scene, elements, origin, direction);
                    row.push(met.and_then(|(patch, _)| patch).map_or(NONE, |patch| number[patch as usize]));
                });
                row
            });
            hits.extend(block.into_iter().flatten());
            done((first + count) as f64 / groups.len() as f64);
        }
        Self { hits, rays }
    }

    pub(crate) fn row(&self, cluster: usize) -> &[u32] {
        &self.hits[cluster * self.rays..(cluster + 1) * self.rays]
    }
}

/// Rays off a cluster: from points that are spread over its patches by area, by the cosine.
fn from_cluster(
    scene: &Scene,
    leaves: &[ElementId],
    members: &[u32],
    cluster: usize,
    rays: usize,
    mut visit: impl FnMut(glam::DVec3, glam::DVec3),
) {
    let polygon = |member: u32| &scene.tree.elements[leaves[member as usize] as usize].polygon;
    let whole: f64 = members.iter().map(|&m| polygon(m).area()).sum();
    let sequence = Sequence::new(cluster as u64);
    let bits = mix(!(cluster as u64));
    let unit = |bits: u64| (bits >> 40) as f64 / (1_u64 << 24) as f64;
    let shift = [unit(bits), unit(mix(bits))];
    let (mut member, mut below) = (0, 0.0);
    for k in 0..rays {
        let wanted = (k as f64 + 0.5) / rays as f64 * whole;
        while member + 1 < members.len() && below + polygon(members[member]).area() < wanted {
            below += polygon(members[member]).area();
            member += 1;
        }
        let patch = polygon(members[member]);
        let origin = point_of(patch.vertices(), lattice(k as u32, shift)) + patch.normal() * LIFT;
        visit(origin, Hemisphere::new(patch.normal()).direction(sequence.pair(k as u32)));
    }
}
