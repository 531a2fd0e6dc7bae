//! Points of a block in buffer pixels.

use crate::buffer_map::BufferMap;
use pulp::{Arch, NullaryFnOnce};

/// Points that are transformed together: their results stay in the first-level cache.
pub(crate) const BATCH: usize = 256;

/// Transformed points; entries of `kept` number those that lie in the band.
pub(crate) struct Projected {
    /// Position in buffer pixels.
    pub(crate) x: [f32; BATCH],
    pub(crate) y: [f32; BATCH],
    /// Depth relative to the reference.
    pub(crate) depth: [f32; BATCH],
    inside: [u8; BATCH],
    kept: [u16; BATCH],
    count: usize,
}

/// Rows of the buffer that are filled together, and the nearest depth that is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Band {
    pub(crate) width: usize,
    pub(crate) first_row: usize,
    pub(crate) rows: usize,
    /// Depths (relative) must be above this.
    pub(crate) near: f32,
    /// Whether x and y are divided by the depth, and what is added to the relative depth to get it.
    pub(crate) perspective: bool,
    pub(crate) reference: f32,
}

impl Band {
    pub(crate) fn new(map: &BufferMap, first_row: usize, rows: usize) -> Self {
        let reference = map.reference as f32;
        Self {
            width: map.width,
            first_row,
            rows,
            near: -reference * (1.0 - 4.0 * f32::EPSILON),
            perspective: map.is_perspective(),
            reference,
        }
    }
}

impl Projected {
    pub(crate) fn new() -> Self {
        let zero = [0.0; BATCH];
        Self { x: zero, y: zero, depth: zero, inside: [0; BATCH], kept: [0; BATCH], count: 0 }
    }

    /// Numbers of the points in the band.
    pub(crate) fn kept(&self) -> impl Iterator<Item = usize> {
        self.kept[..self.count].iter().map(|k| usize::from(*k))
    }

    /// Index of the pixel of point `k` in the band; it was kept.
    pub(crate) fn pixel(&self, k: usize, band: &Band) -> usize {
        (self.y[k] as usize - band.first_row) * band.width + self.x[k] as usize
    }

    /// Transforms up to [`BATCH`] points and notes which lie in the band.
    pub(crate) fn transform(&mut self, arch: Arch, rows: &[f32; 12], points: [&[f32]; 3], band: &Band) {
        arch.dispatch(Transform { lanes: self, rows, points, band });
        let n = points[0].len().min(BATCH);
        let mut count = 0;
        for i in 0..n {
            // Without a branch: an entry that is not kept is overwritten by the next.
            self.kept[count] = i as u16;
            count += usize::from(self.inside[i]);
        }
        self.count = count;
    }

    // A function of its own: the compiler knows that its parameters do not overlap.
    #[inline(always)]
    fn transform_lanes(&mut self, rows: &[f32; 12], points: [&[f32]; 3], band: &Band) {
        let [px, py, pz] = points;
        let n = px.len().min(BATCH);
        let (px, py, pz) = (&px[..n], &py[..n], &pz[..n]);
        let (x, y, depth) = (&mut self.x[..n], &mut self.y[..n], &mut self.depth[..n]);
        for i in 0..n {
            let row = |r: usize| rows[r] * px[i] + rows[r + 1] * py[i] + rows[r + 2] * pz[i] + rows[r + 3];
            let d = row(8);
            let k = if band.perspective { 1.0 / (d + band.reference) } else { 1.0 };
            (x[i], y[i], depth[i]) = (row(0) * k, row(4) * k, d);
        }
        let right = band.width as f32;
        let (top, bottom) = (band.first_row as f32, (band.first_row + band.rows) as f32);
        let inside = &mut self.inside[..n];
        for i in 0..n {
            let (x, y) = (x[i], y[i]);
            let here = (x >= 0.0) & (x < right) & (y >= top) & (y < bottom) & (depth[i] > band.near);
            inside[i] = u8::from(here);
        }
    }
}

/// The arithmetic of [`Projected::transform`], compiled once more for each kind of vector instructions: the
/// same operations in the same order, so results do not change.
struct Transform<'a> {
    lanes: &'a mut Projected,
    rows: &'a [f32; 12],
    points: [&'a [f32]; 3],
    band: &'a Band,
}

impl NullaryFnOnce for Transform<'_> {
    type Output = ();

    // Not a closure: it would not be inlined into the vectorised caller, and would be compiled without the wide
    // instructions.
    #[inline(always)]
    fn call(self) {
        self.lanes.transform_lanes(self.rows, self.points, self.band);
    }
}
