//! Where surfaces end: a smooth curve through the last pixels of the buffer that hold them.
//!
//! Whether a surface reaches a pixel is decided by single points, so that the row of its last pixels is ragged. Blurred by a Gaussian of
//! standard deviation σ, the share of pixels that hold the surface is Φ(s/σ) at a distance s inside a straight border. Solved for s, that is
//! how far inside its outline a corner lies. A pixel with fewer points than its surroundings holds the surface in part. Where a surface is less
//! than three pixels wide, it ends as far beyond its last corners as [`Options::outline`](crate::Options::outline) says.

use crate::border::PAD;
use crate::buffer::{Buffer, DepthScale, STEP};
use crate::parallel::*;

/// Pixels to each side that the blur looks at: as far as the buffer's border reaches.
const RADIUS: usize = PAD;
const SIDE: usize = 2 * RADIUS + 1;

/// Standard deviation of the blur in pixels. Found by experiment, as the next two (`studies -- ibpr`).
const SIGMA: f32 = 1.8;

/// A pixel with this share of the points that its surroundings hold in the mean is taken to be full.
const FULL: f32 = 0.7;

/// Pixels from the outline that is found inward to the true one, at the default reach of outlines: pixels count as soon as they hold a few points.
const FOUND_OUTSIDE: f32 = 0.6;

/// Corners farther inside need not be told apart, in pixels.
const DEEP: f32 = 3.0;

/// Pixels to each side within which a surface must end for its outline to be looked for: what lies deeper is covered in any case.
const NEAR: usize = 1;

/// Rows per task.
const BAND_ROWS: usize = 16;

/// The outline of its surface, as seen from a corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outline {
    /// Pixels from the corner to the outline, below 0 outside.
    pub(crate) inside: f32,
    /// Unit vector away from the outline; zero where there is none to be found.
    pub(crate) inward: (f32, f32),
}

impl Outline {
    /// There is none near, or the surface is too narrow to have one.
    const NONE: Self = Self { inside: DEEP, inward: (0.0, 0.0) };

    pub(crate) fn is_some(&self) -> bool {
        self.inward != (0.0, 0.0)
    }
}

/// The outlines of a buffer of one layer.
#[derive(Debug, Default)]
pub(crate) struct Outlines {
    /// For each entry of the buffer; empty if none were asked for.
    pub(crate) list: Vec<Outline>,
    /// Entries beside which their surface ends.
    ends: Vec<bool>,
}

impl Outlines {
    /// Finds none.
    pub(crate) fn clear(&mut self) {
        self.list.clear();
    }

    /// Finds those of all entries.
    pub(crate) fn find(&mut self, buffer: &Buffer, scale: &DepthScale) {
        let Self { list, ends } = self;
        let (len, n) = (buffer.count.len(), BAND_ROWS * buffer.pitch);
        ends.clear();
        ends.resize(len, false);
        chunks(&mut ends[buffer.inner()], n).enumerate().for_each(|(i, rows)| {
            for (k, ends) in rows.iter_mut().enumerate() {
                *ends = surface_ends(buffer, scale, buffer.inner().start + i * n + k);
            }
        });
        list.clear();
        list.resize(len, Outline::NONE);
        let search = Search { buffer, scale, ends, weights: weights() };
        chunks(&mut list[buffer.inner()], n).enumerate().for_each(|(i, rows)| {
            for (r, row) in rows.chunks_mut(buffer.pitch).enumerate() {
                search.row(i * BAND_ROWS + r, &mut row[PAD..PAD + buffer.width]);
            }
        });
    }
}

/// Whether a pixel holds a surface that a direct neighbour does not hold.
fn surface_ends(buffer: &Buffer, scale: &DepthScale, at: usize) -> bool {
    if buffer.count[at] == 0.0 {
        return false;
    }
    let step = scale.bent_step(buffer.q[at], STEP);
    let apart = |n: usize| buffer.count[n] == 0.0 || (buffer.q[n] - buffer.q[at]).abs() >= step;
    [at - 1, at + 1, at - buffer.pitch, at + buffer.pitch].into_iter().any(apart)
}

type Weights = [[f32; SIDE]; SIDE];

/// The blur's weights, of sum 1.
fn weights() -> Weights {
    let one = |i: usize| {
        let d = i as f32 - RADIUS as f32;
        (-0.5 * d * d / (SIGMA * SIGMA)).exp()
    };
    let sum: f32 = (0..SIDE).map(one).sum();
    std::array::from_fn(|y| std::array::from_fn(|x| one(x) * one(y) / (sum * sum)))
}

/// What the search for outlines needs.
struct Search<'a> {
    buffer: &'a Buffer,
    scale: &'a DepthScale,
    ends: &'a [bool],
    weights: Weights,
}

impl Search<'_> {
    /// The outlines of a row of pixels.
    fn row(&self, row: usize, out: &mut [Outline]) {
        let b = self.buffer;
        let first = b.at(0, row) - NEAR * b.pitch - NEAR;
        // Nearly all pixels are far from where a surface ends: first the columns are looked at, then each pixel's.
        let ends_in = |column: &usize| (0..=2 * NEAR).any(|y| self.ends[first + y * b.pitch + column]);
        let mut next = (0..b.width + 2 * NEAR).filter(ends_in).peekable();
        for (column, out) in out.iter_mut().enumerate() {
            while next.next_if(|c| *c < column).is_some() {}
            if next.peek().is_some_and(|c| *c <= column + 2 * NEAR) && b.count[b.at(column, row)] > 0.0 {
                *out = self.outline(column, row);
            }
        }
    }

    fn outline(&self, column: usize, row: usize) -> Outline {
        let at = self.buffer.at(column, row);
        let window = self.window(at);
        if !window.is_wide {
            return Outline::NONE;
        }
        let full = if window.holding > 0.0 { FULL * window.points / window.holding } else { 1.0 };
        let (mut share, mut gx, mut gy) = (0.0, 0.0, 0.0);
        for (y, (row, weights)) in window.count.iter().zip(&self.weights).enumerate() {
            let (mut sum, mut moment) = (0.0, 0.0);
            for (x, (count, w)) in row.iter().zip(weights).enumerate() {
                let w = w * (count / full).min(1.0);
                sum += w;
                moment += w * (x as f32 - RADIUS as f32);
            }
            share += sum;
            gx += moment;
            gy += sum * (y as f32 - RADIUS as f32);
        }
        let length = gx.hypot(gy);
        if length < 1e-6 {
            return Outline::NONE;
        }
        let inward = (gx / length, gy / length);
        // What the blur misses beyond the other border of a narrow surface.
        let missed = normal_share(-self.depth(at, inward) / SIGMA);
        let (x, y) = (column as f32 + 0.5, row as f32 + 0.5);
        // The blur is asked at the pixel's centre, and the corner is beside it.
        let along = (self.buffer.x[at] - x) * inward.0 + (self.buffer.y[at] - y) * inward.1;
        let inside = (SIGMA * normal_quantile(share + missed) + along).min(DEEP) - FOUND_OUTSIDE;
        Outline { inside, inward }
    }

    fn window(&self, at: usize) -> Window {
        let b = self.buffer;
        let q = b.q[at];
        let step = self.scale.bent_step(q, STEP);
        let first = at - RADIUS * b.pitch - RADIUS;
        let mut window = Window::default();
        for (y, out) in window.count.iter_mut().enumerate() {
            let row = first + y * b.pitch..first + y * b.pitch + SIDE;
            let (counts, depths, ends) = (&b.count[row.clone()], &b.q[row.clone()], &self.ends[row]);
            let (mut points, mut holding, mut wide) = (0.0, 0.0, false);
            // Without branches, so that neighbours are looked at side by side.
            for x in 0..SIDE {
                let (count, apart, weight) = (counts[x], depths[x] - q, self.weights[y][x]);
                let most = step * y.abs_diff(RADIUS).max(x.abs_diff(RADIUS)) as f32;
                let is_there = count > 0.0;
                let holds = is_there & (apart.abs() <= most);
                // A filled gap counts as less than a point.
                let is_measured = holds & (count >= 1.0);
                // Under a nearer surface this one goes on.
                let goes_on = (is_there & (apart < -most)) | (holds & !is_measured);
                out[x] = if is_measured { count } else { 0.0 } + if goes_on { f32::MAX } else { 0.0 };
                points += if is_measured { weight * count } else { 0.0 };
                holding += if is_measured { weight } else { 0.0 };
                wide |= holds & !ends[x];
            }
            window.points += points;
            window.holding += holding;
            window.is_wide |= wide;
        }
        window
    }

    /// Pixels to the last one of a surface in a direction, at most as many as the blur would see.
    fn depth(&self, at: usize, (dx, dy): (f32, f32)) -> f32 {
        const MOST: usize = 2 * RADIUS;
        let b = self.buffer;
        let step = self.scale.bent_step(b.q[at], STEP);
        let goes_on = |k: &usize| {
            let k = *k as f32;
            let place = (k * dy).round() as isize * b.pitch as isize + (k * dx).round() as isize;
            let n = at.wrapping_add_signed(place);
            b.count.get(n).is_some_and(|c| *c > 0.0) && b.q[n] <= b.q[at] + k * step
        };
        (1..MOST).rev().find(goes_on).unwrap_or(0) as f32 + 0.5
    }
}

/// What a surface's pixel sees around it.
#[derive(Default)]
struct Window {
    /// Points of the surface; above all numbers of points where it goes on under a nearer one, or a gap was filled.
    count: [[f32; SIDE]; SIDE],
    /// Sums of weight × points and of weights over pixels with points of the surface.
    points: f32,
    holding: f32,
    /// The surface goes on to all sides of some pixel.
    is_wide: bool,
}

/// Φ: by the logistic function that is closest to it, to 0.01.
fn normal_share(z: f32) -> f32 {
    1.0 / (1.0 + (-1.702 * z).exp())
}

/// Φ⁻¹, to 5e-4 (Hastings' rational approximation: Abramowitz & Stegun, Handbook of Mathematical Functions, 26.2.23).
fn normal_quantile(p: f32) -> f32 {
    let tail = p.min(1.0 - p).max(1e-6);
    let t = (-2.0 * tail.ln()).sqrt();
    let numerator = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    let denominator = 1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308));
    let above = t - numerator / denominator;
    if p < 0.5 { -above } else { above }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A buffer of one depth that holds a point where `holds` says so.
    fn buffer(size: usize, holds: impl Fn(f32, f32) -> bool) -> Buffer {
        let mut b = Buffer::default();
        b.reshape(size, size, 1);
        for row in 0..size {
            for column in 0..size {
                let (at, x, y) = (b.at(column, row), column as f32 + 0.5, row as f32 + 0.5);
                if holds(x, y) {
                    (b.count[at], b.x[at], b.y[at]) = (1.0, x, y);
                }
            }
        }
        b
    }

    const SCALE: DepthScale = DepthScale { spacing: 1.0, footprint: 1.0, bend: 0.0 };

    #[test]
    fn quantiles_invert_the_normal_distribution() {
        for (p, z) in [(0.5, 0.0), (0.841_344_7, 1.0), (0.977_249_9, 2.0), (0.158_655_25, -1.0)] {
            assert!((normal_quantile(p) - z).abs() < 1e-3, "{p}");
        }
    }

    #[test]
    fn corners_know_how_far_inside_a_straight_border_they_are() {
        for normal in [(1.0, 0.0), (0.0, -1.0), (0.6, 0.8), (-0.8, 0.6)] {
            let inside = |x: f32, y: f32| (x - 16.0) * normal.0 + (y - 16.0) * normal.1;
            let b = buffer(32, |x, y| inside(x, y) > 0.0);
            let mut outlines = Outlines::default();
            outlines.find(&b, &SCALE);
            for (row, column) in (10..22).flat_map(|r| (10..22).map(move |c| (r, c))) {
                let o = outlines.list[b.at(column, row)];
                let s = inside(column as f32 + 0.5, row as f32 + 0.5);
                if s > 0.0 && s < 2.0 {
                    assert!((o.inside + FOUND_OUTSIDE - s).abs() < 0.35, "{s} {o:?}");
                    assert!(o.inward.0 * normal.0 + o.inward.1 * normal.1 > 0.98, "{o:?}");
                }
            }
        }
    }

    #[test]
    fn a_crumb_beside_a_surface_is_outside_of_it_and_a_thread_is_left_alone() {
        let b = buffer(40, |x, y| x > 20.0 || (x as usize, y as usize) == (17, 20));
        let mut outlines = Outlines::default();
        outlines.find(&b, &SCALE);
        assert!(outlines.list[b.at(17, 20)].inside < -1.0);
        let thread = buffer(40, |x, _| x > 20.0 && x < 22.0);
        outlines.find(&thread, &SCALE);
        assert!(outlines.list.iter().all(|o| !o.is_some()));
    }
}
