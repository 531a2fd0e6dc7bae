//! From the world to a grid of cells and back: one kind of lens for cameras and for lights.

use crate::bounds::Bounds;
use glam::{DVec2, DVec3};
use pointillist_view::{Projection, View};

/// How depth turns into the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LensKind {
    /// Rays meet in the origin. Nearness is 1/depth.
    Perspective,
    /// Rays are parallel. Nearness is −depth.
    Orthographic,
}

/// A projection from the world onto a plane of unit cells.
///
/// Besides the position in the grid it gives the *nearness* of a point, which grows towards the
/// viewer and is **affine in grid coordinates on any plane**, so that comparing depths inside a cell
/// means comparing two planes. All of it is f64 and relative to the lens's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Perspective or orthographic.
    pub kind: LensKind,
    /// Where the rays meet, or any point of the plane of depth 0; world.
    pub origin: DVec3,
    /// Unit vector along +x of the grid; world.
    pub right: DVec3,
    /// Unit vector along +y of the grid (down in an image); world.
    pub down: DVec3,
    /// Unit vector of the view direction; world.
    pub forward: DVec3,
    /// Cells per unit of x/depth (perspective) or per world unit (orthographic), on both axes.
    pub scale: f64,
    /// Grid position of the view axis.
    pub centre: DVec2,
    /// Largest distance from the origin that matters: what rounding of an orthographic depth is
    /// relative to. Ignored by a perspective lens.
    pub reach: f64,
}

/// An affine function of the grid position, `a + b·x + c·y`, about the lens's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Value at the grid's centre.
    pub at_centre: f64,
    /// Change per cell.
    pub slope: DVec2,
    /// The grid's centre.
    pub centre: DVec2,
}

impl Plane {
    /// The value at a grid position.
    #[must_use]
    #[inline]
    pub fn at(&self, p: DVec2) -> f64 {
        self.at_centre + self.slope.dot(p - self.centre)
    }
}

/// A rectangle of the grid that holds the image of a box: the answer of [`Lens::shadow_of_box`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxImage {
    /// Smallest coordinates on the grid.
    pub low: DVec2,
    /// Largest coordinates on the grid.
    pub high: DVec2,
    /// Largest nearness in the box.
    pub nearest: f64,
}

impl Lens {
    /// The projection of a view onto a grid of `cells` × `cells` cells a pixel.
    #[must_use]
    pub fn of_view(view: &View, cells: u32) -> Self {
        let cells = f64::from(cells);
        let kind = match view.projection() {
            Projection::Perspective { .. } => LensKind::Perspective,
            Projection::Orthographic { .. } => LensKind::Orthographic,
        };
        Self {
            kind,
            origin: view.eye(),
            right: view.right(),
            down: -view.up(),
            forward: view.forward(),
            scale: view.focal_px() * cells,
            centre: view.centre_px() * cells,
            reach: 1.0,
        }
    }

    /// The point in the lens's frame: right, down, depth.
    #[must_use]
    #[inline]
    pub fn local(&self, world: DVec3) -> DVec3 {
        self.local_vector(world - self.origin)
    }

    /// A vector from the origin in the lens's frame.
    #[must_use]
    #[inline]
    pub fn local_vector(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.right.dot(v), self.down.dot(v), self.forward.dot(v))
    }

    /// Grid position of a point in the lens's frame. Perspective: its depth must be positive.
    #[must_use]
    #[inline]
    pub fn project(&self, local: DVec3) -> DVec2 {
        let p = DVec2::new(local.x, local.y);
        match self.kind {
            LensKind::Perspective => p * (self.scale / local.z) + self.centre,
            LensKind::Orthographic => p * self.scale + self.centre,
        }
    }

    /// Nearness of a point at this depth.
    #[must_use]
    #[inline]
    pub fn nearness(&self, depth: f64) -> f64 {
        match self.kind {
            LensKind::Perspective => 1.0 / depth,
            LensKind::Orthographic => -depth,
        }
    }

    /// Depth of a nearness.
    #[must_use]
    #[inline]
    pub fn depth(&self, nearness: f64) -> f64 {
        self.nearness(nearness)
    }

    /// The point at a grid position and nearness, in the lens's frame.
    #[must_use]
    #[inline]
    pub fn unproject(&self, grid: DVec2, nearness: f64) -> DVec3 {
        let p = grid - self.centre;
        match self.kind {
            LensKind::Perspective => {
                let depth = 1.0 / nearness;
                let unit = depth / self.scale;
                DVec3::new(p.x * unit, p.y * unit, depth)
            }
            LensKind::Orthographic => DVec3::new(p.x / self.scale, p.y / self.scale, -nearness),
        }
    }

    /// A vector of the lens's frame in world axes.
    #[must_use]
    #[inline]
    pub fn to_world_axes(&self, local: DVec3) -> DVec3 {
        self.right * local.x + self.down * local.y + self.forward * local.z
    }

    /// Nearness as a function of the grid position on the plane of a triangle (lens frame).
    ///
    /// For a perspective lens every point of the plane satisfies `n·p = n·v`; with p = depth·(X, Y, 1)
    /// the nearness is `n·(X, Y, 1) / n·v`. A plane that contains the origin is seen edge-on and has
    /// no area; it gets a constant.
    #[must_use]
    #[inline]
    pub fn plane(&self, v: [DVec3; 3]) -> Plane {
        let n = (v[1] - v[0]).cross(v[2] - v[0]);
        let (numerator, divisor) = match self.kind {
            LensKind::Perspective => (n, n.dot(v[0])),
            LensKind::Orthographic => (DVec3::new(n.x, n.y, -n.dot(v[0])), n.z),
        };
        let inverse = 1.0 / divisor;
        let plane = Plane {
            at_centre: numerator.z * inverse,
            slope: DVec2::new(numerator.x, numerator.y) * (inverse / self.scale),
            centre: self.centre,
        };
        if plane.at_centre.is_finite() && plane.slope.is_finite() {
            plane
        } else {
            let mean_depth = (v[0].z + v[1].z + v[2].z) / 3.0;
            Plane { at_centre: self.nearness(mean_depth), slope: DVec2::ZERO, centre: self.centre }
        }
    }

    /// Where a box is on the grid; `None` if it reaches behind the lens.
    #[must_use]
    pub fn shadow_of_box(&self, bounds: &Bounds) -> Option<BoxImage> {
        let x = bounds.extent_along(self.origin, self.right);
        let y = bounds.extent_along(self.origin, self.down);
        let z = bounds.extent_along(self.origin, self.forward);
        let (low, high) = (DVec2::new(x.least, y.least), DVec2::new(x.most, y.most));
        match self.kind {
            LensKind::Orthographic => {
                let (low, high) = (low * self.scale + self.centre, high * self.scale + self.centre);
                Some(BoxImage { low, high, nearest: -z.least })
            }
            LensKind::Perspective if z.least > 0.0 => {
                // Each side is farthest from the axis at the near or at the far end of the box.
                let (near, far) = (self.scale / z.least, self.scale / z.most);
                let low = (low * near).min(low * far) + self.centre;
                let high = (high * near).max(high * far) + self.centre;
                Some(BoxImage { low, high, nearest: 1.0 / z.least })
            }
            LensKind::Perspective => None,
        }
    }

    /// Below which difference two nearnesses of this size count as equal.
    ///
    /// Depths of one plane computed through two triangles differ by rounding only: a few ulp of the
    /// largest coordinate involved, and of the slope times the size of a grid position's rounding.
    #[must_use]
    #[inline]
    pub fn tie(&self, nearness: f64, slope: DVec2) -> f64 {
        let size = match self.kind {
            LensKind::Perspective => nearness.abs(),
            LensKind::Orthographic => self.reach,
        };
        TIE * size + GRID_ROUNDING * (slope.x.abs() + slope.y.abs())
    }
}

/// Relative difference of nearness up to which two surfaces coincide (see [`Lens::tie`]).
pub(crate) const TIE: f64 = 1e-10;

/// Rounding of grid positions in cells, with a margin: 1e5 cells × 2⁻⁵² × 4.
const GRID_ROUNDING: f64 = 1e-10;

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{dvec2, dvec3};

    fn lenses() -> [Lens; 2] {
        let lens = Lens {
            kind: LensKind::Perspective,
            origin: dvec3(1e6, -2e6, 3e6),
            right: DVec3::X,
            down: DVec3::NEG_Y,
            forward: DVec3::NEG_Z,
            scale: 200.0,
            centre: dvec2(128.0, 100.0),
            reach: 10.0,
        };
        [lens, Lens { kind: LensKind::Orthographic, ..lens }]
    }

    #[test]
    fn unprojection_undoes_projection() {
        for lens in lenses() {
            let world = lens.origin + dvec3(0.5, 0.25, -3.0);
            let local = lens.local(world);
            let back = lens.unproject(lens.project(local), lens.nearness(local.z));
            assert!((lens.to_world_axes(back) + lens.origin - world).length() < 1e-9);
        }
    }

    #[test]
    fn nearness_is_affine_on_a_plane() {
        for lens in lenses() {
            let v = [dvec3(0.0, 0.0, 2.0), dvec3(1.0, 0.0, 5.0), dvec3(0.0, 2.0, 3.0)];
            let plane = lens.plane(v);
            let p = v[0] * 0.2 + v[1] * 0.5 + v[2] * 0.3;
            assert!((plane.at(lens.project(p)) - lens.nearness(p.z)).abs() < 1e-13);
        }
    }
}
