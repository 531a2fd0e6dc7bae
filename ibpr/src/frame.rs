//! The picture.

/// A drawn frame: row-major layers of `width · height` entries, or empty where not asked for.
///
/// Keep one and draw into it again: memory is allocated for the first frame only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Pixels from left to right.
    pub width: usize,
    /// Pixels from top to bottom.
    pub height: usize,
    /// Linear RGB, premultiplied, and opacity.
    pub colour: Vec<[f32; 4]>,
    /// Distance along the view axis of the nearest surface; +∞ where there is none.
    pub depth: Vec<f32>,
    /// Unit normal in the world, 0 where there is no surface.
    pub normal: Vec<[f32; 3]>,
    /// Points per buffer pixel, 0 where there is no surface.
    pub count: Vec<f32>,
    /// What was drawn and what was skipped.
    pub counts: FrameCounts,
}

/// What one frame drew and skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameCounts {
    /// Size of a buffer pixel in picture pixels (S).
    pub scale: f64,
    /// Blocks that were drawn.
    pub blocks: usize,
    /// Their points.
    pub points: usize,
    /// Blocks outside the view.
    pub blocks_outside: usize,
    /// Blocks skipped because they face away.
    pub blocks_facing_away: usize,
    /// Points skipped, with their blocks.
    pub points_skipped: usize,
}

impl Frame {
    /// Makes room; what was in the layers is not cleared.
    pub(crate) fn reshape(&mut self, width: usize, height: usize, surface_layers: bool) {
        (self.width, self.height) = (width, height);
        let n = width * height;
        self.colour.resize(n, [0.0; 4]);
        self.depth.resize(n, f32::INFINITY);
        let n = if surface_layers { n } else { 0 };
        self.normal.resize(n, [0.0; 3]);
        self.count.resize(n, 0.0);
    }
}
