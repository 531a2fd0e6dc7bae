//! A hierarchy of boxes around occluders.

use std::cell::Cell;

use glam::DVec3;

use super::shaft::Shaft;
use crate::polygon::Polygon;

/// Occluders that a leaf holds.
const LEAF: usize = 4;

#[derive(Clone, Debug)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// Range of the order below it.
    first: u32,
    end: u32,
    /// The second child; the first comes next in the list. 0 for a leaf.
    second: u32,
}

/// A hierarchy of boxes by which the occluders near a shaft are found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Boxes {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl Boxes {
    pub(crate) fn new(occluders: &[Polygon]) -> Self {
        let mut boxes = Self { nodes: vec![], order: (0..occluders.len() as u32).collect() };
        if !occluders.is_empty() {
            boxes.build(occluders, 0, occluders.len());
        }
        boxes
    }

    fn build(&mut self, occluders: &[Polygon], first: usize, end: usize) {
        let all = || self.order[first..end].iter().flat_map(|&i| occluders[i as usize].vertices());
        let low = all().fold(DVec3::INFINITY, |m, &v| m.min(v));
        let high = all().fold(DVec3::NEG_INFINITY, |m, &v| m.max(v));
        let node = self.nodes.len();
        self.nodes.push(Node { low, high, first: first as u32, end: end as u32, second: 0 });
        if end - first <= LEAF {
            return;
        }
        let axis = (high - low).max_position();
        let middle = (first + end) / 2;
        let centre = |i: u32| occluders[i as usize].centre()[axis];
        self.order[first..end].sort_by(|&a, &b| centre(a).total_cmp(&centre(b)).then(a.cmp(&b)));
        self.build(occluders, first, middle);
        self.nodes[node].second = self.nodes.len() as u32;
        self.build(occluders, middle, end);
    }

    /// The occluders that may be in the shaft, by number.
    pub(crate) fn in_shaft(&self, shaft: &Shaft<'_>, occluders: &[Polygon]) -> Vec<u32> {
        let (low, high) = shaft.bounds();
        let mut found = vec![];
        self.visit(0, &|n| n.low.cmple(high).all() && n.high.cmpge(low).all(), &mut |i| {
            if shaft.may_hold(&occluders[i as usize]) {
                found.push(i);
            }
        });
        found.sort_unstable();
        found
    }

    /// The occluders whose boxes may meet the box from `low` to `high`, by number.
    pub(crate) fn in_box(&self, low: DVec3, high: DVec3, found: &mut Vec<u32>) {
        found.clear();
        self.visit(0, &|n| n.low.cmple(high).all() && n.high.cmpge(low).all(), &mut |i| found.push(i));
        found.sort_unstable();
    }

    /// The occluders whose boxes may reach to the inner side of all planes (normal outwards, and its product with a point of the plane) and
    /// into the box from `low` to `high`, by number; some `most` of them if they are more.
    pub(crate) fn in_planes(
        &self,
        planes: &[(DVec3, f64)],
        (low, high): (DVec3, DVec3),
        most: usize,
        found: &mut Vec<u32>,
    ) {
        found.clear();
        // The corner of a box that is farthest inside.
        let inside = |n: &Node, (normal, offset): &(DVec3, f64)| {
            let corner = DVec3::select(normal.cmpgt(DVec3::ZERO), n.low, n.high);
            normal.dot(corner) < *offset
        };
        let count = Cell::new(0);
        let meets = |n: &Node| {
            count.get() < most
                && n.low.cmple(high).all()
                && n.high.cmpge(low).all()
                && planes.iter().all(|plane| inside(n, plane))
        };
        self.visit(0, &meets, &mut |i| {
            count.set(count.get() + 1);
            found.push(i);
        });
        found.sort_unstable();
    }

    fn visit(&self, node: usize, meets: &impl Fn(&Node) -> bool, f: &mut impl FnMut(u32)) {
        let Some(n) = self.nodes.get(node) else { return };
        if !meets(n) {
            return;
        }
        if n.second == 0 {
            self.order[n.first as usize..n.end as usize].iter().for_each(|&i| f(i));
        } else {
            self.visit(node + 1, meets, f);
            self.visit(n.second as usize, meets, f);
        }
    }
}
