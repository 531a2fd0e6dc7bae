//! Camera and picture size, and the linear map from the world to a buffer of any size.

use crate::error::IbprError;
use glam::{DAffine3, DMat3, DVec3};

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
    /// Largest side of a picture in pixels.
    pub const LARGEST_SIDE: u32 = 16384;

    /// A camera at `eye` that looks at `target`.
    ///
    /// # Errors
    /// [`IbprError::BadView`] if the directions do not span a frame or the projection is outside its
    /// range; [`IbprError::BadSize`] for an empty picture or a side above [`View::LARGEST_SIDE`].
    pub fn look_at(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        projection: Projection,
        width: u32,
        height: u32,
    ) -> Result<Self, IbprError> {
        let bad = |reason| Err(IbprError::BadView { reason });
        if !(eye.is_finite() && target.is_finite() && up.is_finite()) {
            return bad("eye, target and up must be finite");
        }
        let Some(forward) = unit_vector(target - eye) else {
            return bad("eye and target coincide");
        };
        Self::with_axes(eye, forward, up, projection, width, height)
    }

    /// A camera from a rigid transform of the world into its frame.
    ///
    /// # Errors
    /// As [`View::look_at`]; [`IbprError::BadView`] also if the matrix is not a rotation.
    pub fn from_matrix(
        view_from_world: DAffine3,
        projection: Projection,
        width: u32,
        height: u32,
    ) -> Result<Self, IbprError> {
        let m = view_from_world.matrix3;
        if !view_from_world.is_finite() || !(m.transpose() * m).abs_diff_eq(DMat3::IDENTITY, 1e-6) {
            return Err(IbprError::BadView { reason: "the view matrix is not rigid" });
        }
        let world_from_view = view_from_world.inverse();
        let axes = world_from_view.matrix3;
        Self::with_axes(world_from_view.translation, -axes.z_axis, axes.y_axis, projection, width, height)
    }

    fn with_axes(
        eye: DVec3,
        forward: DVec3,
        up: DVec3,
        projection: Projection,
        width: u32,
        height: u32,
    ) -> Result<Self, IbprError> {
        let bad = |reason| Err(IbprError::BadView { reason });
        let Some(right) = unit_vector(up).and_then(|up| forward.cross(up).try_normalize()) else {
            return bad("up is zero or parallel to the view direction");
        };
        let good = match projection {
            Projection::Perspective { fov_y_rad } => fov_y_rad > 0.0 && fov_y_rad < std::f64::consts::PI,
            Projection::Orthographic { height } => height > 0.0 && height.is_finite(),
        };
        if !good {
            return bad("the field of view must be between 0 and π, an orthographic height above 0");
        }
        let sides = 1..=Self::LARGEST_SIDE;
        if !(sides.contains(&width) && sides.contains(&height)) {
            return Err(IbprError::BadSize { width, height });
        }
        Ok(Self { eye, right, up: right.cross(forward), forward, projection, width, height })
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

    /// Pixels per world unit at depth 1 (perspective) or at any depth (orthographic).
    pub(crate) fn focal_px(&self) -> f64 {
        let half = 0.5 * f64::from(self.height);
        match self.projection {
            Projection::Perspective { fov_y_rad } => half / (0.5 * fov_y_rad).tan(),
            Projection::Orthographic { height } => half * 2.0 / height,
        }
    }

    pub(crate) fn is_perspective(&self) -> bool {
        matches!(self.projection, Projection::Perspective { .. })
    }

    /// Distance of `p` along the view axis.
    pub(crate) fn depth_of(&self, p: DVec3) -> f64 {
        (p - self.eye).dot(self.forward)
    }

    /// Pixels that one world unit takes at `depth`; for a perspective camera at least at a tiny depth.
    pub(crate) fn pixels_per_unit(&self, depth: f64) -> f64 {
        match self.projection {
            Projection::Perspective { .. } => self.focal_px() / depth.max(f64::MIN_POSITIVE),
            Projection::Orthographic { .. } => self.focal_px(),
        }
    }
}

/// Also of vectors whose squared length is no number of f64.
fn unit_vector(v: DVec3) -> Option<DVec3> {
    (v / v.abs().max_element()).try_normalize()
}

/// The map from the world to a buffer of the picture's shape with pixels of `scale` picture pixels.
///
/// Depth is kept as an offset from a reference depth near the object: a telephoto view of a far object
/// then loses nothing when the rest is `f32`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BufferMap {
    pub(crate) view: View,
    /// Buffer pixels from left to right and from top to bottom.
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Picture pixels per buffer pixel.
    pub(crate) scale: f64,
    /// Depth that has offset 0, in units.
    pub(crate) reference: f64,
    /// World units per unit of the cloud's offsets and of all depths here.
    pub(crate) unit: f64,
}

impl BufferMap {
    /// `reference` is a depth in world units.
    pub(crate) fn new(view: &View, scale: f64, reference: f64, unit: f64) -> Self {
        let side = |pixels: u32| ((f64::from(pixels) / scale).ceil() as usize).max(1);
        let (width, height) = (side(view.width), side(view.height));
        Self { view: *view, width, height, scale, reference: reference / unit, unit }
    }

    /// Buffer pixels that one unit takes at a depth of one unit (perspective) or at any depth.
    pub(crate) fn focal(&self) -> f64 {
        let unit = if self.view.is_perspective() { 1.0 } else { self.unit };
        self.view.focal_px() * unit / self.scale
    }

    /// The principal point in buffer pixels.
    pub(crate) fn centre(&self) -> (f64, f64) {
        (0.5 * f64::from(self.view.width) / self.scale, 0.5 * f64::from(self.view.height) / self.scale)
    }

    /// Rows `x·w, y·w, depth − reference` for points given in units relative to `origin` (in the
    /// world); `w` is the depth, or 1 for an orthographic camera.
    pub(crate) fn rows(&self, origin: DVec3) -> [f32; 12] {
        let v = &self.view;
        let (f, (cx, cy)) = (self.focal(), self.centre());
        let to_origin = (origin - v.eye) / self.unit;
        let (right, up, depth) = (to_origin.dot(v.right), to_origin.dot(v.up), to_origin.dot(v.forward));
        let (x, y) = match v.projection {
            Projection::Perspective { .. } => (
                (f * v.right + cx * v.forward, f * right + cx * depth),
                (cy * v.forward - f * v.up, cy * depth - f * up),
            ),
            Projection::Orthographic { .. } => ((f * v.right, f * right + cx), (-f * v.up, cy - f * up)),
        };
        let d = (v.forward, depth - self.reference);
        let mut rows = [0.0; 12];
        for (row, (n, offset)) in rows.chunks_exact_mut(4).zip([x, y, d]) {
            row.copy_from_slice(&[n.x as f32, n.y as f32, n.z as f32, offset as f32]);
        }
        rows
    }

    /// 1 / reference depth, or 0 for an orthographic camera: a surface that is a plane in the world has
    /// a *bent depth* `d / (1 + k·d)` that is affine over the picture (d: offset from the reference).
    pub(crate) fn bend(&self) -> f32 {
        if self.view.is_perspective() { (1.0 / self.reference) as f32 } else { 0.0 }
    }
}
