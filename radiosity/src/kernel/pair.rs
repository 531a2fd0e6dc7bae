//! Mutual exchange A₁F₁₂ of two unoccluded polygons.
//!
//! After both are cut at the other's horizon, one of two rules is chosen by what it costs:
//!
//! * *areas*: Gauss–Legendre over both. The kernel has no singularity and nothing cancels, so this is for
//!   pairs that are far apart, where the contour form loses digits with the distance.
//! * *points*: Gauss–Legendre over the one, Lambert's exact formula for the other: for pairs of very different size.
//! * *contours*: 1/2π ∮∮ ln r dx·dy (\[1\], eq. 21), in closed form for parallel and for touching edges; for all that is near.

use std::borrow::Cow;

use glam::DVec3;

use super::edges::{Edge, Integral, Setting};
use super::gauss;
use crate::polygon::{Polygon, edges};
use pointillist_dice::lambert;

/// Heights over a horizon below this, relative to the pair, are on it: patches of one wall do not see each other.
const HORIZON: f64 = 1e-14;
/// Edges closer than this, relative to the pair, touch.
const TOUCHING: f64 = 2e-15;
/// Highest order of the quadrature over areas.
const MAX_AREA_ORDER: usize = 8;
/// Quadrature over both areas must meet the tolerance with this many evaluations; contours cost about as much.
const MAX_AREA_EVALUATIONS: usize = 1300;
/// The same for Lambert's formula, whose edges cost about twenty evaluations each.
const MAX_POINTS: usize = 50;
/// Factor on the plain estimate ρ⁻²ⁿ of the error of Gauss quadrature: a margin found by experiment, not proven. The property tests hold
/// errors against bounds.
const AREA_SAFETY: f64 = 40.0;

/// Which rule gave a factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rule {
    /// The two do not see each other.
    Apart,
    Areas,
    Points,
    Contours,
}

/// A₁F₁₂ = A₂F₂₁ with a bound on its error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mutual {
    pub(crate) value: f64,
    pub(crate) error: f64,
    pub(crate) rule: Rule,
}

impl Mutual {
    /// Of polygons that do not see each other.
    pub(crate) const NONE: Self = Self { value: 0.0, error: 0.0, rule: Rule::Apart };
}

/// The parts of two polygons in front of each other; none if they face apart.
pub(crate) fn facing_parts<'p>(
    a: &'p Polygon,
    b: &'p Polygon,
) -> Option<(Cow<'p, Polygon>, Cow<'p, Polygon>)> {
    let size = (a.centre() - b.centre()).length() + a.radius() + b.radius();
    let on_horizon = HORIZON * size;
    let (lowest_b, highest_b) = a.heights_of(b.vertices());
    if highest_b <= on_horizon {
        return None;
    }
    let (lowest_a, highest_a) = b.heights_of(a.vertices());
    if highest_a <= on_horizon {
        return None;
    }
    let part = |p: &'p Polygon, lowest: f64, plane: &Polygon| {
        if lowest >= -on_horizon { Some(Cow::Borrowed(p)) } else { p.in_front_of(plane).map(Cow::Owned) }
    };
    Some((part(a, lowest_a, b)?, part(b, lowest_b, a)?))
}

/// Exchange of two polygons without anything between, to about `tolerance` relative to itself where rounding permits.
pub(crate) fn mutual(a: &Polygon, b: &Polygon, tolerance: f64) -> Mutual {
    let Some((a, b)) = facing_parts(a, b) else { return Mutual::NONE };
    let found = mutual_of_parts(&a, &b, tolerance);
    // Neither sends more than all of it to the other, and nothing less than nothing: rounding, and what outlines are off their
    // plane, may.
    Mutual { value: found.value.clamp(0.0, a.area().min(b.area())), ..found }
}

/// As [`mutual`], of polygons that lie in front of each other.
fn mutual_of_parts(a: &Polygon, b: &Polygon, tolerance: f64) -> Mutual {
    let distance = (a.centre() - b.centre()).length();
    let gap = distance - a.radius() - b.radius();
    if gap > 0.0 {
        let (rate_a, rate_b) = (rate(gap / a.radius()), rate(gap / b.radius()));
        let (n, m) = (order(rate_a, tolerance), order(rate_b, tolerance));
        let quads = |p: &Polygon| (p.vertices().len() - 1) / 2;
        let cost = n * n * m * m * quads(a) * quads(b);
        if cost <= MAX_AREA_EVALUATIONS && n <= MAX_AREA_ORDER && m <= MAX_AREA_ORDER {
            return over_areas(a, b, (n, m), missed(rate_a, n) + missed(rate_b, m));
        }
    }
    let (small, large) = if a.radius() <= b.radius() { (a, b) } else { (b, a) };
    over_points(small, large, tolerance).unwrap_or_else(|| over_contours(a, b, tolerance))
}

/// Sum of the half-axes of the ellipse in which the kernel is analytic, for a gap in half-lengths.
fn rate(gap: f64) -> f64 {
    gap + (1.0 + gap * gap).sqrt()
}

/// Relative error of Gauss quadrature with `order` points along each side.
fn missed(rate: f64, order: usize) -> f64 {
    AREA_SAFETY * rate.powi(-2 * (order as i32 - 1))
}

/// The order for which [`missed`] is at most half the tolerance.
///
/// One more than the kernel's own decay asks for: heights over the horizon and the Jacobian of a triangle are factors of degree
/// one each, which alone take a point.
fn order(rate: f64, tolerance: f64) -> usize {
    let order = ((2.0 * AREA_SAFETY / tolerance).ln() / (2.0 * rate.ln())).ceil();
    if order < 100.0 { order.max(1.0) as usize + 1 } else { 100 }
}

/// Points of one polygon for quadrature, as separate lists for the inner loop.
#[derive(Clone, Debug)]
struct Samples {
    len: usize,
    x: [f64; MAX_AREA_POINTS],
    y: [f64; MAX_AREA_POINTS],
    z: [f64; MAX_AREA_POINTS],
    /// Weight of the point times its height over the other polygon's plane.
    weight: [f64; MAX_AREA_POINTS],
}

/// Most points of one quadrangle.
const MAX_AREA_POINTS: usize = MAX_AREA_ORDER * MAX_AREA_ORDER;

impl Samples {
    fn of(quad: &[DVec3; 4], order: usize, other: &Polygon) -> Self {
        let none = [0.0; MAX_AREA_POINTS];
        let mut list = Self { len: 0, x: none, y: none, z: none, weight: none };
        let rule = gauss::rule(order);
        for (u, weight_u) in rule.iter() {
            for (v, weight_v) in rule.iter() {
                let (p, area) = gauss::on_quad(quad, u, v);
                let from_centre = p - other.centre();
                let i = list.len;
                (list.x[i], list.y[i], list.z[i]) = (from_centre.x, from_centre.y, from_centre.z);
                list.weight[i] = weight_u * weight_v * area * other.normal().dot(from_centre);
                list.len += 1;
            }
        }
        list
    }
}

/// ∬ cos cos / πr² by quadrature over both. `missed` is the relative error to expect.
fn over_areas(a: &Polygon, b: &Polygon, (n, m): (usize, usize), missed: f64) -> Mutual {
    let mut sum = 0.0;
    let shift = a.centre() - b.centre();
    for quad_a in a.quads() {
        let of_a = Samples::of(&quad_a, n, b);
        for quad_b in b.quads() {
            let of_b = Samples::of(&quad_b, m, a);
            for i in 0..of_a.len {
                // Points of a are relative to b's centre, those of b to a's.
                let from = DVec3::new(of_a.x[i], of_a.y[i], of_a.z[i]) - shift;
                sum += of_a.weight[i] * inner_sum(&of_b, from);
            }
        }
    }
    let value = sum / std::f64::consts::PI;
    let error = value * (missed + 16.0 * f64::EPSILON);
    Mutual { value, error, rule: Rule::Areas }
}

/// Σ weight / r⁴ in four sums, so that the compiler may take them side by side.
#[inline]
fn inner_sum(b: &Samples, from: DVec3) -> f64 {
    let mut sums = [0.0; 4];
    let padded = b.len.next_multiple_of(4).min(MAX_AREA_POINTS);
    for start in (0..padded).step_by(4) {
        for (k, sum) in sums.iter_mut().enumerate() {
            let i = start + k;
            let (x, y, z) = (b.x[i] - from.x, b.y[i] - from.y, b.z[i] - from.z);
            let r2 = x * x + y * y + z * z;
            *sum += b.weight[i] / (r2 * r2);
        }
    }
    // Padding has weight 0; its distance is that of `from` to a's centre, which may be 0.
    let sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
    if sum.is_nan() { plain_sum(b, from) } else { sum }
}

/// As [`inner_sum`], without the padding.
#[cold]
fn plain_sum(b: &Samples, from: DVec3) -> f64 {
    (0..b.len)
        .map(|i| {
            let r2 = (DVec3::new(b.x[i], b.y[i], b.z[i]) - from).length_squared();
            b.weight[i] / (r2 * r2)
        })
        .sum()
}

/// Lambert's formula at points of the smaller; none if that takes too many.
fn over_points(small: &Polygon, large: &Polygon, tolerance: f64) -> Option<Mutual> {
    let centre = small.centre();
    let nearest = edges(large.vertices()).fold(f64::MAX, |d, (a, b)| d.min(distance_to_edge(centre, a, b)));
    let gap = nearest - small.radius();
    if gap <= 0.0 {
        return None;
    }
    let rate = rate(gap / small.radius());
    let n = order(rate, tolerance);
    let quads = (small.vertices().len() - 1) / 2;
    if n > gauss::MAX_ORDER || quads * n * n * large.vertices().len() > 4 * MAX_POINTS {
        return None;
    }
    let (mut sum, mut least) = (0.0, f64::MAX);
    for quad in small.quads() {
        for (u, weight_u) in gauss::rule(n).iter() {
            for (v, weight_v) in gauss::rule(n).iter() {
                let (p, area) = gauss::on_quad(&quad, u, v);
                let share = lambert::share(p, small.normal(), large.vertices());
                sum += weight_u * weight_v * area * share;
                least = least.min(share);
            }
        }
    }
    // A point's share is a sum of angles over up to 1: where it is small, digits cancel.
    let angles = large.vertices().len() as f64 * 4.0 * f64::EPSILON * small.area();
    Some(Mutual { value: sum, error: sum.abs() * missed(rate, n) + angles, rule: Rule::Points })
}

/// Distance of a point to a straight edge.
fn distance_to_edge(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    (a + along * t - p).length()
}

/// 1/2π ∮∮ ln r dx·dy.
fn over_contours(a: &Polygon, b: &Polygon, tolerance: f64) -> Mutual {
    let distance = (a.centre() - b.centre()).length();
    let size = distance + a.radius() + b.radius();
    let reference = distance.max(a.radius().min(b.radius()));
    // What is small beside the edges needs more digits of each of them.
    let small = a.radius().min(b.radius());
    let sharp = tolerance * (small / reference).min(1.0).powi(2) * 0.1;
    let setting = Setting {
        inverse_reference2: 1.0 / (reference * reference),
        touching: TOUCHING * size,
        tolerance: sharp.clamp(1e-17, 0.1),
    };
    let of = |p: &Polygon| -> Vec<Edge> {
        edges(p.vertices()).filter_map(|(from, to)| Edge::new(from, to)).collect()
    };
    let (edges_a, edges_b) = (of(a), of(b));
    let mut sum = Integral::default();
    for edge_a in &edges_a {
        for edge_b in &edges_b {
            sum += setting.over(edge_a, edge_b);
        }
    }
    let scale = 0.5 / std::f64::consts::PI;
    Mutual { value: scale * sum.value, error: scale * sum.error, rule: Rule::Contours }
}
