//! The camera: where it is, how it projects, onto how many pixels.

use crate::axes::{right_and_up, unit_vector};
use crate::error::ViewError;
use crate::pixel_rect::PixelRect;
use crate::projection::Projection;
use glam::{DAffine3, DMat3, DVec2, DVec3};

/// A matrix counts as rigid if no entry of MᵀM is farther from the identity's: what rounding a rotation to `f32`
/// leaves.
const RIGID: f64 = 1e-6;

/// A camera and its picture.
///
/// The camera looks along its −Z with +Y up. Pixel positions are continuous, (0, 0) is the top left corner of the
/// picture. Depth is measured along the view direction, in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    projection: Projection,
    width: u32,
    height: u32,
    /// Follows from the projection and the height; kept because the tangent takes longer than the rest of a projection.
    focal_px: f64,
}

/// Where a point is in the picture: the answer of [`View::project`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Projected {
    /// Pixels from the top left corner, to the right and down; also outside the picture.
    pub pixel: DVec2,
    /// Distance from the eye along the view direction, world units.
    pub depth: f64,
}

/// All that is seen at one position of the picture: the answer of [`View::ray`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ray {
    /// The point at depth 0, world. The eye, for a perspective view.
    pub origin: DVec3,
    /// Change per unit of depth, world: not a unit vector, its component along the view direction is 1.
    pub direction: DVec3,
}

impl Ray {
    /// The point at a depth (along the view direction, world units).
    #[must_use]
    pub fn at(&self, depth: f64) -> DVec3 {
        self.origin + self.direction * depth
    }
}

impl View {
    /// Largest width and height of a picture in pixels. Pictures of that size are for renderers that go tile by tile;
    /// one that keeps the whole picture in memory has a limit of its own.
    pub const LARGEST_SIDE: u32 = 1 << 20;

    /// Largest absolute coordinate of eye and target, world units. Differences and distances then stay finite.
    pub const LARGEST_COORDINATE: f64 = 1e300;

    /// The axes have length 1, and are orthogonal, up to this.
    pub const AXIS_ERROR: f64 = 16.0 * f64::EPSILON;

    /// A camera at `eye` that looks at `target`, with `up` upwards in the picture. `up` may have any length.
    ///
    /// # Errors
    /// [`ViewError::BadEye`], [`ViewError::BadTarget`] for coordinates that are not finite or beyond
    /// [`View::LARGEST_COORDINATE`]; [`ViewError::EyeIsTarget`]; [`ViewError::BadUp`] if `up` is zero, not finite, or
    /// parallel to the view direction within 1.4e-14 rad; [`ViewError::BadFieldOfView`] or [`ViewError::BadHeight`] if
    /// the projection is outside its range; [`ViewError::BadSize`] if a side is 0 or above [`View::LARGEST_SIDE`].
    pub fn look_at(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        projection: Projection,
        width: u32,
        height: u32,
    ) -> Result<Self, ViewError> {
        if !is_in_range(eye) {
            return Err(ViewError::BadEye { eye });
        }
        if !is_in_range(target) {
            return Err(ViewError::BadTarget { target });
        }
        let forward = unit_vector(target - eye).ok_or(ViewError::EyeIsTarget { eye })?;
        Self::with_axes(eye, forward, up, projection, width, height)
    }

    /// A camera from the rigid motion that takes the world into its frame, as
    /// `glam::dcamera::rh::view::look_at_affine3` makes it.
    ///
    /// The 3×3 part M may be off a rotation by 1e-6 (|MᵀM − 1|, each entry), so that matrices that were `f32` pass; its
    /// axes are made orthonormal, the view direction first. The eye is the point that the matrix takes to the origin.
    ///
    /// # Errors
    /// [`ViewError::NotRigid`] if the matrix scales, shears or is not finite; [`ViewError::Mirrored`] if its
    /// determinant is negative; [`ViewError::BadEye`]; and for projection and size as [`View::look_at`].
    pub fn from_matrix(
        view_from_world: DAffine3,
        projection: Projection,
        width: u32,
        height: u32,
    ) -> Result<Self, ViewError> {
        let m = view_from_world.matrix3;
        let deviation = off_orthonormal(&m);
        if deviation.is_nan() || deviation > RIGID {
            return Err(ViewError::NotRigid { deviation });
        }
        let determinant = m.determinant();
        if determinant < 0.0 {
            return Err(ViewError::Mirrored { determinant });
        }
        let eye = m.inverse() * -view_from_world.translation;
        if !is_in_range(eye) {
            return Err(ViewError::BadEye { eye });
        }
        let forward = unit_vector(-m.row(2)).ok_or(ViewError::NotRigid { deviation })?;
        Self::with_axes(eye, forward, m.row(1), projection, width, height)
    }

    fn with_axes(
        eye: DVec3,
        forward: DVec3,
        up: DVec3,
        projection: Projection,
        width: u32,
        height: u32,
    ) -> Result<Self, ViewError> {
        let (right, up) = right_and_up(forward, up).ok_or(ViewError::BadUp { up, forward })?;
        projection.check()?;
        Self { eye, right, up, forward, projection, width, height, focal_px: 0.0 }.with_size(width, height)
    }

    /// The same camera with a picture of another size. What is seen from top to bottom stays; the width of the picture
    /// decides what is seen at its sides.
    ///
    /// # Errors
    /// [`ViewError::BadSize`] if a side is 0 or above [`View::LARGEST_SIDE`].
    pub fn with_size(self, width: u32, height: u32) -> Result<Self, ViewError> {
        let sides = 1..=Self::LARGEST_SIDE;
        if !(sides.contains(&width) && sides.contains(&height)) {
            return Err(ViewError::BadSize { width, height });
        }
        Ok(Self { width, height, focal_px: focal_px(self.projection, height), ..self })
    }

    /// Position of the camera, world units. For an orthographic view: a point of the plane of depth 0, seen in the
    /// middle.
    #[must_use]
    pub const fn eye(&self) -> DVec3 {
        self.eye
    }

    /// Unit vector of the view direction, world.
    #[must_use]
    pub const fn forward(&self) -> DVec3 {
        self.forward
    }

    /// Unit vector to the right in the picture, world.
    #[must_use]
    pub const fn right(&self) -> DVec3 {
        self.right
    }

    /// Unit vector upwards in the picture, world: against the direction in which rows are counted.
    #[must_use]
    pub const fn up(&self) -> DVec3 {
        self.up
    }

    /// How depth is mapped.
    #[must_use]
    pub const fn projection(&self) -> Projection {
        self.projection
    }

    /// Pixels from left to right.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Pixels from top to bottom.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// All pixels of the picture.
    #[must_use]
    pub const fn picture(&self) -> PixelRect {
        PixelRect::of_picture(self.width, self.height)
    }

    /// The pixel position of the view axis: the middle of the picture.
    #[must_use]
    pub fn centre_px(&self) -> DVec2 {
        0.5 * DVec2::new(f64::from(self.width), f64::from(self.height))
    }

    /// Pixels per world unit at depth 1 (perspective; at depth d it is this over d) or at any depth (orthographic).
    /// Pixels are square: the same in both directions.
    #[must_use]
    pub const fn focal_px(&self) -> f64 {
        self.focal_px
    }

    /// The rigid motion that takes the world into the frame of the camera, for [`View::from_matrix`] and for others'
    /// renderers.
    ///
    /// Its translation is the eye turned into the frame, and so rounded to a few ulps of the eye's largest coordinate.
    #[must_use]
    pub fn view_from_world(&self) -> DAffine3 {
        let world_from_view = DMat3::from_cols(self.right, self.up, -self.forward);
        let rotation = world_from_view.transpose();
        DAffine3::from_mat3_translation(rotation, -(rotation * self.eye))
    }

    /// Where a point of the world is in the picture.
    ///
    /// `None` if there is no such place: in a perspective view for depths up to 0, in any for a result beyond the range
    /// of `f64`. An orthographic view also has points behind the eye, with negative depths. Positions outside the
    /// picture are given, too.
    #[must_use]
    pub fn project(&self, point: DVec3) -> Option<Projected> {
        let from_eye = point - self.eye;
        let depth = from_eye.dot(self.forward);
        let across = DVec2::new(from_eye.dot(self.right), -from_eye.dot(self.up));
        let offset = match self.projection {
            Projection::Perspective { .. } if depth > 0.0 => across / depth,
            Projection::Perspective { .. } => return None,
            Projection::Orthographic { .. } => across,
        };
        let pixel = offset * self.focal_px() + self.centre_px();
        (pixel.is_finite() && depth.is_finite()).then_some(Projected { pixel, depth })
    }

    /// The point of the world at a pixel position (pixels from the top left corner) and a depth (world units along the
    /// view direction). Finite for finite arguments, unless the point is beyond the range of `f64`.
    #[must_use]
    pub fn unproject(&self, pixel: DVec2, depth: f64) -> DVec3 {
        self.ray(pixel).at(depth)
    }

    /// The line of all points that are seen at a pixel position: pixels from the top left corner, (0.5, 0.5) in the
    /// middle of the first pixel.
    #[must_use]
    pub fn ray(&self, pixel: DVec2) -> Ray {
        let offset = (pixel - self.centre_px()) / self.focal_px();
        match self.projection {
            Projection::Perspective { .. } => {
                Ray { origin: self.eye, direction: self.forward + self.right * offset.x - self.up * offset.y }
            }
            Projection::Orthographic { .. } => {
                Ray { origin: self.eye + self.right * offset.x - self.up * offset.y, direction: self.forward }
            }
        }
    }
}

/// See [`View::focal_px`].
fn focal_px(projection: Projection, picture_height: u32) -> f64 {
    let half = 0.5 * f64::from(picture_height);
    match projection {
        Projection::Perspective { fov_y_rad } => half / (0.5 * fov_y_rad).tan(),
        Projection::Orthographic { height } => half / (0.5 * height),
    }
}

fn is_in_range(point: DVec3) -> bool {
    point.abs().cmple(DVec3::splat(View::LARGEST_COORDINATE)).all()
}

/// Largest entry of |MᵀM − 1|; NaN if one is not finite.
fn off_orthonormal(m: &DMat3) -> f64 {
    let off = m.transpose() * *m - DMat3::IDENTITY;
    if off.is_finite() {
        off.to_cols_array().into_iter().fold(0.0, |worst, e| worst.max(e.abs()))
    } else {
        f64::NAN
    }
}
