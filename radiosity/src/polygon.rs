//! Convex planar polygons, checked once.

use glam::DVec3;
use pointillist_dice::{clip_ring, share_before_crossing};

use crate::error::PolygonError;

/// How far vertices may lie off the polygon's plane, and corners bend inward, relative to the polygon's size.
///
/// Coordinates that went through a text file with six digits are this far off; the form factor of such a polygon is
/// that of its outline, whose error is of the same relative size.
pub const SHAPE_TOLERANCE: f64 = 1e-6;

/// The thinnest polygon there is: twice its area relative to the square of its size.
///
/// Below, the normal is made of rounding.
const LEAST_RELATIVE_AREA: f64 = 1e-14;

/// A planar convex polygon with a front: the side from which its vertices run counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    vertices: Vec<DVec3>,
    normal: DVec3,
    area: f64,
    centre: DVec3,
    radius: f64,
}

impl Polygon {
    /// The polygon with these vertices, in any unit of length. A vertex that repeats the one before is dropped.
    ///
    /// # Errors
    /// [`PolygonError`]: fewer than three vertices, a coordinate that is not finite or too large or too small to be
    /// squared (beyond 1e±70), no area, vertices off one plane or a corner that bends inward by more than
    /// [`SHAPE_TOLERANCE`].
    pub fn new(vertices: &[DVec3]) -> Result<Self, PolygonError> {
        if let Some(index) = vertices.iter().position(|v| !v.is_finite() || v.abs().max_element() > 1e70) {
            return Err(PolygonError::NotFinite { index });
        }
        let mut ring: Vec<DVec3> = Vec::with_capacity(vertices.len());
        for &v in vertices {
            if ring.last() != Some(&v) {
                ring.push(v);
            }
        }
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        if ring.len() < 3 {
            return Err(PolygonError::TooFewVertices { count: ring.len() });
        }
        let polygon = Self::unchecked(ring).ok_or(PolygonError::NoArea)?;
        polygon.check_plane()?;
        polygon.check_corners()?;
        Ok(polygon)
    }

    /// The polygon of vertices that are known to be planar and convex; none where there is no area.
    pub(crate) fn unchecked(vertices: Vec<DVec3>) -> Option<Self> {
        let count = vertices.len() as f64;
        let mean = vertices.iter().sum::<DVec3>() / count;
        let mut twice = DVec3::ZERO;
        let mut extent2 = 0.0_f64;
        for (a, b) in edges(&vertices) {
            twice += (a - mean).cross(b - mean);
            extent2 = extent2.max((a - mean).length_squared());
        }
        let length = twice.length();
        if length.is_nan() || length <= LEAST_RELATIVE_AREA * extent2 || length < 1e-140 {
            return None;
        }
        let normal = twice / length;
        Some(Self { normal, area: 0.5 * length, centre: mean, radius: extent2.sqrt(), vertices })
    }

    fn check_plane(&self) -> Result<(), PolygonError> {
        let off = |v: &DVec3| self.height(*v).abs() / self.radius;
        match self.vertices.iter().position(|v| off(v) > SHAPE_TOLERANCE) {
            Some(index) => {
                Err(PolygonError::NotPlanar { index, off: off(&self.vertices[index]) * self.radius })
            }
            None => Ok(()),
        }
    }

    /// Every corner turns left, and all of them together once around.
    fn check_corners(&self) -> Result<(), PolygonError> {
        let n = self.vertices.len();
        let mut turned = 0.0;
        for i in 0..n {
            let [a, b, c] = [0, 1, 2].map(|k| self.vertices[(i + k) % n]);
            let (before, after) = (b - a, c - b);
            let turn = before.cross(after).dot(self.normal);
            if turn < -SHAPE_TOLERANCE * self.radius * self.radius {
                return Err(PolygonError::NotConvex { index: (i + 1) % n });
            }
            turned += turn.atan2(before.dot(after));
        }
        // Two turns and more: a star, whose corners are convex one by one.
        if turned > 3.0 * std::f64::consts::PI {
            return Err(PolygonError::NotConvex { index: 0 });
        }
        Ok(())
    }

    /// The vertices, counter-clockwise seen from the front.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Unit vector off the front.
    #[must_use]
    pub const fn normal(&self) -> DVec3 {
        self.normal
    }

    /// In squared units of the vertices.
    #[must_use]
    pub const fn area(&self) -> f64 {
        self.area
    }

    /// Mean of the vertices.
    #[must_use]
    pub const fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Distance of the farthest vertex from [`Polygon::centre`].
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// Distance of `p` in front of the plane; negative behind.
    #[must_use]
    pub fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p - self.centre)
    }

    /// The same outline, seen from the other side.
    #[must_use]
    pub fn flipped(&self) -> Self {
        let vertices = self.vertices.iter().rev().copied().collect();
        Self { vertices, normal: -self.normal, ..*self }
    }

    /// Smallest and largest height of the vertices of `other`.
    pub(crate) fn heights_of(&self, other: &[DVec3]) -> (f64, f64) {
        other.iter().map(|&v| self.height(v)).fold((f64::MAX, f64::MIN), |(lo, hi), h| (lo.min(h), hi.max(h)))
    }

    /// What lies in front of `plane`; none if nothing with area does.
    pub(crate) fn in_front_of(&self, plane: &Self) -> Option<Self> {
        Self::unchecked(clipped(&self.vertices, |v| plane.height(v)))
    }

    /// Moved, then scaled.
    pub(crate) fn moved(&self, by: DVec3, scale: f64) -> Self {
        Self {
            vertices: self.vertices.iter().map(|&v| (v + by) * scale).collect(),
            normal: self.normal,
            area: self.area * scale * scale,
            centre: (self.centre + by) * scale,
            radius: self.radius * scale,
        }
    }

    /// The polygon as quadrangles of a fan; a triangle is one with its last two corners equal.
    pub(crate) fn quads(&self) -> impl Iterator<Item = [DVec3; 4]> + '_ {
        let v = &self.vertices;
        (1..v.len() - 1).step_by(2).map(move |i| [v[0], v[i], v[i + 1], v[(i + 2).min(v.len() - 1)]])
    }
}

/// Edges of a ring, from the one that ends at the first vertex on.
pub(crate) fn edges(ring: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    let last = ring.last().copied().unwrap_or_default();
    std::iter::once(last).chain(ring.iter().copied()).zip(ring.iter().copied())
}

/// The part of a convex ring where `value`, an affine function, is not negative.
pub(crate) fn clipped(ring: &[DVec3], value: impl Fn(DVec3) -> f64) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(ring.len() + 1);
    clip_ring(ring, value, crossing, |p| kept.push(p));
    kept
}

/// Where the edge from `a` to `b` meets a plane, by heights over it.
fn crossing((a, value_a): (DVec3, f64), (b, value_b): (DVec3, f64)) -> DVec3 {
    a + (b - a) * share_before_crossing(value_a, value_b)
}
