//! The surface of the points' convex hull, and its point nearest to a position outside.
//!
//! The nearest point of a convex body is unique and moves continuously with the position. So weights beyond the hull,
//! which are those of that point, are continuous.

use crate::vertices::Vertices;
use glam::DVec3;

/// Sides of cells beyond which there is no cell: triangles, or segments `[a, b, b]`, or ends `[a, a, a]`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hull {
    facets: Vec<[u32; 3]>,
    /// Normals of any length that point outward; 0 where rounding hides which way that is, and of facets that are edges or points.
    outward: Vec<DVec3>,
    /// The facets at point i are `around[first[i]..first[i + 1]]`.
    around: Vec<u32>,
    first: Vec<u32>,
}

/// A point of a facet as weights of its corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    pub(crate) corners: [u32; 3],
    pub(crate) weights: [f64; 3],
    at: DVec3,
}

/// Cosines below this may have the wrong sign by rounding.
const LEVEL: f64 = 4.0 * f64::EPSILON;

impl Nearest {
    /// Whether it is nearer to `p` than the other. Distances are not compared: those from far away are equal up to
    /// rounding.
    fn is_nearer_than(&self, other: &Self, p: DVec3) -> bool {
        let step = self.at - other.at;
        let ahead = p - 0.5 * (self.at + other.at);
        step.dot(ahead) > LEVEL * step.length() * ahead.length()
    }
}

impl Hull {
    /// The hull of these facets with their outward normals.
    pub(crate) fn new(points: usize, facets: Vec<[u32; 3]>, outward: Vec<DVec3>) -> Self {
        let mut first = vec![0_u32; points + 1];
        let distinct = |f: &[u32; 3]| {
            let [a, b, c] = *f;
            [Some(a), (b != a).then_some(b), (c != a && c != b).then_some(c)].into_iter().flatten()
        };
        for corner in facets.iter().flat_map(distinct) {
            first[corner as usize + 1] += 1;
        }
        for i in 0..points {
            first[i + 1] += first[i];
        }
        let mut next = first.clone();
        let mut around = vec![0; first[points] as usize];
        for (i, facet) in facets.iter().enumerate() {
            for corner in distinct(facet) {
                let slot = &mut next[corner as usize];
                around[*slot as usize] = i as u32;
                *slot += 1;
            }
        }
        Self { facets, outward, around, first }
    }

    /// The point of the hull that is nearest to `p`, which lies outside of facet `start`.
    ///
    /// Walks from facet to facet as long as a facet that shares a corner, and has `p` on its outer side, is nearer: on
    /// a convex body a facet without a nearer neighbour is the nearest of all.
    pub(crate) fn nearest(&self, vertices: &Vertices, start: u32, p: DVec3) -> Nearest {
        let mut best = self.on_facet(vertices, start, p);
        // Distances fall with each step, so no facet is met twice; rounding cannot make it endless either.
        for _ in 0..self.facets.len() {
            let mut is_nearest = true;
            for corner in best.corners {
                let (from, to) = (self.first[corner as usize], self.first[corner as usize + 1]);
                for &facet in &self.around[from as usize..to as usize] {
                    let away = p - vertices.at(self.facets[facet as usize][0]);
                    let outward = self.outward[facet as usize];
                    if outward == DVec3::ZERO || outward.dot(away) > 0.0 {
                        let other = self.on_facet(vertices, facet, p);
                        if other.is_nearer_than(&best, p) {
                            (best, is_nearest) = (other, false);
                        }
                    }
                }
            }
            if is_nearest {
                break;
            }
        }
        best
    }

    pub(crate) fn facet_count(&self) -> u32 {
        self.facets.len() as u32
    }

    /// Which of some facets is nearest to `p`.
    pub(crate) fn nearest_of(
        &self,
        vertices: &Vertices,
        facets: impl IntoIterator<Item = u32>,
        p: DVec3,
    ) -> Option<u32> {
        let all = facets.into_iter().map(|facet| (facet, self.on_facet(vertices, facet, p)));
        all.reduce(|best, other| if other.1.is_nearer_than(&best.1, p) { other } else { best })
            .map(|best| best.0)
    }

    fn on_facet(&self, vertices: &Vertices, facet: u32, p: DVec3) -> Nearest {
        let corners = self.facets[facet as usize];
        let [a, b, c] = corners.map(|i| vertices.at(i));
        let weights = match corners[1] == corners[2] {
            true => on_segment(a, b, p),
            false if is_line(vertices, [a, b, c]) => on_longest_side([a, b, c], p),
            false => on_triangle([a, b, c], p),
        };
        let at = a * weights[0] + b * weights[1] + c * weights[2];
        Nearest { corners, weights, at }
    }
}

/// Weights of the point of a segment that is nearest to `p`; the third is 0.
fn on_segment(a: DVec3, b: DVec3, p: DVec3) -> [f64; 3] {
    let along = b - a;
    let length2 = along.length_squared();
    let t = if length2 > 0.0 { ((p - a).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    [1.0 - t, t, 0.0]
}

/// Whether a triangle is a line up to rounding.
fn is_line(vertices: &Vertices, [a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    (b - a).cross(c - a).length() <= vertices.flat_below(longest) * longest
}

/// Weights of the point that is nearest to `p` of a triangle that is a line up to rounding.
fn on_longest_side([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let [bc, ca, ab] = [c - b, a - c, b - a].map(DVec3::length_squared);
    if ab >= bc && ab >= ca {
        on_segment(a, b, p)
    } else if bc >= ca {
        let [u, v, _] = on_segment(b, c, p);
        [0.0, u, v]
    } else {
        let [u, v, _] = on_segment(c, a, p);
        [v, 0.0, u]
    }
}

/// Weights of the point of a triangle that is nearest to `p` (Ericson, *Real-time collision detection*, §5.1.5).
fn on_triangle([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    // As products of the above these would be rounded to a part of the longest side's square, which is all that a thin triangle has.
    let (pa, pb, pc) = (a - p, b - p, c - p);
    let (wa, wb, wc) = (normal.dot(pb.cross(pc)), normal.dot(pc.cross(pa)), normal.dot(pa.cross(pb)));
    if d1 <= 0.0 && d2 <= 0.0 {
        [1.0, 0.0, 0.0]
    } else if d3 >= 0.0 && d4 <= d3 {
        [0.0, 1.0, 0.0]
    } else if d6 >= 0.0 && d5 <= d6 {
        [0.0, 0.0, 1.0]
    } else if wc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        on_segment(a, b, p)
    } else if wb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let [u, v, _] = on_segment(a, c, p);
        [u, 0.0, v]
    } else if wa <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let [u, v, _] = on_segment(b, c, p);
        [0.0, u, v]
    } else {
        let sum = wa + wb + wc;
        [wa / sum, wb / sum, wc / sum]
    }
}
