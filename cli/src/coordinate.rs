//! The range of coordinates that are accepted.

use glam::DVec3;

/// The largest coordinate that can be used. Squares of larger ones do not fit into the 32-bit numbers of pixels.
pub const LARGEST: f64 = 1e18;

/// Whether a place can be used: no coordinate is NaN, infinite or beyond ±[`LARGEST`].
#[must_use]
pub fn is_usable(place: DVec3) -> bool {
    place.abs().cmple(DVec3::splat(LARGEST)).all()
}
