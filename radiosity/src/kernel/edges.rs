//! ∬ ln r over two straight edges, the terms of the contour form of a form factor (\[1\]).
//!
//! Edges that are parallel, or that touch, are integrated in closed form; so nothing that is left has a singularity, and
//! Gauss–Legendre quadrature of the analytic inner integral converges geometrically, at a rate that the gap between
//! the edges gives.

use glam::DVec3;

use super::gauss;

/// Edges whose directions differ by less (sine) are parallel: what rounding makes of patches of a turned wall.
const PARALLEL: f64 = 1e-13;
/// Edges whose directions have a smaller cosine do not contribute.
const PERPENDICULAR: f64 = 1e-15;
/// Parallel edges farther apart than this many lengths are left to quadrature: the closed form subtracts
/// numbers of the size of the squared distance.
const PARALLEL_REACH: f64 = 3.0;
/// Pieces shorter than this, relative to the edge, are no longer halved.
const SHORTEST_PIECE: f64 = 1e-18;
/// Towards a point it takes some sixty; edges that run side by side a hair apart, but are not parallel, would take any number. What is left
/// is in the error.
const MAX_HALVINGS: usize = 400;

/// A directed edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub(crate) start: DVec3,
    pub(crate) end: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) length: f64,
}

impl Edge {
    /// The edge from `start` to `end`; none if they are one point.
    pub(crate) fn new(start: DVec3, end: DVec3) -> Option<Self> {
        let length = (end - start).length();
        (length > 0.0).then(|| Self { start, end, direction: (end - start) / length, length })
    }
}

/// A value, a bound on the rounding in it and one on what quadrature left out.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Integral {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

impl std::ops::AddAssign for Integral {
    fn add_assign(&mut self, other: Self) {
        self.value += other.value;
        self.error += other.error;
    }
}

/// What all pairs of one contour integral share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting {
    /// Distances are divided by this before the logarithm; any positive value gives the same sum over closed
    /// contours, one of the size of the distances the smallest rounding.
    pub(crate) inverse_reference2: f64,
    /// Edges that come this close touch.
    pub(crate) touching: f64,
    /// Accuracy of quadrature, relative to the product of the lengths.
    pub(crate) tolerance: f64,
}

impl Setting {
    /// ∬ ln r dx·dy over two edges.
    pub(crate) fn over(&self, a: &Edge, b: &Edge) -> Integral {
        let cosine = a.direction.dot(b.direction);
        if cosine.abs() < PERPENDICULAR {
            return Integral::default();
        }
        let (a, b) = if a.length <= b.length { (a, b) } else { (b, a) };
        let (gap, meeting) = gap(a, b);
        let sine2 = a.direction.cross(b.direction).length_squared();
        if sine2 < PARALLEL * PARALLEL && gap < PARALLEL_REACH * b.length {
            return self.parallel(a, b);
        }
        let plain = if gap <= self.touching {
            self.touching_at(meeting, a, b, cosine)
        } else {
            self.quadrature(a, b, gap)
        };
        Integral { value: cosine * plain.value, error: cosine.abs() * plain.error }
    }

    /// Signed ∬ of two parallel edges: second differences of G with G″ = ln r.
    fn parallel(&self, a: &Edge, b: &Edge) -> Integral {
        let along = a.direction;
        let (to_start, to_end) = (b.start - a.start, b.end - a.start);
        let (t0, t1) = (to_start.dot(along), to_end.dot(along));
        let distance = (to_start - along * t0).length();
        let second = |x: f64| {
            let (x2, h2) = (x * x, distance * distance);
            let log = 0.25 * (x2 - h2) * self.ln(x2 + h2);
            let angle = if distance > 0.0 { distance * x * (x / distance).atan() } else { 0.0 };
            (log - 0.75 * x2 + angle, log.abs() + 0.75 * x2 + angle.abs())
        };
        let mut sum = Integral::default();
        for (x, sign) in [(a.length - t0, 1.0), (-t0, -1.0), (a.length - t1, -1.0), (-t1, 1.0)] {
            let (value, size) = second(x);
            sum += Integral { value: sign * value, error: 2.0 * f64::EPSILON * size };
        }
        sum
    }

    /// ∬ of two edges whose lines meet at `o`.
    ///
    /// I(s, t) = ∫₀ˢ∫₀ᵗ ln r is homogeneous up to a logarithm, so that Euler's theorem gives it from its own two
    /// derivatives: I = ½ (s ∂I/∂s + t ∂I/∂t − s t).
    fn touching_at(&self, o: DVec3, a: &Edge, b: &Edge, cosine: f64) -> Integral {
        let sine = a.direction.cross(b.direction).length();
        let one = |s: f64, t: f64| {
            let over_t = self.along_line(-s * cosine, s.abs() * sine, t);
            let over_s = self.along_line(-t * cosine, t.abs() * sine, s);
            0.5 * (s * over_t + t * over_s - s * t)
        };
        let s = [(a.start - o).dot(a.direction), (a.end - o).dot(a.direction)];
        let t = [(b.start - o).dot(b.direction), (b.end - o).dot(b.direction)];
        let terms = [one(s[1], t[1]), -one(s[0], t[1]), -one(s[1], t[0]), one(s[0], t[0])];
        let size: f64 = terms.iter().map(|v| v.abs()).sum();
        let products = a.length * b.length;
        Integral { value: terms.iter().sum(), error: 4.0 * f64::EPSILON * (size + products) }
    }

    /// ∫ ln r over a straight piece that starts `w` after the foot of the perpendicular, `h` away from it.
    #[inline]
    fn along_line(&self, w: f64, h: f64, length: f64) -> f64 {
        let end = w + length;
        let h2 = h * h;
        let logs = 0.5 * (end * self.ln(end * end + h2) - w * self.ln(w * w + h2));
        let angle = if h > 0.0 { h * (length * h).atan2(h2 + w * end) } else { 0.0 };
        logs - length + angle
    }

    /// ln r² in units of the reference; 0 at 0, where it is always multiplied by 0.
    #[inline]
    fn ln(&self, r2: f64) -> f64 {
        if r2 > 0.0 { (r2 * self.inverse_reference2).ln() } else { 0.0 }
    }

    /// ∬ by Gauss–Legendre along `a`, halved where `b` is near.
    fn quadrature(&self, a: &Edge, b: &Edge, gap_of_all: f64) -> Integral {
        let mut sum = Integral::default();
        let mut stack = [(0.0, 0.0, 0.0); 80];
        stack[0] = (0.0, 1.0, gap_of_all);
        let (mut height, mut halvings) = (1, 0);
        while height > 0 {
            height -= 1;
            let (from, to, near) = stack[height];
            let half = 0.5 * (to - from) * a.length;
            if near < 2.0 * half
                && to - from > SHORTEST_PIECE
                && height + 2 <= stack.len()
                && halvings < MAX_HALVINGS
            {
                halvings += 1;
                let middle = 0.5 * (from + to);
                for (f, t) in [(middle, to), (from, middle)] {
                    let piece = part(a, f, t);
                    stack[height] = (f, t, piece.map_or(0.0, |p| gap(&p, b).0));
                    height += 1;
                }
                continue;
            }
            sum += self.piece(a, b, (from, to), near / half);
        }
        sum
    }

    /// One piece of `a`, with `b` at least `ratio` half-lengths away.
    fn piece(&self, a: &Edge, b: &Edge, (from, to): (f64, f64), ratio: f64) -> Integral {
        // The integrand is analytic in the ellipse with foci at the ends that reaches to b.
        let rate = ratio + (1.0 + ratio * ratio).sqrt();
        let wanted = (-self.tolerance.ln() / (2.0 * rate.ln())).ceil();
        let order = if wanted < 14.0 { wanted.max(2.0) as usize } else { 14 };
        let mut sum = 0.0;
        let mut size = 0.0_f64;
        for (x, weight) in gauss::rule(order).iter() {
            let p = a.start + a.direction * (a.length * (from + (to - from) * x));
            let q = b.start - p;
            let foot = q.dot(b.direction);
            let inner = self.along_line(foot, (q - b.direction * foot).length(), b.length);
            sum += weight * inner;
            size = size.max(inner.abs());
        }
        let length = (to - from) * a.length;
        let missed = rate.powi(-2 * order as i32);
        let error = length * (2.0 * f64::EPSILON * (size + b.length) + missed * b.length);
        Integral { value: length * sum, error }
    }
}

/// The part of an edge between two of its parameters.
fn part(a: &Edge, from: f64, to: f64) -> Option<Edge> {
    let at = |t: f64| a.start + a.direction * (a.length * t);
    let length = (to - from) * a.length;
    (length > 0.0).then(|| Edge { start: at(from), end: at(to), direction: a.direction, length })
}

/// Distance between two edges and the point of the first that is nearest to the second.
pub(crate) fn gap(a: &Edge, b: &Edge) -> (f64, DVec3) {
    let between = a.start - b.start;
    let cosine = a.direction.dot(b.direction);
    let (along_a, along_b) = (a.direction.dot(between), b.direction.dot(between));
    let sine2 = 1.0 - cosine * cosine;
    let s = if sine2 > 1e-12 { ((cosine * along_b - along_a) / sine2).clamp(0.0, a.length) } else { 0.0 };
    // Alternating projections; the segments' nearest points are reached in two rounds unless they are nearly parallel.
    let nearest = |s: f64| {
        let t = (s * cosine + along_b).clamp(0.0, b.length);
        let s = (t * cosine - along_a).clamp(0.0, a.length);
        let t = (s * cosine + along_b).clamp(0.0, b.length);
        let p = a.start + a.direction * s;
        ((p - (b.start + b.direction * t)).length_squared(), p)
    };
    let mut best = nearest(s);
    if sine2 <= 1e-12 {
        let other = nearest(a.length);
        if other.0 < best.0 {
            best = other;
        }
    }
    (best.0.sqrt(), best.1)
}
