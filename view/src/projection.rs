//! How depth turns into the picture.

use crate::error::ViewError;
use std::f64::consts::PI;

/// How the camera maps depth.
///
/// Renderers match on it: another kind of projection would be a breaking change, on purpose, since each has to say what
/// it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays meet in the eye.
    Perspective {
        /// Full vertical field of view in radians: at least 1e-300, less than π.
        fov_y_rad: f64,
    },
    /// Rays are parallel.
    Orthographic {
        /// World units from the top of the picture to its bottom: 1e-300 to 1e300.
        height: f64,
    },
}

impl Projection {
    /// Fields of view and heights from here keep the number of pixels per world unit finite for every picture size.
    const SMALLEST: f64 = 1e-300;
    /// Largest orthographic height, for the same reason.
    const LARGEST_HEIGHT: f64 = 1e300;

    /// Whether rays meet in the eye.
    #[must_use]
    pub const fn is_perspective(&self) -> bool {
        matches!(self, Self::Perspective { .. })
    }

    pub(crate) fn check(&self) -> Result<(), ViewError> {
        match *self {
            Self::Perspective { fov_y_rad } if !(Self::SMALLEST..PI).contains(&fov_y_rad) => {
                Err(ViewError::BadFieldOfView { fov_y_rad })
            }
            Self::Orthographic { height } if !(Self::SMALLEST..=Self::LARGEST_HEIGHT).contains(&height) => {
                Err(ViewError::BadHeight { height })
            }
            _ => Ok(()),
        }
    }
}
