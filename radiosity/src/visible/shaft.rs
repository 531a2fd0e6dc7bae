//! Shaft culling \[4\]: which occluders reach into the convex hull of two polygons.

use glam::DVec3;

use crate::polygon::{Polygon, edges};

/// An occluder that reaches into the hull by at most this, times the hull's size, only touches it.
const TOUCHING: f64 = 1e-12;

/// The space between two polygons that face each other.
#[derive(Clone, Debug)]
pub(crate) struct Shaft<'p> {
    ends: [&'p [DVec3]; 2],
    centres: [DVec3; 2],
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
        let (ends, centres) = ([a.vertices(), b.vertices()], [a.centre(), b.centre()]);
        let mut planes = Vec::with_capacity(2 + ends[0].len() + ends[1].len());
        planes.extend([plane(a), plane(b)]);
        Self { ends, centres, low, high, slack, planes }
    }

    /// Adds the planes through an edge of one end and a corner of the other that have both ends on one side.
    pub(crate) fn with_planes(mut self) -> Self {
        for (one, other) in [(0, 1), (1, 0)] {
            for edge in edges(self.ends[one]) {
                let plane = self.supporting(edge, self.centres[one], self.ends[other]);
                self.planes.extend(plane);
            }
        }
        self
    }

    /// The plane through an edge of the end around `centre` that has both ends behind it, turned about the edge from corner to
    /// corner of the `other`.
    fn supporting(&self, (p, q): (DVec3, DVec3), centre: DVec3, other: &[DVec3]) -> Option<(DVec3, f64)> {
        let mut outwards: Option<DVec3> = None;
        for &corner in other {
            if outwards.is_some_and(|n| n.dot(corner - p) <= self.slack) {
                continue;
            }
            let Some(normal) = (q - p).cross(corner - p).try_normalize() else { continue };
            let side = normal.dot(centre - p);
            if side.abs() > self.slack {
                outwards = Some(if side > 0.0 { -normal } else { normal });
            }
        }
        let normal = outwards?;
        let offset = normal.dot(p);
        let behind = |v: &DVec3| normal.dot(*v) - offset <= self.slack;
        self.ends.into_iter().flatten().all(behind).then_some((normal, offset))
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
