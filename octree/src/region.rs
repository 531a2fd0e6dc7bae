//! What a node is drawn for: the parts of space for which a cut has nothing deeper, and the points that these need.

use crate::cube::Cube;
use crate::cut::{Cut, CutOptions, is_seen};
use crate::tree::Tree;
use glam::DVec3;
use pointillist_view::View;
use std::collections::HashSet;

/// Octants of a node that a cut shows by this node and those around it, since it has none of its children there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Region {
    /// Number of the tree.
    pub tree: usize,
    /// Number of the node in it.
    pub node: u32,
    /// A bit for each octant, by the number that [`crate::NodeKey::child`] has for it.
    pub octants: u8,
}

/// The regions of a cut, by tree and node: together they are all of space that is in view and in a root, each place once. `view` and
/// `options` are those of the cut.
#[must_use]
pub fn regions(trees: &[&Tree], view: &View, options: &CutOptions, cut: &Cut) -> Vec<Region> {
    let taken: HashSet<(usize, u32)> = cut.nodes.iter().copied().collect();
    let of_node = |&(number, node): &(usize, u32)| {
        let tree = trees[number];
        let key = tree.nodes()[node as usize].key;
        let has_deeper =
            |octant: usize| tree.child(node, octant).is_some_and(|c| taken.contains(&(number, c)));
        let is_shown = |octant: usize| {
            // The deepest nodes cannot be divided: all of them is one place.
            let place = key.child(octant).map_or(tree.cube().of(key), |child| tree.cube().of(child));
            !has_deeper(octant) && is_seen(view, place, options.margin_px)
        };
        let octants = (0..8).filter(|&octant| is_shown(octant)).fold(0, |all, octant| all | 1 << octant);
        (octants != 0).then_some(Region { tree: number, node, octants })
    };
    let mut regions: Vec<Region> = cut.nodes.iter().filter_map(of_node).collect();
    regions.sort_unstable();
    regions
}

/// An octant of a node and what lies around it, in lattice cells.
#[derive(Clone, Copy, Debug)]
pub struct Neighbourhood {
    cube: Cube,
    level: u8,
    own: [[i64; 2]; 3],
    /// First and last cells, the margin among them.
    low: [i64; 3],
    high: [i64; 3],
}

/// Bits of a lattice coordinate.
const BITS: u8 = 32;

impl Neighbourhood {
    /// One octant of a node and `spacings` times the distance of its points around it, at most half of its side.
    ///
    /// # Panics
    /// If there is no such node, or for an octant above 7.
    #[must_use]
    pub fn of(tree: &Tree, node: u32, octant: usize, spacings: f64) -> Self {
        assert!(octant < 8, "a cube has eight octants");
        let key = tree.nodes()[node as usize].key;
        let side = 1i64 << (BITS - 1 - key.level);
        let cells = spacings * tree.spacing(node) / tree.cube().side * f64::from(BITS).exp2();
        // `as` moves what is out of range to the ends.
        let margin = (cells as i64).clamp(0, side / 2);
        let low = |axis: usize| (2 * i64::from(key.place[axis]) + (octant >> axis & 1) as i64) * side;
        let own = [0, 1, 2].map(|axis| [low(axis), low(axis) + side - 1]);
        Self {
            cube: tree.cube(),
            level: key.level,
            own,
            low: own.map(|[first, _]| first - margin),
            high: own.map(|[_, last]| last + margin),
        }
    }

    /// The nodes of the node's level and those above that may have points in it, the root first.
    #[must_use]
    pub fn nodes(&self, tree: &Tree) -> Vec<u32> {
        let mut found = vec![];
        let mut todo: Vec<u32> = tree.root().into_iter().collect();
        while let Some(node) = todo.pop() {
            let key = tree.nodes()[node as usize].key;
            let side = 1i64 << (BITS - key.level);
            let meets = |axis: usize| {
                let low = i64::from(key.place[axis]) * side;
                low <= self.high[axis] && low + side > self.low[axis]
            };
            if !(0..3).all(meets) {
                continue;
            }
            found.push(node);
            if key.level < self.level {
                todo.extend(tree.children(node));
            }
        }
        found.sort_unstable_by_key(|&node| (tree.nodes()[node as usize].key, node));
        found
    }

    /// Whether a position lies in it, and whether in the octant itself; each position is in one octant of one node of a level.
    #[must_use]
    pub fn holds(&self, position: DVec3) -> Option<bool> {
        let cell = self.cube.cell(position).map(i64::from);
        let is_near = (0..3).all(|axis| self.low[axis] <= cell[axis] && cell[axis] <= self.high[axis]);
        let is_own = || (0..3).all(|axis| self.own[axis][0] <= cell[axis] && cell[axis] <= self.own[axis][1]);
        is_near.then(is_own)
    }
}
