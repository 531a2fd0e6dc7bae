//! The correlated rule: the area of a receiver that is left when all casters in front of it are subtracted.

use crate::casters::Caster;
use crate::covered::{Cover, Covering};
use crate::lit_regions::LitRegions;
use crate::overlap::{Corners, Edges, Overlap};
use crate::pieces;
use crate::query::{Measure, Query};
use crate::target::Target;
use glam::DVec2;
use pointillist_dice::ConvexPolygon;
use pointillist_dice::hide::{Blocker, Occluders, Regions};
use pointillist_micropoint::{Face, Front, Layer, in_front};
use std::cmp::Ordering;

/// Overlaps with an area below this, times that of the receiver, are taken for rounding.
const NEGLIGIBLE: f64 = 1e-9;

/// Memory of this rule.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    regions: Regions,
    blockers: Vec<Blocker>,
    /// Those of them that are opaque and in front of all of the target.
    whole: Vec<Cover>,
    covering: Covering,
    /// The target's corners.
    corners: Corners,
    /// Opacities over the whole target that are known already, by caster.
    known: Vec<(u32, f64)>,
    /// Those of the blockers that are masks, partly open for all that is known.
    masks: usize,
    /// Where in the list of its group the caster is that hid the last target.
    last_hider: Option<usize>,
    /// Targets that had to be cut.
    pub(crate) partial: u64,
}

impl Memory {
    /// Begins with the targets of another group.
    pub(crate) fn start_group(&mut self) {
        self.last_hider = None;
    }
}

/// The lit fraction of a target, 0..=1; of one that is not evenly lit, the lit regions go to `regions`.
pub(crate) fn lit_fraction(
    query: &Query<'_>,
    target: &Target,
    outline: &[DVec2],
    (measure, squares): (&Measure<'_>, u32),
    work: &mut Memory,
    mut regions: Option<&mut LitRegions>,
) -> f64 {
    if !find_blockers(query, target, outline, measure.face, work) {
        return 0.0;
    }
    if work.blockers.is_empty() {
        if let Some(regions) = regions.filter(|_| target.shared) {
            regions.push(target.receiver, outline, measure.area(outline), measure);
        }
        return 1.0;
    }
    if work.covering.hides(&work.whole, |caster| query.shape(caster), outline) {
        return 0.0;
    }
    // The result must not depend on the order in which casters were found.
    let caster = |b: &Blocker| &query.casters[b.number as usize];
    work.blockers.sort_unstable_by(|a, b| compare(caster(a), caster(b)));
    work.partial += 1;
    let occluders = TargetOccluders { query, outline, known: &work.known };
    let Memory { regions: left, blockers, masks, .. } = work;
    let (mut lit, mut even) = (0.0, None);
    // How much passes one mask does not depend on where its holes are, only what it falls on.
    let uneven = *masks > 1 || (*masks == 1 && regions.is_some());
    let squares = if uneven { squares } else { 1 };
    pieces::divide(outline, squares, measure, |piece| {
        left.hide(*piece, NEGLIGIBLE * target.area, blockers, &occluders);
        if left.is_hidden() {
            return;
        }
        if let [only] = left.list()
            && only.polygon.vertices() == outline
            && !target.shared
        {
            even = Some(only.transmittance);
            return;
        }
        for region in left.list() {
            let outline = region.polygon.vertices();
            let weight = region.transmittance * measure.area(outline);
            lit += weight;
            if let Some(regions) = regions.as_deref_mut() {
                regions.push(target.receiver, outline, weight, measure);
            }
        }
    });
    if let Some(transmittance) = even {
        return transmittance.min(1.0);
    }
    if lit <= 0.0 {
        return 0.0;
    }
    let whole = measure.area(outline);
    if whole > 0.0 { (lit / whole).min(1.0) } else { 0.0 }
}

/// Collects the casters that overlap the target and stand before it. Returns false as soon as one of
/// them hides it all: then nothing else matters, and the result is 0 whatever the order.
fn find_blockers(
    query: &Query<'_>,
    target: &Target,
    outline: &[DVec2],
    face: &Face,
    work: &mut Memory,
) -> bool {
    work.blockers.clear();
    work.whole.clear();
    work.known.clear();
    work.masks = 0;
    work.corners.set(outline);
    // The caster that hid the last target often hides the next one.
    let first = work.last_hider;
    for at in first.into_iter().chain((0..query.nearby.len()).filter(|&at| Some(at) != first)) {
        let near = &query.nearby[at];
        if !near.may_darken(target, face) {
            continue;
        }
        let (c, caster) = (near.index, &query.casters[near.index as usize]);
        let (shape, sides) = query.shape(c);
        let overlap = Overlap::of(sides, &work.corners);
        if overlap == Overlap::Apart || work.corners.has_separating_edge(shape) {
            continue;
        }
        let upper = Layer { face: &caster.face, outline: shape, nearness: caster.face.nearness };
        let lower = Layer { face, outline, nearness: target.nearness };
        let front = in_front(query.lens, DVec2::ZERO, upper, lower, false);
        if front == Front::Everywhere && overlap == Overlap::Over {
            // Receivers are small: over most of them a mask is 0 or 1 throughout.
            let opacity = query.opacity(caster, outline);
            if opacity >= 1.0 {
                work.last_hider = Some(at);
                return false;
            }
            if opacity <= 0.0 {
                continue;
            }
            work.known.push((c, opacity));
        }
        let half = match front {
            Front::Nowhere => continue,
            Front::Everywhere => None,
            Front::Within(half) => Some(half),
        };
        work.blockers.push(Blocker { number: c, front: half });
        if half.is_none() && caster.opacity == Some(1.0) {
            let across = if let Overlap::Across(edges) = overlap { edges } else { Edges::default() };
            work.whole.push(Cover { caster: c, across });
        }
        work.masks += usize::from(caster.opacity.is_none());
    }
    true
}

/// The casters before one target.
struct TargetOccluders<'a> {
    query: &'a Query<'a>,
    outline: &'a [DVec2],
    known: &'a [(u32, f64)],
}

impl Occluders for TargetOccluders<'_> {
    fn outline(&self, number: u32) -> &[DVec2] {
        self.query.shape(number).0
    }

    fn is_opaque(&self, number: u32) -> bool {
        self.query.casters[number as usize].opacity == Some(1.0)
    }

    fn opacity(&self, number: u32, over: &ConvexPolygon) -> f64 {
        let known = || self.known.iter().find(|(caster, _)| *caster == number);
        // Behind masks alone most targets are never cut.
        match (over.vertices() == self.outline).then(known).flatten() {
            Some((_, opacity)) => *opacity,
            None => self.query.opacity(&self.query.casters[number as usize], over.vertices()),
        }
    }
}

/// A canonical order of casters: opaque ones before textured ones, whose masks need not be asked where opaque ones hide the receiver;
/// then by nearness to the light, nearest first, then by place. The triangle's number decides only between equals.
pub(crate) fn compare(a: &Caster, b: &Caster) -> Ordering {
    let textured = a.opacity.is_none().cmp(&b.opacity.is_none());
    let (qa, qb) = (a.face.nearness, b.face.nearness);
    let by_place = || {
        let ((la, ha), (lb, hb)) = (a.bounds, b.bounds);
        let corners = [(la.x, lb.x), (la.y, lb.y), (ha.x, hb.x), (ha.y, hb.y)];
        corners.iter().fold(Ordering::Equal, |order, (x, y)| order.then_with(|| x.total_cmp(y)))
    };
    // The two halves of a rectangle agree in all that so far.
    let by_corners = || {
        let (ca, cb) = (a.corner_sum, b.corner_sum);
        ca.x.total_cmp(&cb.x).then(ca.y.total_cmp(&cb.y))
    };
    let by_number = || (a.face.surface, a.face.id).cmp(&(b.face.surface, b.face.id));
    let by_nearness = qb.most.total_cmp(&qa.most).then(qb.least.total_cmp(&qa.least));
    textured.then(by_nearness).then_with(by_place).then_with(by_corners).then_with(by_number)
}
