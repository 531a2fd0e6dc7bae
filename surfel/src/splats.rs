//! The list of the discs of a tile.

use crate::batch::Projected;
use crate::splat::Splat;

/// A list that keeps its memory initialised when it is emptied: new entries are written in place. Pushing entries made
/// elsewhere would copy them once more.
#[derive(Default)]
pub(crate) struct Splats {
    all: Vec<Splat>,
    count: usize,
    /// The number of the selected node that each disc belongs to.
    nodes: Vec<u32>,
}

impl Splats {
    pub(crate) fn clear(&mut self) {
        self.count = 0;
        self.nodes.clear();
    }

    pub(crate) fn as_slice(&self) -> &[Splat] {
        &self.all[..self.count]
    }

    /// Sorts numbers of discs by node, the nearest node first; discs of one node keep their order.
    pub(crate) fn sort_by_node(&self, numbers: &mut [u32]) {
        numbers.sort_by_key(|&i| self.nodes[i as usize]);
    }

    /// Adds those that were projected of `count` items of a node.
    #[inline(always)]
    pub(crate) fn append(&mut self, projected: &Projected, count: usize, node: u32) {
        let room = self.count + count;
        if self.all.len() < room {
            self.all.resize(room.next_power_of_two(), Splat::NONE);
        }
        for item in (0..count).filter(|&item| projected.is_kept(item)) {
            self.all[self.count] = projected.splat(item);
            self.count += 1;
        }
        self.nodes.resize(self.count, node);
    }
}
