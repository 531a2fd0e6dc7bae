//! Which of two surfaces is in front, over the area that they have in common.

use crate::face::Face;
use crate::interval::Interval;
use crate::lens::Lens;
use glam::DVec2;
use pointillist_dice::{ConvexPolygon, HalfPlane, convex};

/// A polygon on a face, with its range of nearness.
#[derive(Clone, Copy)]
pub struct Layer<'a> {
    /// The face it lies on.
    pub face: &'a Face,
    /// Its outline, convex and in positive order; [`in_front`] says in which frame.
    pub outline: &'a [DVec2],
    /// Smallest and largest nearness over the outline.
    pub nearness: Interval,
}

/// Where one layer is nearer than another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Front {
    /// Nowhere on their common area.
    Nowhere,
    /// On all of their common area.
    Everywhere,
    /// On this side of the line in which they cross.
    Within(HalfPlane),
}

/// Where `upper` is in front of `lower`, over their common area; outlines are relative to `corner`.
///
/// Coincident layers (see [`Lens::tie`]) are in front of each other if `if_coincident` says so. Nearness
/// is affine on either, so its extremes are at corners of the common area and the line of equal
/// nearness is straight.
#[must_use]
#[inline]
pub fn in_front(
    lens: &Lens,
    corner: DVec2,
    upper: Layer<'_>,
    lower: Layer<'_>,
    if_coincident: bool,
) -> Front {
    // Ranges that lie apart need no planes, however steep these are.
    if upper.nearness.least >= lower.nearness.most + lens.tie(lower.nearness.most, DVec2::ZERO) {
        return Front::Everywhere;
    }
    in_front_by_planes(lens, corner, &upper, &lower, if_coincident)
}

/// The same by the planes of the layers. Not inlined: the ranges of nearness decide most questions.
#[inline(never)]
fn in_front_by_planes(
    lens: &Lens,
    corner: DVec2,
    upper: &Layer<'_>,
    lower: &Layer<'_>,
    if_coincident: bool,
) -> Front {
    let (fu, fl) = (&upper.face.plane, &lower.face.plane);
    let tie = lens.tie(lower.nearness.most, fu.slope.abs() + fl.slope.abs());
    // What holds of the planes over all of the lower outline holds over the common area, too. (Nearness itself is clamped to its range, which
    // beyond the upper outline is not affine.)
    let mut planes = Interval::EMPTY;
    lower.outline.iter().for_each(|&v| planes.include(fu.at(v + corner) - fl.at(v + corner)));
    if planes.least > tie && planes.least.is_finite() {
        return Front::Everywhere;
    }
    if planes.most <= tie && !if_coincident {
        return Front::Nowhere;
    }
    // Two polygons that stay in place: moving one takes as long as cutting it.
    let (mut common, mut spare) =
        (&mut ConvexPolygon::from_vertices(lower.outline), &mut ConvexPolygon::default());
    for half in convex::half_planes(upper.outline) {
        // Most half-planes hold the whole polygon, which takes less time to find out than to copy it.
        if common.vertices().iter().any(|&v| half.value(v) < 0.0) {
            common.clip_into(&half, spare);
            std::mem::swap(&mut common, &mut spare);
        }
    }
    let mut difference = Interval::EMPTY;
    for &v in common.vertices() {
        difference.include(upper.face.nearness_at(v + corner) - lower.face.nearness_at(v + corner));
    }
    let Interval { least, most } = difference;
    if common.is_empty() {
        Front::Nowhere
    } else if most <= tie {
        if least >= -tie && if_coincident { Front::Everywhere } else { Front::Nowhere }
    } else if least >= -tie {
        Front::Everywhere
    } else {
        let anchor = lower.outline[0];
        let offset = fu.at(anchor + corner) - fl.at(anchor + corner);
        Front::Within(HalfPlane { anchor, normal: fu.slope - fl.slope, offset })
    }
}
