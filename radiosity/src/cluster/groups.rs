//! Patches that face about the same way and are near one another, as clusters.
//!
//! A tree over all patches is split along the longest of six axes, three of position and three of the normal, until every part is small enough
//! in both. Patches larger than that are clusters of their own.

use glam::DVec3;

use crate::scene::Scene;
use crate::tree::ElementId;

/// Extent of the normals of a cluster along an axis, at most: a little above what a cube's edges make with the normals of its faces.
const TURN: f64 = 0.6;

/// Clusters of patches.
#[derive(Clone, Debug, Default)]
pub(crate) struct Groups {
    /// Patches, cluster by cluster, as indices into the list of leaves.
    pub(crate) members: Vec<u32>,
    /// Where each cluster's members start; one more at the end.
    pub(crate) starts: Vec<u32>,
    /// The cluster of each patch.
    pub(crate) of_patch: Vec<u32>,
}

impl Groups {
    /// Clusters whose centres of patches are within `size` of one another along each axis.
    pub(crate) fn new(scene: &Scene, leaves: &[ElementId], size: f64) -> Self {
        let mut items: Vec<([f64; 6], u32)> = leaves.iter().enumerate().map(|(i, &leaf)| {
            let polygon = &scene.tree.elements[leaf as usize].polygon;
            let (c, n): (DVec3, DVec3) = (polygon.centre() / size, polygon.normal() / TURN);
            ([c.x, c.y, c.z, n.x, n.y, n.z], i as u32)
        }).collect();
        let mut groups = Self { of_patch: vec![0; leaves.len()], ..Self::default() };
        groups.split(&mut items);
        groups.starts.push(groups.members.len() as u32);
        groups
    }

    fn split(&mut self, items: &mut [([f64; 6], u32)]) {
        let (mut axis, mut longest, mut middle) = (0, 0.0, 0.0);
        for k in 0..6 {
            let low = items.iter().fold(f64::INFINITY, |m, i| m.min(i.0[k]));
            let high = items.iter().fold(f64::NEG_INFINITY, |m, i| m.max(i.0[k]));
            if high - low > longest {
                (axis, longest, middle) = (k, high - low, 0.5 * (low + high));
            }
        }
        // Patches with exactly these centres are parted no further.
        let count = if longest > 1.0 { partition(items, |i| i.0[axis] < middle) } else { 0 };
        if count > 0 && count < items.len() {
            let (one, other) = items.split_at_mut(count);
            self.split(one);
            self.split(other);
            return;
        }
        let cluster = self.starts.len() as u32;
        self.starts.push(self.members.len() as u32);
        for item in items.iter() {
            self.members.push(item.1);
            self.of_patch[item.1 as usize] = cluster;
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub(crate) fn members(&self, cluster: usize) -> &[u32] {
        &self.members[self.starts[cluster] as usize..self.starts[cluster + 1] as usize]
    }
}

/// Those that are first come first, in their order; returns how many.
fn partition<T: Copy>(items: &mut [T], first: impl Fn(&T) -> bool) -> usize {
    let (yes, no): (Vec<T>, Vec<T>) = items.iter().partition(|i| first(i));
    items[..yes.len()].copy_from_slice(&yes);
    items[yes.len()..].copy_from_slice(&no);
    yes.len()
}
