//! The boundary of rings that meet themselves or one another: step 4 of [`fill`](crate::fill), slab by slab.

use crate::meet::RingEdge;
use crate::rule::{Boundary, FillRule};

/// Appends the boundary of what is inside of a group of rings to `found`, between `rows[0]` and `rows[1]` at least.
///
/// `crossings` are the heights at which edges cross; `around` is the winding number outside of the group. Cost: for each slab, the edges that
/// pass through it.
pub(crate) fn sweep(
    mut edges: Vec<RingEdge>,
    crossings: Vec<f64>,
    (rule, around): (FillRule, i32),
    rows: [f64; 2],
    found: &mut Vec<Boundary>,
) {
    edges.retain(|e| e.top.y != e.bottom.y);
    edges.sort_by(|a, b| a.top.y.total_cmp(&b.top.y));
    let mut lines: Vec<f64> = edges.iter().flat_map(|e| [e.top.y, e.bottom.y]).chain(crossings).collect();
    lines.sort_by(f64::total_cmp);
    lines.dedup();
    let first = lines.partition_point(|&y| y <= rows[0]).saturating_sub(1);
    let mut slabs = Slabs { edges: &edges, active: vec![], open: vec![None; edges.len()], waiting: 0, found };
    for slab in lines[first..].windows(2).take_while(|slab| slab[0] < rows[1]) {
        slabs.enter(slab[0]);
        slabs.count(slab, rule, around);
    }
    slabs.close_all();
}

struct Slabs<'a> {
    /// By the heights of their tops.
    edges: &'a [RingEdge],
    /// Edges that reach into the slab, with x in its middle.
    active: Vec<(usize, f64)>,
    /// For each edge that is boundary: the height from which on, and whether the inside is where x is larger.
    open: Vec<Option<(f64, bool)>>,
    /// The first edge that begins below the slab.
    waiting: usize,
    found: &'a mut Vec<Boundary>,
}

impl Slabs<'_> {
    /// Goes on to the slab that begins at `y`.
    fn enter(&mut self, y: f64) {
        while self.edges.get(self.waiting).is_some_and(|e| e.top.y <= y) {
            self.active.push((self.waiting, 0.0));
            self.waiting += 1;
        }
        let (edges, open, found) = (self.edges, &mut self.open, &mut *self.found);
        self.active.retain(|&(e, _)| {
            let stays = edges[e].bottom.y > y;
            if !stays {
                close(&edges[e], edges[e].bottom.y, &mut open[e], found);
            }
            stays
        });
    }

    /// Counts winding numbers along the middle of the slab.
    fn count(&mut self, slab: &[f64], rule: FillRule, around: i32) {
        let [y0, y1] = [slab[0], slab[1]];
        // Halved before the sum, which may overflow.
        let middle = 0.5 * y0 + 0.5 * y1;
        self.active.iter_mut().for_each(|(e, x)| *x = self.edges[*e].x_at(middle));
        self.active.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        let mut winding = around;
        for &(e, _) in &self.active {
            let before = rule.is_inside(winding);
            winding += self.edges[e].winding;
            let after = rule.is_inside(winding);
            let inside_right = (before != after).then_some(after);
            if self.open[e].map(|open| open.1) != inside_right {
                close(&self.edges[e], y0, &mut self.open[e], self.found);
                self.open[e] = inside_right.map(|inside_right| (y0, inside_right));
            }
        }
    }

    fn close_all(self) {
        for (edge, mut open) in self.edges.iter().zip(self.open) {
            close(edge, edge.bottom.y, &mut open, self.found);
        }
    }
}

/// Ends at height `to` the part of an edge that is boundary, if there is one.
fn close(edge: &RingEdge, to: f64, open: &mut Option<(f64, bool)>, found: &mut Vec<Boundary>) {
    if let Some((from, inside_right)) = open.take() {
        found.push(Boundary { top: edge.top, bottom: edge.bottom, from, to, inside_right });
    }
}
