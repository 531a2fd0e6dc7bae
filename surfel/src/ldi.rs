//! Samples by layered depth images along the three axes.
//!
//! In \[1\] every ray keeps all of its intersections, and a surface gets up to three sets of points. Here each triangle
//! is met only by the rays along the axis that its normal is nearest to. It gets one set, of `|n|∞ / spacing²` points
//! per area, which varies by √3 at most; keeping all three sets would vary as much, with 1.5 times the points.

use crate::cover::{self, MAX_CELLS};
use crate::mesh::Mesh;
use crate::{SurfacePoint, SurfelError};
use glam::{DVec2, DVec3};
use pointillist_parallel as parallel;
use std::cmp::Ordering;

/// No point of a smooth surface is farther than this many spacings from the nearest sample: √6.
///
/// Seen along the rays, samples are the corners of unit squares, and any disc of radius 1/√2 holds one. Beside the line
/// where another axis takes over, or a border, half a disc must hold one; half a disc of radius √2 holds that disc. The
/// plane is stretched along its slope by `1 / |n|∞ ≤ √3` at most. (Within a plane it is half as much.)
pub(crate) const COVER: f64 = 2.449_489_742_783_178;

/// A sample and the ray that found it.
struct Hit {
    axis: usize,
    row: i64,
    column: i64,
    point: SurfacePoint,
}

/// The axis along which a triangle's points are found, the first of equals.
fn axis_of(normal: DVec3) -> usize {
    let n = normal.abs();
    if n.x >= n.y && n.x >= n.z {
        0
    } else if n.y >= n.z {
        1
    } else {
        2
    }
}

/// Sum of all triangles' shadows on the planes that they are sampled from.
fn facing_area(mesh: &Mesh<'_>) -> f64 {
    (0..mesh.len()).map(|t| mesh.area_of(t) * mesh.normal(t).abs().max_element()).sum()
}

/// Points to be expected with rays this far apart.
pub(crate) fn expected_count(mesh: &Mesh<'_>, spacing: f64) -> f64 {
    facing_area(mesh) / spacing / spacing
}

/// The spacing at which this number of points is to be expected.
pub(crate) fn spacing_for(mesh: &Mesh<'_>, count: f64) -> f64 {
    (facing_area(mesh) / count).sqrt()
}

/// All samples, ray by ray. Rays start half a spacing from the low end of the mesh's box.
pub(crate) fn points(mesh: &Mesh<'_>, spacing: f64) -> Result<Vec<SurfacePoint>, SurfelError> {
    let (low, high) = mesh.bounds;
    let cells = (high - low).max_element() / spacing;
    if cells > f64::from(MAX_CELLS) {
        return Err(SurfelError::TooFine { cells, limit: MAX_CELLS });
    }
    let mut hits = parallel::flat_map(mesh.len(), |t, hits| add_hits(mesh, t, spacing, hits));
    parallel::sort_by(&mut hits, compare);
    Ok(hits.into_iter().map(|hit| hit.point).collect())
}

/// Ray by ray, from low to high. Points in the same place are ordered by how they lie, and only equal ones by the
/// numbers of their triangles.
fn compare(a: &Hit, b: &Hit) -> Ordering {
    let ray = |h: &Hit| (h.axis, h.row, h.column);
    let numbers = |h: &Hit| {
        let (p, n) = (h.point.position, h.point.normal);
        [p[h.axis], p[(h.axis + 1) % 3], p[(h.axis + 2) % 3], n.x, n.y, n.z]
    };
    let by_number = || numbers(a).iter().zip(&numbers(b)).map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne());
    ray(a)
        .cmp(&ray(b))
        .then_with(|| by_number().unwrap_or(Ordering::Equal))
        .then_with(|| a.point.triangle.cmp(&b.point.triangle))
}

fn add_hits(mesh: &Mesh<'_>, triangle: usize, spacing: f64, hits: &mut Vec<Hit>) {
    let normal = mesh.normal(triangle);
    if normal == DVec3::ZERO {
        return;
    }
    let axis = axis_of(normal);
    let low = mesh.bounds.0;
    // In spacings from the low end, seen along the axis.
    let seen = mesh.corners(triangle).map(|p| {
        let p = (p - low) / spacing;
        DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3])
    });
    cover::covered(seen.map(|p| cover::vertex(p.x, p.y)), |column, row| {
        let ray = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
        let point = mesh.point(triangle, barycentric(seen, ray));
        hits.push(Hit { axis, row, column, point });
    });
}

/// Barycentric coordinates of a point that is inside, or outside by the rounding of vertices: then those of a point
/// nearby that is inside.
fn barycentric(corners: [DVec2; 3], p: DVec2) -> DVec3 {
    let [a, b, c] = corners.map(|corner| corner - p);
    let weights = DVec3::new(b.perp_dot(c), c.perp_dot(a), a.perp_dot(b));
    let sum = weights.element_sum();
    // All of it is rounding: any point of the triangle is as near.
    let thirds = DVec3::splat(1.0 / 3.0);
    if sum == 0.0 {
        return thirds;
    }
    let weights = (weights / sum).max(DVec3::ZERO);
    let inside = weights / weights.element_sum();
    if inside.is_finite() { inside } else { thirds }
}
