//! The interval of a line that a triangle hides from a point.

use glam::DVec3;

/// A triangle that may hide something of the line; coordinates are those of the light's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LineCaster {
    pub(crate) corners: [DVec3; 3],
    /// Unit normal and offset of its plane.
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
    /// 1 for opaque ones, the constant opacity for others; masks multiply it.
    pub(crate) opacity: f64,
    /// Surface and number of a masked triangle.
    pub(crate) mask: Option<(u32, u32)>,
}

/// A part of a line whose ends are 0 and 1; empty if its first number is not below its second.
pub(crate) type Interval = (f64, f64);

/// The part of an interval at which `from + t · (to − from)` is positive, for a function that has these values at 0 and 1.
pub(crate) fn positive((from, to): (f64, f64), (least, most): Interval) -> Interval {
    match (from > 0.0, to > 0.0) {
        (true, true) => (least, most),
        (true, false) => (least, most.min(from / (from - to))),
        (false, true) => (least.max(from / (from - to)), most),
        (false, false) => (1.0, 0.0),
    }
}

impl LineCaster {
    /// The interval of places on the line from `a` to `b` that it hides from a point; `None` if it hides nothing. A triangle whose plane is
    /// within `coincident` of the point does not: the point is on it.
    pub(crate) fn hidden(&self, point: DVec3, [a, b]: [DVec3; 2], coincident: f64) -> Option<Interval> {
        let height = |p: DVec3| self.normal.dot(p) - self.offset;
        let own = height(point);
        if own.abs() <= coincident {
            return None;
        }
        // Towards the side of the plane that the point is not on.
        let side = -own.signum();
        let mut interval = positive((side * height(a), side * height(b)), (0.0, 1.0));
        let (to_a, to_b) = (a - point, b - point);
        for k in 0..3 {
            if interval.0 >= interval.1 {
                return None;
            }
            let (v, w) = (self.corners[k] - point, self.corners[(k + 1) % 3] - point);
            // An edge is the same for both its triangles: their intervals meet without a gap.
            let swap = self.corners[k].to_array() > self.corners[(k + 1) % 3].to_array();
            let across = if swap { -w.cross(v) } else { v.cross(w) } * side;
            interval = positive((across.dot(to_a), across.dot(to_b)), interval);
        }
        (interval.0 < interval.1).then_some(interval)
    }
}
