//! The first points that span space, or what less all points span.

use super::cell::Vertex;
use super::sites::Sites;

/// What a set of points spans, by points that do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Simplex {
    /// All points coincide, or there are no points.
    Point,
    /// All lie on a line, not all in one place.
    Line,
    /// All lie in a plane, not all on a line.
    Plane([Vertex; 3]),
    /// They do not lie in a plane.
    Space([Vertex; 4]),
}

impl Simplex {
    /// One pass: each point is visited once, however many lie in a plane.
    pub(super) fn new(sites: &Sites, vertices: &[Vertex]) -> Self {
        let mut rest = vertices.iter().copied();
        let Some(a) = rest.next() else { return Self::Point };
        let Some(b) = rest.find(|&v| sites.compare(a, v).is_ne()) else { return Self::Point };
        let Some(c) = rest.find(|&v| !sites.are_collinear([a, b, v])) else { return Self::Line };
        match rest.find(|&v| sites.orient([a, b, c, v]) != 0.0) {
            None => Self::Plane([a, b, c]),
            Some(d) => Self::Space([a, b, c, d]),
        }
    }
}
