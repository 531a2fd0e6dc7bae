//! Flat, Gouraud and Phong shading: what is interpolated across a triangle.

use crate::{keep_visible, turn_to};
use glam::Vec3;

/// What is interpolated between the corners of a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Interpolation {
    /// Nothing: the face normal serves the whole triangle.
    #[default]
    Flat,
    /// Colors: corners are shaded, the inside is mixed.
    Gouraud,
    /// Normals: every point is shaded by itself.
    Phong,
}

/// The corners' colors mixed by barycentric weights: the inside of a Gouraud triangle.
#[must_use]
pub fn interpolate_color(corners: [Vec3; 3], weights: Vec3) -> Vec3 {
    corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z
}

/// The normal to shade with, from the corners' normals and barycentric weights: a unit vector that the eye can see.
///
/// `face` is the face normal already turned to the eye ([`turn_to`]), `to_eye` a unit vector. The mixed normal is
/// turned to the side of `face`, and where it still points away from the eye (near the silhouette of a coarse mesh)
/// it is tilted until it is at right angles to the view. Where the corners cancel out, `face` comes back. Three
/// corners that equal the face normal give it back to rounding, so Phong on a flat face is flat shading.
#[must_use]
pub fn interpolate_normal(corners: [Vec3; 3], weights: Vec3, face: Vec3, to_eye: Vec3) -> Vec3 {
    let mixed = interpolate_color(corners, weights).normalize_or_zero();
    if mixed == Vec3::ZERO {
        return face;
    }
    let normal = turn_to(mixed, face);
    keep_visible(normal, to_eye, face)
}
