//! The outlines of shadows on a light's plane, for the points of one group.
//!
//! From a point P, a sheet's projection winds one way or the other, by the side of its plane that P is on. An edge between two sheets
//! that wind the same way is passed once in each direction: inside of the shadow. The others count by the sum over their sheets.

use super::shaft::Shaft;
use super::sheets::{Kind, Sheet, Sheets, at_height};
use super::sweep::Sweep;
use glam::{DVec2, DVec3};

/// Casters are cut off at this distance below a receiver's height, relative to the height: what is nearer to the receiver than this share
/// of the light's distance, in the direction of the light's normal, would be projected to infinity.
const NEAREST: f64 = 1e-6;

/// How far the planes of a group's sheets must be from its box for their side to be the same for all points, in units of the distance
/// that counts as 0: rounding must not decide.
const SURE: f64 = 2.0;

#[derive(Clone, Copy, Debug)]
struct OutlineEdge {
    ends: [DVec3; 2],
    kind: Kind,
    /// Sum over the sheets whose side is the same for all points of the group.
    sure: i32,
    /// Sum over all sheets, for the point at hand.
    now: i32,
    /// Some sheet's side depends on the point.
    open: bool,
}

/// The edges of a group's sheets, and memory.
#[derive(Debug, Default)]
pub(crate) struct Outline {
    edges: Vec<OutlineEdge>,
    /// For each edge of the batch, its position in `edges`, or `NONE`.
    position: Vec<u32>,
    numbers: Vec<u32>,
    /// Edges that may count. Those that cancel for all points of the group do not, nor do those that [`Shaft::is_right_or_beside`] finds.
    live: Vec<u32>,
    /// Sheets whose side depends on the point, or that reach above a point of the group.
    open: Vec<u32>,
    coincident: f64,
}

const NONE: u32 = u32::MAX;

impl Outline {
    /// Begins a batch.
    pub(crate) fn start(&mut self, sheets: &Sheets, coincident: f64) {
        self.edges.clear();
        self.numbers.clear();
        self.position.clear();
        self.position.resize(sheets.edge_count(), NONE);
        self.coincident = coincident;
    }

    /// Takes the sheets of a group of points within a box; `shaft` is that box's.
    pub(crate) fn take(
        &mut self,
        sheets: &Sheets,
        group: impl Iterator<Item = u32>,
        (low, high): (DVec3, DVec3),
        shaft: &Shaft,
    ) {
        for number in self.numbers.drain(..) {
            self.position[number as usize] = NONE;
        }
        self.edges.clear();
        self.open.clear();
        let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
        for s in group {
            let sheet = &sheets.list[s as usize];
            let middle = sheet.normal.dot(centre) - sheet.offset;
            let reach = sheet.normal.abs().dot(half) + SURE * self.coincident;
            let below = sheets.corners(sheet).all(|c| c.z <= highest_caster(low.z));
            if below && middle.abs() > reach {
                let side = if middle > 0.0 { 1 } else { -1 };
                self.add(sheets, sheet, |edge, turn| edge.sure += side * turn);
            } else {
                self.add(sheets, sheet, |edge, _| edge.open = true);
                self.open.push(s);
            }
        }
        self.live.clear();
        let counts = |e: &OutlineEdge| (e.open || e.sure != 0) && !shaft.is_right_or_beside(e.ends);
        self.live.extend((0..self.edges.len()).filter(|&i| counts(&self.edges[i])).map(|i| i as u32));
    }

    fn add(&mut self, sheets: &Sheets, sheet: &Sheet, mut act: impl FnMut(&mut OutlineEdge, i32)) {
        for e in sheet.edges() {
            let position = &mut self.position[e.edge() as usize];
            if *position == NONE {
                *position = self.edges.len() as u32;
                self.numbers.push(e.edge());
                self.edges.push(OutlineEdge {
                    ends: sheets.ends(e.edge()),
                    kind: sheets.kind_of(e.edge()),
                    sure: 0,
                    now: 0,
                    open: false,
                });
            }
            act(&mut self.edges[*position as usize], e.turn());
        }
    }

    /// Adds the outlines that a point of a surface sees to a sweep. Returns the largest factor by which an outline within `shaft` moves
    /// when the point moves; outlines below the surface's horizon do not count.
    pub(crate) fn cast(
        &mut self,
        sheets: &Sheets,
        (point, normal): (DVec3, DVec3),
        shaft: &Shaft,
        sweep: &mut Sweep,
    ) -> f64 {
        let top = highest_caster(point.z);
        for &i in &self.live {
            let edge = &mut self.edges[i as usize];
            edge.now = edge.sure;
        }
        for i in 0..self.open.len() {
            let sheet = &sheets.list[self.open[i] as usize];
            let distance = sheet.normal.dot(point) - sheet.offset;
            if distance.abs() <= self.coincident {
                continue;
            }
            let side = if distance > 0.0 { 1 } else { -1 };
            for e in sheet.edges() {
                self.edges[self.position[e.edge() as usize] as usize].now += side * e.turn();
            }
            self.cast_cut(sheet, point, top, side, sweep);
        }
        let mut factor = 0.0_f64;
        for &i in &self.live {
            let OutlineEdge { ends: [a, b], now, kind, .. } = self.edges[i as usize];
            if now == 0 || (a.z > top && b.z > top) {
                continue;
            }
            let cut = |p: DVec3| if p.z > top { at_height(a, b, top) } else { p };
            let (a, b) = (cut(a), cut(b));
            sweep.add(projected(point, a), projected(point, b), now, kind);
            let below = |p: DVec3| normal.dot(p - point) <= self.coincident;
            if below(a) && below(b) {
                continue;
            }
            if let Some(nearest) = shaft.highest_within(a, b) {
                factor = factor.max(nearest / (point.z - nearest));
            }
        }
        factor
    }

    /// Whether a sheet passes between these corners, which are within a box: there is a shadow's outline there, and no edge for it.
    ///
    /// Sheets that the box's own shaft misses do not count, margin or not: whether they are among the group's depends on the group.
    pub(crate) fn passes_between(
        &self,
        sheets: &Sheets,
        corners: impl Iterator<Item = DVec3> + Clone,
        (low, high): (DVec3, DVec3),
        shaft: &Shaft,
    ) -> bool {
        let shaft = shaft.without_margin();
        self.open.iter().any(|&s| {
            let sheet = &sheets.list[s as usize];
            let beside = (0..3).any(|axis| {
                let all = |beyond: &dyn Fn(f64) -> bool| sheets.corners(sheet).all(|c| beyond(c[axis]));
                all(&|x| x < low[axis]) || all(&|x| x > high[axis])
            });
            let distance = |c: DVec3| sheet.normal.dot(c) - sheet.offset;
            !beside
                && !shaft.misses(sheets.corners(sheet))
                && corners.clone().any(|c| distance(c) > self.coincident)
                && corners.clone().any(|c| distance(c) < -self.coincident)
        })
    }

    /// The edge along which a sheet is cut off at height `top`.
    fn cast_cut(&self, sheet: &Sheet, point: DVec3, top: f64, side: i32, sweep: &mut Sweep) {
        let (mut leaves, mut returns, mut kind) = (None, None, 0);
        for e in sheet.edges() {
            let OutlineEdge { ends: [a, b], kind: own, .. } =
                self.edges[self.position[e.edge() as usize] as usize];
            kind = own;
            if (a.z > top) != (b.z > top) {
                let at = Some(at_height(a, b, top));
                // Upward as the sheet goes along it.
                let up = (b.z > top) == (e.turn() > 0);
                if up { leaves = at } else { returns = at }
            }
        }
        if let (Some(from), Some(to)) = (leaves, returns) {
            sweep.add(projected(point, from), projected(point, to), side, kind);
        }
    }
}

/// The greatest height at which casters count for a point at this height.
pub(crate) fn highest_caster(height: f64) -> f64 {
    height * (1.0 - NEAREST)
}

/// Where the line from `point` through `p` meets the light's plane.
#[inline]
pub(crate) fn projected(point: DVec3, p: DVec3) -> DVec2 {
    let scale = point.z / (point.z - p.z);
    point.truncate() + (p.truncate() - point.truncate()) * scale
}
