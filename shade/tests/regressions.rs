//! What once went wrong, each with its smallest input.

use glam::{DVec3, Vec3, dvec3};
use pointillist_shade::{Falloff, Light, Weighting, face_normal, vertex_normals};
use std::num::NonZeroU32;

/// The cross product of the edges overflowed, and zero times infinity became the irradiance.
#[test]
fn a_rectangle_too_large_for_its_area_is_dark() {
    let light = Light::Rect {
        corner: DVec3::ZERO,
        edge_u: dvec3(f64::MAX, 0.0, f64::MAX),
        edge_v: dvec3(f64::MAX, f64::MIN_POSITIVE, 7.0),
        radiance: Vec3::ZERO,
        samples: NonZeroU32::new(1),
        falloff: Falloff::InverseSquare,
    };
    assert!(light.illuminate(0, DVec3::ZERO).is_dark());
}

/// Sides longer than `f64::MAX` became infinite, and their cross product NaN.
#[test]
fn a_triangle_across_the_whole_number_range_has_a_normal() {
    let corners = [dvec3(-f64::MAX, 0.0, 0.0), dvec3(f64::MAX, 0.0, 0.0), dvec3(0.0, f64::MAX, 0.0)];
    let normals = vertex_normals(&corners, &[[0, 1, 2]], Weighting::Area).unwrap();
    assert_eq!(normals, [Vec3::Z; 3]);
}

/// The squares of a nearly parallel pair of sides underflowed, and the normal was not of unit length.
#[test]
fn the_normal_of_a_sliver_has_unit_length() {
    let tiny = f64::MIN_POSITIVE;
    let n = face_normal(dvec3(tiny, tiny, 0.0), DVec3::ZERO, dvec3(0.0, 0.0, 1.0));
    assert!(n == DVec3::ZERO || (n.length() - 1.0).abs() < 1e-12, "{n}");
}
