//! The camera of a request: `WIDTH HEIGHT EYE TARGET`, with +Y upwards.

use crate::SiteError;
use crate::request::Request;
use glam::DVec3;
use pointillist_view::{Projection, View};

/// Largest side of a picture, pixels.
const MOST: u32 = 2048;
/// Full field of view from the top of the picture to its bottom.
const FOV_Y_RAD: f64 = 0.6;

pub(crate) fn read(request: &mut Request<'_>) -> Result<View, SiteError> {
    let (width, height) = (request.count("width", 1, MOST)?, request.count("height", 1, MOST)?);
    let (eye, target) = (request.vector("eye")?, request.vector("target")?);
    let projection = Projection::Perspective { fov_y_rad: FOV_Y_RAD };
    Ok(View::look_at(eye, target, DVec3::Y, projection, width, height)?)
}
