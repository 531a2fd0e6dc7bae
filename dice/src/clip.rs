//! Clipping a convex ring by a half-space, whatever its vertices are.

/// The part of a convex ring where `value`, an affine function of place, is not negative (Sutherland–Hodgman for one half-space).
///
/// `keep` gets its vertices in the order of the ring. Vertices on the border stay; only an edge with ends strictly on both sides gets
/// a new one: `crossing` makes it, from both ends with their values. [`share_before_crossing`] says how far from the first end it lies.
/// Values that are NaN are outside and cross nothing. Cost: one `value` a vertex.
///
/// ```
/// use glam::DVec3;
/// use pointillist_dice::{clip_ring, share_before_crossing};
///
/// // The part of a triangle above the plane z = 1.
/// let ring = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Z * 2.0];
/// let mut part = vec![];
/// clip_ring(&ring, |p| p.z - 1.0, |(a, va), (b, vb)| a.lerp(b, share_before_crossing(va, vb)), |p| part.push(p));
/// assert_eq!(part, [DVec3::Z, DVec3::new(2.0, 0.0, 1.0), DVec3::Z * 2.0]);
/// ```
#[inline]
pub fn clip_ring<V: Copy>(
    ring: &[V],
    value: impl Fn(V) -> f64,
    mut crossing: impl FnMut((V, f64), (V, f64)) -> V,
    mut keep: impl FnMut(V),
) {
    let Some(&(mut a)) = ring.last() else { return };
    let mut value_a = value(a);
    for &b in ring {
        let value_b = value(b);
        if (value_a < 0.0 && value_b > 0.0) || (value_a > 0.0 && value_b < 0.0) {
            keep(crossing((a, value_a), (b, value_b)));
        }
        if value_b >= 0.0 {
            keep(b);
        }
        (a, value_a) = (b, value_b);
    }
}

/// Where an affine function with these values of opposite sign at the ends of an edge is 0, from 0 at the first end to 1 at the second.
#[must_use]
#[inline]
pub fn share_before_crossing(value_a: f64, value_b: f64) -> f64 {
    value_a / (value_a - value_b)
}
