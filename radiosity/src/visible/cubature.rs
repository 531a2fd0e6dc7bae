//! Mutual exchange A₁F₁₂ of two polygons with occluders between them, by adaptive cubature of the hidden part.
//!
//! 1. The unoccluded exchange is computed by the rules of [`pair`]. What occluders hide is computed apart and subtracted.
//! 2. The smaller polygon, the receiver, is divided into quadrangular cells, along the planes of occluders that stand on it.
//! 3. A cell whose shaft to the source holds no occluder hides nothing; a cell whose shaft is blocked by a single occluder hides all of its
//!    unoccluded exchange. Both are exact ("settled").
//! 4. In other cells the hidden share of the source is integrated by [`ORDER`]² Gauss points. At each point it is exact: Lambert's formula for
//!    the parts of the source that occluders hide.
//! 5. Cells with the largest error estimates are divided until the sum of the estimates is within the [`Goal`]: at first along the lines where the hidden
//!    share changes its kind ([`Events`]), into parts in each of which it is smooth, then into quarters. The estimate of a quarter is
//!    what quartering changed, so that cells become small where the hidden share is not smooth all the same; that of a part is small as far as its samples
//!    are those of a smooth function. Near a common edge of receiver and
//!    source the unoccluded share is far from a polynomial, but only the hidden part, small there, is integrated numerically.

use std::borrow::Cow;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::events::Events;
use super::parts::{Pieces, Source};
use super::shaft::Shaft;
use crate::kernel::gauss;
use crate::kernel::pair::{self, Mutual, Rule, facing_parts};
use crate::polygon::{Polygon, clipped};
use pointillist_dice::lambert;

/// Gauss points along each side of a cell.
const ORDER: usize = 3;
/// Cells of a lower depth than this are also sampled near their corners, to find occluders that hide something there only.
const LOOKED_AT_CORNERS: u8 = 1;
/// Cells of a lower depth than this have an error for each narrow occluder in their shaft that hid the source from no sample.
const SEARCHED: u8 = 3;
/// Distance between neighbouring samples, at most, as a share of the cell's diagonal.
const SLIPS_THROUGH: f64 = 0.5;
/// Corner samples are moved towards the cell's centre by this share of the way: on a contact line the occluder is seen edge on and hides
/// nothing.
const INWARD: f64 = 1e-3;
/// Error estimate of the Gauss rule for a discontinuous hidden share, as a share of the difference between its largest and smallest sample.
/// A step anywhere between two of three Gauss points is integrated with an error of at most 2/9 of its height; this is about half of that.
const SPREAD: f64 = 1.0 / 8.0;
/// Where this relative error or less is asked for, cells are cut along lines before they are sampled: hardly any would be good enough whole.
const CUT_AT_ONCE: f64 = 2e-3;
/// For a smooth function the Gauss rule misses what is beyond degree 5. If coefficients of Legendre polynomials fall by a factor `r` from degree to degree,
/// samples differ by about `2r`, their second differences make `r²`, and the error is about `r⁶`, so that the estimate of [`SPREAD`] may be
/// multiplied by the fourth power of the ratio of the two, times [`BEND`]. The third power is on the safe side; in a Cornell box the second makes no error smaller and takes a
/// ninth longer.
const BEND: f64 = 2.0;
const DECAY: i32 = 3;
/// The error that quarters are taken to have left is what quartering changed, divided by this. For a kink across a cell 4 would do; 2 allows
/// for levels that agree by chance.
const GAIN: f64 = 2.0;
/// Most occluders along whose planes the receiver is cut where they stand on it, so that the discontinuity at their foot lies on borders
/// of cells.
const MAX_CUTS: usize = 8;

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// Relative error of unoccluded exchange.
    pub(crate) unoccluded: f64,
    /// Error relative to the result.
    pub(crate) relative: f64,
    /// Absolute error that is accepted whatever the result, in units of area.
    pub(crate) absolute: f64,
    /// Most cells that are sampled for one pair. If they do not suffice, the result has a larger error bound.
    pub(crate) max_cells: usize,
    /// Cells are quartered down to at least this depth.
    pub(crate) least_depth: u8,
}

/// What one pair cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Work {
    /// Cells that were sampled.
    pub(crate) cells: usize,
}

/// Where a cell lies among the lines of [`Events`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lines {
    /// It was not asked yet whether any crosses it.
    Unknown,
    /// It lies between them.
    Between,
    /// It is a quarter of a cell.
    Quarter,
}

struct Cell {
    quad: [DVec3; 4],
    occluders: Vec<u32>,
    hidden: f64,
    /// Error estimate from the differences of the samples: by [`SPREAD`], and by `rough` if no line is known to cross it.
    spread: f64,
    /// How little the samples are those of a smooth function: 0 to 1.
    rough: f64,
    /// Where it lies among the lines of [`Events`].
    lines: Lines,
    error: f64,
    depth: u8,
    /// Whether it is exact but for rounding and the unoccluded rule, which smaller cells do not improve.
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

/// Exchange A₁F₁₂ past the occluders. They may come in any order, and may lie outside of the shaft between the polygons.
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

/// As [`mutual`], for occluders that were tested already: all may lie in the shaft of the whole polygons, and none blocks it alone.
pub(crate) fn mutual_in_shaft(
    a: &Polygon,
    b: &Polygon,
    occluders: &[&Polygon],
    goal: Goal,
    pieces: &mut Pieces,
) -> (Mutual, Work) {
    match facing_parts(a, b) {
        Some((Cow::Borrowed(a), Cow::Borrowed(b))) => past(a, b, occluders, goal, pieces),
        // The parts that face one another have a smaller shaft, which must be tested.
        _ => mutual(a, b, occluders, goal, pieces),
    }
}

fn past(a: &Polygon, b: &Polygon, occluders: &[&Polygon], goal: Goal, pieces: &mut Pieces) -> (Mutual, Work) {
    let (receiver, source) = if a.area() <= b.area() { (a, b) } else { (b, a) };
    let flat = Source::new(source);
    Cubature { receiver, source, flat: &flat, occluders, goal, pieces, events: None, work: Work::default() }
        .run()
}

struct Cubature<'p> {
    receiver: &'p Polygon,
    source: &'p Polygon,
    flat: &'p Source,
    occluders: &'p [&'p Polygon],
    goal: Goal,
    pieces: &'p mut Pieces,
    /// Found when the first cell is divided.
    events: Option<Events>,
    work: Work,
}

impl Cubature<'_> {
    fn run(mut self) -> (Mutual, Work) {
        let open = pair::mutual(self.receiver, self.source, self.goal.unoccluded);
        let mut heap = BinaryHeap::new();
        let mut settled = (0.0, open.error);
        let all: Vec<u32> = (0..self.occluders.len() as u32).collect();
        for quad in self.roots() {
            if self.goal.relative <= CUT_AT_ONCE && self.cut((&quad, &all, 0), &mut heap, &mut settled) {
                continue;
            }
            let mut cell = self.cell(quad, &all, 0, Lines::Unknown);
            if cell.settled || self.goal.least_depth > 0 {
                self.divide(&cell, &mut heap, &mut settled);
            } else {
                cell.error += cell.spread;
                heap.push(cell);
            }
        }
        loop {
            // Formed anew, not kept up to date: a running sum would collect rounding. Batches keep the cost linear in the cells.
            let (hidden, error) = sums(&heap, settled);
            // For a pair that is hidden completely the difference of exact rules is their rounding.
            let value = if open.value - hidden > settled.1 { open.value - hidden } else { 0.0 };
            let enough = self.goal.absolute.max(self.goal.relative * value);
            // Without cells in the heap only the error of the exact rules is left.
            if error <= enough || self.work.cells >= self.goal.max_cells || heap.is_empty() {
                return (Mutual { value, error, rule: Rule::Points }, self.work);
            }
            // A batch of the cells with the largest errors for each sum.
            for _ in 0..(heap.len() / 4).max(1) {
                let Some(cell) = heap.pop() else { break };
                self.divide(&cell, &mut heap, &mut settled);
            }
        }
    }

    /// The receiver in quadrangles, cut along the planes of occluders that stand on it.
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

    /// Replaces a cell by its quarters; a settled cell is added to the sums `settled` (hidden, error).
    fn divide(&mut self, cell: &Cell, heap: &mut BinaryHeap<Cell>, settled: &mut (f64, f64)) {
        if cell.settled {
            settled.0 += cell.hidden;
            settled.1 += cell.error;
            return;
        }
        if cell.lines == Lines::Unknown {
            if self.cut((&cell.quad, &cell.occluders, cell.depth), heap, settled) {
                return;
            }
            if cell.depth >= self.goal.least_depth && cell.rough < 1.0 {
                let spread = cell.spread * cell.rough;
                let (error, occluders) = (cell.error - cell.spread + spread, cell.occluders.clone());
                heap.push(Cell { error, spread, occluders, lines: Lines::Between, ..*cell });
                return;
            }
        }
        let [a, b, c, d] = cell.quad;
        let [ab, bc, cd, da] = [(a, b), (b, c), (c, d), (d, a)].map(|(p, q)| 0.5 * (p + q));
        let middle = 0.5 * (ab + cd);
        let quarters = [[a, ab, middle, da], [ab, b, bc, middle], [middle, bc, c, cd], [da, middle, cd, d]];
        let mut children =
            quarters.map(|quad| self.cell(quad, &cell.occluders, cell.depth + 1, Lines::Quarter));
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

    /// Replaces a cell by parts along lines of [`Events`]; false if none meets it.
    fn cut(
        &mut self,
        (&[a, b, c, d], list, depth): (&[DVec3; 4], &[u32], u8),
        heap: &mut BinaryHeap<Cell>,
        settled: &mut (f64, f64),
    ) -> bool {
        let (receiver, source, occluders) = (self.receiver, self.source, self.occluders);
        let events = self.events.get_or_insert_with(|| Events::new(receiver, source, occluders));
        let ring = if c == d { vec![a, b, c] } else { vec![a, b, c, d] };
        let parts = events.cut(&ring);
        if parts.len() == 1 {
            return false;
        }
        for part in parts.into_iter().filter_map(Polygon::unchecked) {
            for quad in part.quads() {
                let mut child = self.cell(quad, list, depth + 1, Lines::Between);
                if child.settled {
                    settled.0 += child.hidden;
                    settled.1 += child.error;
                } else {
                    child.error += child.spread;
                    heap.push(child);
                }
            }
        }
        true
    }

    /// A cell: settled if its shaft is free or blocked by one occluder, else sampled.
    fn cell(&mut self, quad: [DVec3; 4], occluders: &[u32], depth: u8, lines: Lines) -> Cell {
        let (hidden, spread, error, settled) = (0.0, 0.0, 0.0, true);
        let mut cell =
            Cell { quad, occluders: vec![], hidden, spread, rough: 1.0, lines, error, depth, settled };
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
        let searched = cell.depth < SEARCHED;
        let mut met = vec![false; if searched { list.len() } else { 0 }];
        let (mut area, mut least, mut most) = (0.0, f64::MAX, 0.0_f64);
        let mut hidden_at = |p: DVec3| {
            let occluders = list.iter().copied();
            let mut meets = |i: usize| met[i] = true;
            // Only the upper cells look for occluders that slip through.
            let meets: Option<&mut dyn FnMut(usize)> = if searched { Some(&mut meets) } else { None };
            let hidden = self.flat.hidden_share((p, normal), occluders, self.pieces, meets);
            (least, most) = (least.min(hidden), most.max(hidden));
            hidden
        };
        let rule = gauss::rule(ORDER);
        let mut samples = [[0.0; ORDER]; ORDER];
        for ((u, weight_u), row) in rule.iter().zip(&mut samples) {
            for ((v, weight_v), sample) in rule.iter().zip(row) {
                let (p, jacobian) = gauss::on_quad(&cell.quad, u, v);
                let weight = weight_u * weight_v * jacobian;
                *sample = hidden_at(p);
                cell.hidden += weight * *sample;
                area += weight;
            }
        }
        let mut bend = curvature(&samples);
        if cell.depth < LOOKED_AT_CORNERS || cell.lines == Lines::Between {
            // The tip of a shadow, or of a lit gap between shadows, may lie between the Gauss points and a corner.
            let centre = 0.25 * cell.quad.iter().sum::<DVec3>();
            for (number, corner) in cell.quad.into_iter().enumerate() {
                let found = hidden_at(corner.lerp(centre, INWARD));
                bend = bend.max((found - extrapolated(&samples, number)).abs());
            }
        }
        cell.spread = SPREAD * area * (most - least);
        if most > least {
            cell.rough = (BEND * bend / (most - least)).min(1.0).powi(DECAY);
        }
        if cell.lines != Lines::Unknown {
            cell.spread *= cell.rough;
        }
        if searched {
            let unmet = met.iter().zip(&list).filter(|(met, _)| !**met).map(|(_, occluder)| *occluder);
            cell.error = unmet.map(|occluder| self.missed(&cell.quad, occluder)).sum();
        }
    }

    /// Bound on what an occluder hides from a cell if it hid the source from none of the cell's samples.
    fn missed(&self, quad: &[DVec3; 4], occluder: &Polygon) -> f64 {
        let [a, b, c, d] = *quad;
        let size = (c - a).length().max((d - b).length());
        // A shadow is at least as wide as its occluder (exactly so for a point source), so one wider than the distance of the samples
        // contains one of them.
        if occluder.area() / occluder.radius() >= SLIPS_THROUGH * size {
            return 0.0;
        }
        let (centre, normal) = (0.25 * (a + b + c + d), self.receiver.normal());
        let whole = lambert::share(centre, normal, self.source.vertices());
        let most = lambert::share_above_horizon(centre, normal, occluder.vertices()).abs();
        0.5 * (c - a).cross(d - b).length() * most.min(whole).max(0.0)
    }
}

/// The biquadratic through the samples at a corner.
fn extrapolated(samples: &[[f64; ORDER]; ORDER], corner: usize) -> f64 {
    const WEIGHTS: [f64; ORDER] = [1.478_830_557_701_236, -2.0 / 3.0, 0.187_836_108_965_430_6];
    let (far_u, far_v) = (corner == 1 || corner == 2, corner >= 2);
    let at = |i: usize, far: bool| WEIGHTS[if far { ORDER - 1 - i } else { i }];
    let row = |i: usize| (0..ORDER).map(|j| at(j, far_v) * samples[i][j]).sum::<f64>();
    (0..ORDER).map(|i| at(i, far_u) * row(i)).sum()
}

/// Largest second difference of samples along a row or a column, as the coefficient of the Legendre polynomial of degree 2.
fn curvature(samples: &[[f64; ORDER]; ORDER]) -> f64 {
    let of = |a: f64, b: f64, c: f64| (a - 2.0 * b + c).abs() * (5.0 / 18.0) * 2.0;
    (0..ORDER).fold(0.0, |most: f64, i| {
        let row = of(samples[i][0], samples[i][1], samples[i][2]);
        most.max(row).max(of(samples[0][i], samples[1][i], samples[2][i]))
    })
}

/// The hidden exchange of all cells, and its error.
fn sums(heap: &BinaryHeap<Cell>, settled: (f64, f64)) -> (f64, f64) {
    // In the order of the heap's array, which depends on the input alone, so that results are reproducible.
    heap.iter().fold(settled, |(h, e), cell| (h + cell.hidden, e + cell.error))
}
