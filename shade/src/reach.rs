//! Where a light cannot reach, told for a whole box of places at once.

use crate::light::{Light, direction_and_length};
use glam::{DVec3, Vec3};

/// Widens cones: much more than the angles of [`Light::illuminate`] are rounded by.
const ROUNDING_RAD: f64 = 1e-6;

/// The same for distances, in sizes of what they are between.
const ROUNDING: f64 = 1e-9;

impl Light {
    /// Whether anything may arrive within the box from `low` to `high`: `false` only where [`Self::illuminate`] is dark at every point of it.
    ///
    /// Lights of no intensity reach nothing, spots only what their cone meets, areas that shine on one side only what is before them.
    #[must_use]
    pub fn may_reach(&self, low: DVec3, high: DVec3) -> bool {
        if self.color() == Vec3::ZERO {
            return false;
        }
        match *self {
            Self::Spot { position, direction, beam_rad, cutoff_rad, exponent, .. } => {
                let cutoff_rad = beam_rad.max(cutoff_rad);
                let half =
                    if exponent > 0.0 { cutoff_rad.min(std::f64::consts::FRAC_PI_2) } else { cutoff_rad };
                cone_meets(position, direction, half, low, high)
            }
            Self::Rect { corner, edge_u, edge_v, .. } => is_before(corner, edge_u.cross(edge_v), low, high),
            Self::Polygon { outline, two_sided: false, .. } => {
                let front = outline.area_vector();
                outline.vertices().iter().any(|corner| is_before(*corner, front, low, high))
            }
            _ => true,
        }
    }
}

/// Whether a cone meets the sphere about a box.
fn cone_meets(apex: DVec3, axis: DVec3, half_rad: f64, low: DVec3, high: DVec3) -> bool {
    let centre = 0.5 * low + 0.5 * high;
    let radius = (0.5 * high - 0.5 * low).length();
    let (axis, _) = direction_and_length(axis);
    let (away, distance) = direction_and_length(centre - apex);
    let outside = radius * (1.0 + ROUNDING) < distance && distance.is_finite();
    let angle = axis.cross(away).length().atan2(axis.dot(away));
    // What is not a number may be reached.
    !(outside && angle - (radius / distance).asin() > half_rad + ROUNDING_RAD)
}

/// Whether a corner of the box is on the side of a plane that its normal points to, or in the plane.
fn is_before(on_plane: DVec3, normal: DVec3, low: DVec3, high: DVec3) -> bool {
    let farthest = DVec3::select(normal.cmpgt(DVec3::ZERO), high, low);
    let size = (on_plane.abs() + low.abs() + high.abs()).max_element() * normal.length();
    let distance = (farthest - on_plane).dot(normal);
    distance.is_nan() || distance >= -ROUNDING * size
}
