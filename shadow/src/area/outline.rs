//! The outlines of shadows on a light's plane, for the points of one group.
//!
//! From a point P, a sheet's projection winds one way or the other, by the side of its plane that P is on. An edge between two sheets
//! that wind the same way is passed once in each direction: inside of the shadow. The others count by the sum over their sheets.

use super::light_cells::Outlined;
use super::shaft::Shaft;
use super::sheets::{Kind, Sheet, Sheets, at_height};
use glam::{DVec2, DVec3};

/// Casters are cut off at this distance below a receiver's height, relative to the height: what is nearer to the receiver than this share
/// of the light's distance, in the direction of the light's normal, would be projected to infinity.
const NEAREST: f64 = 1e-6;

/// How far the planes of a group's sheets must be from its box for their side to be the same for all points, in units of the distance
/// that counts as 0: rounding must not decide.
const SURE: f64 = 2.0;

/// An edge of a group's sheets.
#[derive(Clone, Copy, Debug)]
struct OutlineEdge {
    ends: [DVec3; 2],
    kind: Kind,
    number: u32,
    /// Sum over the sheets whose side is the same for all points of the group.
    sure: i32,
    /// Sum over all sheets, for the point at hand.
    now: i32,
    /// Some sheet's side depends on the point.
    open: bool,
}

impl OutlineEdge {
    const NOTHING: Self =
        Self { ends: [DVec3::NEG_INFINITY; 2], kind: 0, number: 0, sure: 0, now: 0, open: false };

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

/// A sheet whose side depends on the point, or that reaches above a point of the group.
#[derive(Clone, Copy, Debug)]
struct OpenSheet {
    normal: DVec3,
    offset: f64,
    /// Positions among the live edges, and how the sheet goes along them; 0 for edges that do not count.
    edges: [(u32, i32); 4],
    /// The side that the point at hand is on: 1, −1, or 0 within its plane.
    side: i32,
    /// It may be cut off for some point of the group.
    rises: bool,
    number: u32,
}

/// The edges of a group's sheets, and memory.
#[derive(Debug, Default)]
pub(crate) struct Outline {
    edges: Vec<OutlineEdge>,
    /// For each edge of the batch, its position in `edges`, or `NONE`.
    position: Vec<u32>,
    numbers: Vec<u32>,
    /// Edges that may count, the highest first. Those that cancel for all points of the group do not, nor do those that
    /// [`Shaft::is_right_or_beside`] finds. One more stands for all of these.
    live: Vec<OutlineEdge>,
    /// Positions in `edges` of the live ones, and for each of `edges` its position among the live ones.
    order: Vec<u32>,
    live_position: Vec<u32>,
    open: Vec<OpenSheet>,
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
        for number in group {
            let sheet = &sheets.list[number as usize];
            let middle = sheet.normal.dot(centre) - sheet.offset;
            let reach = sheet.normal.abs().dot(half) + SURE * self.coincident;
            let rises = sheets.corners(sheet).any(|c| c.z > highest_caster(low.z));
            if !rises && middle.abs() > reach {
                let side = if middle > 0.0 { 1 } else { -1 };
                self.add(sheets, sheet, |edge, turn| edge.sure += side * turn);
            } else {
                self.add(sheets, sheet, |edge, _| edge.open = true);
                let Sheet { normal, offset, .. } = *sheet;
                self.open.push(OpenSheet { normal, offset, edges: [(0, 0); 4], side: 0, rises, number });
            }
        }
        self.choose_live(sheets, shaft);
    }

    fn add(&mut self, sheets: &Sheets, sheet: &Sheet, mut act: impl FnMut(&mut OutlineEdge, i32)) {
        for e in sheet.edges() {
            let position = &mut self.position[e.edge() as usize];
            if *position == NONE {
                *position = self.edges.len() as u32;
                self.numbers.push(e.edge());
                let number = e.edge();
                let (ends, kind) = (sheets.ends(number), sheets.kind_of(number));
                self.edges.push(OutlineEdge { ends, kind, number, ..OutlineEdge::NOTHING });
            }
            act(&mut self.edges[*position as usize], e.turn());
        }
    }

    /// Finds the edges that may count, and where open sheets have theirs.
    fn choose_live(&mut self, sheets: &Sheets, shaft: &Shaft) {
        let Self { edges, position, live, order, live_position, open, .. } = self;
        let counts = |e: &OutlineEdge| (e.open || e.sure != 0) && !shaft.is_right_or_beside(e.ends);
        order.clear();
        order.extend((0..edges.len() as u32).filter(|&i| counts(&edges[i as usize])));
        let top = |&i: &u32| edges[i as usize].top();
        order.sort_unstable_by(|a, b| top(b).total_cmp(&top(a)));
        live_position.clear();
        live_position.resize(edges.len(), order.len() as u32);
        live.clear();
        for (place, &i) in order.iter().enumerate() {
            live_position[i as usize] = place as u32;
            live.push(edges[i as usize]);
        }
        live.push(OutlineEdge::NOTHING);
        for sheet in open {
            for (own, e) in sheet.edges.iter_mut().zip(sheets.list[sheet.number as usize].edges()) {
                *own = (live_position[position[e.edge() as usize] as usize], e.turn());
            }
        }
    }

    /// Finds out how edges count for a point.
    pub(crate) fn turn_to(&mut self, point: DVec3) {
        for edge in &mut self.live {
            edge.now = edge.sure;
        }
        for sheet in &mut self.open {
            let distance = sheet.normal.dot(point) - sheet.offset;
            sheet.side = i32::from(distance > self.coincident) - i32::from(distance < -self.coincident);
            for (edge, turn) in sheet.edges {
                self.live[edge as usize].now += sheet.side * turn;
            }
        }
        if let Some(last) = self.live.last_mut() {
            last.now = 0;
        }
    }

    /// Whether an outline within `shaft` moves by more than `most` times the way of the point of [`Outline::turn_to`]; outlines below the
    /// surface's horizon do not count.
    pub(crate) fn moves_by_more(&self, most: f64, (point, normal): (DVec3, DVec3), shaft: &Shaft) -> bool {
        let top = highest_caster(point.z);
        let moves = |height: f64| height / (point.z - height) > most;
        let below_horizon = |p: DVec3| normal.dot(p - point) <= self.coincident;
        // The first that is too low ends it: those that follow are lower.
        let high = self.live.iter().take_while(|edge| moves(edge.top().min(top)));
        high.filter_map(|edge| edge.below(top)).any(|[a, b]| {
            !(below_horizon(a) && below_horizon(b)) && shaft.highest_within(a, b).is_some_and(moves)
        })
    }

    /// Calls `visit` for the outlines that the point of [`Outline::turn_to`] sees.
    pub(crate) fn cast(&self, sheets: &Sheets, point: DVec3, mut visit: impl FnMut(Outlined)) {
        let top = highest_caster(point.z);
        for open in self.open.iter().filter(|open| open.rises && open.side != 0) {
            cast_cut(sheets, &sheets.list[open.number as usize], (point, top), open.side, &mut visit);
        }
        for edge in &self.live {
            if let Some([a, b]) = edge.below(top) {
                let (from, to) = (projected(point, a), projected(point, b));
                visit(Outlined { from, to, winding: edge.now, kind: edge.kind, edge: edge.number });
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
        self.open.iter().any(|open| {
            let sheet = &sheets.list[open.number as usize];
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
}

/// The edge along which a sheet is cut off at height `top`, for a point on this side of it.
fn cast_cut(
    sheets: &Sheets,
    sheet: &Sheet,
    (point, top): (DVec3, f64),
    winding: i32,
    visit: &mut impl FnMut(Outlined),
) {
    let (mut leaves, mut returns, mut edge) = (None, None, 0);
    for e in sheet.edges() {
        edge = e.edge();
        let [a, b] = sheets.ends(edge);
        if (a.z > top) != (b.z > top) {
            let at = Some(at_height(a, b, top));
            // Upward as the sheet goes along it.
            let up = (b.z > top) == (e.turn() > 0);
            if up { leaves = at } else { returns = at }
        }
    }
    if let (Some(from), Some(to)) = (leaves, returns) {
        let (from, to) = (projected(point, from), projected(point, to));
        visit(Outlined { from, to, winding, kind: sheets.kind_of(edge), edge });
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
