//! The picture.
//!
//! `pointillist-surfel` has a frame of the same form in its own `frame.rs`: both keep their layers private and fill
//! them in different ways (strips here, tiles there), so a shared type would have to let everybody write to its layers,
//! to save five one-line functions.

/// A drawn frame: layers of `width · height` entries, row by row from the top left pixel.
///
/// Frames of `pointillist-ibpr` and `pointillist-surfel` have the same form. Color and depth are always there; the
/// other layers are empty unless [`Options::surface_layers`](crate::Options::surface_layers) asks for them. A new frame
/// has no pixels. Keep one and draw into it again: memory is allocated for the first frame, and when the size of the
/// picture grows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) color: Vec<[f32; 4]>,
    pub(crate) depth: Vec<f32>,
    pub(crate) normal: Vec<[f32; 3]>,
    pub(crate) count: Vec<f32>,
    pub(crate) counts: FrameCounts,
}

/// What one frame drew and skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FrameCounts {
    /// Size of a buffer pixel in picture pixels (S).
    pub scale: f64,
    /// Blocks that were drawn.
    pub blocks: usize,
    /// Their points.
    pub points: usize,
    /// Blocks beyond the view and a few buffer pixels beside it.
    pub blocks_outside: usize,
    /// Blocks skipped because they face away.
    pub blocks_facing_away: usize,
    /// Points skipped, with their blocks.
    pub points_skipped: usize,
}

impl Frame {
    /// A frame without pixels.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Pixels from left to right.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels from top to bottom.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Linear RGB, premultiplied by the opacity, and opacity from 0 to 1; all 0 where there is no surface.
    #[must_use]
    pub fn color(&self) -> &[[f32; 4]] {
        &self.color
    }

    /// Distance from the eye along the view direction, world units, of the nearest surface that covers half the pixel
    /// or more; `f32::INFINITY` where there is none.
    #[must_use]
    pub fn depth(&self) -> &[f32] {
        &self.depth
    }

    /// Unit normal of that surface in the world; 0 where there is none. Empty if surface layers were not asked for.
    #[must_use]
    pub fn normal(&self) -> &[[f32; 3]] {
        &self.normal
    }

    /// Points per buffer pixel of that surface; 0 where there is none. Empty if surface layers were not asked for.
    #[must_use]
    pub fn count(&self) -> &[f32] {
        &self.count
    }

    /// What was drawn and what was skipped.
    #[must_use]
    pub fn counts(&self) -> &FrameCounts {
        &self.counts
    }

    /// Makes room; what was in the layers is not cleared.
    pub(crate) fn reshape(&mut self, width: usize, height: usize, surface_layers: bool) {
        (self.width, self.height) = (width, height);
        let n = width * height;
        self.color.resize(n, [0.0; 4]);
        self.depth.resize(n, f32::INFINITY);
        let n = if surface_layers { n } else { 0 };
        self.normal.resize(n, [0.0; 3]);
        self.count.resize(n, 0.0);
    }
}
