//! The camera: a rigid map, a projection and a size.

use crate::error::SurfelError;
use glam::{DAffine3, DMat3, DVec3};

/// How the camera maps depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Full vertical field of view in radians.
    Perspective {
        /// Between 0 and π.
        fov_y_rad: f64,
    },
    /// World units from the top of the picture to its bottom.
    Orthographic {
        /// Greater than 0.
        height: f64,
    },
}

/// A camera and its picture. The camera looks along its −Z with +Y up; pixel (0, 0) is top left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    pub(crate) eye: DVec3,
    /// World axes of the picture: to the right, down, into the scene.
    pub(crate) right: DVec3,
    pub(crate) down: DVec3,
    pub(crate) forward: DVec3,
    pub(crate) projection: Projection,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl View {
    /// Largest side of a picture in pixels.
    pub const LARGEST_SIDE: u32 = 16384;

    /// A camera from the rigid map of the world into its frame, as `glam::dcamera::rh::view::look_at_affine3` makes it.
    ///
    /// # Errors
    /// [`SurfelError::BadView`] if the map is not a rotation and a shift, or the projection outside its range;
    /// [`SurfelError::BadSize`] for an empty picture or a side above [`View::LARGEST_SIDE`].
    pub fn new(
        view_from_world: DAffine3,
        projection: Projection,
        width: u32,
        height: u32,
    ) -> Result<Self, SurfelError> {
        let m = view_from_world.matrix3;
        let rigid = (m.transpose() * m).abs_diff_eq(DMat3::IDENTITY, 1e-6) && m.determinant() > 0.0;
        if !(view_from_world.is_finite() && rigid) {
            return Err(SurfelError::BadView { reason: "the matrix is not a rotation and a shift" });
        }
        let good = match projection {
            Projection::Perspective { fov_y_rad } => fov_y_rad > 0.0 && fov_y_rad < std::f64::consts::PI,
            Projection::Orthographic { height } => height > 0.0 && height.is_finite(),
        };
        if !good {
            let reason = "the field of view must be between 0 and π, an orthographic height above 0";
            return Err(SurfelError::BadView { reason });
        }
        let sides = 1..=Self::LARGEST_SIDE;
        if !(sides.contains(&width) && sides.contains(&height)) {
            return Err(SurfelError::BadSize { width, height });
        }
        let axes = m.transpose();
        let eye = -(axes * view_from_world.translation);
        let (right, down, forward) = (axes.x_axis, -axes.y_axis, -axes.z_axis);
        Ok(Self { eye, right, down, forward, projection, width, height })
    }

    /// The eye in the world.
    #[must_use]
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// Unit view direction.
    #[must_use]
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// Pixels from left to right.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels from top to bottom.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    pub(crate) fn is_perspective(&self) -> bool {
        matches!(self.projection, Projection::Perspective { .. })
    }

    /// Pixels per world unit at depth 1 (perspective) or at any depth (orthographic).
    pub(crate) fn focal_px(&self) -> f64 {
        let half = 0.5 * f64::from(self.height);
        match self.projection {
            Projection::Perspective { fov_y_rad } => half / (0.5 * fov_y_rad).tan(),
            Projection::Orthographic { height } => half * 2.0 / height,
        }
    }

    /// Coordinates along right, down and forward of a direction.
    pub(crate) fn turned(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.right), v.dot(self.down), v.dot(self.forward))
    }
}
