//! Normals of the averaged points, and the corners of faces.

use crate::border::{MARGIN, PAD};
use crate::buffer::{Buffer, Corner, DepthScale, STEP, SUBPIXEL, whole_steps};
use crate::buffer_map::BufferMap;
use crate::fit::{Chunk, LANES};
use crate::noise::{Histogram, radius_for_noise};
use crate::options::Normals;
use crate::parallel::*;
use glam::Vec3;
use pulp::Arch;
use std::ops::Range;

/// Rows per task.
const BAND_ROWS: usize = 16;

/// Fits planes (or makes triangles), and writes the corners of `buffer` in these rows of pixels, and perhaps in others.
pub(crate) fn make_corners(
    buffer: &mut Buffer,
    map: &BufferMap,
    scale: &DepthScale,
    rule: Normals,
    wanted: Range<usize>,
    histogram: &mut Histogram,
) {
    let inner = buffer.inner();
    let n = BAND_ROWS * buffer.pitch;
    let mut corners = std::mem::take(&mut buffer.corners);
    let shared = &*buffer;
    let camera = Camera::new(map);
    let arch = Arch::new();
    let radius = match rule {
        Normals::Plane => radius_for_noise(shared, scale, arch, histogram),
        Normals::Triangles => 1,
    };
    let fitting = Fitting { arch, scale: *scale, radius };
    chunks(&mut corners[inner], n).enumerate().for_each(|(i, rows)| {
        if (i + 1) * BAND_ROWS <= wanted.start || i * BAND_ROWS >= wanted.end {
            return;
        }
        for (r, row) in rows.chunks_mut(shared.stride).enumerate() {
            // Rows of entries: all layers of a row of pixels, then those of the next.
            let start = shared.at(0, i * BAND_ROWS) + r * shared.stride;
            let out = &mut row[PAD..PAD + shared.width];
            match rule {
                Normals::Plane => plane_row(shared, start, &camera, &fitting, out),
                Normals::Triangles => triangle_row(shared, start, &camera, scale, out),
            }
        }
    });
    buffer.corners = corners;
}

/// What turns buffer positions into camera space.
struct Camera {
    centre: (f32, f32),
    inverse_focal: f32,
    focal: f32,
    reference: f32,
    perspective: bool,
    bend: f32,
    /// Steps of corner positions per buffer pixel.
    steps: f32,
}

impl Camera {
    fn new(map: &BufferMap) -> Self {
        let (x, y) = map.centre();
        Self {
            centre: (x as f32, y as f32),
            inverse_focal: (1.0 / map.focal()) as f32,
            focal: map.focal() as f32,
            reference: map.reference as f32,
            perspective: map.is_perspective(),
            bend: map.bend(),
            steps: map.scale as f32 * SUBPIXEL,
        }
    }

    /// Normal of the surface whose bent depth changes by `slope` per buffer pixel at (x, y, q), towards
    /// the eye. Follows from n·P = 1 for the points P of a plane, whose 1/depth is affine in the picture.
    fn normal(&self, x: f32, y: f32, q: f32, slope: [f32; 2]) -> Option<Vec3> {
        let [a, b] = slope;
        let (u, v) = (x - self.centre.0, y - self.centre.1);
        let back = if self.perspective { self.reference - q + a * u + b * v } else { 1.0 };
        Vec3::new(a * self.focal, -b * self.focal, back).try_normalize()
    }

    /// Position in camera space, relative to the reference depth.
    fn position(&self, x: f32, y: f32, q: f32) -> Vec3 {
        let depth = q / (1.0 - self.bend * q);
        let w = if self.perspective { depth + self.reference } else { 1.0 };
        let k = w * self.inverse_focal;
        Vec3::new((x - self.centre.0) * k, (self.centre.1 - y) * k, -depth)
    }

    fn corner(&self, x: f32, y: f32, q: f32, n: Vec3) -> Corner {
        let step = |v: f32| whole_steps((v - MARGIN as f32) * self.steps);
        Corner { x: step(x), y: step(y), surface: [q, n.x, n.y, n.z] }
    }
}

fn plane_row(b: &Buffer, start: usize, camera: &Camera, fitting: &Fitting, out: &mut [Corner]) {
    for (i, out) in out.chunks_mut(LANES).enumerate() {
        let first = start + i * LANES;
        let counts = &b.count[first..first + out.len()];
        if counts.iter().all(|c| *c == 0.0) {
            out.fill(Corner::NONE);
            continue;
        }
        // The last chunk also fits what lies beyond the row, and drops it.
        let fit = |radius| fitting.arch.dispatch(Chunk::<false> { b, first, scale: &fitting.scale, radius });
        let mut fits = fit(fitting.radius);
        if counts.iter().zip(&fits).any(|(count, fit)| *count > 0.0 && !fit.good) {
            for (fit, wider) in fits.iter_mut().zip(fit(fitting.radius + 1)).filter(|(fit, _)| !fit.good) {
                *fit = wider;
            }
        }
        for (k, corner) in out.iter_mut().enumerate() {
            let (at, fit) = (first + k, &fits[k]);
            let normal = || camera.normal(b.x[at], b.y[at], b.q[at], fit.slope);
            *corner = (b.count[at] > 0.0 && fit.good)
                .then(normal)
                .flatten()
                .map_or(Corner::NONE, |n| camera.corner(b.x[at], b.y[at], b.q[at], n));
        }
    }
}

/// How surfaces are fitted in this frame.
struct Fitting {
    arch: Arch,
    scale: DepthScale,
    /// Windows hold (2·radius + 1)² pixels.
    radius: usize,
}

/// The paper's rule: the mean of the normals of up to eight triangles with consecutive neighbours.
fn triangle_row(b: &Buffer, start: usize, camera: &Camera, scale: &DepthScale, out: &mut [Corner]) {
    let s = b.pitch as isize;
    let around = [1, s + 1, s, s - 1, -1, -s - 1, -s, 1 - s];
    let layer = (start / b.stride) % b.layers;
    for (i, corner) in out.iter_mut().enumerate() {
        let at = start + i;
        *corner = Corner::NONE;
        if b.count[at] == 0.0 {
            continue;
        }
        let p = camera.position(b.x[at], b.y[at], b.q[at]);
        let step = scale.bent_step(b.q[at], STEP);
        let edges = around.map(|offset| {
            let top = at.wrapping_add_signed(offset) - layer * b.stride;
            let layers = (0..b.layers).map(|l| top + l * b.stride);
            let apart = |n: usize| (b.q[n] - b.q[at]).abs();
            let n = layers.filter(|n| b.count[*n] > 0.0 && apart(*n) < step);
            let n = n.min_by(|m, n| apart(*m).total_cmp(&apart(*n)))?;
            Some(camera.position(b.x[n], b.y[n], b.q[n]) - p)
        });
        let mut sum = Vec3::ZERO;
        for k in 0..8 {
            if let (Some(e), Some(f)) = (edges[k], edges[(k + 1) % 8]) {
                // Neighbours run clockwise in the picture, so this points towards the eye.
                sum += f.cross(e).normalize_or_zero();
            }
        }
        if let Some(n) = sum.try_normalize() {
            *corner = camera.corner(b.x[at], b.y[at], b.q[at], n);
        }
    }
}
