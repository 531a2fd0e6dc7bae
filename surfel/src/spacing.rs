//! How far apart points of a node may be drawn: limited by the size of pixels, the angle to the eye, and the blur.

use crate::camera::Camera;
use crate::node::Node;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// Points with a blur of radius R may be 3.5 + 0.4·R apart (pixels), but never more than 1.2·R. Found by experiment:
/// wider apart they show as dots.
const BLURRED_START: f32 = 3.5;
const BLURRED_SLOPE: f32 = 0.4;
const BLURRED_MOST: f32 = 1.2;

/// Points on a surface that is seen at an angle may be farther apart, so that as many fall on its pixels; but no
/// farther than at this cosine of the angle.
const LEAST_FACING: f32 = 0.5;

/// How much of the half angle of a node's normals is taken off the angle of their middle: a bent surface faces the eye
/// somewhere.
const BENT: f32 = 0.5;

/// For boxes in the axes of the picture.
pub(crate) const REACH_ROUNDED_UP: f32 = 1.0 + 1e-5;

/// What rounding may add to an angle.
const ROUNDING_RAD: f32 = 1e-3;

/// The largest distance, units. `level` is the number of pixels for points that are sharp.
pub(crate) fn largest_spacing(depths: &Depths, angles: &Angles, camera: &Camera, level: f32) -> f32 {
    let px = level.max(depths.blurred_spacing_px(camera, level));
    let at_an_angle = angles.typical_rad.cos().max(LEAST_FACING).sqrt();
    px / (at_an_angle * camera.pixels_per_unit(depths.0[0].max(camera.near)))
}

/// Relative depths of a node: of its nearest point and of its farthest.
pub(crate) struct Depths(pub(crate) [f32; 2]);

impl Depths {
    pub(crate) fn of(node: &Node, camera: &Camera) -> Self {
        let middle = (camera.local(node).z - camera.reference) as f32;
        let reach = camera.axes[2].abs().dot(node.half) * REACH_ROUNDED_UP;
        Self([middle - reach, middle + reach])
    }

    /// How far apart, in pixels, points may be for their blur.
    fn blurred_spacing_px(&self, camera: &Camera, level: f32) -> f32 {
        let [nearest, farthest] = self.0;
        if nearest <= camera.focus && camera.focus <= farthest {
            return 0.0;
        }
        let px = |depth: f32| camera.blur_radius(depth) * camera.pixels_per_unit(depth);
        let least_blur = px(nearest.max(camera.near)).min(px(farthest));
        let apart = (BLURRED_START + BLURRED_SLOPE * least_blur).min(BLURRED_MOST * least_blur);
        apart * level.min(1.0)
    }
}

/// Angles between the normals of a node and the direction to the eye, radians.
pub(crate) struct Angles {
    /// None is smaller.
    pub(crate) least_rad: f32,
    /// At most a right angle.
    typical_rad: f32,
}

impl Angles {
    pub(crate) fn of(node: &Node, camera: &Camera) -> Self {
        let Some(cone) = node.cone().filter(|_| !camera.sees_both_sides) else {
            return Self { least_rad: 0.0, typical_rad: 0.0 };
        };
        let axis = Vec3::from_array(camera.axes.map(|a| a.dot(cone.axis)));
        let (towards_eye, spread) = if camera.is_perspective {
            let to_eye = -camera.local(node).as_vec3();
            let (distance, radius) = (to_eye.length(), node.half.length());
            // For an eye inside the box, all directions occur.
            let spread = if distance > radius { (radius / distance).asin() } else { PI };
            (to_eye / distance.max(f32::MIN_POSITIVE), spread)
        } else {
            (Vec3::NEG_Z, 0.0)
        };
        let angle = axis.dot(towards_eye).clamp(-1.0, 1.0).acos();
        let least_rad = (angle - cone.half_angle_rad - spread - ROUNDING_RAD).max(0.0);
        let typical_rad = (angle - BENT * cone.half_angle_rad).clamp(0.0, FRAC_PI_2);
        Self { least_rad, typical_rad }
    }
}
