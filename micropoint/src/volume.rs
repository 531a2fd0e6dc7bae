//! What can lie behind a rectangle of the grid.

use crate::bounds::Bounds;
use crate::face::GridRect;
use crate::lens::{Lens, LensKind};
use glam::DVec3;

/// The view volume of a rectangle of the grid, as planes through the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ViewVolume {
    origin: DVec3,
    forward: DVec3,
    planes: [(DVec3, f64); 4],
}

impl ViewVolume {
    /// The volume behind a rectangle of the grid.
    #[must_use]
    pub(crate) fn new(lens: &Lens, rect: &GridRect) -> Self {
        let side = |axis: DVec3, line: f64, sign: f64| match lens.kind {
            LensKind::Perspective => (sign * (axis - lens.forward * line), 0.0),
            LensKind::Orthographic => (sign * axis, -sign * line),
        };
        let (x, y) = (lens.right * lens.scale, lens.down * lens.scale);
        Self {
            origin: lens.origin,
            forward: lens.forward,
            planes: [
                side(x, rect.low.x - lens.centre.x, 1.0),
                side(x, rect.high.x - lens.centre.x, -1.0),
                side(y, rect.low.y - lens.centre.y, 1.0),
                side(y, rect.high.y - lens.centre.y, -1.0),
            ],
        }
    }

    /// Least depth of a box, or `None` if it is outside.
    #[must_use]
    #[inline]
    pub(crate) fn nearest_depth(&self, bounds: &Bounds) -> Option<f64> {
        for (normal, offset) in &self.planes {
            if bounds.extent_along(self.origin, *normal).most + offset < 0.0 {
                return None;
            }
        }
        let depth = bounds.extent_along(self.origin, self.forward);
        (depth.most >= 0.0).then_some(depth.least.max(0.0))
    }
}
