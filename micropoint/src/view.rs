//! Camera, picture size and the part of it that is asked for.

use crate::error::MicropointError;
use crate::lens::{Lens, LensKind};
use glam::{DAffine3, DVec2, DVec3};

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
    pub(crate) right: DVec3,
    pub(crate) up: DVec3,
    pub(crate) forward: DVec3,
    pub(crate) projection: Projection,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl View {
    /// A camera at `eye` that looks at `target`.
    ///
    /// # Errors
    /// [`MicropointError::BadView`] if the directions do not span a frame or the projection is
    /// outside its range; [`MicropointError::BadSize`] for an empty picture or one of more than 2²⁰
    /// pixels on a side.
    pub fn look_at(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        projection: Projection,
        width: u32,
        height: u32,
    ) -> Result<Self, MicropointError> {
        let bad = |reason| Err(MicropointError::BadView { reason });
        if !(eye.is_finite() && target.is_finite() && up.is_finite()) {
            return bad("eye, target and up must be finite");
        }
        let Some(forward) = (target - eye).try_normalize() else {
            return bad("eye and target coincide");
        };
        Self::with_axes(eye, forward, up, projection, width, height)
    }

    fn with_axes(
        eye: DVec3,
        forward: DVec3,
        up: DVec3,
        projection: Projection,
        width: u32,
        height: u32,
    ) -> Result<Self, MicropointError> {
        let bad = |reason| Err(MicropointError::BadView { reason });
        let Some(right) = forward.cross(up.normalize_or_zero()).try_normalize() else {
            return bad("up is zero or parallel to the view direction");
        };
        let good = match projection {
            Projection::Perspective { fov_y_rad } => fov_y_rad > 0.0 && fov_y_rad < std::f64::consts::PI,
            Projection::Orthographic { height } => height > 0.0 && height.is_finite(),
        };
        if !good {
            return bad("the field of view must be between 0 and π, an orthographic height above 0");
        }
        const LARGEST: u32 = 1 << 20;
        if width == 0 || height == 0 || width > LARGEST || height > LARGEST {
            return Err(MicropointError::BadSize { width, height });
        }
        Ok(Self { eye, right, up: right.cross(forward), forward, projection, width, height })
    }

    /// A camera from a rigid transform of the world into its frame.
    ///
    /// # Errors
    /// As [`View::look_at`]; [`MicropointError::BadView`] also if the matrix is not a rotation.
    pub fn from_matrix(
        view_from_world: DAffine3,
        projection: Projection,
        width: u32,
        height: u32,
    ) -> Result<Self, MicropointError> {
        let m = view_from_world.matrix3;
        let rotation = m.transpose().mul_mat3(&m);
        if !view_from_world.is_finite() || !rotation.abs_diff_eq(glam::DMat3::IDENTITY, 1e-6) {
            return Err(MicropointError::BadView { reason: "the view matrix is not rigid" });
        }
        let world_from_view = view_from_world.inverse();
        let (eye, axes) = (world_from_view.translation, world_from_view.matrix3);
        Self::with_axes(eye, -axes.z_axis, axes.y_axis, projection, width, height)
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

    /// The projection onto a grid of `cells` × `cells` cells a pixel.
    #[must_use]
    pub fn lens(&self, cells: u32) -> Lens {
        let size = DVec2::new(f64::from(self.width), f64::from(self.height)) * f64::from(cells);
        let (kind, half_height) = match self.projection {
            Projection::Perspective { fov_y_rad } => (LensKind::Perspective, (0.5 * fov_y_rad).tan()),
            Projection::Orthographic { height } => (LensKind::Orthographic, 0.5 * height),
        };
        Lens {
            kind,
            origin: self.eye,
            right: self.right,
            down: -self.up,
            forward: self.forward,
            // Pixels are square: the width follows from the height.
            scale: 0.5 * size.y / half_height,
            centre: 0.5 * size,
            reach: 1.0,
        }
    }

    /// Direction (not normalised) from the eye through a pixel position, and where the ray starts.
    #[must_use]
    pub fn ray(&self, pixel: DVec2) -> (DVec3, DVec3) {
        let lens = self.lens(1);
        let p = (pixel - lens.centre) / lens.scale;
        match lens.kind {
            LensKind::Perspective => (self.eye, self.forward + lens.right * p.x + lens.down * p.y),
            LensKind::Orthographic => (self.eye + lens.right * p.x + lens.down * p.y, self.forward),
        }
    }
}

/// A rectangle of pixels: columns `x0..x1`, rows `y0..y1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl PixelRect {
    /// Pixels from left to right.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.x1.saturating_sub(self.x0)
    }

    /// Pixels from top to bottom.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.y1.saturating_sub(self.y0)
    }

    /// What both rectangles hold.
    #[must_use]
    pub fn within(&self, other: PixelRect) -> Self {
        let (x0, y0) = (self.x0.max(other.x0), self.y0.max(other.y0));
        Self { x0, y0, x1: self.x1.min(other.x1).max(x0), y1: self.y1.min(other.y1).max(y0) }
    }

    /// What this rectangle has in common with another.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let (x0, y0) = (self.x0.max(other.x0), self.y0.max(other.y0));
        Self { x0, y0, x1: self.x1.min(other.x1).max(x0), y1: self.y1.min(other.y1).max(y0) }
    }

    /// The tiles of this rectangle, row by row. Tiles are aligned to the whole picture, so that a
    /// crop is made of the same tiles. A size of 0 counts as 1.
    pub fn tiles(&self, size: u32) -> impl Iterator<Item = PixelRect> + use<> {
        let rect = *self;
        let size = size.max(1);
        let first = move |v: u32| v / size * size;
        (first(rect.y0)..rect.y1).step_by(size as usize).flat_map(move |y| {
            (first(rect.x0)..rect.x1).step_by(size as usize).map(move |x| PixelRect {
                x0: x.max(rect.x0),
                y0: y.max(rect.y0),
                x1: x.saturating_add(size).min(rect.x1),
                y1: y.saturating_add(size).min(rect.y1),
            })
        })
    }
}
