//! The share of a point's cosine-weighted hemisphere that a polygon takes: Lambert's formula.

use glam::DVec3;

use crate::polygon::edges;

/// Form factor from a surface element to a polygon that lies in front of it and faces it, nothing between.
///
/// F = 1/2π Σ θₖ nₖ·n over the edges, θₖ the angle under which an edge is seen and nₖ the normal of the plane through it and the
/// point (\[1\], eq. 10). Positive if the polygon's front faces `point`. Exact up to rounding, which grows
/// with the distance over the polygon's size.
pub(crate) fn share(point: DVec3, normal: DVec3, ring: &[DVec3]) -> f64 {
    let mut sum = 0.0;
    let Some(&last) = ring.last() else { return 0.0 };
    let mut a = last - point;
    for &v in ring {
        let b = v - point;
        sum += edge(a, b, normal);
        a = b;
    }
    // Rings that are counter-clockwise from their front turn clockwise about a direction that looks at it.
    -sum * (0.5 / std::f64::consts::PI)
}

/// θ n_edge·n of the edge from `a` to `b`, both relative to the point.
#[inline]
fn edge(a: DVec3, b: DVec3, normal: DVec3) -> f64 {
    let cross = a.cross(b);
    let (sine, cosine) = (cross.length(), a.dot(b));
    if sine <= 1e-30 * (cosine.abs() + f64::MIN_POSITIVE) {
        // Seen end on, the edge has no angle; with the point on it, the plane through both is any.
        return 0.0;
    }
    normal.dot(cross) * (sine.atan2(cosine) / sine)
}

/// As [`share`] of a polygon that may reach below the horizon of `normal`, and be seen from behind (then negative).
pub(crate) fn share_above_horizon(point: DVec3, normal: DVec3, ring: &[DVec3]) -> f64 {
    let side = |v: DVec3| normal.dot(v - point);
    if ring.iter().all(|&v| side(v) >= 0.0) {
        return share(point, normal, ring);
    }
    let mut sum = 0.0;
    let mut first: Option<DVec3> = None;
    let mut previous: Option<DVec3> = None;
    let mut visit = |v: DVec3| {
        if let Some(p) = previous {
            sum += edge(p - point, v - point, normal);
        }
        first = first.or(Some(v));
        previous = Some(v);
    };
    for (a, b) in edges(ring) {
        let (sa, sb) = (side(a), side(b));
        if (sa < 0.0 && sb > 0.0) || (sa > 0.0 && sb < 0.0) {
            visit(a + (b - a) * (sa / (sa - sb)));
        }
        if sb >= 0.0 {
            visit(b);
        }
    }
    if let (Some(first), Some(last)) = (first, previous) {
        sum += edge(last - point, first - point, normal);
    }
    -sum * (0.5 / std::f64::consts::PI)
}
