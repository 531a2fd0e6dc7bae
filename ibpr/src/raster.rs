//! Draws small triangles into a strip of the picture.

use crate::buffer::SUBPIXEL;
use std::ops::Range;

/// What a picture pixel keeps of a face besides its surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paint {
    /// Linear RGB, premultiplied by the opacity, and the opacity.
    pub(crate) color: [f32; 4],
    /// Number of averaged points.
    pub(crate) count: f32,
}

impl Paint {
    /// For faces that are not painted.
    pub(crate) const NONE: Self = Self { color: [0.0, 0.0, 0.0, 1.0], count: 0.0 };
}

/// A vertex as it is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    /// Picture pixels in steps of 1/[`SUBPIXEL`].
    pub(crate) x: i32,
    pub(crate) y: i32,
    /// Bent depth and normal.
    pub(crate) surface: [f32; 4],
    /// Picture pixels from here to the outline of the surface; below 0 outside.
    pub(crate) inside: f32,
}

/// What the pixels of a strip keep of the faces that cover them.
pub(crate) trait Pixels {
    /// A face covers the share `cover` (above 0, at most 1) of pixel `at`.
    fn put(&mut self, at: usize, surface: [f32; 4], cover: f32, paint: impl FnOnce() -> Option<Paint>);
}

/// Some rows of the picture.
#[derive(Debug, Default)]
pub(crate) struct Strip<P> {
    pub(crate) width: usize,
    pub(crate) first_row: usize,
    pub(crate) rows: usize,
    /// The columns that are drawn.
    pub(crate) columns: Range<usize>,
    pub(crate) pixels: P,
}

impl<P: Pixels> Strip<P> {
    /// Assigns rows of the picture to it.
    pub(crate) fn set_rows(&mut self, width: usize, first_row: usize, rows: usize, columns: Range<usize>) {
        (self.width, self.first_row, self.rows) = (width, first_row, rows);
        self.columns = columns;
    }

    /// Draws a triangle, of either orientation. `paints` are the paints of its vertices.
    ///
    /// Pixels whose centre lies on an edge belong to one of the two triangles that share it
    /// (top-left rule on 1/[`SUBPIXEL`] pixels), so meshes have neither gaps nor pixels drawn twice.
    pub(crate) fn triangle<const RIM: bool>(&mut self, vertices: [&Vertex; 3], paints: Option<[&Paint; 3]>) {
        let [a, b, c] = vertices;
        let area = i64::from(b.x - a.x) * i64::from(c.y - a.y) - i64::from(b.y - a.y) * i64::from(c.x - a.x);
        match area {
            0 => {}
            1.. => self.oriented::<RIM>([a, b, c], paints, area),
            _ => self.oriented::<RIM>([a, c, b], paints.map(|[p, q, r]| [p, r, q]), -area),
        }
    }

    fn oriented<const RIM: bool>(&mut self, [a, b, c]: [&Vertex; 3], paints: Option<[&Paint; 3]>, area: i64) {
        const STEP: i64 = SUBPIXEL as i64;
        const HALF: i32 = SUBPIXEL as i32 / 2;
        // Pixels whose centres lie in the bounding box.
        let first = |v: i32| (v + HALF - 1).div_euclid(STEP as i32);
        let last = |v: i32| (v - HALF).div_euclid(STEP as i32);
        let left = first(a.x.min(b.x).min(c.x)).max(self.columns.start as i32);
        let right = last(a.x.max(b.x).max(c.x)).min(self.columns.end as i32 - 1);
        let top = first(a.y.min(b.y).min(c.y)).max(self.first_row as i32);
        let bottom = last(a.y.max(b.y).max(c.y)).min((self.first_row + self.rows) as i32 - 1);
        if left > right || top > bottom {
            return;
        }
        let centre = (i64::from(left) * STEP + i64::from(HALF), i64::from(top) * STEP + i64::from(HALF));
        let edges = [Edge::new(b, c, centre), Edge::new(c, a, centre), Edge::new(a, b, centre)];
        let inverse = 1.0 / area as f32;
        let [e, f, g] = &edges;
        let mut row = [e.value, f.value, g.value];
        for y in top..=bottom {
            let [mut p, mut q, mut r] = row;
            let base = (y as usize - self.first_row) * self.width;
            for x in left..=right {
                // Inside where none of the three values is negative: their signs are tested together.
                if (p | q | r) >= 0 {
                    let weights = [(q - f.bias) as f32 * inverse, (r - g.bias) as f32 * inverse];
                    self.put::<RIM>(base + x as usize, [a, b, c], weights, paints);
                }
                (p, q, r) = (p + e.right, q + f.right, r + g.right);
            }
            row = [row[0] + e.down, row[1] + f.down, row[2] + g.down];
        }
    }

    /// `weights` are those of the second and third vertex.
    #[inline(always)]
    fn put<const RIM: bool>(
        &mut self,
        at: usize,
        [a, b, c]: [&Vertex; 3],
        weights: [f32; 2],
        paints: Option<[&Paint; 3]>,
    ) {
        let mix = |a: f32, b: f32, c: f32| a + weights[0] * (b - a) + weights[1] * (c - a);
        let mix4 = |a: &[f32; 4], b: &[f32; 4], c: &[f32; 4]| {
            let mut out = *a;
            for (i, v) in out.iter_mut().enumerate() {
                *v = mix(a[i], b[i], c[i]);
            }
            out
        };
        // A pixel whose centre lies this far inside the outline is covered to this share.
        let cover = if RIM { (mix(a.inside, b.inside, c.inside) + 0.5).min(1.0) } else { 1.0 };
        if cover > 0.0 {
            let surface = mix4(&a.surface, &b.surface, &c.surface);
            self.pixels.put(at, surface, cover, || {
                paints.map(|[p, q, r]| Paint {
                    color: mix4(&p.color, &q.color, &r.color),
                    count: mix(p.count, q.count, r.count),
                })
            });
        }
    }
}

/// Twice the area of the triangle of an edge and a pixel's centre, in square steps, plus the bias.
#[derive(Clone, Copy)]
struct Edge {
    value: i64,
    /// What a pixel to the right or below adds.
    right: i64,
    down: i64,
    /// −1 where the edge itself does not belong to the triangle.
    bias: i64,
}

impl Edge {
    fn new(from: &Vertex, to: &Vertex, centre: (i64, i64)) -> Self {
        let (dx, dy) = (i64::from(to.x - from.x), i64::from(to.y - from.y));
        let value = dx * (centre.1 - i64::from(from.y)) - dy * (centre.0 - i64::from(from.x));
        let top_left = dy < 0 || (dy == 0 && dx > 0);
        let step = SUBPIXEL as i64;
        let bias = if top_left { 0 } else { -1 };
        Self { value: value + bias, right: -dy * step, down: dx * step, bias }
    }
}
