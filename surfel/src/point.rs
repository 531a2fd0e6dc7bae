//! A point of a mesh.

use glam::DVec3;
use std::ops::{Add, Mul};

/// A sample of a mesh: where it is, and a disc about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// On the triangle, up to rounding; world.
    pub position: DVec3,
    /// Unit normal of the triangle, on the side from which its corners run counter-clockwise.
    pub normal: DVec3,
    /// The triangle's number in the caller's list.
    pub triangle: u32,
    /// Weights of the triangle's corners: not negative, sum 1.
    pub barycentric: DVec3,
    /// Radius of its disc, world units: all discs together leave no gap on a smooth surface. Rounded up.
    pub radius: f32,
}

impl SurfacePoint {
    /// An attribute at the point, from its values at the triangle's three corners.
    ///
    /// ```
    /// # use glam::DVec3;
    /// # let options = pointillist_surfel::SampleOptions::DEFAULT.with_count(1);
    /// # let point = pointillist_surfel::sample(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]], &options)?[0];
    /// let x_of_corners = [0.0, 1.0, 0.0];
    /// assert!((point.interpolate(x_of_corners) - point.position.x).abs() < 1e-15);
    /// # Ok::<(), pointillist_surfel::SurfelError>(())
    /// ```
    #[must_use]
    pub fn interpolate<T: Mul<f64, Output = T> + Add<Output = T>>(&self, corners: [T; 3]) -> T {
        let [a, b, c] = corners;
        a * self.barycentric.x + b * self.barycentric.y + c * self.barycentric.z
    }
}
