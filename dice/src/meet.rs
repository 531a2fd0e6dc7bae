//! Where the edges of outlines meet one another, and how often outlines wind about a point.
//!
//! Edges stand in the order of their rings, in which neighbours are near one another. Boxes about 1, 2, 4, … consecutive edges make a
//! binary tree; pairs of edges that may meet, and edges beside a point, are found by going down where boxes overlap. For outlines of `n`
//! edges such as coastlines that takes O(n log n) time.

use glam::DVec2;

/// An edge of an outline; `top` has the smaller y.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RingEdge {
    pub(crate) top: DVec2,
    pub(crate) bottom: DVec2,
    /// +1 if the outline goes from `top` to `bottom`, −1 if the other way.
    pub(crate) winding: i32,
    /// Number of the ring.
    pub(crate) ring: usize,
    /// Position in the ring, and number of edges of the ring: edges at consecutive positions share a corner.
    place: usize,
    count: usize,
}

impl RingEdge {
    /// x at height `y`; that of the nearer end for heights beyond the ends.
    pub(crate) fn x_at(&self, y: f64) -> f64 {
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

/// The edges of all rings, ring by ring. Corners that repeat the one before them, or the first, are left out.
pub(crate) fn edges_of_rings(rings: &[Vec<DVec2>]) -> Vec<RingEdge> {
    rings.iter().enumerate().flat_map(|(ring, vertices)| edges_of_ring(ring, vertices)).collect()
}

fn edges_of_ring(ring: usize, vertices: &[DVec2]) -> Vec<RingEdge> {
    let mut corners = vertices.to_vec();
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

/// How two edges meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Meeting {
    /// They have points in common, or it is not certain that they have none.
    Touch,
    /// Each has its ends on both sides of the other; at this y, rounded.
    Cross(f64),
}

/// Edges with their tree of boxes.
pub(crate) struct EdgeTree<'a> {
    edges: &'a [RingEdge],
    /// Boxes (low, high) of single edges, of pairs, of fours, … up to one box about all.
    levels: Vec<Vec<[DVec2; 2]>>,
}

impl<'a> EdgeTree<'a> {
    pub(crate) fn new(edges: &'a [RingEdge]) -> Self {
        let of_edge = |e: &RingEdge| [e.top.min(e.bottom), e.top.max(e.bottom)];
        let mut levels = vec![edges.iter().map(of_edge).collect::<Vec<_>>()];
        while let Some(last) = levels.last()
            && last.len() > 1
        {
            let joined = |pair: &[[DVec2; 2]]| {
                pair.iter()
                    .copied()
                    .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
                    .expect("chunks are not empty")
            };
            let next = last.chunks(2).map(joined).collect();
            levels.push(next);
        }
        Self { edges, levels }
    }

    /// Every pair of edges that meet, but for neighbours of a ring that have their common corner in common and nothing else.
    pub(crate) fn meetings(&self, mut visit: impl FnMut(&RingEdge, &RingEdge, Meeting)) {
        let mut stack = vec![(self.levels.len() - 1, 0, 0)];
        while let Some((level, i, j)) = stack.pop() {
            let boxes = &self.levels[level];
            if i >= boxes.len() || j >= boxes.len() || (i != j && are_apart(boxes[i], boxes[j])) {
                continue;
            }
            if level > 0 {
                let below = level - 1;
                stack.extend([
                    (below, 2 * i, 2 * j),
                    (below, 2 * i, 2 * j + 1),
                    (below, 2 * i + 1, 2 * j + 1),
                ]);
                if i != j {
                    stack.push((below, 2 * i + 1, 2 * j));
                }
            } else if i != j {
                let (a, b) = (&self.edges[i], &self.edges[j]);
                if let Some(meeting) = meeting(a, b) {
                    visit(a, b, meeting);
                }
            }
        }
    }

    /// How often the rings that `counts` go round `p`, counted along the ray from `p` to smaller x; `None` if rounding leaves it open on
    /// which side of an edge `p` is.
    pub(crate) fn winding_about(&self, p: DVec2, counts: impl Fn(usize) -> bool) -> Option<i32> {
        let mut winding = 0;
        let mut stack = vec![(self.levels.len() - 1, 0)];
        while let Some((level, i)) = stack.pop() {
            let Some([low, high]) = self.levels[level].get(i) else { continue };
            if low.x > p.x || low.y > p.y || high.y < p.y {
                continue;
            }
            if level > 0 {
                stack.extend([(level - 1, 2 * i), (level - 1, 2 * i + 1)]);
                continue;
            }
            let edge = &self.edges[i];
            // Half-open, so that a ray through a corner counts one of its two edges.
            if counts(edge.ring) && edge.top.y <= p.y && p.y < edge.bottom.y {
                let side = side(edge, p);
                if side == 0.0 {
                    return None;
                }
                winding += if side < 0.0 { edge.winding } else { 0 };
            }
        }
        Some(winding)
    }
}

fn are_apart([a_low, a_high]: [DVec2; 2], [b_low, b_high]: [DVec2; 2]) -> bool {
    a_high.cmplt(b_low).any() || b_high.cmplt(a_low).any()
}

fn meeting(a: &RingEdge, b: &RingEdge) -> Option<Meeting> {
    let of_b = [side(a, b.top), side(a, b.bottom)];
    let of_a = [side(b, a.top), side(b, a.bottom)];
    // Not the sign of the product, which underflows.
    let on_one_side = |[s, t]: [f64; 2]| (s > 0.0 && t > 0.0) || (s < 0.0 && t < 0.0);
    if on_one_side(of_b) || on_one_side(of_a) {
        return None;
    }
    if of_b.contains(&0.0) || of_a.contains(&0.0) {
        let corners = of_b.iter().chain(&of_a).filter(|&&s| s == 0.0).count();
        // Two edges about a corner: each has the corner, and nothing else, on the other's line.
        let is_corner = a.follows(b) && corners == 2 && a.count > 2;
        return (!is_corner).then_some(Meeting::Touch);
    }
    let share = of_b[0] / (of_b[0] - of_b[1]);
    let y = b.top.y + (b.bottom.y - b.top.y) * share;
    let range = [a.top.y.max(b.top.y), a.bottom.y.min(b.bottom.y)];
    Some(Meeting::Cross(y.clamp(range[0], range[1])))
}

/// On which side of an edge's line a point is, negative for larger x; 0 if that is not certain.
fn side(edge: &RingEdge, p: DVec2) -> f64 {
    /// Bound on the rounding of a 2×2 determinant of differences, over the size of its terms.
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    let (u, v) = (edge.bottom - edge.top, p - edge.top);
    let (forward, backward) = (u.x * v.y, u.y * v.x);
    let value = forward - backward;
    // Products below the smallest normal number have lost digits.
    let uncertain = ROUNDING * (forward.abs() + backward.abs()) + f64::MIN_POSITIVE;
    if value.abs() > uncertain { value } else { 0.0 }
}
