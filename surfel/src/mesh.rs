//! A validated mesh, with its areas and normals.

use crate::{SurfacePoint, SurfelError};
use glam::DVec3;
use pointillist_parallel as parallel;

/// Range of areas: square roots of these, divided by any count, have squares that are normal numbers.
const AREAS: std::ops::RangeInclusive<f64> = 1e-280..=1e280;

/// A mesh whose indices are in range, whose coordinates are finite, and which has an area.
pub(crate) struct Mesh<'a> {
    positions: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    /// Unit normal of each triangle; zero for one without area, which gets no points.
    normals: Vec<DVec3>,
    /// Area of all triangles up to and including each.
    area_up_to: Vec<f64>,
    /// Smallest and largest coordinates of all corners.
    pub(crate) bounds: (DVec3, DVec3),
}

impl<'a> Mesh<'a> {
    pub(crate) fn new(positions: &'a [DVec3], triangles: &'a [[u32; 3]]) -> Result<Self, SurfelError> {
        if let Some(index) = positions.iter().position(|p| !p.is_finite()) {
            return Err(SurfelError::VertexNotFinite { index, value: positions[index].to_array() });
        }
        let count = positions.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= count) {
                return Err(SurfelError::VertexOutOfRange { triangle, vertex, count });
            }
        }
        let crosses = parallel::map(triangles.len(), |t| {
            let [a, b, c] = triangles[t].map(|v| positions[v as usize]);
            (b - a).cross(c - a)
        });
        let mut area = 0.0;
        let area_up_to: Vec<f64> = crosses
            .iter()
            .map(|cross| {
                area += 0.5 * cross.length();
                area
            })
            .collect();
        if !AREAS.contains(&area) {
            return Err(SurfelError::NoArea { area });
        }
        let corners = triangles.iter().flatten().map(|&v| positions[v as usize]);
        let bounds =
            corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let normals = crosses.iter().map(|cross| cross.normalize_or_zero()).collect();
        Ok(Self { positions, triangles, normals, area_up_to, bounds })
    }

    pub(crate) fn len(&self) -> usize {
        self.triangles.len()
    }

    pub(crate) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }

    pub(crate) fn normal(&self, triangle: usize) -> DVec3 {
        self.normals[triangle]
    }

    /// Sum of all areas: finite, more than 0.
    pub(crate) fn area(&self) -> f64 {
        self.area_up_to.last().copied().unwrap_or(0.0)
    }

    pub(crate) fn area_of(&self, triangle: usize) -> f64 {
        self.area_up_to[triangle] - if triangle == 0 { 0.0 } else { self.area_up_to[triangle - 1] }
    }

    /// The triangle in which this much area, from 0 to all, is used up.
    pub(crate) fn triangle_at(&self, area: f64) -> usize {
        // By rounding this may be the whole area: then it is the last triangle that adds to the sum.
        let area = area.min(self.area().next_down());
        self.area_up_to.partition_point(|&up_to| up_to <= area)
    }

    /// The point with these barycentric coordinates, as yet without a radius.
    pub(crate) fn point(&self, triangle: usize, barycentric: DVec3) -> SurfacePoint {
        let [a, b, c] = self.corners(triangle);
        // About the first corner, so that far from the origin only the sum is rounded.
        let position = a + ((b - a) * barycentric.y + (c - a) * barycentric.z);
        let (normal, triangle) = (self.normals[triangle], triangle as u32);
        SurfacePoint { position, normal, triangle, barycentric, radius: 0.0 }
    }
}
