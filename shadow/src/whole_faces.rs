//! Small faces of the viewer, looked at as a whole: most are lit all over, and their receivers need not be asked one by one.
//!
//! A face is a target of its own, with the outline of its triangle. Casters that are beyond one of its edges, or nowhere in front of
//! it, matter to none of its receivers; what is left is all that these are asked of.

use crate::casters::Nearby;
use crate::covered::{Cover, Covering};
use crate::ends::{Shadow, ShadowEnds};
use crate::overlap::{Corners, Edges, Overlap};
use crate::query::Query;
use crate::target::Target;
use glam::{DVec2, DVec3};
use pointillist_dice::{ConvexPolygon, HalfPlane};
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

/// What stands before a face that is looked at whole. Memory is reused from face to face.
#[derive(Debug, Default)]
pub(crate) struct WholeFace {
    /// The casters that may darken some of its receivers.
    pub(crate) casters: Vec<Nearby>,
    /// Those of them that are opaque and in front of all of it.
    opaque: Vec<Cover>,
    covering: Covering,
    /// Where their shadow ends, if they are all there is.
    ends: ShadowEnds,
    /// The face's corners.
    corners: Corners,
    /// Casters whose bounds overlap those of the face, by their places in the list.
    found: Vec<u32>,
}

impl WholeFace {
    /// Looks at a face. Returns the lit fraction of its receivers if it is the same for all; else they are to be asked one by one about
    /// [`WholeFace::casters`].
    pub(crate) fn look(
        &mut self,
        query: &Query<'_>,
        target: &Target,
        (face, outline): (&Face, &[DVec2]),
    ) -> Option<f64> {
        let Self { casters, opaque, covering, corners, found, ends } = self;
        ends.clear();
        corners.set(outline);
        casters.clear();
        opaque.clear();
        Nearby::find(query.nearby, target, face, found);
        for near in found.iter().map(|&at| &query.nearby[at as usize]) {
            let caster = &query.casters[near.index as usize];
            let (shape, sides) = query.shape(near.index);
            let overlap = Overlap::of(sides, corners);
            if overlap == Overlap::Apart || corners.has_separating_edge(shape) {
                continue;
            }
            let upper = Layer { face: &caster.face, outline: shape, nearness: caster.face.nearness };
            let lower = Layer { face, outline, nearness: target.nearness };
            match in_front(query.lens, DVec2::ZERO, upper, lower, false) {
                Front::Nowhere => continue,
                Front::Everywhere if caster.opacity == Some(1.0) => {
                    let across = match overlap {
                        Overlap::Across(edges) => edges,
                        _ if covers(query, sides, corners) => return Some(0.0),
                        _ => Edges::default(),
                    };
                    opaque.push(Cover { caster: near.index, across });
                }
                Front::Everywhere | Front::Within(_) => {}
            }
            casters.push(*near);
        }
        if casters.is_empty() {
            return Some(1.0);
        }
        let shape = |caster| query.shape(caster);
        if covering.hides(opaque, shape, outline) {
            return Some(0.0);
        }
        if opaque.len() == casters.len() {
            ends.find(covering, opaque, shape, outline);
        }
        None
    }

    /// The shadow on a receiver of the face that was looked at last, by its outline. `lit` is memory for what is lit.
    pub(crate) fn shadow_on<'l>(
        &self,
        query: &Query<'_>,
        outline: &[DVec2],
        lit: &'l mut ConvexPolygon,
    ) -> Shadow<'l> {
        self.ends.shadow_on(&self.opaque, |caster| query.shape(caster), outline, lit)
    }
}

/// Whether a caster reaches beyond some corners all around, by [`MARGIN`].
fn covers(query: &Query<'_>, sides: &[HalfPlane], corners: &Corners) -> bool {
    let margin = |half: &HalfPlane| MARGIN * half.normal.abs().max_element() * query.lens.scale;
    sides.iter().all(|half| corners.range(half).0 > margin(half))
}
