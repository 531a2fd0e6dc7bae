//! The buffer at screen/S: one averaged point per pixel, or one for each of several layers.

use crate::border::PAD;
use crate::buffer_map::BufferMap;
use pointillist_view::View;

/// Depths of neighbouring pixels of one surface differ by less than this many units (the paper's 5).
pub(crate) const STEP: f32 = 5.0;

/// Entries after the last row, so that the last pixels can be read as a whole vector.
const TAIL: usize = 16;

/// A corner of faces: an averaged point in the picture, with its normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// Picture pixels in steps of 1/[`SUBPIXEL`].
    pub(crate) x: i32,
    pub(crate) y: i32,
    /// Bent depth, and the unit normal in the camera's frame (right, up, back) towards the eye.
    pub(crate) surface: [f32; 4],
}

/// Steps per picture pixel in which corners are placed.
pub(crate) const SUBPIXEL: f32 = 256.0;

/// Farthest steps from the corner of the picture, as far as the largest picture reaches: sums of two of them, and differences of such sums,
/// fit 32 bits. Buffer pixels may be far larger than pictures.
const FARTHEST: f32 = (View::LARGEST_SIDE * SUBPIXEL as u32) as f32;

/// A number of steps, whole and not beyond [`FARTHEST`].
#[inline]
pub(crate) fn whole_steps(steps: f32) -> i32 {
    steps.round().clamp(-FARTHEST, FARTHEST) as i32
}

impl Corner {
    /// A corner that no face uses.
    pub(crate) const NONE: Self = Self { x: 0, y: 0, surface: [f32::INFINITY, 0.0, 0.0, 0.0] };

    pub(crate) fn is_some(&self) -> bool {
        self.surface[0] < f32::INFINITY
    }
}

/// One averaged point per pixel and layer, as arrays with a border of [`PAD`] empty pixels.
///
/// A row of pixels is [`Buffer::layers`] rows of entries, one below the other, nearest layer first.
#[derive(Debug, Default)]
pub(crate) struct Buffer {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Surfaces per pixel.
    pub(crate) layers: usize,
    /// Entries from a pixel to its next layer.
    pub(crate) stride: usize,
    /// Entries from a pixel to the one below it.
    pub(crate) pitch: usize,
    /// Averaged position in buffer pixels; in empty pixels 0.
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    /// Averaged bent depth (see [`BufferMap::bend`]).
    pub(crate) q: Vec<f32>,
    /// Number of averaged points; 0 where the pixel is empty.
    pub(crate) count: Vec<f32>,
    /// What faces are made of.
    pub(crate) corners: Vec<Corner>,
    /// Averaged color, premultiplied by the opacity, and the opacity: 1 in opaque frames, which for clouds without colors do not keep it up
    /// to date.
    pub(crate) color: Vec<[f32; 4]>,
}

impl Buffer {
    pub(crate) fn reshape(&mut self, width: usize, height: usize, layers: usize) {
        let (stride, rows) = (width + 2 * PAD, height + 2 * PAD);
        let len = stride * rows * layers + TAIL;
        let same = (width, height, layers) == (self.width, self.height, self.layers);
        (self.width, self.height, self.layers) = (width, height, layers);
        (self.stride, self.pitch) = (stride, stride * layers);
        if !same {
            for array in [&mut self.x, &mut self.y, &mut self.q, &mut self.count] {
                array.clear();
                array.resize(len, 0.0);
            }
            self.color.clear();
            self.color.resize(len, [0.0; 4]);
            self.corners.clear();
            self.corners.resize(len, Corner::NONE);
        }
    }

    /// Forgets all points.
    pub(crate) fn empty(&mut self) {
        for array in [&mut self.x, &mut self.y, &mut self.q, &mut self.count] {
            array.fill(0.0);
        }
        self.color.fill([0.0; 4]);
    }

    /// Index of the nearest layer of pixel (`column`, `row`).
    pub(crate) fn at(&self, column: usize, row: usize) -> usize {
        (row + PAD) * self.pitch + column + PAD
    }

    /// Entries of the arrays without the empty rows above and below.
    pub(crate) fn inner(&self) -> std::ops::Range<usize> {
        PAD * self.pitch..(PAD + self.height) * self.pitch
    }
}

/// How far depths may differ on one surface, as bent depths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthScale {
    /// Typical distance of points in units (see [`BufferMap::unit`]).
    pub(crate) spacing: f32,
    /// Units per buffer pixel at the reference depth.
    pub(crate) footprint: f32,
    /// See [`BufferMap::bend`].
    pub(crate) bend: f32,
}

impl DepthScale {
    pub(crate) fn new(map: &BufferMap, spacing: f64) -> Self {
        let depth = if map.is_perspective() { map.reference } else { 1.0 };
        Self {
            spacing: (spacing / map.unit) as f32,
            footprint: (depth / map.focal()) as f32,
            bend: map.bend(),
        }
    }

    /// The distance that counts as 1 between neighbours at relative depth `d`: the spacing of points, or the size of a
    /// buffer pixel where that is larger.
    pub(crate) fn unit(&self, d: f32) -> f32 {
        self.spacing.max(self.footprint * (1.0 + self.bend * d))
    }

    pub(crate) fn bent(&self, d: f32) -> f32 {
        d / (1.0 + self.bend * d)
    }

    /// `steps` units at bent depth `q`, as a difference of bent depths.
    pub(crate) fn bent_step(&self, q: f32, steps: f32) -> f32 {
        let slope = 1.0 - self.bend * q;
        // unit(straight(q)) · dq/dd, where dq/dd = (1 − k·q)² and 1 + k·d = 1/(1 − k·q).
        steps * (self.spacing * slope * slope).max(self.footprint * slope)
    }
}

/// Rows of a buffer that a band writes.
pub(crate) struct BufferBand<'a> {
    pub(crate) x: &'a mut [f32],
    pub(crate) y: &'a mut [f32],
    pub(crate) q: &'a mut [f32],
    pub(crate) count: &'a mut [f32],
    pub(crate) color: &'a mut [[f32; 4]],
    /// Entries to the next layer and to the next row.
    pub(crate) stride: usize,
    pub(crate) pitch: usize,
}
