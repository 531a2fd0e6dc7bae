//! The linear map from the world to a buffer of any size.

use crate::border::MARGIN;
use glam::DVec3;
use pointillist_view::{Projection, View};

/// Distance of `p` from the eye along the view direction, world units.
pub(crate) fn depth_of(view: &View, p: DVec3) -> f64 {
    (p - view.eye()).dot(view.forward())
}

/// The map from the world to a buffer of the picture's shape and its [`MARGIN`], with pixels of `scale` picture pixels.
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
        let side = |pixels: u32| ((f64::from(pixels) / scale).ceil() as usize).max(1) + 2 * MARGIN;
        let (width, height) = (side(view.width()), side(view.height()));
        Self { view: *view, width, height, scale, reference: reference / unit, unit }
    }

    pub(crate) fn is_perspective(&self) -> bool {
        self.view.projection().is_perspective()
    }

    /// Buffer pixels that one unit takes at a depth of one unit (perspective) or at any depth.
    pub(crate) fn focal(&self) -> f64 {
        let unit = if self.is_perspective() { 1.0 } else { self.unit };
        self.view.focal_px() * unit / self.scale
    }

    /// The principal point in buffer pixels.
    pub(crate) fn centre(&self) -> (f64, f64) {
        let centre = self.view.centre_px() / self.scale + MARGIN as f64;
        (centre.x, centre.y)
    }

    /// Rows `x·w, y·w, depth − reference` for points given relative to `origin` (in the world) in a `unit` of their own; `w` is the depth,
    /// or 1 for an orthographic camera.
    pub(crate) fn rows(&self, origin: DVec3, unit: f64) -> [f32; 12] {
        let v = &self.view;
        let (to_right, upward, forward) = (v.right(), v.up(), v.forward());
        let (f, (cx, cy)) = (self.focal(), self.centre());
        let to_origin = (origin - v.eye()) / self.unit;
        let (right, up, depth) = (to_origin.dot(to_right), to_origin.dot(upward), to_origin.dot(forward));
        let (x, y) = match v.projection() {
            Projection::Perspective { .. } => (
                (f * to_right + cx * forward, f * right + cx * depth),
                (cy * forward - f * upward, cy * depth - f * up),
            ),
            Projection::Orthographic { .. } => ((f * to_right, f * right + cx), (-f * upward, cy - f * up)),
        };
        let d = (forward, depth - self.reference);
        // A power of 2: nothing is rounded.
        let own = unit / self.unit;
        let mut rows = [0.0; 12];
        for (row, (n, offset)) in rows.chunks_exact_mut(4).zip([x, y, d]) {
            let n = (n * own).as_vec3();
            row.copy_from_slice(&[n.x, n.y, n.z, offset as f32]);
        }
        rows
    }

    /// 1 / reference depth, or 0 for an orthographic camera: a surface that is a plane in the world has
    /// a *bent depth* `d / (1 + k·d)` that is affine over the picture (d: offset from the reference).
    pub(crate) fn bend(&self) -> f32 {
        if self.is_perspective() { (1.0 / self.reference) as f32 } else { 0.0 }
    }
}
