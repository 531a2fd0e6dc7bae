//! Boxes of boxes of clusters: what is out of the way is skipped with all its contents.

use crate::bounds::Bounds;
use crate::geometry::Geometry;

/// Children of a node of the hierarchy.
const FAN_OUT: usize = 4;

impl Geometry {
    pub(crate) fn build_levels(&mut self) {
        let union = |group: &[Bounds]| group.iter().fold(Bounds::EMPTY, |a, &b| a.union(b));
        let leaves: Vec<Bounds> = self.clusters.iter().map(|c| c.bounds).collect();
        let mut level: Vec<Bounds> = leaves.chunks(FAN_OUT).map(union).collect();
        while !level.is_empty() {
            let next: Vec<Bounds> = level.chunks(FAN_OUT).map(union).collect();
            let last = level.len() == 1;
            self.levels.push(level);
            if last {
                break;
            }
            level = next;
        }
    }

    /// The level of the hierarchy's root, above which there is nothing; clusters are level 0. `None` without geometry.
    pub(crate) fn top_level(&self) -> Option<usize> {
        self.levels.last()?.first().map(|_| self.levels.len())
    }

    /// A box of the hierarchy: a cluster's at level 0.
    pub(crate) fn box_at(&self, level: usize, index: usize) -> &Bounds {
        if level == 0 { &self.clusters[index].bounds } else { &self.levels[level - 1][index] }
    }

    /// The boxes within a box of a level above 0, at the level below.
    pub(crate) fn children(&self, level: usize, index: usize) -> std::ops::Range<usize> {
        let below = level - 1;
        let count = if below == 0 { self.clusters.len() } else { self.levels[below - 1].len() };
        let first = index * FAN_OUT;
        first..(first + FAN_OUT).min(count)
    }

    /// Visits the clusters that `bound` admits, in order of the distance it gives, nearest first.
    ///
    /// `bound` returns a lower bound of the distance of anything in the box, or `None` to refuse it
    /// with all its contents; `visit` returns the distance beyond which nothing matters any more.
    /// Returns how many boxes were refused or left unvisited.
    pub(crate) fn visit_near_to_far(
        &self,
        queue: &mut ClusterQueue,
        mut bound: impl FnMut(&Bounds) -> Option<f64>,
        mut visit: impl FnMut(u32) -> f64,
    ) -> u64 {
        let heap = &mut queue.heap;
        heap.clear();
        let mut skipped = 0;
        let Some(root) = self.levels.last().and_then(|l| l.first()) else { return 0 };
        let clusters_below = |level: usize| (FAN_OUT as u64).pow(level as u32);
        if let Some(d) = bound(root) {
            heap.push(Entry { distance: d, level: self.levels.len() as u32, index: 0 });
        }
        let mut limit = f64::INFINITY;
        while let Some(Entry { distance, level, index }) = heap.pop() {
            if distance > limit {
                skipped += heap.drain().map(|e| clusters_below(e.level as usize)).sum::<u64>() + 1;
                break;
            }
            if level == 0 {
                limit = visit(index);
                continue;
            }
            let below = level as usize - 1;
            for child in self.children(level as usize, index as usize) {
                match bound(self.box_at(below, child)) {
                    Some(d) if d <= limit => {
                        heap.push(Entry { distance: d, level: below as u32, index: child as u32 });
                    }
                    _ => skipped += clusters_below(below),
                }
            }
        }
        skipped
    }
}

/// Reusable memory of [`Geometry::visit_near_to_far`].
#[derive(Debug, Default)]
pub(crate) struct ClusterQueue {
    heap: std::collections::BinaryHeap<Entry>,
}

/// A box in the queue, ordered so that the heap gives the nearest first.
#[derive(Debug, PartialEq)]
struct Entry {
    distance: f64,
    level: u32,
    index: u32,
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other
            .distance
            .total_cmp(&self.distance)
            .then(other.level.cmp(&self.level))
            .then(other.index.cmp(&self.index))
    }
}
