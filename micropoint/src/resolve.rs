//! From the parts in a cell to what is seen of them.

use crate::dicer::{DiceJob, Dicer, mean_opacity};
use crate::divide::Squares;
use crate::fine::FineGrid;
use crate::front::{Front, Layer, in_front};
use crate::lens::Lens;
use crate::neighbours::{self, Neighbours};
use glam::DVec2;
use pointillist_dice::hide::{Blocker, Occluders, Region, Regions};
use pointillist_dice::{ConvexPolygon, convex};
use std::ops::ControlFlow;

/// How parts in one cell hide one another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Occlusion {
    /// Exactly: a part is cut by the parts in front of it.
    #[default]
    Correlated,
    /// As in the paper, §4.2.6: parts whose depth ranges overlap or touch are one layer; layers are
    /// composited as if each were spread evenly over the cell.
    Paper,
}

/// The visible share of a part.
pub(crate) struct Visible<'a> {
    pub(crate) part: u32,
    /// Visible share of the cell: area × transmittance × opacity.
    pub(crate) weight: f64,
    /// Transmittance-weighted centroid of the visible area, relative to the cell.
    pub(crate) centroid: DVec2,
    /// The visible area in convex pieces with their own weights; `None`: the whole part.
    pub(crate) pieces: Option<&'a [Region]>,
    /// A piece weighs its area times its transmittance times this: the part's opacity, unless the pieces have their own in their
    /// transmittance; less where more would be seen than the cell has room for.
    pub(crate) scale: f64,
}

impl Visible<'_> {
    /// All of a part.
    fn whole(dicer: &Dicer, number: u32) -> Self {
        let part = dicer.part(number);
        let weight = part.area * f64::from(part.opacity);
        Visible { part: number, weight, centroid: part.centroid, pieces: None, scale: 1.0 }
    }

    /// Lets the part fill what is left of its cell at most. Where dozens of translucent parts cross one another, some dim the
    /// rest by their mean (see [`Regions`]), and what is seen of all of them may add up to more than the cell.
    fn fit_into(mut self, room: f64) -> Self {
        if self.weight > room + FINISHED {
            self.scale *= room / self.weight;
            self.weight = room;
        }
        self
    }
}

/// Overlaps with an area of at most this, in cells, are taken for rounding. A hundred of them in a cell stay below the tolerance to which sums
/// of weights are tested. Parts that touch with larger rounding are recognised by an edge that separates them.
pub(crate) const NEGLIGIBLE_AREA: f64 = 1e-13;

/// A cell in which less than this is still open is finished.
const FINISHED: f64 = 1e-13;

/// Depth ranges closer than this, relative to their nearness, touch (algorithms: 1e-9…1e-6).
const TOUCH: f64 = 1e-7;

/// Resolves one cell under the exact rule.
pub(crate) fn resolve_exactly(
    dicer: &mut Dicer,
    scratch: &mut ResolveScratch,
    job: &DiceJob<'_>,
    cell: usize,
    corner: DVec2,
    mut emit: impl FnMut(&Dicer, Visible<'_>),
) {
    let mut order = dicer.sorted_parts(cell);
    if let Some(count) = dicer.tiling(cell) {
        for &p in &order[..count] {
            emit(dicer, Visible::whole(dicer, p));
        }
        dicer.counts.cells_single += u64::from(count == 1);
        dicer.counts.cells_tiled += u64::from(count > 1);
    } else if order.is_empty() {
        dicer.counts.cells_empty += 1;
    } else {
        let stored = dicer.stored();
        if order.len() >= neighbours::WORTH_IT {
            dicer.bring_together(&mut order);
        }
        let mut emit = |dicer: &Dicer, visible: Visible<'_>| {
            emit(dicer, visible);
            ControlFlow::Continue(())
        };
        let compared = if job.squares_per_side > 1 && shows_mask(dicer, scratch, job, corner, &order) {
            resolve_divided(dicer, scratch, job, corner, &order, &mut emit)
        } else {
            resolve_square(dicer, scratch, job, (corner, 1.0), &order, &mut emit)
        };
        dicer.forget_since(stored);
        dicer.counts.cells_single += u64::from(!compared && order.len() == 1);
        dicer.counts.cells_compared += u64::from(compared);
        dicer.counts.cells_apart += u64::from(!compared && order.len() > 1);
    }
    dicer.recycle(order);
}

/// Whether anything is seen of a mask that is partly open. One that lies behind what covers the cell must not matter: whether it is here at all depends
/// on what came first.
fn shows_mask(
    dicer: &Dicer,
    scratch: &mut ResolveScratch,
    job: &DiceJob<'_>,
    corner: DVec2,
    order: &[u32],
) -> bool {
    let parts = Parts { dicer, job, corner };
    let mut shown = false;
    if order.iter().any(|&p| parts.is_masked(p)) {
        resolve_square(dicer, scratch, job, (corner, 1.0), order, &mut |_, visible| {
            shown = parts.is_masked(visible.part);
            if shown { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
    }
    shown
}

/// Resolves a cell square by square. Returns whether parts touch one another.
fn resolve_divided(
    dicer: &mut Dicer,
    scratch: &mut ResolveScratch,
    job: &DiceJob<'_>,
    corner: DVec2,
    order: &[u32],
    emit: &mut impl FnMut(&Dicer, Visible<'_>) -> ControlFlow<()>,
) -> bool {
    let mut squares = std::mem::take(&mut scratch.squares);
    squares.divide(dicer, job, corner, order);
    let area = 1.0 / f64::from(job.squares_per_side * job.squares_per_side);
    let mut compared = false;
    for order in squares.iter() {
        compared |= resolve_square(dicer, scratch, job, (corner, area), order, emit);
    }
    scratch.squares = squares;
    compared
}

/// Resolves a cell, or a square of one, with this area, in which these parts are, nearest first, until `emit` breaks. Returns whether parts touch
/// one another.
fn resolve_square(
    dicer: &Dicer,
    scratch: &mut ResolveScratch,
    job: &DiceJob<'_>,
    (corner, area): (DVec2, f64),
    order: &[u32],
    emit: &mut impl FnMut(&Dicer, Visible<'_>) -> ControlFlow<()>,
) -> bool {
    if let [only] = *order {
        let _ = emit(dicer, Visible::whole(dicer, only));
        return false;
    }
    let (mut seen, mut compared) = (0.0, false);
    scratch.others.start(dicer, order);
    let mut sight = Sight::Hidden;
    for (i, &p) in order.iter().enumerate() {
        if scratch.others.hidden_by_full_squares(dicer, job.lens, p, i) {
            sight = Sight::Hidden;
            compared = true;
            continue;
        }
        sight = match i.checked_sub(1).map(|before| order[before]) {
            Some(before) if dicer.is_copy(before, p) => {
                behind_a_copy(sight, dicer, before, &mut scratch.cut.regions)
            }
            _ => scratch.hide(&Parts { dicer, job, corner }, order, i),
        };
        compared |= sight != Sight::Whole;
        if sight == Sight::Hidden {
            continue;
        }
        scratch.others.stand(i);
        let visible = match sight {
            Sight::Whole => Visible::whole(dicer, p),
            _ => scratch.cut.in_pieces(&Parts { dicer, job, corner }, p),
        };
        scratch.others.fill(dicer, p, i, &visible);
        let visible = visible.fit_into(area - seen);
        if visible.weight <= 0.0 {
            continue;
        }
        seen += visible.weight;
        if emit(dicer, visible).is_break() || seen >= area - FINISHED {
            break;
        }
    }
    compared
}

/// How much of a part can be seen.
#[derive(Clone, Copy, PartialEq)]
enum Sight {
    /// All of it: no other part touches it from the front.
    Whole,
    /// The regions in [`ResolveScratch`].
    Pieces,
    /// Nothing.
    Hidden,
}

/// What is seen of a part behind a copy of itself: what is seen of the copy, through the copy. Comparing each of n copies with all
/// others would take n² steps.
fn behind_a_copy(copy_sight: Sight, dicer: &Dicer, copy: u32, regions: &mut Regions) -> Sight {
    let opacity = f64::from(dicer.part(copy).opacity);
    match copy_sight {
        Sight::Hidden => return Sight::Hidden,
        Sight::Whole => {
            let outline = dicer.outline(dicer.part(copy));
            regions.start(ConvexPolygon::from_vertices(outline), NEGLIGIBLE_AREA);
        }
        Sight::Pieces => {}
    }
    regions.dim(1.0 - opacity);
    if regions.is_hidden() { Sight::Hidden } else { Sight::Pieces }
}

/// Memory of [`resolve_exactly`].
#[derive(Debug, Default)]
pub(crate) struct ResolveScratch {
    squares: Squares,
    cut: Cut,
    others: Others,
}

/// Memory for what is left of one part.
#[derive(Debug, Default)]
struct Cut {
    regions: Regions,
    blockers: Vec<Blocker>,
    /// The regions of a masked part, with the opacity of each in its transmittance.
    masked: Vec<Region>,
}

/// The parts that one part is compared with.
#[derive(Debug, Default)]
struct Others {
    /// The ranks so far of which something is seen, rising: what is behind others hides nothing that those do not.
    standing: Vec<u32>,
    /// By rank, whether it is among them, for [`Search::Pencil`].
    stands: Vec<bool>,
    search: Search,
    neighbours: Neighbours,
    fine: FineGrid,
}

/// How the parts that may hide a part are found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Search {
    /// All are looked at.
    #[default]
    All,
    /// In [`FineGrid`]: many small parts.
    Fine,
    /// In [`Neighbours`]: many long parts.
    Pencil,
}

impl Others {
    fn start(&mut self, dicer: &Dicer, order: &[u32]) {
        self.standing.clear();
        self.stands.clear();
        self.search = Search::All;
        if order.len() < neighbours::WORTH_IT {
            return;
        }
        let bounds = order.iter().map(|&p| dicer.part(p).bounds.corners());
        if !dicer.are_thin(order.iter().copied()) && self.fine.build(bounds) {
            self.search = Search::Fine;
        } else {
            self.search = Search::Pencil;
            self.stands.resize(order.len(), false);
            let overlap = |a: u32, b: u32| dicer.overlap(order[a as usize], order[b as usize]);
            self.neighbours.build(order.iter().map(|&p| dicer.outline(dicer.part(p))), overlap);
        }
    }

    /// Whether a part lies behind squares of the cell that are full.
    fn hidden_by_full_squares(&self, dicer: &Dicer, lens: &Lens, p: u32, rank: usize) -> bool {
        if self.search != Search::Fine {
            return false;
        }
        let part = dicer.part(p);
        let slope = dicer.faces[part.face as usize].plane.slope;
        self.fine.hides(rank, part.nearness.most + lens.tie(part.nearness.most, slope))
    }

    /// Fills the squares of the cell with what is seen of an opaque part.
    fn fill(&mut self, dicer: &Dicer, p: u32, rank: usize, visible: &Visible<'_>) {
        let part = dicer.part(p);
        if self.search != Search::Fine || part.opacity < 1.0 {
            return;
        }
        let nearness = part.nearness.least;
        match visible.pieces {
            None => self.fine.fill(rank, dicer.outline(part), part.area, nearness),
            Some(regions) => {
                // A region that is dimmed may also be hidden in part, where it was not worth a cut.
                for region in regions.iter().filter(|region| region.transmittance == 1.0) {
                    self.fine.fill(rank, region.polygon.vertices(), region.polygon.area(), nearness);
                }
            }
        }
    }

    fn stand(&mut self, rank: usize) {
        match self.search {
            Search::All => self.standing.push(rank as u32),
            Search::Fine => self.fine.add_seen(rank as u32),
            Search::Pencil => self.stands[rank] = true,
        }
    }
}

/// The parts of a cell as occluders of each other.
struct Parts<'a> {
    dicer: &'a Dicer,
    job: &'a DiceJob<'a>,
    corner: DVec2,
}

impl Parts<'_> {
    /// Whether the opacity of a part varies over it.
    fn is_masked(&self, number: u32) -> bool {
        let part = self.dicer.part(number);
        let face = &self.dicer.faces[part.face as usize];
        (0.0..1.0).contains(&part.opacity)
            && self.job.geometry.surfaces()[face.surface as usize].textured_opacity
    }
}

impl Occluders for Parts<'_> {
    fn outline(&self, number: u32) -> &[DVec2] {
        self.dicer.outline(self.dicer.part(number))
    }

    fn is_opaque(&self, number: u32) -> bool {
        self.dicer.part(number).opacity >= 1.0
    }

    /// A mask's own mean over the polygon: holes of the part may lie elsewhere.
    fn opacity(&self, number: u32, over: &ConvexPolygon) -> f64 {
        let part = self.dicer.part(number);
        if self.is_masked(number) && over.vertices() != self.outline(number) {
            let face = &self.dicer.faces[part.face as usize];
            return f64::from(mean_opacity(self.job, face, self.corner, over.vertices()));
        }
        f64::from(part.opacity)
    }
}

impl ResolveScratch {
    /// What is seen of part `order[i]` behind the parts in front of it.
    fn hide(&mut self, parts: &Parts<'_>, order: &[u32], i: usize) -> Sight {
        let Self { cut, others, .. } = self;
        let (dicer, lens) = (parts.dicer, parts.job.lens);
        let least = dicer.part(order[i]).nearness.least;
        // What lies behind by less than rounding coincides, and may be in front by its number.
        let behind = least - lens.tie(least, DVec2::ZERO);
        // The parts are sorted by their nearest point.
        let near = i + 1 + order[i + 1..].partition_point(|&p| dicer.part(p).nearness.most >= behind);
        let overlaps = |&rank: &u32| dicer.overlap(order[i], order[rank as usize]);
        let Others { standing, stands, neighbours, fine, search } = others;
        let found = match search {
            Search::All => {
                let ranks = standing.iter().copied().chain(i as u32 + 1..near as u32);
                return cut.hide(parts, order[i], ranks.filter(overlaps).map(|rank| order[rank as usize]));
            }
            Search::Fine => fine.near(i as u32, near as u32, overlaps),
            Search::Pencil => {
                let counts = |rank: usize| if rank < i { stands[rank] } else { rank > i && rank < near };
                neighbours.of(i, counts, overlaps)
            }
        };
        cut.hide(parts, order[i], found.iter().map(|&rank| order[rank as usize]))
    }
}

impl Cut {
    /// What is seen of part `p` in the regions that were found last. Where it and all in front of it are masks, the outlines of those do not
    /// bound what is seen: it stays in one piece.
    fn in_pieces(&mut self, parts: &Parts<'_>, p: u32) -> Visible<'_> {
        let Self { regions, masked, blockers } = self;
        let (list, scale) = if parts.is_masked(p) {
            masked.clear();
            masked.extend(regions.list().iter().map(|region| {
                let opacity = parts.opacity(p, &region.polygon);
                Region { transmittance: region.transmittance * opacity, ..*region }
            }));
            masked.retain(|region| region.transmittance > 0.0);
            (&masked[..], 1.0)
        } else {
            (regions.list(), f64::from(parts.dicer.part(p).opacity))
        };
        let (mut weight, mut moment) = (0.0, DVec2::ZERO);
        for r in list {
            let (area, centroid) = r.polygon.area_and_centroid();
            weight += area * r.transmittance * scale;
            moment += centroid * (area * r.transmittance * scale);
        }
        let centroid = if weight > 0.0 { moment / weight } else { DVec2::ZERO };
        let one_piece = parts.is_masked(p) && blockers.iter().all(|b| parts.is_masked(b.number));
        let pieces = (!one_piece).then_some(list);
        Visible { part: p, weight, centroid, pieces, scale }
    }

    /// What is seen of part `p` behind those of `others`, which overlap it, that are in front of it.
    fn hide(&mut self, parts: &Parts<'_>, p: u32, others: impl Iterator<Item = u32>) -> Sight {
        let (dicer, lens, corner) = (parts.dicer, parts.job.lens, parts.corner);
        let part = dicer.part(p);
        let outline = dicer.outline(part);
        self.blockers.clear();
        for o in others {
            let other = dicer.part(o);
            let (fo, fp) = (&dicer.faces[other.face as usize], &dicer.faces[part.face as usize]);
            let upper = Layer { face: fo, outline: dicer.outline(other), nearness: other.nearness };
            let lower = Layer { face: fp, outline, nearness: part.nearness };
            // Which of two coincident surfaces is seen must not change from cell to cell.
            let first = fo.precedence(fp) == std::cmp::Ordering::Less;
            match in_front(lens, corner, upper, lower, first) {
                Front::Nowhere => {}
                Front::Everywhere
                    if other.opacity >= 1.0 && convex::contains(dicer.outline(other), outline) =>
                {
                    return Sight::Hidden;
                }
                Front::Everywhere => self.blockers.push(Blocker { number: o, front: None }),
                Front::Within(half) => self.blockers.push(Blocker { number: o, front: Some(half) }),
            }
        }
        if self.blockers.is_empty() {
            return Sight::Whole;
        }
        let polygon = ConvexPolygon::from_vertices(outline);
        self.regions.hide(polygon, NEGLIGIBLE_AREA, &self.blockers, parts);
        if self.regions.is_hidden() { Sight::Hidden } else { Sight::Pieces }
    }
}

/// Resolves one cell under the paper's rule.
pub(crate) fn resolve_by_layers(dicer: &mut Dicer, cell: usize, mut emit: impl FnMut(&Dicer, Visible<'_>)) {
    let order = dicer.sorted_parts(cell);
    let mut transmittance = 1.0;
    let mut start = 0;
    while start < order.len() && transmittance > FINISHED {
        let first = dicer.part(order[start]);
        let mut layer_low = first.nearness.least;
        let mut end = start + 1;
        // Sorted by the nearest point, so a layer ends where the next part does not reach it.
        while end < order.len() {
            let next = dicer.part(order[end]);
            if next.nearness.most < layer_low - TOUCH * layer_low.abs() {
                break;
            }
            layer_low = layer_low.min(next.nearness.least);
            end += 1;
        }
        let opacity_of = |p: u32| dicer.part(p).area * f64::from(dicer.part(p).opacity);
        let sum: f64 = order[start..end].iter().map(|&p| opacity_of(p)).sum();
        let layer = sum.min(1.0);
        for &p in &order[start..end] {
            let weight = transmittance * layer * (opacity_of(p) / sum);
            let centroid = dicer.part(p).centroid;
            emit(dicer, Visible { part: p, weight, centroid, pieces: None, scale: 1.0 });
        }
        transmittance *= 1.0 - layer;
        start = end;
    }
    match order.len() {
        0 => dicer.counts.cells_empty += 1,
        1 => dicer.counts.cells_single += 1,
        _ => dicer.counts.cells_compared += 1,
    }
    dicer.recycle(order);
}
