//! Curved surfaces fitted to windows of averaged points, several pixels at a time.

use crate::buffer::{Buffer, DepthScale, STEP};
use pulp::NullaryFnOnce;

/// Pixels that are fitted together.
pub(crate) const LANES: usize = 8;

/// Unknowns of the fitted surface: c + a·x + b·y + d·x² + e·x·y + f·y².
const TERMS: usize = 6;

/// Entries of the upper triangle of the normal equations.
const PAIRS: usize = TERMS * (TERMS + 1) / 2;

/// A value for each of the pixels that are fitted together.
type Lanes = [f32; LANES];

/// A fitted surface at its pixel.
#[derive(Clone, Copy, Default)]
pub(crate) struct Fit {
    pub(crate) slope: [f32; 2],
    /// Mean square distance of the averaged points from the surface, along the view; 0 if not asked for.
    pub(crate) residual: f32,
    pub(crate) good: bool,
}

/// The fits of [`LANES`] neighbouring pixels, with their residuals or without, compiled once more for each kind of
/// vector instructions: the same operations in the same order, so results do not change.
pub(crate) struct Chunk<'a, const RESIDUAL: bool> {
    pub(crate) b: &'a Buffer,
    pub(crate) first: usize,
    pub(crate) scale: &'a DepthScale,
    pub(crate) radius: usize,
}

impl<const RESIDUAL: bool> NullaryFnOnce for Chunk<'_, RESIDUAL> {
    type Output = [Fit; LANES];

    // Not a closure: it would not be inlined into the vectorised caller, and would be compiled without the wide
    // instructions.
    #[inline(always)]
    fn call(self) -> [Fit; LANES] {
        let mut step = [0.0; LANES];
        for (s, q) in step.iter_mut().zip(&self.b.q[self.first..self.first + LANES]) {
            *s = self.scale.bent_step(*q, STEP);
        }
        sum_window(self.b, self.first, &step, self.radius as isize).solve::<RESIDUAL>()
    }
}

/// Normal equations over a window.
#[derive(Clone, Copy)]
struct Window {
    /// Row by row from the diagonal on.
    left: [Lanes; PAIRS],
    right: [Lanes; TERMS],
    /// Sum of w·q².
    qq: Lanes,
}

#[inline(always)]
fn sum_window(b: &Buffer, first: usize, step: &Lanes, radius: isize) -> Window {
    let zero = [0.0; LANES];
    let mut s = Window { left: [zero; PAIRS], right: [zero; TERMS], qq: zero };
    let of = |array: &[f32], at: usize| -> Lanes {
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

/// Largest weight of a pixel in a fit, in points: the means of pixels with more points are hardly more accurate.
const MOST_WEIGHT: f32 = 8.0;

/// Added to the diagonal of the curved terms, relative to the sum of the weights: where a window has too few points to
/// determine curvature, the fit is a plane.
const STIFFNESS: f32 = 0.02;

impl Window {
    /// Least squares for all lanes at once, by LDLᵀ: (1) the lower half of the normal equations, (2) L and
    /// D, with the right side carried along, (3) the residual, (4) back substitution.
    #[inline(always)]
    fn solve<const RESIDUAL: bool>(&self) -> [Fit; LANES] {
        let mut m = [[[0.0; LANES]; TERMS]; TERMS];
        self.fill_lower(&mut m);
        let good = self.spans_plane();
        let mut rhs = self.right;
        decompose(&mut m, &mut rhs);
        let mut fits = [Fit::default(); LANES];
        for (k, fit) in fits.iter_mut().enumerate().filter(|_| RESIDUAL) {
            let explained: f32 = (0..TERMS).map(|i| rhs[i][k] * rhs[i][k] * m[i][i][k]).sum();
            fit.residual = ((self.qq[k] - explained) / self.left[0][k]).max(0.0);
        }
        substitute_back(&m, &mut rhs);
        for (k, fit) in fits.iter_mut().enumerate() {
            fit.slope = [rhs[1][k], rhs[2][k]];
            fit.good = good[k];
        }
        fits
    }

    #[inline(always)]
    fn fill_lower(&self, m: &mut Matrix) {
        let mut pair = 0;
        for i in 0..TERMS {
            for row in &mut m[i..] {
                row[i] = self.left[pair];
                pair += 1;
            }
        }
        let weight = self.left[0];
        for (i, row) in m.iter_mut().enumerate().skip(CURVED) {
            for (v, w) in row[i].iter_mut().zip(weight) {
                *v += STIFFNESS * w;
            }
        }
    }

    /// Whether the points of each lane are not all on a line.
    #[inline(always)]
    fn spans_plane(&self) -> [bool; LANES] {
        // A fifth of the ratio that three pixels of an L have.
        const THINNEST: f32 = 0.02;
        let [w, x, y] = [0, 1, 2].map(|i| &self.left[i]);
        let [sxx, sxy, syy] = [TERMS, TERMS + 1, 2 * TERMS - 1].map(|i| &self.left[i]);
        let mut spans = [false; LANES];
        for (k, spans) in spans.iter_mut().enumerate() {
            let inverse = 1.0 / w[k];
            let xx = sxx[k] - x[k] * x[k] * inverse;
            let xy = sxy[k] - x[k] * y[k] * inverse;
            let yy = syy[k] - y[k] * y[k] * inverse;
            *spans = xx * yy - xy * xy > THINNEST * (xx + yy) * (xx + yy);
        }
        spans
    }
}

type Matrix = [[Lanes; TERMS]; TERMS];

/// First of the terms that bend the surface.
const CURVED: usize = 3;

/// `m` becomes L with D on the diagonal, `rhs` becomes D⁻¹·L⁻¹·rhs.
///
/// Lanes are the innermost loops, which the compiler vectorises.
#[inline(always)]
fn decompose(m: &mut Matrix, rhs: &mut [Lanes; TERMS]) {
    for i in 0..TERMS {
        // D·L of this row, which every entry needs.
        let mut scaled = [[0.0; LANES]; TERMS];
        for j in 0..i {
            let mut v = m[i][j];
            for l in 0..j {
                v = minus_product(v, &scaled[l], &m[j][l]);
            }
            scaled[j] = v;
            m[i][j] = lanes(|k| v[k] / m[j][j][k]);
        }
        let (mut v, mut r) = (m[i][i], rhs[i]);
        for l in 0..i {
            v = minus_product(v, &m[i][l], &scaled[l]);
            r = minus_product(r, &rhs[l], &scaled[l]);
        }
        m[i][i] = v;
        rhs[i] = lanes(|k| r[k] / v[k]);
    }
}

/// `rhs` becomes L⁻ᵀ·rhs.
#[inline(always)]
fn substitute_back(m: &Matrix, rhs: &mut [Lanes; TERMS]) {
    for i in (0..TERMS).rev() {
        for l in i + 1..TERMS {
            rhs[i] = minus_product(rhs[i], &m[l][i], &rhs[l]);
        }
    }
}

#[inline(always)]
fn lanes(value: impl Fn(usize) -> f32) -> Lanes {
    std::array::from_fn(value)
}

/// v − a·b
#[inline(always)]
fn minus_product(v: Lanes, a: &Lanes, b: &Lanes) -> Lanes {
    lanes(|k| v[k] - a[k] * b[k])
}
