//! Outlines of lights with an area.

use crate::error::LightError;
use glam::DVec3;

/// Most vertices of a [`LightOutline`].
pub const LARGEST_OUTLINE: usize = 12;

/// A convex planar polygon that shines: 3 to [`LARGEST_OUTLINE`] vertices, kept in place so that lights can be copied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightOutline {
    vertices: [DVec3; LARGEST_OUTLINE],
    count: usize,
}

impl LightOutline {
    /// An outline with these vertices, counter-clockwise as seen from the front. That they are planar and convex is for whoever takes the
    /// light's area to check.
    ///
    /// # Errors
    /// [`LightError`] if there are fewer than 3 vertices or more than [`LARGEST_OUTLINE`].
    pub fn new(vertices: &[DVec3]) -> Result<Self, LightError> {
        if !(3..=LARGEST_OUTLINE).contains(&vertices.len()) {
            return Err(LightError::OutlineLength { found: vertices.len() });
        }
        let mut own = [DVec3::ZERO; LARGEST_OUTLINE];
        own[..vertices.len()].copy_from_slice(vertices);
        Ok(Self { vertices: own, count: vertices.len() })
    }

    pub(crate) fn from_quad(quad: [DVec3; 4]) -> Self {
        let mut vertices = [DVec3::ZERO; LARGEST_OUTLINE];
        vertices[..4].copy_from_slice(&quad);
        Self { vertices, count: 4 }
    }

    /// Its vertices.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices[..self.count]
    }

    /// The normal of its front, as long as its area.
    #[must_use]
    pub fn area_vector(&self) -> DVec3 {
        self.fan().map(|[a, b, c]| (b - a).cross(c - a)).sum::<DVec3>() * 0.5
    }

    /// The point at a place of the unit square: evenly spread if the places are.
    pub(crate) fn point(&self, [s, t]: [f64; 2]) -> DVec3 {
        let front = self.area_vector().normalize_or_zero();
        let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).dot(front).max(0.0);
        let mut left = s * self.fan().map(area).sum::<f64>();
        let last = self.count - 3;
        for (i, triangle) in self.fan().enumerate() {
            let own = area(triangle);
            if left <= own || i == last {
                let share = if own > 0.0 { (left / own).min(1.0) } else { 0.0 };
                let [a, b, c] = triangle;
                // The root makes places even: a strip at distance r from `a` has an area proportional to r.
                let r = share.sqrt();
                return a + ((b - a) * (1.0 - t) + (c - a) * t) * r;
            }
            left -= own;
        }
        self.vertices[0]
    }

    fn fan(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        let v = self.vertices();
        (2..v.len()).map(move |i| [v[0], v[i - 1], v[i]])
    }
}
