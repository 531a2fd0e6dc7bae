//! Surfaces cut along the contact lines of other surfaces that stand on them.
//!
//! Radiosity is discontinuous there: the floor is dark under a box and lit beside it (discontinuity meshing of order 0). A patch on both
//! sides of the line would have the mean of both radiosities, and would light the foot of the box with it.

use glam::DVec3;

use crate::polygon::{Polygon, clipped, edges};

/// An edge stands on a surface if the distance of both its ends to the plane is at most this, times the radius of the surface.
const STANDING: f64 = 1e-7;
/// A cut is left out if one of its sides extends less far from the cut than this, or if the contact line within the part is shorter, times
/// the radius of the part.
const LEAST_PART: f64 = 1e-6;
/// Planes are parallel if the sine of the angle between their normals is below this.
const PARALLEL: f64 = 1e-6;
/// Most parts of one surface. Further contact lines are not cut along; patches there are only limited by the patch size.
const MAX_PARTS: usize = 256;

/// The parts into which the edges of `others` that stand on a surface divide it; the surface itself if there are none.
pub(crate) fn parts<'p>(polygon: &Polygon, others: impl Iterator<Item = &'p Polygon>) -> Vec<Polygon> {
    let mut list = vec![polygon.clone()];
    let standing = STANDING * polygon.radius();
    for other in others {
        let far = (other.centre() - polygon.centre()).length() > other.radius() + polygon.radius();
        if far || other.normal().cross(polygon.normal()).length() < PARALLEL {
            continue;
        }
        for (a, b) in edges(other.vertices()) {
            let on_it = |p: DVec3| polygon.height(p).abs() <= standing;
            if list.len() < MAX_PARTS && on_it(a) && on_it(b) {
                list = list.iter().flat_map(|part| divided(part, other, (a, b))).collect();
            }
        }
    }
    list
}

/// The part divided by the plane of `other`, if the contact line from `a` to `b` runs through it; else the part as it is.
fn divided(part: &Polygon, other: &Polygon, (a, b): (DVec3, DVec3)) -> Vec<Polygon> {
    let least = LEAST_PART * part.radius();
    let (low, high) = other.heights_of(part.vertices());
    if low > -least || high < least || !runs_through(part, a, b) {
        return vec![part.clone()];
    }
    let side = |sign: f64| Polygon::unchecked(clipped(part.vertices(), |v| sign * other.height(v)));
    match (side(1.0), side(-1.0)) {
        (Some(one), Some(two)) => vec![one, two],
        _ => vec![part.clone()],
    }
}

/// Whether the segment has a piece inside the part that is longer than [`LEAST_PART`].
fn runs_through(part: &Polygon, a: DVec3, b: DVec3) -> bool {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (p, q) in edges(part.vertices()) {
        let inward = part.normal().cross(q - p);
        let (at_a, at_b) = (inward.dot(a - p), inward.dot(b - p));
        let change = at_b - at_a;
        if change.abs() <= 1e-12 * inward.length() * (b - a).length() {
            if at_a <= 0.0 {
                return false;
            }
        } else if change > 0.0 {
            from = from.max(-at_a / change);
        } else {
            to = to.min(-at_a / change);
        }
    }
    (to - from) * (b - a).length() > LEAST_PART * part.radius()
}
