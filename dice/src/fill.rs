//! Outlines that cross themselves, and outlines with holes, as edges between inside and outside.
//!
//! 1. Edges are compared in pairs, those that can meet in y, for where they cross. A ring whose edges do not meet is left as it is.
//! 2. Horizontal lines through all corners and crossings divide the plane into slabs, within which no edges cross.
//! 3. In each slab edges are sorted from left to right, and winding numbers are counted along them. Where the rule changes from outside
//!    to inside or back, the edge is part of the boundary; pieces of one edge in consecutive slabs are one piece.
//!
//! Crossings are rounded to `f64`: areas are off by about the last place of the coordinates times the length of the edges that cross.

use glam::DVec2;

/// What of an outline is inside, by how often it winds about a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FillRule {
    /// An odd number of times: a ring within a ring is a hole, whatever its direction. The default.
    #[default]
    EvenOdd,
    /// Any number of times but 0: a ring within a ring is a hole only if it goes the other way round.
    NonZero,
}

impl FillRule {
    fn is_inside(self, winding: i32) -> bool {
        match self {
            Self::EvenOdd => winding % 2 != 0,
            Self::NonZero => winding != 0,
        }
    }
}

/// An edge of an outline; `top` has the smaller y.
#[derive(Clone, Copy, Debug)]
struct RingEdge {
    top: DVec2,
    bottom: DVec2,
    /// +1 if the outline goes down along it, −1 if up.
    winding: i32,
    /// Ring, place in it, and edges of that ring: edges that follow one another share a corner.
    ring: usize,
    place: usize,
    count: usize,
}

impl RingEdge {
    fn x_at(&self, y: f64) -> f64 {
        if y <= self.top.y {
            return self.top.x;
        }
        if y >= self.bottom.y {
            return self.bottom.x;
        }
        self.top.x + (self.bottom.x - self.top.x) * ((y - self.top.y) / (self.bottom.y - self.top.y))
    }

    fn follows(&self, other: &Self) -> bool {
        self.ring == other.ring
            && ((self.place + 1) % self.count == other.place || (other.place + 1) % other.count == self.place)
    }
}

/// A part of the boundary: `inside_right` says on which side of the way from `top` to `bottom` the inside is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Boundary {
    pub(crate) top: DVec2,
    pub(crate) bottom: DVec2,
    pub(crate) inside_right: bool,
}

/// The boundary of what is inside, without horizontal edges; `None` for a single ring that does not meet itself, which is its own boundary.
pub(crate) fn boundary(rings: &[&[DVec2]], rule: FillRule) -> Option<Vec<Boundary>> {
    let mut edges: Vec<RingEdge> = rings.iter().enumerate().flat_map(|(i, ring)| edges_of(i, ring)).collect();
    edges.sort_by(|a, b| a.top.y.total_cmp(&b.top.y));
    let meetings = meetings(&edges);
    if rings.len() == 1 && !meetings.any {
        return None;
    }
    edges.retain(|e| e.top.y != e.bottom.y);
    let mut lines: Vec<f64> =
        edges.iter().flat_map(|e| [e.top.y, e.bottom.y]).chain(meetings.crossings).collect();
    lines.sort_by(f64::total_cmp);
    lines.dedup();
    Some(sweep(&edges, &lines, rule))
}

fn edges_of(ring: usize, vertices: &[DVec2]) -> Vec<RingEdge> {
    let mut corners: Vec<DVec2> = vertices.to_vec();
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    let count = corners.len();
    let edge = |place: usize| {
        let (a, b) = (corners[place], corners[(place + 1) % count]);
        let goes_down = a.y <= b.y;
        let (top, bottom) = if goes_down { (a, b) } else { (b, a) };
        RingEdge { top, bottom, winding: if goes_down { 1 } else { -1 }, ring, place, count }
    };
    if count < 2 { vec![] } else { (0..count).map(edge).collect() }
}

#[derive(Default)]
struct Meetings {
    /// Whether any two edges meet but for the corners that outlines go round.
    any: bool,
    /// y of the crossings.
    crossings: Vec<f64>,
}

/// Step 1; `edges` are sorted by their tops.
fn meetings(edges: &[RingEdge]) -> Meetings {
    let mut found = Meetings::default();
    let mut active: Vec<&RingEdge> = vec![];
    for edge in edges {
        active.retain(|other| other.bottom.y >= edge.top.y);
        for other in &active {
            match meeting(edge, other) {
                Meeting::None => {}
                Meeting::Touch => found.any = true,
                Meeting::Cross(y) => {
                    found.any = true;
                    found.crossings.push(y);
                }
            }
        }
        active.push(edge);
    }
    found
}

enum Meeting {
    None,
    Touch,
    Cross(f64),
}

fn meeting(a: &RingEdge, b: &RingEdge) -> Meeting {
    let apart = |[l, m]: [f64; 2], [n, o]: [f64; 2]| l.max(m) < n.min(o) || n.max(o) < l.min(m);
    if apart([a.top.x, a.bottom.x], [b.top.x, b.bottom.x]) {
        return Meeting::None;
    }
    let of_b = [side(a, b.top), side(a, b.bottom)];
    let of_a = [side(b, a.top), side(b, a.bottom)];
    let on_one_side = |[s, t]: [f64; 2]| s * t > 0.0;
    if on_one_side(of_b) || on_one_side(of_a) {
        return Meeting::None;
    }
    if of_b.contains(&0.0) || of_a.contains(&0.0) {
        let corners = of_b.iter().chain(&of_a).filter(|&&s| s == 0.0).count();
        // Two edges about a corner: each has the corner, and nothing else, on the other's line.
        return if a.follows(b) && corners == 2 && a.count > 2 { Meeting::None } else { Meeting::Touch };
    }
    let share = of_b[0] / (of_b[0] - of_b[1]);
    let y = b.top.y + (b.bottom.y - b.top.y) * share;
    let range = [a.top.y.max(b.top.y), a.bottom.y.min(b.bottom.y)];
    Meeting::Cross(y.clamp(range[0], range[1]))
}

/// On which side of an edge's line a point is; 0 if that is not certain.
fn side(edge: &RingEdge, p: DVec2) -> f64 {
    /// Bound on the rounding of a 2×2 determinant of differences, over the size of its terms.
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    let (u, v) = (edge.bottom - edge.top, p - edge.top);
    let (forward, backward) = (u.x * v.y, u.y * v.x);
    let value = forward - backward;
    if value.abs() <= ROUNDING * (forward.abs() + backward.abs()) { 0.0 } else { value }
}

/// Steps 2 and 3.
fn sweep(edges: &[RingEdge], lines: &[f64], rule: FillRule) -> Vec<Boundary> {
    let mut found = vec![];
    // Of edges that reach into the slab: number, x in its middle.
    let mut active: Vec<(usize, f64)> = vec![];
    // For each edge the piece of boundary that is not finished: where it begins, and whether the inside is to its right.
    let mut open: Vec<Option<(DVec2, bool)>> = vec![None; edges.len()];
    let mut waiting = 0;
    for slab in lines.windows(2) {
        let [y0, y1] = [slab[0], slab[1]];
        active.retain(|&(e, _)| {
            let stays = edges[e].bottom.y > y0;
            if !stays && let Some((top, inside_right)) = open[e].take() {
                found.push(Boundary { top, bottom: edges[e].bottom, inside_right });
            }
            stays
        });
        while edges.get(waiting).is_some_and(|e| e.top.y <= y0) {
            active.push((waiting, 0.0));
            waiting += 1;
        }
        let middle = 0.5 * (y0 + y1);
        active.iter_mut().for_each(|(e, x)| *x = edges[*e].x_at(middle));
        active.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        let mut winding = 0;
        for &(e, _) in &active {
            let before = rule.is_inside(winding);
            winding += edges[e].winding;
            let after = rule.is_inside(winding);
            let side = (before != after).then_some(after);
            if open[e].map(|(_, side)| side) != side {
                let at = DVec2::new(edges[e].x_at(y0), y0);
                if let Some((top, inside_right)) = open[e].take() {
                    found.push(Boundary { top, bottom: at, inside_right });
                }
                open[e] = side.map(|side| (at, side));
            }
        }
    }
    for (edge, open) in edges.iter().zip(open) {
        if let Some((top, inside_right)) = open {
            found.push(Boundary { top, bottom: edge.bottom, inside_right });
        }
    }
    found
}
