//! What can be between two polygons: the convex hull of both, and what reaches into it \[4\].

use glam::DVec3;

use crate::polygon::{Polygon, edges};

/// What comes this close to the hull's border, relative to its size, only touches it.
const TOUCHING: f64 = 1e-12;

/// The space between two polygons that face each other.
#[derive(Clone, Debug)]
pub(crate) struct Shaft<'p> {
    ends: [&'p [DVec3]; 2],
    low: DVec3,
    high: DVec3,
    slack: f64,
    /// Normal outwards, and its product with a point of the plane.
    planes: Vec<(DVec3, f64)>,
}

impl<'p> Shaft<'p> {
    /// Its bounding box; planes are found by [`Shaft::with_planes`].
    pub(crate) fn new(a: &'p Polygon, b: &'p Polygon) -> Self {
        let all = || a.vertices().iter().chain(b.vertices());
        let low = all().fold(DVec3::INFINITY, |m, &v| m.min(v));
        let high = all().fold(DVec3::NEG_INFINITY, |m, &v| m.max(v));
        let slack = TOUCHING * (high - low).max_element();
        let plane = |p: &Polygon| (-p.normal(), -p.normal().dot(p.centre()));
        Self { ends: [a.vertices(), b.vertices()], low, high, slack, planes: vec![plane(a), plane(b)] }
    }

    /// Adds the planes through an edge of one end and a corner of the other that have both ends on one side.
    pub(crate) fn with_planes(mut self) -> Self {
        let [a, b] = self.ends;
        let mut found = vec![];
        for (ring, other) in [(a, b), (b, a)] {
            for (p, q) in edges(ring) {
                found.extend(other.iter().find_map(|&r| self.supporting(p, q, r)));
            }
        }
        self.planes.append(&mut found);
        self
    }

    /// The plane through three points, if both ends are on one side of it.
    fn supporting(&self, p: DVec3, q: DVec3, r: DVec3) -> Option<(DVec3, f64)> {
        let normal = (q - p).cross(r - p).try_normalize()?;
        let offset = normal.dot(p);
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        for v in self.ends.into_iter().flatten() {
            let side = normal.dot(*v) - offset;
            (low, high) = (low.min(side), high.max(side));
            if low < -self.slack && high > self.slack {
                return None;
            }
        }
        if high <= self.slack { Some((normal, offset)) } else { Some((-normal, -offset)) }
    }

    /// Smallest and largest corner of the box around it.
    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    /// Whether the occluder may be between the ends. What only touches the hull, or has both ends on one side, is not.
    pub(crate) fn may_hold(&self, occluder: &Polygon) -> bool {
        let ring = occluder.vertices();
        let slack = self.slack;
        for axis in 0..3 {
            if ring.iter().all(|v| v[axis] >= self.high[axis] - slack)
                || ring.iter().all(|v| v[axis] <= self.low[axis] + slack)
            {
                // A box of no thickness has everything on its border.
                if self.high[axis] - self.low[axis] > 4.0 * slack {
                    return false;
                }
            }
        }
        if self.planes.iter().any(|(n, d)| ring.iter().all(|v| n.dot(*v) - d >= -slack)) {
            return false;
        }
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for v in self.ends.into_iter().flatten() {
            let height = occluder.height(*v);
            (low, high) = (low.min(height), high.max(height));
        }
        low < -slack && high > slack
    }

    /// Whether the occluder alone hides the ends from each other entirely.
    ///
    /// The places where lines between two convex ends cross a plane between them are the hull of those of the lines between
    /// their corners.
    pub(crate) fn is_blocked_by(&self, occluder: &Polygon) -> bool {
        let [a, b] = self.ends;
        let height_a = occluder.height(a[0]);
        let sign = height_a.signum();
        let strictly = |v: &DVec3, sign: f64| occluder.height(*v) * sign > self.slack;
        if !a.iter().all(|v| strictly(v, sign)) || !b.iter().all(|v| strictly(v, -sign)) {
            return false;
        }
        let inside = |p: DVec3| {
            edges(occluder.vertices()).all(|(s, t)| occluder.normal().dot((t - s).cross(p - s)) >= 0.0)
        };
        a.iter().all(|&p| {
            let from = occluder.height(p);
            b.iter().all(|&q| inside(p + (q - p) * (from / (from - occluder.height(q)))))
        })
    }
}
