//! Face normals, vertex normals, and which side of a surface is lit.

use crate::ShadeError;
use glam::{DVec3, Vec3};

/// How much each face counts in the normal of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Weighting {
    /// By its area, so that slivers do not tilt the surface.
    #[default]
    Area,
    /// By its angle at the vertex: how the surface around is cut into triangles does not matter \[17\].
    Angle,
    /// All the same.
    Plain,
}

/// Unit normal of the triangle, counter-clockwise seen from its front; zero for a triangle without area.
#[must_use]
pub fn face_normal(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    // Scaled by the longest side first: the cross product of 1e-200 sides would underflow to "no area".
    let (ab, ac) = (half_side(a, b), half_side(a, c));
    let largest = ab.abs().max_element().max(ac.abs().max_element());
    if largest == 0.0 || !largest.is_finite() {
        return DVec3::ZERO;
    }
    unit((ab / largest).cross(ac / largest))
}

/// A unit normal for every vertex: the mean of its faces' normals; zero for a vertex without faces.
///
/// Sums run in the order of `triangles`, so the same input gives the same bytes.
///
/// # Errors
///
/// An index out of range, or a position that is not finite.
pub fn vertex_normals(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    weighting: Weighting,
) -> Result<Vec<Vec3>, ShadeError> {
    if let Some(index) = positions.iter().position(|p| !p.is_finite()) {
        return Err(ShadeError::VertexNotFinite { index, value: positions[index].to_array() });
    }
    // Cross products are taken of sides divided by this, so that areas neither overflow nor underflow.
    let extent = extent(positions);
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for (triangle, corners) in triangles.iter().enumerate() {
        let points = corners_of(positions, triangle, *corners)?;
        for (&vertex, share) in corners.iter().zip(shares(points, weighting, extent)) {
            sums[vertex as usize] += share;
        }
    }
    Ok(sums.iter().map(|&sum| unit(sum).as_vec3()).collect())
}

/// What a triangle adds to the normals at its three corners. `extent` scales areas.
pub(crate) fn shares([a, b, c]: [DVec3; 3], weighting: Weighting, extent: f64) -> [DVec3; 3] {
    match weighting {
        Weighting::Area => [(half_side(a, b) / extent).cross(half_side(a, c) / extent); 3],
        Weighting::Plain => [face_normal(a, b, c); 3],
        Weighting::Angle => {
            let normal = face_normal(a, b, c);
            let angle = |at, to, and| unit(half_side(at, to)).angle_between(unit(half_side(at, and)));
            [angle(a, b, c), angle(b, c, a), angle(c, a, b)]
                .map(|w| if w.is_finite() { normal * w } else { DVec3::ZERO })
        }
    }
}

/// `normal`, or its opposite if that is the one on the side of `towards`.
#[must_use]
pub fn turn_to(normal: Vec3, towards: Vec3) -> Vec3 {
    if normal.dot(towards) < 0.0 { -normal } else { normal }
}

/// The two-sided rule: light arrives where the eye looks only if both are on the same side of the face.
///
/// `face` is the face normal turned to the eye; `to_light` points to the light.
#[must_use]
pub fn sees_light(face: Vec3, to_light: Vec3) -> bool {
    face.dot(to_light) > 0.0
}

pub(crate) fn corners_of(
    positions: &[DVec3],
    triangle: usize,
    corners: [u32; 3],
) -> Result<[DVec3; 3], ShadeError> {
    let mut points = [DVec3::ZERO; 3];
    for (point, vertex) in points.iter_mut().zip(corners) {
        *point = *positions.get(vertex as usize).ok_or(ShadeError::VertexOutOfRange {
            triangle,
            vertex,
            count: positions.len(),
        })?;
    }
    Ok(points)
}

pub(crate) fn extent(positions: &[DVec3]) -> f64 {
    let (low, high) = positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    let half = half_side(low, high).max_element();
    if half.is_finite() && half > 0.0 { half } else { 1.0 }
}

/// Half of `b − a`, because the whole may be infinite.
fn half_side(a: DVec3, b: DVec3) -> DVec3 {
    b * 0.5 - a * 0.5
}

/// The direction of a vector of any finite length, or zero.
pub(crate) fn unit(v: DVec3) -> DVec3 {
    let largest = v.abs().max_element();
    // Scaled first: the square of 1e200 is not a number we can use, nor is that of 1e-200.
    if largest == 0.0 || !largest.is_finite() { DVec3::ZERO } else { (v / largest).normalize() }
}
