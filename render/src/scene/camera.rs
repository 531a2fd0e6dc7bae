//! The camera of a scene.

use glam::DVec3;
use pointillist_view::{Projection, View, ViewError};

/// Where the eye is and what it takes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position in the world.
    pub eye: DVec3,
    /// The position that is looked at; differs from `eye`.
    pub target: DVec3,
    /// Up in the picture, of any length; neither zero nor parallel to the view direction.
    pub up: DVec3,
    /// Perspective with an angle, or orthographic with a height.
    pub projection: Projection,
}

impl Camera {
    /// A perspective camera with +Y up and this angle from the bottom of the picture to its top, in radians.
    #[must_use]
    pub fn perspective(eye: DVec3, target: DVec3, fov_y_rad: f64) -> Self {
        Self { eye, target, up: DVec3::Y, projection: Projection::Perspective { fov_y_rad } }
    }

    /// Right, up and backward: the axes of the camera in the world, orthonormal. The camera looks along −Z.
    #[must_use]
    pub fn axes(&self) -> [DVec3; 3] {
        let backward = (self.eye - self.target).normalize();
        let right = self.up.normalize().cross(backward).normalize();
        [right, backward.cross(right), backward]
    }

    /// The camera with a picture of this width and height in pixels.
    ///
    /// # Errors
    /// [`ViewError`] if a field is not as it says, or the picture is empty or larger than [`View::LARGEST_SIDE`].
    pub fn view(&self, [width, height]: [u32; 2]) -> Result<View, ViewError> {
        View::look_at(self.eye, self.target, self.up, self.projection, width, height)
    }
}
