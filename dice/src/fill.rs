//! Boundary edges of outlines that cross themselves or have holes, by a fill rule.
//!
//! 1. Find the edges that meet ([`meet`](crate::meet)). Rings that meet one another, directly or by way of others, are one group.
//! 2. A group lies between the others: their winding number is the same all around it, and is counted at one of its corners.
//! 3. A ring that meets neither itself nor others is boundary as a whole, with the inside on the same side everywhere, or not at all. So
//!    outlines with holes, holes with islands and so on are exact: no coordinate is computed.
//! 4. Other groups are divided by horizontal lines through all corners and crossings into slabs, within which no edges cross. In each slab,
//!    edges are sorted from left to right and winding numbers are counted along them. Where the rule changes from outside to inside or
//!    back, the edge is boundary.
//!
//! A crossing is rounded to `f64` only as the height at which one edge ends to be boundary and the other begins; the edges themselves stay
//! what they are. So the area at a crossing is off by about the square of the last place of the coordinates. Edges whose distance in the
//! middle of a slab is within rounding may be sorted the wrong way round, which misplaces the area between them.

use glam::DVec2;

use crate::meet::{EdgeTree, Meeting, RingEdge, edges_of_rings};
use crate::rule::{Boundary, FillRule};
use crate::slabs;

/// The boundary of what is inside, without horizontal edges; `None` for a single ring that does not meet itself, which is its own boundary.
///
/// Between the heights `rows[0]` and `rows[1]` the answer does not depend on them; beyond, parts of it may be missing. `orientation` of a ring
/// is +1 if its inside is where x is larger than on the edges that go down, −1 if it is on their other side, `None` if it has no area.
pub(crate) fn boundary(
    rings: &[Vec<DVec2>],
    rule: FillRule,
    rows: [f64; 2],
    orientation: impl Fn(usize) -> Option<i32>,
) -> Option<Vec<Boundary>> {
    let edges = edges_of_rings(rings);
    let tree = EdgeTree::new(&edges);
    // 1
    let mut groups = Groups::new(rings.len());
    let mut crossings = vec![vec![]; rings.len()];
    tree.meetings(|a, b, meeting| {
        groups.join(a.ring, b.ring);
        if let Meeting::Cross(y) = meeting {
            crossings[a.ring].push(y);
        }
    });
    if rings.len() == 1 && !groups.meets[0] {
        return None;
    }
    // 2
    let edges_of = |ring: usize| {
        let first = edges.partition_point(|e| e.ring < ring);
        &edges[first..first + edges[first..].partition_point(|e| e.ring == ring)]
    };
    let windings = groups.windings(edges_of, &tree);
    let mut found = vec![];
    for (members, winding) in groups.members().iter().zip(windings) {
        if let &[ring] = &members[..]
            && !groups.meets[ring]
        {
            // 3
            if let Some(orientation) = orientation(ring) {
                add_simple_ring(edges_of(ring), rule, [winding, winding + orientation], &mut found);
            }
        } else {
            // 4
            let edges = members.iter().flat_map(|&ring| edges_of(ring)).copied().collect();
            let crossings = members.iter().flat_map(|&ring| &crossings[ring]).copied().collect();
            slabs::sweep(edges, crossings, (rule, winding), rows, &mut found);
        }
    }
    Some(found)
}

/// Step 3, for a ring with these winding numbers outside and inside of it.
fn add_simple_ring(
    edges: &[RingEdge],
    rule: FillRule,
    [outside, inside]: [i32; 2],
    found: &mut Vec<Boundary>,
) {
    if rule.is_inside(outside) == rule.is_inside(inside) {
        return;
    }
    for &RingEdge { top, bottom, winding, .. } in edges.iter().filter(|e| e.top.y != e.bottom.y) {
        let right = if winding == inside - outside { inside } else { outside };
        found.push(Boundary { top, bottom, from: top.y, to: bottom.y, inside_right: rule.is_inside(right) });
    }
}

/// Rings that meet one another, as trees of rings (union–find).
struct Groups {
    parent: Vec<usize>,
    /// Whether a ring meets itself or another one.
    meets: Vec<bool>,
}

impl Groups {
    fn new(count: usize) -> Self {
        Self { parent: (0..count).collect(), meets: vec![false; count] }
    }

    fn root(&self, mut ring: usize) -> usize {
        while self.parent[ring] != ring {
            ring = self.parent[ring];
        }
        ring
    }

    fn join(&mut self, a: usize, b: usize) {
        (self.meets[a], self.meets[b]) = (true, true);
        let roots = [self.root(a), self.root(b)];
        let root = roots[0].min(roots[1]);
        // The rings themselves, too, so that ways to roots stay short.
        [a, b, roots[0], roots[1]].into_iter().for_each(|ring| self.parent[ring] = root);
    }

    /// The rings of each group, by the first of them.
    fn members(&self) -> Vec<Vec<usize>> {
        let mut groups = vec![vec![]; self.parent.len()];
        (0..self.parent.len()).for_each(|ring| groups[self.root(ring)].push(ring));
        groups.retain(|group| !group.is_empty());
        groups
    }

    /// Step 2: the winding number of all other groups around each one, in the order of [`Self::members`]. Where rounding leaves it open at
    /// all corners of a group, all rings are made one group: no decision is needed within one.
    fn windings<'e>(&mut self, edges_of: impl Fn(usize) -> &'e [RingEdge], tree: &EdgeTree<'_>) -> Vec<i32> {
        let roots: Vec<usize> = (0..self.parent.len()).map(|ring| self.root(ring)).collect();
        let around = |group: &Vec<usize>| {
            let is_other = |ring: usize| roots[ring] != roots[group[0]];
            let mut corners = group.iter().flat_map(|&ring| edges_of(ring)).map(|e| e.top).peekable();
            if corners.peek().is_none() {
                Some(0)
            } else {
                corners.find_map(|p| tree.winding_about(p, is_other))
            }
        };
        let windings: Option<Vec<i32>> = self.members().iter().map(around).collect();
        windings.unwrap_or_else(|| {
            (0..self.parent.len()).for_each(|ring| self.join(0, ring));
            vec![0]
        })
    }
}
