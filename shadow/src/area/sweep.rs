//! The part of a convex polygon where the winding number of other edges is 0, as trapezoids: a sweep along y (J. L. Bentley and T. A. Ottmann,
//! "Algorithms for reporting and counting geometric intersections", 1979).
//!
//! 1. Edges are clipped to the polygon's bounding rectangle. What lies to its right does not matter; what lies to its left counts by the
//!    winding number that it leaves on the rectangle's left side, as vertical edges there.
//! 2. At the heights of vertices, edges end and begin. There all edges are sorted by their places anew, and winding numbers are counted from left to right:
//!    no error of rounding lasts.
//! 3. Between these heights neighbours change places where they cross, one pair after the other. Only the gap between them has a new winding number.
//! 4. A gap between the same two edges is one trapezoid.

use super::light::SeenLight;
use super::sheets::{Kind, Sheets};
use glam::{DVec2, dvec2};
use std::cmp::Ordering;

/// A visible part is no wider than this share of the polygon where sides that coincide are rounded.
const NARROW: f64 = 1e-15;

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

/// A side that passes through the current height, and the gap between it and the next one on its right.
#[derive(Clone, Copy, Debug)]
struct Active {
    side: u32,
    /// Where it was at the last height of vertices.
    x: f64,
    /// Winding numbers in the gap: of the polygon, and of what hides it.
    light: i32,
    hidden: i32,
    /// The share of light that passes there; 0 outside of the polygon.
    passed: f64,
    /// The height from which on the gap has been between these sides and let this share pass.
    from: f64,
    /// The height at which the two sides cross; infinite if they do not.
    crossing: f64,
    /// Another side has come to be on its left or right at the current height.
    is_new: bool,
}

impl Active {
    fn new(side: u32, at: DVec2) -> Self {
        let (x, from) = (at.x, at.y);
        Self { side, x, light: 0, hidden: 0, passed: 0.0, from, crossing: f64::INFINITY, is_new: true }
    }
}

/// The sweep and its memory.
#[derive(Debug, Default)]
pub(crate) struct Sweep {
    low: DVec2,
    high: DVec2,
    /// What is not wider is rounding.
    narrow: f64,
    sides: Vec<Side>,
    /// Steps of the winding numbers along the left side: kind, height, and what is added from there on.
    steps: Vec<(Kind, f64, i32)>,
    /// The sides by their upper ends.
    ends: Vec<u32>,
    /// For each translucent kind, the winding number at hand.
    layers: Vec<i32>,
    /// From left to right.
    active: Vec<Active>,
}

impl Sweep {
    /// Begins with a convex polygon in positive order.
    pub(crate) fn start(&mut self, polygon: &[DVec2]) {
        self.sides.clear();
        self.steps.clear();
        (self.low, self.high) = pointillist_dice::convex::bounds(polygon);
        self.narrow = NARROW * (self.high.x - self.low.x);
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

    /// How many edges of what hides or dims the polygon lie over its bounding rectangle.
    pub(crate) fn outline_count(&self) -> usize {
        self.sides.iter().filter(|s| s.what != Border::Light).count()
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
        self.ends.clear();
        self.ends.extend(0..self.sides.len() as u32);
        let Self { sides, ends, .. } = &mut *self;
        let end = |side: u32| sides[side as usize].high.y;
        ends.sort_unstable_by(|&a, &b| end(a).total_cmp(&end(b)).then(a.cmp(&b)));
        self.active.clear();
        let (mut ended, mut begun) = (0, 0);
        while ended < self.sides.len() {
            let first_end = self.sides[self.ends[ended] as usize].high.y;
            let y = self.sides.get(begun).map_or(first_end, |side| side.low.y.min(first_end));
            self.cross_up_to(y, sheets, seen);
            let ends = self.ends[ended..].iter().take_while(|&&e| self.sides[e as usize].high.y <= y).count();
            self.end_and_sort(y, ends > 0, seen);
            ended += ends;
            while self.sides.get(begun).is_some_and(|side| side.low.y <= y) {
                self.begin(begun as u32, seen);
                begun += 1;
            }
            self.count(y, sheets, seen);
        }
    }

    /// Step 2: takes away what ends at a height, and sorts the others by their places just above it.
    fn end_and_sort(&mut self, y: f64, some_end: bool, seen: &mut SeenLight) {
        if some_end {
            let ends = |a: &Active| self.sides[a.side as usize].high.y <= y;
            for i in 1..self.active.len() {
                if ends(&self.active[i - 1]) || ends(&self.active[i]) {
                    close((&self.sides, self.narrow), &mut self.active, i - 1, y, seen);
                }
            }
            self.active.retain(|a| !ends(a));
        }
        for i in 0..self.active.len() {
            let side = self.active[i].side;
            let x = self.sides[side as usize].x_at(y);
            self.active[i].x = x;
            let mut place = i;
            while place > 0 && self.is_before(side, x, &self.active[place - 1]) {
                self.swap(place - 1, y, seen);
                place -= 1;
            }
        }
    }

    /// Whether a side that is at `x` belongs to the left of an active one just above the height at hand.
    fn is_before(&self, side: u32, x: f64, other: &Active) -> bool {
        if x != other.x {
            return x < other.x;
        }
        let [a, b] = [side, other.side].map(|s| &self.sides[s as usize]);
        a.slope < b.slope || (a.slope == b.slope && a.compare(b).is_lt())
    }

    /// Puts a side that begins among the others.
    fn begin(&mut self, side: u32, seen: &mut SeenLight) {
        let at = self.sides[side as usize].low;
        let place = self.active.partition_point(|a| !self.is_before(side, at.x, a));
        if place > 0 {
            close((&self.sides, self.narrow), &mut self.active, place - 1, at.y, seen);
        }
        self.active.insert(place, Active::new(side, at));
    }

    /// Two neighbours, the left one by its place, change theirs. The winding number between them is to be counted.
    fn swap(&mut self, left: usize, y: f64, seen: &mut SeenLight) {
        for gap in left.saturating_sub(1)..=left + 1 {
            close((&self.sides, self.narrow), &mut self.active, gap, y, seen);
        }
        let [(a, xa), (b, xb)] = [left, left + 1].map(|i| (self.active[i].side, self.active[i].x));
        (self.active[left].side, self.active[left].x) = (b, xb);
        (self.active[left + 1].side, self.active[left + 1].x) = (a, xa);
    }

    /// Counts all winding numbers, from left to right.
    fn count(&mut self, y: f64, sheets: &Sheets, seen: &mut SeenLight) {
        self.layers.clear();
        self.layers.resize(sheets.kinds().len(), 0);
        let (mut light, mut hidden) = (0, 0);
        for i in 0..self.active.len() {
            let side = &self.sides[self.active[i].side as usize];
            (light, hidden) = counted(side, sheets, (light, hidden), &mut self.layers);
            let passed = if light != 0 && hidden == 0 { sheets.passed(&self.layers) } else { 0.0 };
            if passed != self.active[i].passed {
                close((&self.sides, self.narrow), &mut self.active, i, y, seen);
                self.active[i].passed = passed;
            }
            (self.active[i].light, self.active[i].hidden) = (light, hidden);
            if self.active[i].is_new {
                self.active[i].is_new = false;
                self.active[i].crossing = self.crossing(i, y);
            }
        }
    }

    /// Step 3: neighbours that cross below a height change places.
    fn cross_up_to(&mut self, to: f64, sheets: &Sheets, seen: &mut SeenLight) {
        loop {
            let lowest = |least: (f64, usize), (i, a): (usize, &Active)| {
                if a.crossing < least.0 { (a.crossing, i) } else { least }
            };
            let (y, left) = self.active.iter().enumerate().fold((to, usize::MAX), lowest);
            if left == usize::MAX {
                return;
            }
            self.swap(left, y, seen);
            self.count_between(left, sheets);
            for gap in left.saturating_sub(1)..=left + 1 {
                self.active[gap].is_new = false;
                self.active[gap].crossing = self.crossing(gap, y);
            }
        }
    }

    /// Counts the winding numbers in one gap, those on its left being known.
    fn count_between(&mut self, gap: usize, sheets: &Sheets) {
        let Self { sides, layers, active, .. } = self;
        layers.clear();
        layers.resize(sheets.kinds().len(), 0);
        if !layers.is_empty() {
            for a in &active[..gap] {
                counted(&sides[a.side as usize], sheets, (0, 0), layers);
            }
        }
        let before = gap.checked_sub(1).map_or((0, 0), |i| (active[i].light, active[i].hidden));
        let (light, hidden) = counted(&sides[active[gap].side as usize], sheets, before, layers);
        let passed = if light != 0 && hidden == 0 { sheets.passed(layers) } else { 0.0 };
        active[gap] = Active { light, hidden, passed, ..active[gap] };
    }

    /// The height from `y` on at which the sides of a gap cross.
    fn crossing(&self, gap: usize, y: f64) -> f64 {
        let Some(next) = self.active.get(gap + 1) else { return f64::INFINITY };
        let [left, right] = [self.active[gap].side, next.side].map(|s| &self.sides[s as usize]);
        let closing = left.slope - right.slope;
        if closing <= 0.0 || left.high == right.high {
            return f64::INFINITY;
        }
        let at = y + ((right.x_at(y) - left.x_at(y)) / closing).max(0.0);
        if at < left.high.y.min(right.high.y) { at } else { f64::INFINITY }
    }
}

/// The winding numbers of the polygon and of what hides it on the right of a side, by those on its left; those of what dims it are in `layers`.
fn counted(side: &Side, sheets: &Sheets, (light, hidden): (i32, i32), layers: &mut [i32]) -> (i32, i32) {
    match side.what {
        Border::Light => (light + side.winding, hidden),
        Border::Sheet(0) => (light, hidden + side.winding),
        Border::Sheet(kind) => {
            if let Ok(place) = sheets.kinds().binary_search(&kind) {
                layers[place] += side.winding;
            }
            (light, hidden)
        }
    }
}

/// Ends the trapezoid of a gap at height `to`: above, it is another one.
fn close((sides, narrow): (&[Side], f64), active: &mut [Active], gap: usize, to: f64, seen: &mut SeenLight) {
    let Some(&Active { side, passed, from, .. }) = active.get(gap) else { return };
    if passed > 0.0
        && from < to
        && let Some(next) = active.get(gap + 1)
    {
        let (l, r) = (&sides[side as usize], &sides[next.side as usize]);
        let to = to.min(l.high.y).min(r.high.y);
        let at = |s: &Side, y: f64| dvec2(s.x_at(y), y);
        // Rounding may put the ends of two sides that meet on each other's other side.
        let right = |y: f64| dvec2(r.x_at(y).max(l.x_at(y)), y);
        let ring = [at(l, from), right(from), right(to), at(l, to)];
        if (ring[1].x - ring[0].x).max(ring[2].x - ring[3].x) > narrow {
            seen.push(ring.into_iter(), passed);
        }
    }
    active[gap].from = to;
    active[gap].is_new = true;
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use pointillist_dice::convex;

    /// Numbers in 0..1, by a linear congruence.
    pub(crate) struct Numbers(pub(crate) u64);

    impl Numbers {
        pub(crate) fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// Where a line of this height is inside a convex ring; from the largest to the smallest number if nowhere.
    fn row(ring: &[DVec2], y: f64) -> (f64, f64) {
        let mut inside = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, &a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            if (a.y < y) != (b.y < y) {
                let x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
                inside = (inside.0.min(x), inside.1.max(x));
            }
        }
        inside
    }

    /// The length of a line of this height that is inside `polygon` and outside of all of `hiding`.
    fn visible_length(polygon: &[DVec2], hiding: &[Vec<DVec2>], y: f64) -> f64 {
        let (mut x, end) = row(polygon, y);
        let mut hidden: Vec<_> = hiding.iter().map(|ring| row(ring, y)).filter(|r| r.0 < r.1).collect();
        hidden.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut sum = 0.0;
        for (from, to) in hidden {
            sum += (from.min(end) - x).max(0.0);
            x = x.max(to);
        }
        sum + (end - x).max(0.0)
    }

    fn swept(polygon: &[DVec2], hiding: &[Vec<DVec2>]) -> SeenLight {
        let (mut sweep, mut seen) = (Sweep::default(), SeenLight::default());
        sweep.start(polygon);
        for ring in hiding {
            for (i, &a) in ring.iter().enumerate() {
                sweep.add(a, ring[(i + 1) % ring.len()], -1, 0);
            }
        }
        sweep.finish(polygon, &Sheets::default(), &mut seen);
        seen
    }

    /// Compares rows of what is visible. `snap` rounds coordinates: edges and corners then often coincide.
    fn rows_are_right(seed: u64, count: usize, snap: impl Fn(f64) -> f64) {
        let mut numbers = Numbers(seed);
        let mut corner = |size: f64, at: DVec2| {
            at + dvec2(snap((numbers.next() - 0.5) * size), snap((numbers.next() - 0.5) * size))
        };
        let polygon = [dvec2(-1.0, -0.5), dvec2(0.5, -1.0), dvec2(1.0, 0.75), dvec2(-0.75, 1.0)];
        let mut hiding = vec![];
        while hiding.len() < count {
            let middle = corner(2.5, DVec2::ZERO);
            let mut ring = [(); 3].map(|()| corner(if hiding.len() % 7 == 0 { 2.0 } else { 0.4 }, middle));
            if convex::area(&ring) < 0.0 {
                ring.reverse();
            }
            if convex::area(&ring) > 0.0 {
                hiding.push(ring.to_vec());
            }
        }
        let seen = swept(&polygon, &hiding);
        for _ in 0..64 {
            // Not at the height of a corner.
            let y = 1.9 * (numbers.next() - 0.5) + 1e-9;
            let parts = seen.plane_parts().map(|(part, _)| row(part, y));
            let length: f64 = parts.filter(|r| r.0 < r.1).map(|r| r.1 - r.0).sum();
            let expected = visible_length(&polygon, &hiding, y);
            assert!((length - expected).abs() < 1e-9, "seed {seed}, y = {y}: {length}, not {expected}");
        }
    }

    #[test]
    fn rows_of_what_is_visible_are_those_between_the_triangles() {
        for seed in 0..200 {
            rows_are_right(seed, 1 + seed as usize % 60, |v| v);
        }
    }

    #[test]
    fn edges_and_corners_may_coincide() {
        for seed in 0..200 {
            rows_are_right(seed, 1 + seed as usize % 60, |v| (v * 8.0).round() / 8.0);
            // Level edges that rounding makes a little steep.
            rows_are_right(seed, 1 + seed as usize % 60, |v| {
                ((v * 8.0).round() / 8.0) * (1.0 + 1e-15 * (v * 999.0).sin())
            });
        }
    }

    #[test]
    fn what_nothing_hides_stays_whole() {
        let polygon = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(0.0, 1.0)];
        let right_of_it = [dvec2(2.0, 0.0), dvec2(3.0, 0.0), dvec2(3.0, 1.0)].to_vec();
        let seen = swept(&polygon, &[right_of_it]);
        assert_eq!(seen.plane_parts().map(|(part, _)| part.to_vec()).collect::<Vec<_>>(), [polygon.to_vec()]);
    }
}
