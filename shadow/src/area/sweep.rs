//! The part of a convex polygon where the winding number of other edges is 0: slab by slab, as trapezoids.
//!
//! 1. Edges are clipped to the polygon's bounding rectangle. What lies to its right does not matter; what lies to its left counts by the
//!    winding number that it leaves on the rectangle's left side, as vertical edges there.
//! 2. Heights of vertices divide the rectangle into slabs. Where neighbouring edges cross within a slab, it is divided again.
//! 3. Within a slab, edges are sorted by their place at mid-height, and winding numbers are counted from left to right.
//! 4. Trapezoids between the same two edges are joined over slabs.

use super::light::SeenLight;
use super::sheets::{Kind, Sheets};
use glam::{DVec2, dvec2};
use std::cmp::Ordering;

/// An edge, upward along y.
#[derive(Clone, Copy, Debug)]
struct Side {
    low: DVec2,
    high: DVec2,
    /// Of x over y.
    slope: f64,
    /// What it adds to the winding number from left to right.
    winding: i32,
    what: Border,
}

/// What a side is the border of. The order of these decides between sides at one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Border {
    /// What hides or dims: sheets of one kind.
    Sheet(Kind),
    /// The polygon.
    Light,
}

impl Side {
    fn new(low: DVec2, high: DVec2, winding: i32, what: Border) -> Self {
        let slope = (high.x - low.x) / (high.y - low.y);
        // An overflow is that of a height next to 0: where within it the side is, does not matter.
        let slope = if slope.is_finite() { slope } else { 0.0 };
        Self { low, high, slope, winding, what }
    }

    fn x_at(&self, y: f64) -> f64 {
        if y <= self.low.y {
            self.low.x
        } else if y >= self.high.y {
            self.high.x
        } else {
            self.low.x + (y - self.low.y) * self.slope
        }
    }

    fn y_at(&self, x: f64) -> f64 {
        let share = (x - self.low.x) / (self.high.x - self.low.x);
        (self.low.y + (self.high.y - self.low.y) * share).clamp(self.low.y, self.high.y)
    }

    /// The part between two heights within its own.
    fn between(&self, from: f64, to: f64) -> Self {
        Self { low: dvec2(self.x_at(from), from), high: dvec2(self.x_at(to), to), ..*self }
    }

    /// A total order by place.
    fn compare(&self, other: &Self) -> Ordering {
        let key = |s: &Self| [s.low.x, s.low.y, s.high.x, s.high.y];
        let places = key(self).into_iter().zip(key(other)).map(|(a, b)| a.total_cmp(&b));
        let by_place = places.fold(Ordering::Equal, Ordering::then);
        by_place.then(self.what.cmp(&other.what)).then(self.winding.cmp(&other.winding))
    }
}

/// A side that passes through the current slab.
#[derive(Clone, Copy, Debug)]
struct Active {
    side: u32,
    /// Where it is at the slab's two heights.
    x: [f64; 2],
}

/// A trapezoid that may go on in the next slab.
#[derive(Clone, Copy, Debug)]
struct Open {
    left: u32,
    right: u32,
    from: f64,
    transmittance: f64,
}

/// The sweep and its memory.
#[derive(Debug, Default)]
pub(crate) struct Sweep {
    low: DVec2,
    high: DVec2,
    sides: Vec<Side>,
    /// Steps of the winding numbers along the left side: kind, height, and what is added from there on.
    steps: Vec<(Kind, f64, i32)>,
    /// For each translucent kind, the winding number at hand.
    layers: Vec<i32>,
    active: Vec<Active>,
    open: Vec<Open>,
    found: Vec<Open>,
}

impl Sweep {
    /// Begins with a convex polygon in positive order.
    pub(crate) fn start(&mut self, polygon: &[DVec2]) {
        self.sides.clear();
        self.steps.clear();
        (self.low, self.high) = pointillist_dice::convex::bounds(polygon);
        for (i, &a) in polygon.iter().enumerate() {
            let b = polygon[(i + 1) % polygon.len()];
            if a.y < b.y {
                self.sides.push(Side::new(a, b, -1, Border::Light));
            } else if b.y < a.y {
                self.sides.push(Side::new(b, a, 1, Border::Light));
            }
        }
    }

    /// Adds an edge of what hides the polygon: step 1.
    #[inline]
    pub(crate) fn add(&mut self, a: DVec2, b: DVec2, winding: i32, kind: Kind) {
        let up = a.y < b.y;
        let (low, high, winding) = if up { (a, b, winding) } else { (b, a, -winding) };
        if high.y <= self.low.y || low.y >= self.high.y || low.x.min(high.x) >= self.high.x || low.y == high.y
        {
            return;
        }
        let side = Side::new(low, high, winding, Border::Sheet(kind));
        let (from, to) = (low.y.max(self.low.y), high.y.min(self.high.y));
        if low.x.max(high.x) <= self.low.x {
            return self.add_steps(from, to, winding, kind);
        }
        self.add_clipped(side.between(from, to), kind);
    }

    fn add_steps(&mut self, from: f64, to: f64, winding: i32, kind: Kind) {
        if from < to {
            self.steps.push((kind, from, winding));
            self.steps.push((kind, to, -winding));
        }
    }

    /// Adds a side whose heights are within the rectangle's.
    fn add_clipped(&mut self, side: Side, kind: Kind) {
        let Side { low, high, winding, .. } = side;
        let (mut from, mut to) = (low.y, high.y);
        let (left, right) = (self.low.x, self.high.x);
        if low.x.max(high.x) <= left {
            return self.add_steps(from, to, winding, kind);
        }
        if low.x < left {
            let y = side.y_at(left);
            self.add_steps(from, y, winding, kind);
            from = y;
        } else if high.x < left {
            let y = side.y_at(left);
            self.add_steps(y, to, winding, kind);
            to = y;
        }
        if low.x > right {
            from = from.max(side.y_at(right));
        } else if high.x > right {
            to = to.min(side.y_at(right));
        }
        if from < to {
            self.sides.push(side.between(from, to));
        }
    }

    /// Steps along the left side as vertical sides there, joined where the winding number does not change.
    fn close_steps(&mut self) {
        self.steps.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        // Of each kind the steps add up to 0, so that the next one begins with no winding.
        let (mut winding, mut from) = (0, self.low.y);
        let mut first = 0;
        while first < self.steps.len() {
            let (kind, y, _) = self.steps[first];
            let same = self.steps[first..].iter().take_while(|s| s.0 == kind && s.1 == y);
            let (count, change) = same.fold((0, 0), |(n, sum), s| (n + 1, sum + s.2));
            if change != 0 {
                self.push_left(winding, from, y, kind);
                winding += change;
                from = y;
            }
            first += count;
        }
    }

    fn push_left(&mut self, winding: i32, from: f64, to: f64, kind: Kind) {
        if winding != 0 && from < to {
            let (low, high) = (dvec2(self.low.x, from), dvec2(self.low.x, to));
            self.sides.push(Side::new(low, high, winding, Border::Sheet(kind)));
        }
    }

    /// Appends the visible parts to `seen`: steps 2 to 4.
    pub(crate) fn finish(&mut self, polygon: &[DVec2], sheets: &Sheets, seen: &mut SeenLight) {
        self.close_steps();
        if self.sides.iter().all(|s| s.what == Border::Light) {
            return seen.push(polygon.iter().copied(), 1.0);
        }
        self.sides.sort_unstable_by(|a, b| a.low.y.total_cmp(&b.low.y).then_with(|| a.compare(b)));
        self.active.clear();
        self.open.clear();
        let (mut from, mut waiting) = (self.sides[0].low.y, 0);
        while waiting < self.sides.len() || !self.active.is_empty() {
            let sides = &self.sides;
            while let Some(side) = sides.get(waiting).filter(|side| side.low.y <= from) {
                self.active.push(Active { side: waiting as u32, x: [side.low.x; 2] });
                waiting += 1;
            }
            let next = sides.get(waiting).map_or(f64::INFINITY, |side| side.low.y);
            let ends = self.active.iter().map(|a| sides[a.side as usize].high.y);
            let to = ends.fold(next, |first, end| if end < first { end } else { first });
            self.divide(from, to, sheets, seen);
            self.active.retain(|a| self.sides[a.side as usize].high.y > to);
            from = to;
        }
        self.found.clear();
        self.close(f64::INFINITY, seen);
    }

    /// A slab, divided where neighbours cross.
    fn divide(&mut self, from: f64, to: f64, sheets: &Sheets, seen: &mut SeenLight) {
        let mut from = from;
        // Each crossing of two sides ends a part; the limit only guards against rounding that never ends.
        let limit = self.active.len() * self.active.len() + 1;
        for _ in 0..limit {
            let mut end = to;
            while let Some(crossing) = self.sort(from, end) {
                end = crossing;
            }
            self.count(from, sheets, seen);
            if end >= to {
                return;
            }
            from = end;
        }
        self.sort(from, to);
        self.count(from, sheets, seen);
    }

    /// Sorts the active sides, whose places at the first of two heights are known, by their places half way. Returns the lowest height strictly between at
    /// which neighbours cross.
    fn sort(&mut self, from: f64, to: f64) -> Option<f64> {
        let Self { sides, active, .. } = self;
        let is_before = |a: &Active, b: &Active| {
            let [at_a, at_b] = [a, b].map(|s| s.x[0] + s.x[1]);
            at_a < at_b || (at_a == at_b && sides[a.side as usize].compare(&sides[b.side as usize]).is_lt())
        };
        // Insertion: from slab to slab the order hardly changes.
        for i in 0..active.len() {
            let mut next = active[i];
            next.x[1] = sides[next.side as usize].x_at(to);
            let mut place = i;
            while place > 0 && is_before(&next, &active[place - 1]) {
                active[place] = active[place - 1];
                place -= 1;
            }
            active[place] = next;
        }
        let crossing = |pair: &[Active]| {
            let [d0, d1] = [pair[0].x[0] - pair[1].x[0], pair[0].x[1] - pair[1].x[1]];
            if (d0 < 0.0) == (d1 < 0.0) || d0 == 0.0 || d1 == 0.0 {
                return None;
            }
            let y = from + (to - from) * (d0 / (d0 - d1));
            (y > from && y < to).then_some(y)
        };
        active.windows(2).filter_map(crossing).reduce(f64::min)
    }

    /// Counts winding numbers through a slab that begins at `from`: step 3.
    fn count(&mut self, from: f64, sheets: &Sheets, seen: &mut SeenLight) {
        let (mut light, mut hidden) = (0, 0);
        self.layers.clear();
        self.layers.resize(sheets.kinds().len(), 0);
        self.found.clear();
        let mut left = None;
        for a in &self.active {
            let side = &self.sides[a.side as usize];
            let mut dims = false;
            match side.what {
                Border::Light => light += side.winding,
                Border::Sheet(0) => hidden += side.winding,
                Border::Sheet(kind) => {
                    if let Ok(place) = sheets.kinds().binary_search(&kind) {
                        self.layers[place] += side.winding;
                    }
                    dims = true;
                }
            }
            let visible = light != 0 && hidden == 0;
            if let Some((l, transmittance)) = left
                && (dims || !visible)
            {
                self.found.push(Open { left: l, right: a.side, from, transmittance });
                left = None;
            }
            if visible && left.is_none() {
                let passed = sheets.passed(&self.layers);
                left = (passed > 0.0).then_some((a.side, passed));
            }
        }
        self.close(from, seen);
        // The slab's upper height is the next one's lower.
        self.active.iter_mut().for_each(|a| a.x[0] = a.x[1]);
    }

    /// Ends at height `to` what does not go on in `found`, which becomes what is open.
    fn close(&mut self, to: f64, seen: &mut SeenLight) {
        for o in &self.open {
            if let Some(f) = self
                .found
                .iter_mut()
                .find(|f| f.left == o.left && f.right == o.right && f.transmittance == o.transmittance)
            {
                f.from = o.from;
                continue;
            }
            let (l, r) = (&self.sides[o.left as usize], &self.sides[o.right as usize]);
            let to = to.min(l.high.y).min(r.high.y);
            let at = |s: &Side, y: f64| dvec2(s.x_at(y), y);
            // Rounding may put the ends of two sides that meet on each other's other side.
            let right = |y: f64| dvec2(r.x_at(y).max(l.x_at(y)), y);
            seen.push([at(l, o.from), right(o.from), right(to), at(l, to)].into_iter(), o.transmittance);
        }
        std::mem::swap(&mut self.open, &mut self.found);
    }
}
