//! Surfaces cut along the lines where others stand on them.
//!
//! Light jumps there: the floor under a box is dark, beside it is not. A patch with both would be of a mean brightness that is
//! nowhere, and would give that to the foot of the box.

use glam::DVec3;

use crate::polygon::{Polygon, clipped, edges};

/// Edges this near to a surface, relative to it, stand on it.
const STANDING: f64 = 1e-7;
/// Parts of a surface on one side of a cut that reach less far, relative to it, are none.
const LEAST_PART: f64 = 1e-6;
/// Planes whose normals agree this well are parallel.
const PARALLEL: f64 = 1e-6;
/// Most parts of one surface; further contacts are left to the patches' size.
const MAX_PARTS: usize = 256;

/// The parts of a surface between the edges of `others` that stand on it; one if there are none.
pub(crate) fn parts(polygon: &Polygon, others: &[Polygon]) -> Vec<Polygon> {
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

/// Both sides of a plane if the contact runs through the part, else the part.
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

/// Whether a piece of the segment is inside.
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
