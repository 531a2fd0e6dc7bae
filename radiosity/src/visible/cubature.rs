//! Exchange of two polygons with others between them.
//!
//! What they would exchange with nothing between is exact (the unoccluded rules); what is hidden of it is taken off. For that the
//! smaller polygon is divided into cells. From a cell before which nothing stands nothing is hidden, from one that is shut off by a
//! single occluder exactly all is; in the others the hidden share is sampled, itself exact, by Gauss points. Cells are halved both ways,
//! the worst first, until what halving changes is below the tolerance: so work gathers where the hidden part changes its kind. Near edges,
//! where the share of the whole source is anything but a polynomial, what little is hidden of it costs little accuracy.

use std::borrow::Cow;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::parts::{Pieces, Source};
use super::shaft::Shaft;
use crate::kernel::pair::{self, Mutual, Rule, facing_parts};
use crate::kernel::{gauss, lambert};
use crate::polygon::{Polygon, clipped};

/// Gauss points along each side of a cell.
const ORDER: usize = 3;
/// Cells that were halved less often are looked at from their corners, too.
const LOOKED_AT_CORNERS: u8 = 1;
/// Cells that were halved less often are halved while a narrow occluder is between that was before no sample.
const SEARCHED: u8 = 3;
/// Samples are apart by less than this share of a cell's diagonal.
const SLIPS_THROUGH: f64 = 0.5;
/// How far towards the centre a corner is looked from: on the line where an occluder stands nothing is hidden.
const INWARD: f64 = 1e-3;
/// What Gauss points may be off where the hidden share jumps, as a share of what it varies by: a step between two of three points is
/// a fifth off at worst.
const SPREAD: f64 = 1.0 / 8.0;
/// What halving changed, over what the halves are taken to be still off. A kink across a cell would allow four; two levels that agree
/// by chance ask for less.
const GAIN: f64 = 2.0;
/// Occluders that stand on the receiver cut it, so that the jump of light at their foot lies on borders of cells; at most so many.
const MAX_CUTS: usize = 8;

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// Relative error of unoccluded exchange.
    pub(crate) unoccluded: f64,
    /// Error relative to the result.
    pub(crate) relative: f64,
    /// Error that is always good enough, in units of area.
    pub(crate) absolute: f64,
    /// Most cells of one pair; beyond, the bound says how far it got.
    pub(crate) max_cells: usize,
    /// Cells are halved at least so often.
    pub(crate) least_depth: u8,
}

/// What one pair cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Work {
    /// Cells that were sampled.
    pub(crate) cells: usize,
}

struct Cell {
    quad: [DVec3; 4],
    occluders: Vec<u32>,
    hidden: f64,
    /// What the samples' differences let it be off.
    spread: f64,
    error: f64,
    depth: u8,
    /// Rounding and quadrature of what is exact, which halving does not improve.
    settled: bool,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.error.total_cmp(&other.error).is_eq()
    }
}
impl Eq for Cell {}
impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Cell {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.error.total_cmp(&other.error)
    }
}

/// Exchange A₁F₁₂ past the occluders, in any order, which may hold polygons that are not between at all.
pub(crate) fn mutual(
    a: &Polygon,
    b: &Polygon,
    occluders: &[&Polygon],
    goal: Goal,
    pieces: &mut Pieces,
) -> (Mutual, Work) {
    let Some((a, b)) = facing_parts(a, b) else { return (Mutual::NONE, Work::default()) };
    let shaft = Shaft::new(&a, &b).with_planes();
    let between: Vec<&Polygon> = occluders.iter().copied().filter(|o| shaft.may_hold(o)).collect();
    if between.is_empty() {
        return (pair::mutual(&a, &b, goal.unoccluded), Work::default());
    }
    if between.iter().any(|o| shaft.is_blocked_by(o)) {
        return (Mutual::NONE, Work::default());
    }
    past(&a, &b, &between, goal, pieces)
}

/// As [`mutual`], of occluders that the shaft of the whole polygons may hold and none of which hides all.
pub(crate) fn mutual_in_shaft(
    a: &Polygon,
    b: &Polygon,
    occluders: &[&Polygon],
    goal: Goal,
    pieces: &mut Pieces,
) -> (Mutual, Work) {
    match facing_parts(a, b) {
        Some((Cow::Borrowed(a), Cow::Borrowed(b))) => past(a, b, occluders, goal, pieces),
        // Parts have a smaller shaft.
        _ => mutual(a, b, occluders, goal, pieces),
    }
}

fn past(a: &Polygon, b: &Polygon, occluders: &[&Polygon], goal: Goal, pieces: &mut Pieces) -> (Mutual, Work) {
    let (receiver, source) = if a.area() <= b.area() { (a, b) } else { (b, a) };
    let flat = Source::new(source);
    Cubature { receiver, source, flat: &flat, occluders, goal, pieces, work: Work::default() }.run()
}

struct Cubature<'p> {
    receiver: &'p Polygon,
    source: &'p Polygon,
    flat: &'p Source,
    occluders: &'p [&'p Polygon],
    goal: Goal,
    pieces: &'p mut Pieces,
    work: Work,
}

impl Cubature<'_> {
    fn run(mut self) -> (Mutual, Work) {
        let open = pair::mutual(self.receiver, self.source, self.goal.unoccluded);
        let mut heap = BinaryHeap::new();
        let mut settled = (0.0, open.error);
        let all: Vec<u32> = (0..self.occluders.len() as u32).collect();
        for quad in self.roots() {
            let mut cell = self.cell(quad, &all, 0);
            if cell.settled || self.goal.least_depth > 0 {
                self.divide(&cell, &mut heap, &mut settled);
            } else {
                cell.error += cell.spread;
                heap.push(cell);
            }
        }
        loop {
            // Summed anew each time it matters would be quadratic; the running sums are renewed at the end.
            let (hidden, error) = sums(&heap, settled);
            // What exact rules leave of a pair that is hidden altogether is their rounding.
            let value = if open.value - hidden > settled.1 { open.value - hidden } else { 0.0 };
            let enough = self.goal.absolute.max(self.goal.relative * value);
            // Without open cells what is left is the error of exact rules.
            if error <= enough || self.work.cells >= self.goal.max_cells || heap.is_empty() {
                return (Mutual { value, error, rule: Rule::Points }, self.work);
            }
            // A batch of the worst, so that the sums are not formed for each.
            for _ in 0..(heap.len() / 4).max(1) {
                let Some(cell) = heap.pop() else { break };
                self.divide(&cell, &mut heap, &mut settled);
            }
        }
    }

    /// The receiver, cut where occluders meet it.
    fn roots(&self) -> Vec<[DVec3; 4]> {
        let slack = 1e-12 * self.receiver.radius();
        let mut parts = vec![self.receiver.clone()];
        let meets = |o: &&Polygon| {
            let (low, high) = self.receiver.heights_of(o.vertices());
            low <= slack && high > slack
        };
        for occluder in self.occluders.iter().filter(|o| meets(o)).take(MAX_CUTS) {
            let mut next = vec![];
            for part in parts {
                let (low, high) = occluder.heights_of(part.vertices());
                if low < -slack && high > slack {
                    let side = |sign: f64| clipped(part.vertices(), |v| sign * occluder.height(v));
                    next.extend([1.0, -1.0].into_iter().filter_map(|sign| Polygon::unchecked(side(sign))));
                } else {
                    next.push(part);
                }
            }
            parts = next;
        }
        parts.iter().flat_map(|p| p.quads().collect::<Vec<_>>()).collect()
    }

    /// Replaces a cell by its quarters.
    fn divide(&mut self, cell: &Cell, heap: &mut BinaryHeap<Cell>, settled: &mut (f64, f64)) {
        if cell.settled {
            settled.0 += cell.hidden;
            settled.1 += cell.error;
            return;
        }
        let [a, b, c, d] = cell.quad;
        let [ab, bc, cd, da] = [(a, b), (b, c), (c, d), (d, a)].map(|(p, q)| 0.5 * (p + q));
        let middle = 0.5 * (ab + cd);
        let quarters = [[a, ab, middle, da], [ab, b, bc, middle], [middle, bc, c, cd], [da, middle, cd, d]];
        let mut children = quarters.map(|quad| self.cell(quad, &cell.occluders, cell.depth + 1));
        let total: f64 = children.iter().map(|c| c.hidden).sum();
        let open = children.iter().filter(|c| !c.settled).count().max(1) as f64;
        let change = (total - cell.hidden).abs() / (GAIN * open);
        for child in &mut children {
            if !child.settled {
                child.error += change.min(child.spread);
                if child.depth < self.goal.least_depth {
                    child.error += child.hidden.max(change);
                }
            }
        }
        for child in children {
            if child.settled {
                settled.0 += child.hidden;
                settled.1 += child.error;
            } else {
                heap.push(child);
            }
        }
    }

    /// One cell: exact where it can be, else sampled, with the error for occluders that no sample met.
    fn cell(&mut self, quad: [DVec3; 4], occluders: &[u32], depth: u8) -> Cell {
        let mut cell =
            Cell { quad, occluders: vec![], hidden: 0.0, spread: 0.0, error: 0.0, depth, settled: true };
        let [a, b, c, d] = quad;
        let ring = if c == d { vec![a, b, c] } else { quad.to_vec() };
        let Some(mut polygon) = Polygon::unchecked(ring) else { return cell };
        if polygon.normal().dot(self.receiver.normal()) < 0.0 {
            polygon = polygon.flipped();
        }
        let shaft = Shaft::new(&polygon, self.source).with_planes();
        let of = |i: u32| self.occluders[i as usize];
        cell.occluders = occluders.iter().copied().filter(|&i| shaft.may_hold(of(i))).collect();
        if cell.occluders.iter().any(|&i| shaft.is_blocked_by(of(i))) {
            let exact = pair::mutual(&polygon, self.source, self.goal.unoccluded);
            (cell.hidden, cell.error) = (exact.value, exact.error);
        } else if !cell.occluders.is_empty() {
            cell.settled = false;
            self.sample(&mut cell);
        }
        cell
    }

    fn sample(&mut self, cell: &mut Cell) {
        self.work.cells += 1;
        let normal = self.receiver.normal();
        let list: Vec<&Polygon> = cell.occluders.iter().map(|&i| self.occluders[i as usize]).collect();
        let mut met = vec![false; list.len()];
        let (mut area, mut least, mut most) = (0.0, f64::MAX, 0.0_f64);
        let mut hidden_at = |p: DVec3| {
            let occluders = list.iter().copied();
            let hidden = self.flat.hidden_share((p, normal), occluders, self.pieces, |i| met[i] = true);
            (least, most) = (least.min(hidden), most.max(hidden));
            hidden
        };
        let rule = gauss::rule(ORDER);
        for (u, weight_u) in rule.iter() {
            for (v, weight_v) in rule.iter() {
                let (p, jacobian) = gauss::on_quad(&cell.quad, u, v);
                let weight = weight_u * weight_v * jacobian;
                cell.hidden += weight * hidden_at(p);
                area += weight;
            }
        }
        if cell.depth < LOOKED_AT_CORNERS {
            // What no sample tells, a corner does: the tip of a shadow, or of what is left between shadows.
            let centre = 0.25 * cell.quad.iter().sum::<DVec3>();
            for corner in cell.quad {
                hidden_at(corner.lerp(centre, INWARD));
            }
        }
        cell.spread = SPREAD * area * (most - least);
        if cell.depth < SEARCHED {
            let unmet = met.iter().zip(&list).filter(|(met, _)| !**met).map(|(_, occluder)| *occluder);
            cell.error = unmet.map(|occluder| self.missed(&cell.quad, occluder)).sum();
        }
    }

    /// Most that an occluder hides which is before no sample and no corner of a cell.
    fn missed(&self, quad: &[DVec3; 4], occluder: &Polygon) -> f64 {
        let [a, b, c, d] = *quad;
        let size = (c - a).length().max((d - b).length());
        // A shadow as wide as samples are apart does not slip through between them; a source without extent makes it as narrow as its
        // occluder.
        if occluder.area() / occluder.radius() >= SLIPS_THROUGH * size {
            return 0.0;
        }
        let (centre, normal) = (0.25 * (a + b + c + d), self.receiver.normal());
        let whole = lambert::share(centre, normal, self.source.vertices());
        let most = lambert::share_above_horizon(centre, normal, occluder.vertices()).abs();
        0.5 * (c - a).cross(d - b).length() * most.min(whole).max(0.0)
    }
}

/// What is hidden from all cells, and its error.
fn sums(heap: &BinaryHeap<Cell>, settled: (f64, f64)) -> (f64, f64) {
    // In the order of the heap's array, which depends on nothing but the input.
    heap.iter().fold(settled, |(h, e), cell| (h + cell.hidden, e + cell.error))
}
