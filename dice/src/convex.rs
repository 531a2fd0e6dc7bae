//! Convex polygons of bounded size on the stack: the currency of every exact visibility test.

use crate::clip::{clip_ring, share_before_crossing};
use glam::DVec2;

/// A half-plane `{p : normal · (p − anchor) + offset ≥ 0}`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane {
    /// A point near which values are most accurate; on the border if `offset` is 0.
    pub anchor: DVec2,
    /// Points into the half-plane; need not be a unit vector.
    pub normal: DVec2,
    /// Value at the anchor.
    pub offset: f64,
}

impl HalfPlane {
    /// The half-plane to the left of the directed line `a → b` (the inner side of an edge of a
    /// polygon with positive signed area).
    #[must_use]
    #[inline]
    pub fn left_of(a: DVec2, b: DVec2) -> Self {
        let d = b - a;
        Self { anchor: a, normal: DVec2::new(-d.y, d.x), offset: 0.0 }
    }

    /// Signed distance of `p`, scaled by the length of the normal.
    #[must_use]
    #[inline]
    pub fn value(&self, p: DVec2) -> f64 {
        self.normal.dot(p - self.anchor) + self.offset
    }
}

/// Most vertices that a [`ConvexPolygon`] holds.
///
/// A triangle cut by a view pyramid and a cell has at most eleven; sixteen leaves room for the cuts
/// that occluders make.
pub const MAX_VERTICES: usize = 16;

/// A convex polygon with positive signed area (`∮ x dy > 0`) and at most [`MAX_VERTICES`] vertices.
///
/// Cutting adds at most one vertex. A cut that would exceed the capacity leaves out the vertex
/// whose corner is flattest, which changes the area by the least possible amount; it takes a
/// sixteen-gon to get there.
#[derive(Clone, Copy, Debug)]
pub struct ConvexPolygon {
    len: usize,
    vertices: [DVec2; MAX_VERTICES],
}

impl Default for ConvexPolygon {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl PartialEq for ConvexPolygon {
    fn eq(&self, other: &Self) -> bool {
        self.vertices() == other.vertices()
    }
}

impl ConvexPolygon {
    /// No vertices, no area.
    pub const EMPTY: Self = Self { len: 0, vertices: [DVec2::ZERO; MAX_VERTICES] };

    /// The polygon with these vertices, which must be convex and in positive order.
    ///
    /// # Panics
    /// If there are more than [`MAX_VERTICES`].
    #[must_use]
    pub fn from_vertices(vertices: &[DVec2]) -> Self {
        let mut polygon = Self::EMPTY;
        polygon.vertices[..vertices.len()].copy_from_slice(vertices);
        polygon.len = vertices.len();
        polygon
    }

    /// The axis-aligned rectangle from `min` to `max`.
    #[must_use]
    pub fn rectangle(min: DVec2, max: DVec2) -> Self {
        Self::from_vertices(&[min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)])
    }

    /// The vertices in order.
    #[must_use]
    #[inline]
    pub fn vertices(&self) -> &[DVec2] {
        &self.vertices[..self.len]
    }

    /// Whether fewer than three vertices are left.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len < 3
    }

    /// Leaves no vertices.
    #[inline]
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Appends a vertex; at capacity the flattest corner makes room.
    #[inline]
    pub fn push(&mut self, p: DVec2) {
        if self.len == MAX_VERTICES {
            self.remove_flattest();
        }
        self.vertices[self.len] = p;
        self.len += 1;
    }

    #[cold]
    fn remove_flattest(&mut self) {
        let n = self.len;
        let corner = |i: usize| {
            let (a, b, c) = (self.vertices[(i + n - 1) % n], self.vertices[i], self.vertices[(i + 1) % n]);
            (b - a).perp_dot(c - b).abs()
        };
        let flattest = (0..n).min_by(|&i, &j| corner(i).total_cmp(&corner(j))).unwrap_or(0);
        self.vertices.copy_within(flattest + 1..n, flattest);
        self.len -= 1;
    }

    /// Signed area, taken relative to the first vertex.
    #[must_use]
    #[inline]
    pub fn area(&self) -> f64 {
        area(self.vertices())
    }

    /// Area and centroid; the centroid of a polygon without area is its first vertex.
    #[must_use]
    #[inline]
    pub fn area_and_centroid(&self) -> (f64, DVec2) {
        area_and_centroid(self.vertices())
    }

    /// Smallest and largest coordinates.
    #[must_use]
    #[inline]
    pub fn bounds(&self) -> (DVec2, DVec2) {
        bounds(self.vertices())
    }

    /// Whether some edge of `self` has all of `other` on or beyond it, within rounding.
    ///
    /// True means that the interiors are disjoint. Only the edges of `self` are tried; two convex
    /// polygons are disjoint exactly if this holds one way or the other.
    #[must_use]
    #[inline]
    pub fn has_separating_edge(&self, other: &[DVec2]) -> bool {
        has_separating_edge(self.vertices(), other)
    }

    /// The part inside the half-plane.
    #[must_use]
    #[inline]
    pub fn clipped(&self, half: &HalfPlane) -> Self {
        let mut inside = Self::EMPTY;
        self.clip_into(half, &mut inside);
        inside
    }

    /// As [`ConvexPolygon::clipped`], into a polygon that is there already.
    #[inline]
    pub fn clip_into(&self, half: &HalfPlane, inside: &mut Self) {
        inside.clear();
        clip_ring(self.vertices(), |p| half.value(p), crossing, |p| inside.push(p));
    }

    /// The parts inside and outside the half-plane. Both share the cut's end points bit for bit.
    ///
    /// A polygon wholly on one side comes back unchanged on that side.
    #[must_use]
    pub fn divided(&self, half: &HalfPlane) -> (Self, Self) {
        let (mut inside, mut outside) = (Self::EMPTY, Self::EMPTY);
        self.divide_into(half, &mut inside, &mut outside);
        (inside, outside)
    }

    /// As [`ConvexPolygon::divided`], into polygons that are there already: loops that cut again and again need not move theirs.
    pub fn divide_into(&self, half: &HalfPlane, inside: &mut Self, outside: &mut Self) {
        let n = self.len;
        let mut side = [0.0; MAX_VERTICES];
        let (mut any_in, mut any_out) = (false, false);
        for (s, v) in side.iter_mut().zip(self.vertices()) {
            *s = half.value(*v);
            any_in |= *s > 0.0;
            any_out |= *s < 0.0;
        }
        inside.clear();
        outside.clear();
        if !any_out {
            inside.copy(self);
            return;
        }
        if !any_in {
            outside.copy(self);
            return;
        }
        for i in 0..n {
            let j = if i + 1 == n { 0 } else { i + 1 };
            let (p, q) = (self.vertices[i], self.vertices[j]);
            if side[i] >= 0.0 {
                inside.push(p);
            }
            if side[i] <= 0.0 {
                outside.push(p);
            }
            if side[i] * side[j] < 0.0 {
                let crossing = crossing((p, side[i]), (q, side[j]));
                inside.push(crossing);
                outside.push(crossing);
            }
        }
    }

    /// Becomes `other`; what lies beyond its vertices is not moved.
    pub(crate) fn copy(&mut self, other: &Self) {
        self.len = other.len;
        self.vertices[..other.len].copy_from_slice(other.vertices());
    }
}

/// Where the edge from `p` to `q` meets the border of a half-plane, by the half-plane's values at both.
#[inline]
fn crossing((p, value_p): (DVec2, f64), (q, value_q): (DVec2, f64)) -> DVec2 {
    p + (q - p) * share_before_crossing(value_p, value_q)
}

/// Signed area `∮ x dy` of a ring, relative to its first vertex.
#[must_use]
#[inline]
pub fn area(ring: &[DVec2]) -> f64 {
    let Some((&o, rest)) = ring.split_first() else { return 0.0 };
    let mut twice = 0.0;
    for pair in rest.windows(2) {
        twice += (pair[0] - o).perp_dot(pair[1] - o);
    }
    0.5 * twice
}

/// Signed area and centroid of a ring; without area, the centroid is the first vertex.
#[must_use]
#[inline]
pub fn area_and_centroid(ring: &[DVec2]) -> (f64, DVec2) {
    let Some((&o, rest)) = ring.split_first() else { return (0.0, DVec2::ZERO) };
    let mut twice = 0.0;
    let mut moment = DVec2::ZERO;
    for pair in rest.windows(2) {
        let (a, b) = (pair[0] - o, pair[1] - o);
        let cross = a.perp_dot(b);
        twice += cross;
        moment += cross * (a + b);
    }
    if twice == 0.0 { (0.0, o) } else { (0.5 * twice, o + moment / (3.0 * twice)) }
}

/// Smallest and largest coordinates of some points; `(+∞, −∞)` of none.
#[must_use]
#[inline]
pub fn bounds(points: &[DVec2]) -> (DVec2, DVec2) {
    let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    // Comparisons are one instruction each, `f64::min` and `f64::max` several; of NaN both keep the bounds.
    let less = |a: f64, b: f64| if a < b { a } else { b };
    let more = |a: f64, b: f64| if a > b { a } else { b };
    points.iter().fold(start, |(lo, hi), p| {
        (DVec2::new(less(p.x, lo.x), less(p.y, lo.y)), DVec2::new(more(p.x, hi.x), more(p.y, hi.y)))
    })
}

/// Relative slack of [`has_separating_edge`], in units of edge length times distance.
///
/// Neighbours share the end points of their cuts bit for bit, so that their common edge separates
/// them up to the rounding of coordinates in the thousands; an overlap this thin is far below any
/// area that can be seen.
const SEPARATION_SLACK: f64 = 2e-12;

/// Values of [`HalfPlane::left_of`] an edge up to this count as on or beyond it, where [`has_separating_edge`] asks.
#[must_use]
#[inline]
pub fn separation_slack(edge: DVec2) -> f64 {
    SEPARATION_SLACK * (edge.x.abs() + edge.y.abs())
}

/// Edges this much shorter than their polygon have a direction that may be mostly rounding: coordinates are
/// good to about 1e-16, so what lies a polygon's size away is displaced by 1e-12 at the least.
const SHORT_EDGE: f64 = 1e-4;

/// The half-planes to the left of the edges of a convex ring (positive order), from the last edge on.
///
/// Each holds the whole ring. Cuts leave vertices that nearly coincide, and the line through two such
/// vertices can run anywhere, right through the ring too; it is moved outward then. Vertices that coincide have
/// no edge between them and give no half-plane.
pub fn half_planes(ring: &[DVec2]) -> impl Iterator<Item = HalfPlane> + '_ {
    let (low, high) = bounds(ring);
    let short = SHORT_EDGE * (high - low).max_element();
    let mut previous = ring.last().copied().unwrap_or_default();
    ring.iter().filter_map(move |&v| {
        let mut half = HalfPlane::left_of(previous, v);
        previous = v;
        // Without a normal every point would be on the border: neither inside nor outside.
        if half.normal == DVec2::ZERO {
            return None;
        }
        if half.normal.abs().max_element() < short {
            let least = ring.iter().map(|&p| half.value(p)).fold(0.0, f64::min);
            half.offset = -least;
        }
        Some(half)
    })
}

/// Whether some edge of the convex ring `a` (positive order) has every point of `b` on or beyond it.
#[must_use]
#[inline]
pub fn has_separating_edge(a: &[DVec2], b: &[DVec2]) -> bool {
    let (Some(&last), Some(&first)) = (a.last(), b.first()) else { return true };
    let middle = b[b.len() / 2];
    let mut p = last;
    for &q in a {
        let d = q - p;
        let slack = separation_slack(d);
        let beyond = |v: DVec2| d.perp_dot(v - p) <= slack;
        // Two opposite points refuse nearly all edges that do not separate.
        if (beyond(first) & beyond(middle))
            && d != DVec2::ZERO
            && b.iter().all(|&v| beyond(v))
            // The line through two vertices that nearly coincide may run through `a` itself.
            && a.iter().all(|&v| d.perp_dot(v - p) >= -slack)
        {
            return true;
        }
        p = q;
    }
    false
}

/// Whether two convex polygons have no common interior, within rounding.
#[must_use]
#[inline]
pub fn are_disjoint(a: &[DVec2], b: &[DVec2]) -> bool {
    has_separating_edge(a, b) || has_separating_edge(b, a)
}

/// Whether every point lies inside a convex outline.
#[must_use]
pub fn contains(outline: &[DVec2], points: &[DVec2]) -> bool {
    let Some(&(mut previous)) = outline.last() else { return false };
    outline.iter().all(|&v| {
        let half = HalfPlane::left_of(previous, v);
        previous = v;
        points.iter().all(|&p| half.value(p) >= 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    fn square() -> ConvexPolygon {
        ConvexPolygon::rectangle(dvec2(0.0, 0.0), dvec2(1.0, 1.0))
    }

    #[test]
    fn division_conserves_area_and_shares_the_cut() {
        let half = HalfPlane::left_of(dvec2(0.3, 0.0), dvec2(0.6, 1.0));
        let (a, b) = square().divided(&half);
        assert!((a.area() + b.area() - 1.0).abs() < 1e-15);
        assert!((a.area() - 0.45).abs() < 1e-15);
        let shared = a.vertices().iter().filter(|v| b.vertices().contains(v)).count();
        assert_eq!(shared, 2);
    }

    #[test]
    fn a_polygon_on_one_side_is_returned_unchanged() {
        let half = HalfPlane::left_of(dvec2(0.0, 1.0), dvec2(0.0, 0.0));
        let (inside, outside) = square().divided(&half);
        assert_eq!(inside, square());
        assert!(outside.is_empty());
    }

    #[test]
    fn edges_that_meet_up_to_rounding_separate() {
        let rounded = 0.1 + 0.2;
        assert!(rounded > 0.3);
        // Upright and level edges, too, have their slack.
        let left = ConvexPolygon::rectangle(DVec2::ZERO, dvec2(rounded, 1.0));
        let right = ConvexPolygon::rectangle(dvec2(0.3, 0.0), DVec2::ONE);
        assert!(left.has_separating_edge(right.vertices()) && right.has_separating_edge(left.vertices()));
        let below = ConvexPolygon::rectangle(DVec2::ZERO, dvec2(1.0, rounded));
        let above = ConvexPolygon::rectangle(dvec2(0.0, 0.3), DVec2::ONE);
        assert!(below.has_separating_edge(above.vertices()) && above.has_separating_edge(below.vertices()));
        // What overlaps by more does not.
        let nearer = ConvexPolygon::rectangle(dvec2(0.3 - 1e-9, 0.0), DVec2::ONE);
        assert!(!left.has_separating_edge(nearer.vertices()) && !nearer.has_separating_edge(left.vertices()));
    }

    #[test]
    fn neighbours_are_separated_by_their_common_edge() {
        let diagonal = HalfPlane::left_of(dvec2(0.0, 0.0), dvec2(1.0, 1.0));
        let (a, b) = square().divided(&diagonal);
        assert!(a.has_separating_edge(b.vertices()) || b.has_separating_edge(a.vertices()));
        assert!(!a.has_separating_edge(square().vertices()));
    }

    #[test]
    fn an_edge_made_of_rounding_neither_separates_nor_cuts() {
        // The first and last vertex differ by rounding only; the line through them crosses the polygon.
        let ring = [
            dvec2(0.426_607_057_261_941_6, 0.737_807_213_366_724_8),
            dvec2(0.068_551_934_182_716_77, 1.0),
            dvec2(0.0, 1.0),
            dvec2(0.0, 0.614_429_619_265_079_1),
            dvec2(0.426_607_057_261_941_5, 0.737_807_213_366_724_8),
        ];
        let inside = [dvec2(0.1, 0.7), dvec2(0.2, 0.7), dvec2(0.1, 0.8)];
        assert!(!has_separating_edge(&ring, &inside) && !has_separating_edge(&inside, &ring));
        for half in half_planes(&ring) {
            assert!(ring.iter().chain(&inside).all(|&v| half.value(v) >= -1e-16), "{half:?}");
        }
    }

    #[test]
    fn a_corner_given_twice_has_no_edge_of_its_own() {
        let ring = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 0.0), dvec2(0.0, 1.0)];
        assert_eq!(half_planes(&ring).count(), 3);
        assert!(half_planes(&ring).all(|half| half.value(dvec2(0.25, 0.25)) > 0.0));
    }

    #[test]
    fn capacity_is_kept_by_dropping_the_flattest_corner() {
        let mut polygon = square();
        for i in 0..64 {
            let angle = f64::from(i) * 0.1;
            let (n, c) = (DVec2::from_angle(angle), dvec2(0.5, 0.5));
            polygon = polygon.clipped(&HalfPlane { anchor: c, normal: -n, offset: 0.48 });
        }
        assert!(polygon.vertices().len() <= MAX_VERTICES);
        let disc = std::f64::consts::PI * 0.48 * 0.48;
        assert!((polygon.area() - disc).abs() < 0.03);
    }
}
