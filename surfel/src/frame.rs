//! The picture, in tiles. `ibpr/src/frame.rs` says why `pointillist-ibpr` has one of its own.

use crate::grid::{HEIGHT, TileRect, WIDTH};

/// A drawn frame: layers of `width · height` entries, row by row from the top left pixel.
///
/// Frames of `pointillist-ibpr` and `pointillist-surfel` have the same form. Color and depth are always there; the
/// other layers are empty unless [`Options::surface_layers`](crate::Options::surface_layers) asks for them. A new frame
/// has no pixels. Keep one and draw into it again: memory is allocated for the first frame, and when the size of the
/// picture changes; tiles that stay empty are not touched.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    width: usize,
    height: usize,
    color: Vec<[f32; 4]>,
    depth: Vec<f32>,
    normal: Vec<[f32; 3]>,
    /// Tiles that are not empty, row by row.
    drawn: Vec<bool>,
    pub(crate) counts: FrameCounts,
}

/// What one frame drew and skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct FrameCounts {
    /// Nodes of the octree that are in view, do not face away and are as coarse as they may be.
    pub nodes: usize,
    /// Nodes among them that were skipped in all tiles, because other surfaces hide them.
    pub nodes_hidden: usize,
    /// Nodes outside the view, whose children are not visited, and of those in view the ones beside the window.
    pub nodes_outside: usize,
    /// Nodes that face away; their children are not visited.
    pub nodes_facing_away: usize,
    /// Points of the drawn nodes, links included.
    pub points: usize,
    /// Links among them.
    pub links: usize,
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

    /// Distance from the eye along the view direction, world units, of the nearest surface that, with those before it,
    /// keeps back half the light of the pixel or more; `f32::INFINITY` where there is none.
    #[must_use]
    pub fn depth(&self) -> &[f32] {
        &self.depth
    }

    /// Unit normal of that surface in the world; 0 where there is none. Empty if surface layers were not asked for.
    #[must_use]
    pub fn normal(&self) -> &[[f32; 3]] {
        &self.normal
    }

    /// What was drawn and what was skipped.
    #[must_use]
    pub fn counts(&self) -> &FrameCounts {
        &self.counts
    }

    /// Makes room.
    pub(crate) fn reshape(&mut self, width: usize, height: usize, normals: bool) {
        let n = width * height;
        let normal_count = if normals { n } else { 0 };
        if (self.width, self.height, self.normal.len()) == (width, height, normal_count) {
            return;
        }
        *self = Self {
            width,
            height,
            color: vec![[0.0; 4]; n],
            depth: vec![f32::INFINITY; n],
            normal: vec![[0.0; 3]; normal_count],
            drawn: vec![false; width.div_ceil(WIDTH) * height.div_ceil(HEIGHT)],
            counts: FrameCounts::default(),
        };
    }

    /// The frame in rows of tiles.
    pub(crate) fn bands(&mut self) -> Vec<Band<'_>> {
        let n = self.width * HEIGHT;
        let mut normals = self.normal.chunks_mut(n);
        let layers = self.color.chunks_mut(n).zip(self.depth.chunks_mut(n));
        let drawn = self.drawn.chunks_mut(self.width.div_ceil(WIDTH));
        layers
            .zip(drawn)
            .enumerate()
            .map(|(i, ((color, depth), drawn))| Band {
                first_row: i * HEIGHT,
                width: self.width,
                color,
                depth,
                normal: normals.next(),
                drawn,
            })
            .collect()
    }
}

/// A row of tiles of a frame.
pub(crate) struct Band<'a> {
    pub(crate) first_row: usize,
    pub(crate) width: usize,
    pub(crate) color: &'a mut [[f32; 4]],
    pub(crate) depth: &'a mut [f32],
    pub(crate) normal: Option<&'a mut [[f32; 3]]>,
    /// Which tiles are not empty.
    pub(crate) drawn: &'a mut [bool],
}

impl Band<'_> {
    pub(crate) fn rows(&self) -> usize {
        self.depth.len() / self.width
    }

    /// Columns of a tile.
    fn columns(&self, tile: usize) -> std::ops::Range<usize> {
        tile * WIDTH..((tile + 1) * WIDTH).min(self.width)
    }

    /// All tiles as one.
    pub(crate) fn whole(&self) -> TileRect {
        TileRect { x: 0, y: self.first_row, width: self.width, height: self.rows() }
    }

    /// Where a tile lies.
    pub(crate) fn rect(&self, tile: usize) -> TileRect {
        let columns = self.columns(tile);
        TileRect { x: columns.start, y: self.first_row, width: columns.len(), height: self.rows() }
    }

    /// Makes a tile empty.
    pub(crate) fn clear(&mut self, tile: usize) {
        if !std::mem::replace(&mut self.drawn[tile], false) {
            return;
        }
        let columns = self.columns(tile);
        for row in 0..self.rows() {
            let pixels = row * self.width + columns.start..row * self.width + columns.end;
            self.color[pixels.clone()].fill([0.0; 4]);
            self.depth[pixels.clone()].fill(f32::INFINITY);
            if let Some(normal) = &mut self.normal {
                normal[pixels].fill([0.0; 3]);
            }
        }
    }
}
