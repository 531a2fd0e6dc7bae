//! Lines on a receiver across which the hidden part of a source changes its kind, as in discontinuity meshing \[12\].
//!
//! The hidden share of the source is a smooth function of the point that it is seen from, except where
//!
//! * a corner of the source passes behind an edge of an occluder, or an edge of the source behind a corner of an occluder: these points are the
//!   shadows of the one, cast by the other. Both kinds are sides of one lattice: the point `P(s, v)` is where the line from a corner
//!   `s` of the source through a corner `v` of the occluder meets the receiver's plane;
//! * an occluder is seen edge on: there its outline changes.
//!
//! Edges that two occluders share and that the one continues beyond the other, as those of a box, are no outline and have no line.
//! Points where the outlines of three occluders meet before the source lie on curves, which are left out.

use glam::{DVec2, DVec3};
use pointillist_dice::{clip_ring, share_before_crossing};

use super::parts::Frame;
use crate::polygon::{Polygon, edges};

/// A line is cut along only if both sides of the part are at least this wide, as a share of its width across the line. Lamps that hang a thousandth of the room below a
/// ceiling have half shadows of some thousandths of a patch; 0.04 leaves four times the error in a Cornell box and saves a tenth of the time.
const NARROWEST: f64 = 0.003;
/// A line is cut along only if its segment within the part is at least this long, as a share of the whole line's there.
const SHORTEST: f64 = 0.05;
/// Most parts of one cell.
const MOST_PARTS: usize = 16;
/// Occluders beyond this number have no lines: among so many outlines there is hardly a smooth piece.
const MOST_OCCLUDERS: usize = 12;

/// An occluder's corner that is as high over the receiver as the source's, up to this share, casts no shadow on it.
const AS_HIGH: f64 = 1e-9;

/// A segment on the receiver.
#[derive(Clone, Copy, Debug)]
struct Line {
    ends: [DVec2; 2],
    /// Unit vector across.
    normal: DVec2,
}

/// All lines on a receiver.
#[derive(Clone, Debug)]
pub(crate) struct Events {
    frame: Frame,
    lines: Vec<Line>,
}

/// A point of the receiver's plane in homogeneous coordinates, and what must not be negative there: the heights of the occluder's corner over
/// receiver and source, and which side of the receiver's edges it is on. All are affine along an edge of either.
#[derive(Clone, Debug, Default)]
struct Shadow {
    x: DVec2,
    w: f64,
    limits: Vec<f64>,
}

impl Events {
    pub(crate) fn new(receiver: &Polygon, source: &Polygon, occluders: &[&Polygon]) -> Self {
        let frame = Frame::of(receiver);
        let mut found = Self { frame, lines: vec![] };
        if occluders.len() > MOST_OCCLUDERS {
            return found;
        }
        let ring: Vec<DVec2> = receiver.vertices().iter().map(|&v| frame.flat(v)).collect();
        let plane = Plane { receiver, source, frame, ring };
        for number in 0..occluders.len() {
            found.shadows(&plane, occluders, number);
            found.edge_on(occluders[number], &plane);
        }
        found
    }

    /// Adds the sides of the lattice of one occluder.
    fn shadows(&mut self, plane: &Plane<'_>, occluders: &[&Polygon], number: usize) {
        let occluder = occluders[number];
        let (ends, corners) = (plane.source.vertices(), occluder.vertices());
        let row = |&s: &DVec3| corners.iter().map(|&v| plane.shadow(s, v)).collect();
        let lattice: Vec<Vec<Shadow>> = ends.iter().map(row).collect();
        for j in 0..corners.len() {
            let k = (j + 1) % corners.len();
            let edge = (corners[j], corners[k]);
            // An edge of the occluder, from each corner of the source.
            let others = sharing(occluders, number, edge);
            for (row, &s) in lattice.iter().zip(ends) {
                if others.is_empty() || is_outline(s, occluder, edge, &others) {
                    self.push(&row[j], &row[k]);
                }
            }
            // Each edge of the source, past a corner of the occluder.
            if occluders[..number].iter().all(|o| !o.vertices().contains(&corners[j])) {
                for i in 0..ends.len() {
                    self.push(&lattice[i][j], &lattice[(i + 1) % ends.len()][j]);
                }
            }
        }
    }

    /// Adds what lies on the receiver of the way from one to the other.
    fn push(&mut self, a: &Shadow, b: &Shadow) {
        let limits = a.limits.iter().zip(&b.limits).map(|(&from, &to)| [from, to]);
        if let Some((low, high)) = not_negative(limits) {
            let at = |t: f64| a.x.lerp(b.x, t) / (a.w + (b.w - a.w) * t);
            self.segment(at(low), at(high));
        }
    }

    fn segment(&mut self, a: DVec2, b: DVec2) {
        let way = b - a;
        let length = way.length();
        if length > 0.0 && length.is_finite() {
            self.lines.push(Line { ends: [a, b], normal: way.perp() / length });
        }
    }

    /// Adds the line where the occluder is seen edge on, if the source reaches to both sides of its plane.
    fn edge_on(&mut self, occluder: &Polygon, plane: &Plane<'_>) {
        let (low, high) = occluder.heights_of(plane.source.vertices());
        if low >= 0.0 || high <= 0.0 {
            return;
        }
        let height = |p: DVec2| occluder.height(plane.frame.in_space(p));
        let mut met = vec![];
        for (a, b) in sides(&plane.ring) {
            let (from, to) = (height(a), height(b));
            if (from < 0.0) != (to < 0.0) {
                met.push(a.lerp(b, share_before_crossing(from, to)));
            }
        }
        if let [a, b] = met[..] {
            self.segment(a, b);
        }
    }

    /// A convex part of the receiver, cut along the lines; one part if none meets it.
    pub(crate) fn cut(&self, part: &[DVec3]) -> Vec<Vec<DVec3>> {
        let flat: Vec<DVec2> = part.iter().map(|&v| self.frame.flat(v)).collect();
        let mut waiting = vec![(flat, self.lines.clone())];
        let mut done = vec![];
        while let Some((ring, lines)) = waiting.pop() {
            let lines: Vec<Line> = lines.into_iter().filter_map(|line| line.within(&ring)).collect();
            let is_full = done.len() + waiting.len() + 1 >= MOST_PARTS;
            match best(&lines, &ring) {
                Some(line) if !is_full => {
                    waiting.extend([1.0, -1.0].map(|sign| (line.side(&ring, sign), lines.clone())));
                }
                _ => done.push(ring),
            }
        }
        done.iter().map(|ring| ring.iter().map(|&p| self.frame.in_space(p)).collect()).collect()
    }
}

/// The line that says most about a part: long, and far from its border. Both count in proportion to the part, which may be a sliver.
fn best<'l>(lines: &'l [Line], ring: &[DVec2]) -> Option<&'l Line> {
    let rated = lines.iter().filter_map(|line| {
        let (low, high) = extent(ring, |p| line.value(p));
        let (length, width) = (line.length(), high.min(-low));
        let is_worth = width > NARROWEST * (high - low) && length > SHORTEST * line.chord(ring);
        is_worth.then_some((length * width, line))
    });
    rated.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, line)| line)
}

/// Smallest and largest value at corners.
fn extent(ring: &[DVec2], value: impl Fn(DVec2) -> f64) -> (f64, f64) {
    ring.iter().map(|&p| value(p)).fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)))
}

/// Sides of a ring.
fn sides(ring: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    ring.last().copied().into_iter().chain(ring.iter().copied()).zip(ring.iter().copied())
}

/// The receiver's plane, and what stands before it.
struct Plane<'p> {
    receiver: &'p Polygon,
    source: &'p Polygon,
    frame: Frame,
    ring: Vec<DVec2>,
}

impl Plane<'_> {
    /// Where the line from a corner of the source through one of an occluder meets the plane.
    fn shadow(&self, s: DVec3, v: DVec3) -> Shadow {
        let (above, between) = (self.receiver.height(s), self.receiver.height(v));
        let x = self.frame.flat(v) * above - self.frame.flat(s) * between;
        let w = above - between;
        // The shadow of what is as high as the source is infinitely far away.
        let mut limits = vec![between, self.source.height(v), w - AS_HIGH * above];
        limits.extend(sides(&self.ring).map(|(a, b)| (b - a).perp_dot(x - a * w)));
        Shadow { x, w, limits }
    }
}

impl Line {
    fn length(&self) -> f64 {
        (self.ends[1] - self.ends[0]).length()
    }

    /// Distance, with its side.
    fn value(&self, p: DVec2) -> f64 {
        self.normal.dot(p - self.ends[0])
    }

    /// How far it would reach through a ring if it had no ends.
    fn chord(&self, ring: &[DVec2]) -> f64 {
        let along = |p: DVec2| self.normal.perp_dot(p);
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for (a, b) in sides(ring) {
            let (from, to) = (self.value(a), self.value(b));
            if (from < 0.0) != (to < 0.0) {
                let at = along(a.lerp(b, share_before_crossing(from, to)));
                (low, high) = (low.min(at), high.max(at));
            }
        }
        (high - low).max(0.0)
    }

    /// The part of a ring on one of its sides.
    fn side(&self, ring: &[DVec2], sign: f64) -> Vec<DVec2> {
        let mut kept = Vec::with_capacity(ring.len() + 1);
        let crossing = |(a, from): (DVec2, f64), (b, to)| a.lerp(b, share_before_crossing(from, to));
        clip_ring(ring, |p| sign * self.value(p), crossing, |p| kept.push(p));
        kept
    }

    /// What of it lies in a counter-clockwise ring.
    fn within(&self, ring: &[DVec2]) -> Option<Self> {
        let [a, b] = self.ends;
        let inside = |(from, to): (DVec2, DVec2)| self.ends.map(|p| (to - from).perp_dot(p - from));
        let (low, high) = not_negative(sides(ring).map(inside))?;
        Some(Self { ends: [a.lerp(b, low), a.lerp(b, high)], ..*self })
    }
}

/// Between which parameters, of 0 to 1, no affine function of some is negative, each given by its values at 0 and 1.
fn not_negative(values: impl Iterator<Item = [f64; 2]>) -> Option<(f64, f64)> {
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for [from, to] in values {
        if from <= 0.0 && to <= 0.0 && (from < 0.0 || to < 0.0) {
            return None;
        }
        if from < 0.0 {
            low = low.max(share_before_crossing(from, to));
        } else if to < 0.0 {
            high = high.min(share_before_crossing(from, to));
        }
    }
    (low < high).then_some((low, high))
}

/// Another occluder that has an edge, too.
struct Other {
    /// Whether it comes before this one.
    is_earlier: bool,
    centre: DVec3,
}

fn sharing(occluders: &[&Polygon], number: usize, (a, b): (DVec3, DVec3)) -> Vec<Other> {
    let has = |o: &Polygon| edges(o.vertices()).any(|e| e == (a, b) || e == (b, a));
    let others = occluders.iter().enumerate().filter(|(i, o)| *i != number && has(o));
    others.map(|(i, o)| Other { is_earlier: i < number, centre: o.centre() }).collect()
}

/// Whether an edge ends what is hidden from `s`, though others have it, too: they lie on one side of the plane through both. Of several, the first counts.
fn is_outline(s: DVec3, occluder: &Polygon, (a, b): (DVec3, DVec3), others: &[Other]) -> bool {
    let across = (a - s).cross(b - s);
    let side = |p: DVec3| across.dot(p - s) > 0.0;
    let own = side(occluder.centre());
    others.iter().all(|other| side(other.centre) == own && !other.is_earlier)
}
