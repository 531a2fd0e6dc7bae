//! Normals of the averaged points, and the corners of faces.

use crate::buffer::{Buffer, Corner, DepthScale, PAD, SUBPIXEL};
use crate::options::Normals;
use crate::parallel::*;
use crate::view::BufferMap;
use glam::Vec3;
use pulp::{Arch, NullaryFnOnce};

/// Depths of neighbouring pixels of one surface differ by less than this many units (the paper's 5).
pub(crate) const STEP: f32 = 5.0;

/// Pixels that are fitted together.
const LANES: usize = 8;

/// Rows per task.
const BAND_ROWS: usize = 16;

/// Fits planes (or makes triangles), and writes the corners of `buffer`.
pub(crate) fn make_corners(
    buffer: &mut Buffer,
    map: &BufferMap,
    scale: &DepthScale,
    rule: Normals,
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
            perspective: map.view.is_perspective(),
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
        let step = |v: f32| (v * self.steps).round() as i32;
        Corner { x: step(x), y: step(y), surface: [q, n.x, n.y, n.z] }
    }
}

/// Unknowns of the fitted surface: c + a·x + b·y + d·x² + e·x·y + f·y².
const TERMS: usize = 6;

/// Entries of the upper triangle of the normal equations.
const PAIRS: usize = TERMS * (TERMS + 1) / 2;

/// A value for each of the pixels that are fitted together.
type Lane = [f32; LANES];

/// Normal equations over a window.
#[derive(Clone, Copy)]
struct Window {
    /// Row by row from the diagonal on.
    left: [Lane; PAIRS],
    right: [Lane; TERMS],
    /// Sum of w·q².
    qq: Lane,
}

/// A fitted surface at its pixel.
#[derive(Clone, Copy, Default)]
struct Fit {
    slope: [f32; 2],
    /// Mean square distance of the averaged points from the surface, along the view.
    residual: f32,
    good: bool,
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
        let fit = |radius| fitting.arch.dispatch(Chunk { b, first, scale: &fitting.scale, radius });
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

/// Largest window by default; one more must fit into the border of the buffer.
const WIDEST: usize = PAD - 1;

/// Windows grow until the noise turns normals by less than this. Found by experiment on the bunny with
/// noise of 0 to 1 spacings (`studies -- ibpr`): larger windows lose more detail than they win.
const MOST_ERROR_RAD: f32 = 0.035;

/// The smallest window that the noise of this frame allows.
///
/// The noise is the median distance of averaged points from the surfaces fitted to 3×3 of them, over
/// every eighth row.
fn radius_for_noise(b: &Buffer, scale: &DepthScale, arch: Arch, histogram: &mut Histogram) -> usize {
    const EVERY: usize = 8;
    // 9 values and 6 unknowns: what remains is 3/9 of the variance.
    const LEFT_OVER: f32 = 3.0 / 9.0;
    histogram.clear();
    for row in (0..b.height).step_by(EVERY) {
        let start = b.at(0, row);
        for first in (start..start + b.width).step_by(LANES) {
            if b.count[first..first + LANES].iter().all(|c| *c == 0.0) {
                continue;
            }
            let fits = arch.dispatch(Chunk { b, first, scale, radius: 1 });
            for (k, fit) in fits.iter().enumerate().filter(|(_, f)| f.good) {
                let pixel = scale.footprint * (1.0 - scale.bend * b.q[first + k]);
                histogram.add((fit.residual / LEFT_OVER).sqrt() / pixel);
            }
        }
    }
    let slope_noise = histogram.median();
    // Sum of x² over the window: the variance of a slope is that of a value divided by it.
    let spread = |r: usize| {
        let side = (2 * r + 1) as f32;
        side * side * ((r * (r + 1)) as f32 / 3.0)
    };
    (1..WIDEST).find(|r| slope_noise / spread(*r).sqrt() <= MOST_ERROR_RAD).unwrap_or(WIDEST)
}

/// Counts of values on a logarithmic scale: a median that does not depend on order.
#[derive(Debug, Default)]
pub(crate) struct Histogram {
    bins: Vec<u32>,
}

impl Histogram {
    /// Eight steps to the power of 2, from 2⁻²⁰ on.
    const STEPS: f32 = 8.0;
    const LOWEST: f32 = -20.0;
    const BINS: usize = 256;

    fn clear(&mut self) {
        self.bins.clear();
        self.bins.resize(Self::BINS, 0);
    }

    fn add(&mut self, value: f32) {
        // `as` takes NaN and everything below the scale to the first bin.
        let bin = ((value.log2() - Self::LOWEST) * Self::STEPS) as usize;
        self.bins[bin.min(Self::BINS - 1)] += 1;
    }

    /// Upper end of the bin of the median; 0 without values.
    fn median(&self) -> f32 {
        let half = self.bins.iter().sum::<u32>() / 2;
        let mut seen = 0;
        let bin = self.bins.iter().position(|n| {
            seen += n;
            seen > half
        });
        bin.map_or(0.0, |b| ((b + 1) as f32 / Self::STEPS + Self::LOWEST).exp2())
    }
}

/// The fits of [`LANES`] neighbouring pixels, compiled once more for each kind of vector instructions: the
/// same operations in the same order, so results do not change.
struct Chunk<'a> {
    b: &'a Buffer,
    first: usize,
    scale: &'a DepthScale,
    radius: usize,
}

impl NullaryFnOnce for Chunk<'_> {
    type Output = [Fit; LANES];

    // A closure would not be inlined into the vectorised caller, and what is not inlined stays narrow.
    #[inline(always)]
    fn call(self) -> [Fit; LANES] {
        let mut step = [0.0; LANES];
        for (s, q) in step.iter_mut().zip(&self.b.q[self.first..self.first + LANES]) {
            *s = self.scale.bent_step(*q, STEP);
        }
        sum_window(self.b, self.first, &step, self.radius as isize).solve()
    }
}

#[inline(always)]
fn sum_window(b: &Buffer, first: usize, step: &Lane, radius: isize) -> Window {
    let zero = [0.0; LANES];
    let mut s = Window { left: [zero; PAIRS], right: [zero; TERMS], qq: zero };
    let of = |array: &[f32], at: usize| -> Lane {
        array[at..at + LANES].try_into().expect("a slice of LANES entries")
    };
    let (cx, cy, cq) = (of(&b.x, first), of(&b.y, first), of(&b.q, first));
    // From pixel to pixel a surface changes its layer by one at most: more end together only at creases.
    let layer = (first / b.stride) % b.layers;
    let top = first - layer * b.stride;
    let window = (-radius..=radius).flat_map(|dy| (-radius..=radius).map(move |dx| (dx, dy)));
    for (dx, dy) in window {
        for l in layer.saturating_sub(1)..(layer + 2).min(b.layers) {
            let at = top.wrapping_add_signed(dy * b.pitch as isize + dx) + l * b.stride;
            let count = of(&b.count, at);
            if count == zero {
                continue;
            }
            let (nx, ny, nq) = (of(&b.x, at), of(&b.y, at), of(&b.q, at));
            let reach = dx.abs().max(dy.abs()).max(1) as f32;
            for k in 0..LANES {
                let (x, y, q) = (nx[k] - cx[k], ny[k] - cy[k], nq[k] - cq[k]);
                let inside = q.abs() < step[k] * reach;
                let w = if inside { count[k].min(MOST_WEIGHT) } else { 0.0 };
                let terms = [1.0, x, y, x * x, x * y, y * y];
                let mut pair = 0;
                for i in 0..TERMS {
                    let wt = w * terms[i];
                    for t in &terms[i..] {
                        s.left[pair][k] += wt * t;
                        pair += 1;
                    }
                    s.right[i][k] += wt * q;
                }
                s.qq[k] += w * q * q;
            }
        }
    }
    s
}

/// A pixel with more points counts no more than this: its mean is as good as it gets.
const MOST_WEIGHT: f32 = 8.0;

/// Added to the diagonal of the curved terms, relative to the sum of the weights: where a window has too
/// few points to tell a curve, it fits a plane.
const STIFFNESS: f32 = 0.02;

impl Window {
    /// Least squares by LDLᵀ, for all lanes at once.
    #[inline(always)]
    fn solve(&self) -> [Fit; LANES] {
        let mut m = [[[0.0; LANES]; TERMS]; TERMS];
        let mut pair = 0;
        for i in 0..TERMS {
            for j in i..TERMS {
                m[j][i] = self.left[pair];
                pair += 1;
            }
        }
        let weight = self.left[0];
        let mut good = [false; LANES];
        for k in 0..LANES {
            for i in 3..TERMS {
                m[i][i][k] += STIFFNESS * weight[k];
            }
            // Points on a line span no plane. A fifth of the ratio that three pixels of an L have.
            const THINNEST: f32 = 0.02;
            let inverse = 1.0 / weight[k];
            let xx = m[1][1][k] - m[1][0][k] * m[1][0][k] * inverse;
            let xy = m[2][1][k] - m[1][0][k] * m[2][0][k] * inverse;
            let yy = m[2][2][k] - m[2][0][k] * m[2][0][k] * inverse;
            good[k] = xx * yy - xy * xy > THINNEST * (xx + yy) * (xx + yy);
        }
        let mut rhs = self.right;
        // Forward: m becomes L with D on the diagonal, rhs becomes D⁻¹·L⁻¹·rhs.
        for i in 0..TERMS {
            for j in 0..i {
                for k in 0..LANES {
                    let mut v = m[i][j][k];
                    for l in 0..j {
                        v -= m[i][l][k] * m[j][l][k] * m[l][l][k];
                    }
                    m[i][j][k] = v / m[j][j][k];
                }
            }
            for k in 0..LANES {
                let mut v = m[i][i][k];
                let mut r = rhs[i][k];
                for l in 0..i {
                    v -= m[i][l][k] * m[i][l][k] * m[l][l][k];
                    r -= m[i][l][k] * rhs[l][k] * m[l][l][k];
                }
                m[i][i][k] = v;
                rhs[i][k] = r / v;
            }
        }
        let mut fits = [Fit::default(); LANES];
        let explained = |k: usize| (0..TERMS).map(|i| rhs[i][k] * rhs[i][k] * m[i][i][k]).sum::<f32>();
        for (k, fit) in fits.iter_mut().enumerate() {
            fit.residual = ((self.qq[k] - explained(k)) / weight[k]).max(0.0);
        }
        for i in (0..TERMS).rev() {
            for k in 0..LANES {
                for l in i + 1..TERMS {
                    rhs[i][k] -= m[l][i][k] * rhs[l][k];
                }
            }
        }
        for (k, fit) in fits.iter_mut().enumerate() {
            fit.slope = [rhs[1][k], rhs[2][k]];
            fit.good = good[k];
        }
        fits
    }
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
