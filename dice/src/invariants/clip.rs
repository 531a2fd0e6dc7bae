//! Facts about clipping by a half-plane.

use super::check;
use crate::convex::{self, HalfPlane};
use crate::{clip_ring, share_before_crossing};
use glam::DVec2;

/// A ring, convex or not, with finite corners: both its parts lie on their sides of the line within rounding, keep the corners of their side,
/// share their new corners bit for bit, and their areas add up to that of the ring. (Without a normal, all of the plane is its border, and both
/// parts are the whole ring.)
pub fn clipping_divides(ring: &[DVec2], half: &HalfPlane) -> Result<(), String> {
    if half.normal == DVec2::ZERO {
        return Ok(());
    }
    let part = |sign: f64| {
        let (mut corners, mut new) = (vec![], vec![]);
        let crossing = |(a, va): (DVec2, f64), (b, vb): (DVec2, f64)| {
            let p = a + (b - a) * share_before_crossing(va, vb);
            new.push(p);
            p
        };
        clip_ring(ring, |p| sign * half.value(p), crossing, |p| corners.push(p));
        (corners, new)
    };
    let ((inside, cuts), (outside, same_cuts)) = (part(1.0), part(-1.0));
    check(cuts == same_cuts, || format!("the parts have different crossings: {cuts:?}, {same_cuts:?}"))?;
    let kept = |sign: f64| ring.iter().filter(|&&p| sign * half.value(p) >= 0.0).count();
    check(inside.len() == kept(1.0) + cuts.len() && outside.len() == kept(-1.0) + cuts.len(), || {
        "a corner is lost or doubled".to_owned()
    })?;
    let size = ring.iter().chain([&half.anchor]).fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    let slack = 16.0 * f64::EPSILON * (size * half.normal.abs().max_element() + half.offset.abs());
    let on_side = |corners: &[DVec2], sign: f64| corners.iter().all(|&p| sign * half.value(p) >= -slack);
    check(on_side(&inside, 1.0) && on_side(&outside, -1.0), || "a corner is on the wrong side".to_owned())?;
    let (sum, whole) = (convex::area(&inside) + convex::area(&outside), convex::area(ring));
    let rounding = 64.0 * f64::EPSILON * size * size * ring.len() as f64;
    check((sum - whole).abs() <= rounding, || format!("areas add up to {sum}, not {whole}"))
}
