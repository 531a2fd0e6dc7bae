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

impl OutlineEdge {
    /// The height of its higher end.
    fn top(&self) -> f64 {
        self.ends[0].z.max(self.ends[1].z)
    }

    /// What of it counts for the point at hand, and is no higher than `top`.
    #[inline]
    fn below(&self, top: f64) -> Option<[DVec3; 2]> {
        let [a, b] = self.ends;
        let cut = |p: DVec3| if p.z > top { at_height(a, b, top) } else { p };
        (self.now != 0 && (a.z <= top || b.z <= top)).then(|| [cut(a), cut(b)])
    }
}

/// The edges of a group's sheets, and memory.
#[derive(Debug, Default)]
pub(crate) struct Outline {
    edges: Vec<OutlineEdge>,
    /// For each edge of the batch, its position in `edges`, or `NONE`.
    position: Vec<u32>,
    numbers: Vec<u32>,
    /// Edges that may count, the highest first. Those that cancel for all points of the group do not, nor do those that
    /// [`Shaft::is_right_or_beside`] finds.
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
        let top = |&i: &u32| self.edges[i as usize].top();
        self.live.sort_unstable_by(|a, b| top(b).total_cmp(&top(a)));
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

    /// Finds out how edges count for a point.
    pub(crate) fn turn_to(&mut self, sheets: &Sheets, point: DVec3) {
        for &i in &self.live {
            let edge = &mut self.edges[i as usize];
            edge.now = edge.sure;
        }
        for &s in &self.open {
            let sheet = &sheets.list[s as usize];
            let side = self.side(sheet, point);
            for e in sheet.edges() {
                self.edges[self.position[e.edge() as usize] as usize].now += side * e.turn();
            }
        }
    }

    /// The side of a sheet that a point is on: 1, −1, or 0 within its plane.
    fn side(&self, sheet: &Sheet, point: DVec3) -> i32 {
        let distance = sheet.normal.dot(point) - sheet.offset;
        i32::from(distance > self.coincident) - i32::from(distance < -self.coincident)
    }

    /// Whether an outline within `shaft` moves by more than `most` times the way of the point of [`Outline::turn_to`]; outlines below the
    /// surface's horizon do not count.
    pub(crate) fn moves_by_more(&self, most: f64, (point, normal): (DVec3, DVec3), shaft: &Shaft) -> bool {
        let top = highest_caster(point.z);
        let moves = |height: f64| height / (point.z - height) > most;
        for &i in &self.live {
            let edge = &self.edges[i as usize];
            if !moves(edge.top().min(top)) {
                // Those that follow are lower.
                return false;
            }
            let Some([a, b]) = edge.below(top) else { continue };
            let below_horizon = |p: DVec3| normal.dot(p - point) <= self.coincident;
            if !(below_horizon(a) && below_horizon(b)) && shaft.highest_within(a, b).is_some_and(moves) {
                return true;
            }
        }
        false
    }

    /// Adds the outlines that the point of [`Outline::turn_to`] sees to a sweep.
    pub(crate) fn cast(&self, sheets: &Sheets, point: DVec3, sweep: &mut Sweep) {
        let top = highest_caster(point.z);
        for &s in &self.open {
            let sheet = &sheets.list[s as usize];
            let side = self.side(sheet, point);
            if side != 0 {
                self.cast_cut(sheet, point, top, side, sweep);
            }
        }
        for &i in &self.live {
            let edge = &self.edges[i as usize];
            if let Some([a, b]) = edge.below(top) {
                sweep.add(projected(point, a), projected(point, b), edge.now, edge.kind);
            }
        }
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
