//! The share of a point's cosine-weighted hemisphere that a polygon takes: Lambert's formula.
//!
//! F = 1/2π Σ θₖ nₖ·n over the edges, θₖ the angle under which an edge is seen and nₖ the normal of the plane through it and the
//! point (D. Baum, H. Rushmeier, J. Winget: *Improving radiosity solutions through the use of analytically determined form-factors*,
//! SIGGRAPH 1989, eq. 10).

use crate::clip::{clip_ring, share_before_crossing};
use glam::DVec3;

/// Form factor from a surface element to a polygon that lies in front of it and faces it, nothing between.
///
/// `normal` is that of the element, a unit vector. Positive if the polygon's front, from which it is counter-clockwise, faces `point`.
/// Exact up to rounding, which grows with the distance over the polygon's size. About 15 ns an edge.
#[must_use]
pub fn share(point: DVec3, normal: DVec3, ring: &[DVec3]) -> f64 {
    share_of_ring(normal, ring.iter().map(|&v| v - point))
}

/// As [`share`], of vertices relative to the point.
#[inline]
pub fn share_of_ring(normal: DVec3, mut ring: impl Iterator<Item = DVec3>) -> f64 {
    let Some(first) = ring.next() else { return 0.0 };
    let (mut sum, mut last) = (0.0, first);
    for v in ring {
        sum += edge(last, v, normal);
        last = v;
    }
    sum += edge(last, first, normal);
    // Rings that are counter-clockwise from their front turn clockwise about a direction that looks at it.
    -sum * (0.5 / std::f64::consts::PI)
}

/// Edges under a smaller squared tangent take the series: 14°.
const SMALL_TANGENT2: f64 = 1.0 / 16.0;
/// Terms of atan(t)/t that the above needs for an ulp.
const TERMS: usize = 13;

/// θ n_edge·n of the edge from `a` to `b`, both relative to the point.
#[inline]
fn edge(a: DVec3, b: DVec3, normal: DVec3) -> f64 {
    let cross = a.cross(b);
    let (sine2, cosine) = (cross.length_squared(), a.dot(b));
    // Most edges are seen small; neither root nor arcus tangens is needed for them.
    if cosine > 0.0 && sine2 < SMALL_TANGENT2 * cosine * cosine {
        let inverse = 1.0 / cosine;
        return normal.dot(cross) * (arctangent_over(sine2 * inverse * inverse) * inverse);
    }
    let sine = sine2.sqrt();
    if sine <= 1e-30 * (cosine.abs() + f64::MIN_POSITIVE) {
        // Seen end on, the edge has no angle; with the point on it, the plane through both is any.
        return 0.0;
    }
    normal.dot(cross) * (sine.atan2(cosine) / sine)
}

/// atan(t)/t = 1 − t²/3 + t⁴/5 − …, of small t².
#[inline]
fn arctangent_over(tangent2: f64) -> f64 {
    (0..TERMS).rev().fold(0.0, |sum, k| 1.0 / (2 * k + 1) as f64 - tangent2 * sum)
}

/// As [`share`] of a polygon that may reach below the horizon of `normal`, and be seen from behind (then negative).
#[must_use]
pub fn share_above_horizon(point: DVec3, normal: DVec3, ring: &[DVec3]) -> f64 {
    let side = |v: DVec3| normal.dot(v - point);
    if ring.iter().all(|&v| side(v) >= 0.0) {
        return share(point, normal, ring);
    }
    let mut sum = 0.0;
    let mut first: Option<DVec3> = None;
    let mut previous: Option<DVec3> = None;
    clip_ring(ring, side, crossing, |v| {
        if let Some(p) = previous {
            sum += edge(p - point, v - point, normal);
        }
        first = first.or(Some(v));
        previous = Some(v);
    });
    if let (Some(first), Some(last)) = (first, previous) {
        sum += edge(last - point, first - point, normal);
    }
    -sum * (0.5 / std::f64::consts::PI)
}

/// Where the edge from `a` to `b` meets a plane, by heights over it.
fn crossing((a, value_a): (DVec3, f64), (b, value_b): (DVec3, f64)) -> DVec3 {
    a + (b - a) * share_before_crossing(value_a, value_b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_arcus_tangens() {
        for i in 1..=1000 {
            let t2 = SMALL_TANGENT2 * f64::from(i) / 1000.0;
            let exact = t2.sqrt().atan() / t2.sqrt();
            assert!((arctangent_over(t2) - exact).abs() < 4e-16, "{t2}");
        }
    }
}
