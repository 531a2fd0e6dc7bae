//! Depth of field: which depth is sharp, and how much others blur.

use crate::error::SurfelError;

/// Depth of field.
///
/// Both forms blur a point at depth l, focused at depth f, over a disc of radius d·|l − f| in the plane of the
/// point; a thin lens of aperture radius a has d = a/f.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Focus {
    /// Everything is sharp.
    #[default]
    Everywhere,
    /// The paper's parameter.
    Depth {
        /// d: radius of the blur per unit of distance from the focus. 0 is sharp everywhere.
        depth: f64,
        /// f: depth that is sharp, world units.
        focus: f64,
    },
    /// A thin lens.
    Lens {
        /// Radius, world units. 0 is a pinhole.
        aperture: f64,
        /// Depth that is sharp, world units.
        focus: f64,
    },
}

impl Focus {
    /// A photographer's lens: `focal_length / f_number` is the diameter of its opening. All lengths in world units.
    #[must_use]
    pub fn photographic(focal_length: f64, f_number: f64, focus: f64) -> Self {
        Self::Lens { aperture: 0.5 * focal_length / f_number, focus }
    }

    /// The blur per distance d and the depth in focus f; d = 0 for sharp pictures.
    pub(crate) fn depth_and_focus(&self) -> (f64, f64) {
        match *self {
            Self::Everywhere => (0.0, 1.0),
            Self::Depth { depth, focus } => (depth, focus),
            Self::Lens { aperture, focus } => (aperture / focus, focus),
        }
    }

    pub(crate) fn check(&self) -> Result<(), SurfelError> {
        let (name, amount, focus) = match *self {
            Self::Everywhere => return Ok(()),
            Self::Depth { depth, focus } => ("depth", depth, focus),
            Self::Lens { aperture, focus } => ("aperture", aperture, focus),
        };
        if !(amount >= 0.0 && amount.is_finite()) {
            return Err(SurfelError::BadOption {
                name,
                value: amount,
                range: "it must be at least 0 and finite",
            });
        }
        if !(focus > 0.0 && focus.is_finite()) {
            let range = "it must be before the camera, above 0 and finite";
            return Err(SurfelError::BadOption { name: "focus", value: focus, range });
        }
        Ok(())
    }
}

/// Full field of view in radians of a lens that is focused: a sensor of this height stands behind it at the distance
/// 1/(1/focal length − 1/focus). All lengths in one unit; the focus may be infinite. `None` if it is not beyond the
/// focal length.
#[must_use]
pub fn field_of_view_rad(focal_length: f64, sensor_height: f64, focus: f64) -> Option<f64> {
    let image_distance = focal_length / (1.0 - focal_length / focus);
    (focus > focal_length && focal_length > 0.0 && sensor_height > 0.0)
        .then(|| 2.0 * (0.5 * sensor_height / image_distance).atan())
}
