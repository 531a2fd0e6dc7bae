//! Small faces of the viewer, looked at as a whole: most are lit all over, and their receivers need not be asked one by one.
//!
//! A face is a target of its own, with the outline of its triangle. Casters that are beyond one of its edges, or nowhere in front of
//! it, matter to none of its receivers; what is left is all that these are asked of.

use crate::casters::Nearby;
use crate::query::Query;
use crate::target::Target;
use glam::{DVec2, DVec3};
use pointillist_dice::{HalfPlane, convex};
use pointillist_micropoint::{Face, Front, Layer, Lens, LensKind, in_front};

/// Longest extent in the viewer's grid, in its cells, up to which a face is looked at whole: larger ones have casters far from what a tile sees of them.
const LARGEST: f64 = 24.0;

/// By how much an opaque caster must reach beyond a face to hide all of its receivers, relative to the screen: their corners are those of
/// the face up to rounding.
const MARGIN: f64 = 1e-9;

/// Receivers by face, as lists.
#[derive(Debug, Default)]
pub(crate) struct ByFace {
    /// For each face its first receiver, for each receiver the next one of its face.
    first: Vec<u32>,
    next: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl ByFace {
    pub(crate) fn begin(&mut self, faces: usize, receivers: usize) {
        self.first.clear();
        self.first.resize(faces, NONE);
        self.next.clear();
        self.next.resize(receivers, NONE);
    }

    /// Adds a receiver to those of a face.
    pub(crate) fn add(&mut self, face: u32, receiver: u32) {
        self.next[receiver as usize] = std::mem::replace(&mut self.first[face as usize], receiver);
    }

    /// The receivers of a face.
    pub(crate) fn receivers(&self, face: u32) -> impl Iterator<Item = u32> + '_ {
        let known = |receiver: u32| (receiver != NONE).then_some(receiver);
        std::iter::successors(known(self.first[face as usize]), move |&r| known(self.next[r as usize]))
    }
}

/// Whether a face, by its corners in the viewer's frame, is small enough to be looked at whole.
pub(crate) fn is_small(viewer: &Lens, corners: [DVec3; 3]) -> bool {
    if viewer.kind == LensKind::Perspective && corners.iter().any(|c| c.z <= 0.0) {
        return false;
    }
    let [a, b, c] = corners.map(|c| viewer.project(c));
    (a.max(b).max(c) - a.min(b).min(c)).max_element() <= LARGEST
}

/// The casters that may darken some receiver of a face go to `found`. Returns true if one alone hides all of them.
pub(crate) fn casters_before(
    query: &Query<'_>,
    target: &Target,
    (face, outline): (&Face, &[DVec2]),
    found: &mut Vec<Nearby>,
) -> bool {
    found.clear();
    let (low, high) = target.bounds;
    for near in query.nearby {
        let overlaps = near.bounds.0.cmplt(high).all() && near.bounds.1.cmpgt(low).all();
        if !overlaps || near.nearest < target.nearness.least || near.id == face.id {
            continue;
        }
        let caster = &query.casters[near.index as usize];
        let shape = caster.polygon.vertices();
        let sides = &query.sides[caster.sides.clone()];
        if sides.iter().any(|half| separates(half, outline)) || convex::has_separating_edge(outline, shape) {
            continue;
        }
        let upper = Layer { face: &caster.face, outline: shape, nearness: caster.face.nearness };
        let lower = Layer { face, outline, nearness: target.nearness };
        match in_front(query.lens, DVec2::ZERO, upper, lower, false) {
            Front::Nowhere => continue,
            Front::Everywhere if caster.opacity == Some(1.0) && covers(query, sides, outline) => return true,
            Front::Everywhere | Front::Within(_) => found.push(*near),
        }
    }
    false
}

/// Whether an outline lies beyond the edge of a caster whose inner half-plane this is.
fn separates(half: &HalfPlane, outline: &[DVec2]) -> bool {
    outline.iter().all(|&p| half.value(p) <= 0.0)
}

/// Whether a caster reaches beyond an outline all around, by [`MARGIN`].
fn covers(query: &Query<'_>, sides: &[HalfPlane], outline: &[DVec2]) -> bool {
    sides.iter().all(|half| {
        let margin = MARGIN * half.normal.abs().max_element() * query.lens.scale;
        outline.iter().all(|&p| half.value(p) > margin)
    })
}
