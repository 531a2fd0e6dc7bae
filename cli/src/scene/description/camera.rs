//! `[camera]`.

use super::path::CameraPath;
use crate::input_error::InputError;
use crate::scene::Projection;
use crate::scene::text::Table;
use glam::DVec3;

/// Vertical field of view of a camera that does not say.
pub const DEFAULT_FOV_DEG: f64 = 45.0;

/// Coordinates of eye and target are at most this, so that their differences and squares stay finite.
const LARGEST_COORDINATE: f64 = 1e100;

/// Sine of the smallest angle between `up` and the view direction: below it the picture's roll is noise.
const SMALLEST_UP_SINE: f64 = 1e-9;

/// A camera, perhaps without a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraDescription {
    /// `None`: chosen so that everything is in view.
    pub eye: Option<DVec3>,
    /// `None`: the middle of the scene.
    pub target: Option<DVec3>,
    /// Up in the picture.
    pub up: DVec3,
    /// Field of view or height.
    pub projection: Option<Projection>,
}

impl CameraDescription {
    pub(super) fn read(root: &mut Table<'_>) -> Result<(Self, Option<CameraPath>), InputError> {
        let Some(mut table) = root.table("camera")? else {
            return Ok((Self { eye: None, target: None, up: DVec3::Y, projection: None }, None));
        };
        let eye = place(&mut table, "eye")?;
        let target = place(&mut table, "target")?;
        let up = table.direction("up")?;
        let fov =
            table.number_where("fov", "more than 0 and less than 180 (degrees)", |n| n > 0.0 && n < 180.0)?;
        let height = table.number_where("height", "more than 0", |n| n > 0.0)?;
        let projection = match (fov, height) {
            (Some(_), Some(_)) => {
                let message = "`camera.fov` and `camera.height` are both given; the view is either perspective or parallel";
                return Err(table.error("height", message).with_help("remove one of them"));
            }
            (Some(fov), None) => Some(Projection::Perspective { fov_y_rad: fov.to_radians() }),
            (None, Some(height)) => Some(Projection::Orthographic { height }),
            (None, None) => None,
        };
        if let (Some(eye), Some(target)) = (eye, target) {
            check(&table, eye, target, up.unwrap_or(DVec3::Y))?;
        }
        let path = CameraPath::read(&mut table)?;
        table.finish()?;
        Ok((Self { eye, target, up: up.unwrap_or(DVec3::Y), projection }, path))
    }
}

fn place(table: &mut Table<'_>, key: &'static str) -> Result<Option<DVec3>, InputError> {
    let Some(point) = table.vector(key)? else { return Ok(None) };
    if point.abs().max_element() > LARGEST_COORDINATE {
        let message = format!("`camera.{key}` is beyond {LARGEST_COORDINATE:e}");
        return Err(table.error(key, message));
    }
    Ok(Some(point))
}

fn check(table: &Table<'_>, eye: DVec3, target: DVec3, up: DVec3) -> Result<(), InputError> {
    match view_fault(eye, target, up) {
        None => Ok(()),
        Some(fault) => {
            let key = if eye == target { "target" } else { "up" };
            Err(table.error(key, format!("`camera.{key}`: {fault}")))
        }
    }
}

/// What is wrong with a camera in this place, if anything.
pub(crate) fn view_fault(eye: DVec3, target: DVec3, up: DVec3) -> Option<&'static str> {
    let unit = |v: DVec3| (v / v.abs().max_element()).normalize_or_zero();
    let view = unit(target - eye);
    if eye == target || view == DVec3::ZERO {
        Some("eye and target are the same point, so there is no direction to look in")
    } else if view.cross(unit(up)).length() < SMALLEST_UP_SINE {
        Some("`up` is parallel to the view direction, so the picture has no upright; set another `camera.up`")
    } else {
        None
    }
}
