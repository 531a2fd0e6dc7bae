//! Which parts of a cell may overlap, found without comparing each with each.
//!
//! 1. The pencil: parts are projected along lines that run as their edges do, so that long thin parts (stripes, wires, a mesh seen at a
//!    grazing angle) have short intervals. In a picture, parallel lines converge: the lines of the pencil meet in a point, too.
//! 2. The intervals are sorted by their lower ends. Where only a few pairs of them overlap, as those of parts side by side, the parts of each
//!    pair are compared, once, and only pairs that overlap are kept.
//! 3. Else a part is only compared with what may hide it. Intervals that begin within its own follow it; those that reach into it from before
//!    are found by a tree of highest upper ends (P. Fenwick, "A new data structure for cumulative frequency tables", 1994). A query takes
//!    O(log n) for each part found, and as much again.

use glam::DVec2;

/// With fewer parts, comparing each with each is faster.
pub(crate) const WORTH_IT: usize = 32;

/// Parts are long and thin if on average they fill less than this of a square as long as they are.
pub(crate) const THINNEST: f64 = 1.0 / 32.0;

/// Whether parts, by their areas and lengths, are long and thin. Side by side, such parts touch the same squares of any grid, however short they are:
/// stripes that cut off a corner of a cell.
pub(crate) fn are_thin(parts: impl Iterator<Item = (f64, f64)>) -> bool {
    let (area, squares) = parts.fold((0.0, 0.0), |(a, s), (area, length)| (a + area, s + length * length));
    area < THINNEST * squares
}

/// Intervals are this much longer than computed, in cells: more than projections are rounded by.
const SLACK: f64 = 1e-12;

/// As many outlines, evenly chosen, decide how the pencil runs.
const FITTED: usize = 64;

/// Up to so many pairs for each part are compared at once.
const PAIRS_PER_PART: usize = 4;

/// Memory of the pairs and of the tree, reused from cell to cell.
#[derive(Debug, Default)]
pub(crate) struct Neighbours {
    /// By lower end.
    intervals: Vec<Interval>,
    /// By rank: where its interval is.
    place: Vec<u32>,
    /// Of n intervals from the first on: the highest upper end of the last of them, as many as the lowest set bit of n says.
    highest: Vec<f64>,
    /// Each pair of ranks that overlap, both ways, rising, if all pairs were compared.
    pairs: Vec<(u32, u32)>,
    are_compared: bool,
    found: Vec<u32>,
}

/// What a part covers of the pencil.
#[derive(Clone, Copy, Debug)]
struct Interval {
    low: f64,
    high: f64,
    rank: u32,
}

impl Neighbours {
    /// Takes the outlines of parts; a part's rank is its place among them. `overlap` tells of two ranks whether their parts overlap.
    pub(crate) fn build<'a>(
        &mut self,
        outlines: impl ExactSizeIterator<Item = &'a [DVec2]> + Clone,
        overlap: impl Fn(u32, u32) -> bool,
    ) {
        self.project(outlines);
        self.are_compared = self.compare(overlap);
        if !self.are_compared {
            self.build_tree();
        }
    }

    /// How many of some parts, from the first on, are disjoint, by their outlines and by `overlap`, as for [`Neighbours::build`]. `None` where too many
    /// lie side by side to tell.
    pub(crate) fn disjoint<'a>(
        &mut self,
        outlines: impl ExactSizeIterator<Item = &'a [DVec2]> + Clone,
        overlap: impl Fn(u32, u32) -> bool,
    ) -> Option<usize> {
        let count = outlines.len();
        self.project(outlines);
        self.compare(overlap)
            .then(|| self.pairs.iter().map(|&(a, b)| a.max(b) as usize).fold(count, usize::min))
    }

    /// The interval of each part, sorted.
    fn project<'a>(&mut self, outlines: impl ExactSizeIterator<Item = &'a [DVec2]> + Clone) {
        let step = outlines.len().div_ceil(FITTED).max(1);
        let pencil = Pencil::along(outlines.clone().step_by(step));
        self.intervals.clear();
        self.intervals.extend((0..).zip(outlines).map(|(rank, outline)| pencil.interval(outline, rank)));
        self.intervals.sort_unstable_by(|a, b| a.low.total_cmp(&b.low).then(a.rank.cmp(&b.rank)));
    }

    /// Compares all pairs whose intervals overlap. Gives up, and returns `false`, where those are many.
    fn compare(&mut self, overlap: impl Fn(u32, u32) -> bool) -> bool {
        let mut left = PAIRS_PER_PART * self.intervals.len();
        self.pairs.clear();
        for (i, a) in self.intervals.iter().enumerate() {
            for b in self.intervals[i + 1..].iter().take_while(|b| b.low <= a.high) {
                if left == 0 {
                    return false;
                }
                left -= 1;
                if overlap(a.rank, b.rank) {
                    self.pairs.extend([(a.rank, b.rank), (b.rank, a.rank)]);
                }
            }
        }
        self.pairs.sort_unstable();
        true
    }

    fn build_tree(&mut self) {
        self.place.clear();
        self.place.resize(self.intervals.len(), 0);
        self.highest.clear();
        self.highest.extend(self.intervals.iter().map(|interval| interval.high));
        for (i, interval) in self.intervals.iter().enumerate() {
            self.place[interval.rank as usize] = i as u32;
            let count = i + 1;
            let above = count + (count & count.wrapping_neg());
            let own = self.highest[i];
            if let Some(whole) = self.highest.get_mut(above - 1) {
                *whole = whole.max(own);
            }
        }
    }

    /// Of the ranks that `counts` holds of, those of all parts that overlap a part, rising. `overlaps` tells whether one of them does.
    pub(crate) fn of(
        &mut self,
        rank: usize,
        counts: impl Fn(usize) -> bool,
        overlaps: impl Fn(&u32) -> bool,
    ) -> &[u32] {
        self.found.clear();
        if self.are_compared {
            let first = self.pairs.partition_point(|pair| (pair.0 as usize) < rank);
            let own = self.pairs[first..].iter().take_while(|pair| pair.0 as usize == rank);
            self.found.extend(own.map(|pair| pair.1).filter(|&other| counts(other as usize)));
            return &self.found;
        }
        let counts = |&other: &u32| counts(other as usize) && overlaps(&other);
        let place = self.place[rank] as usize;
        let Interval { low, high, .. } = self.intervals[place];
        let within = self.intervals[place..].iter().take_while(|other| other.low <= high);
        self.found.extend(within.map(|other| other.rank).filter(counts));
        let mut count = place;
        while count > 0 {
            if self.highest[count - 1] < low {
                count &= count - 1;
                continue;
            }
            count -= 1;
            let other = self.intervals[count];
            if other.high >= low && counts(&other.rank) {
                self.found.push(other.rank);
            }
        }
        self.found.sort_unstable();
        &self.found
    }
}

/// Lines that meet in a point, or are parallel, in a cell and around it. With x along them and y across, from the middle of the cell, they are
/// y = t + (slope + turn · t) · x, one for each t.
#[derive(Clone, Copy, Debug)]
struct Pencil {
    along: DVec2,
    slope: f64,
    turn: f64,
}

impl Pencil {
    /// Lines that run as most edges do. Any pencil finds all overlaps; this one finds little else.
    fn along<'a>(outlines: impl Iterator<Item = &'a [DVec2]> + Clone) -> Self {
        let along = main_direction(outlines.clone());
        // A line of slope s through (0, t), least squares for s = slope + turn · t. Edges count by the square of their length along.
        let (mut w, mut wt, mut wtt, mut ws, mut wst) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for_edges(outlines, |from, to| {
            let e = along_and_across(along, to - from);
            let t = along_and_across(along, 0.5 * (from + to) - MIDDLE).y;
            let (weight, rise) = (e.x * e.x, e.x * e.y);
            w += weight;
            wt += weight * t;
            wtt += weight * t * t;
            ws += rise;
            wst += rise * t;
        });
        let spread = w * wtt - wt * wt;
        let turn = if spread > 1e-9 * w * w { (w * wst - wt * ws) / spread } else { 0.0 };
        // The lines must not meet in the cell; its corners are 0.71 from its middle.
        let turn = turn.clamp(-1.0, 1.0);
        let slope = if w > 0.0 { (ws - turn * wt) / w } else { 0.0 };
        Self { along, slope, turn }
    }

    fn interval(&self, outline: &[DVec2], rank: u32) -> Interval {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for &v in outline {
            let p = along_and_across(self.along, v - MIDDLE);
            // A projective map takes convex outlines to convex ones: the corners decide.
            let t = (p.y - self.slope * p.x) / (1.0 + self.turn * p.x);
            low = if t < low { t } else { low };
            high = if t > high { t } else { high };
        }
        Interval { low: low - SLACK, high: high + SLACK, rank }
    }
}

/// The middle of a cell.
const MIDDLE: DVec2 = DVec2::splat(0.5);

fn along_and_across(along: DVec2, v: DVec2) -> DVec2 {
    DVec2::new(along.dot(v), along.perp_dot(v))
}

fn for_edges<'a>(outlines: impl Iterator<Item = &'a [DVec2]>, mut edge: impl FnMut(DVec2, DVec2)) {
    for outline in outlines {
        let Some(&(mut before)) = outline.last() else { continue };
        for &v in outline {
            edge(before, v);
            before = v;
        }
    }
}

/// The unit vector along which the edges of all outlines together are longest: the major axis of the tensor Σ e eᵀ over all edges e.
fn main_direction<'a>(outlines: impl Iterator<Item = &'a [DVec2]>) -> DVec2 {
    // Of the tensor [[a + c, s], [s, a − c]] only the angle of (c, s) matters: twice that of the axis.
    let (mut c, mut s) = (0.0, 0.0);
    for_edges(outlines, |from, to| {
        let e = to - from;
        c += e.x * e.x - e.y * e.y;
        s += 2.0 * e.x * e.y;
    });
    DVec2::from_angle(0.5 * f64::atan2(s, c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;
    use pointillist_dice::convex;

    fn stripe(i: u32, count: u32, slope: f64) -> Vec<DVec2> {
        let at = |i: u32| f64::from(i) / f64::from(count);
        vec![
            dvec2(0.0, at(i)),
            dvec2(1.0, at(i) + slope),
            dvec2(1.0, at(i + 1) + slope),
            dvec2(0.0, at(i + 1)),
        ]
    }

    #[test]
    fn disjoint_parts_are_counted_up_to_the_first_overlap() {
        let overlap_of = |outlines: &[Vec<DVec2>]| {
            let overlap =
                |a: u32, b: u32| !convex::are_disjoint(&outlines[a as usize], &outlines[b as usize]);
            Neighbours::default().disjoint(outlines.iter().map(Vec::as_slice), overlap)
        };
        let mut stripes: Vec<_> = (0..100).map(|i| stripe(i * 37 % 100, 100, 0.3)).collect();
        assert_eq!(overlap_of(&stripes), Some(100));
        stripes[60] = stripe(77, 90, 0.3);
        let meets = |a: usize, b: usize| !convex::are_disjoint(&stripes[a], &stripes[b]);
        let first = (0..100).find(|&b| (0..b).any(|a| meets(a, b)));
        assert!(first >= Some(60));
        assert_eq!(overlap_of(&stripes), first);
        // Layers of copies.
        stripes.iter_mut().for_each(|s| *s = stripe(0, 2, 0.0));
        assert_eq!(overlap_of(&stripes), None);
    }

    #[test]
    fn stripes_are_thin_wherever_they_cross_a_cell_and_meshes_are_not() {
        let of = |outline: &[DVec2]| {
            let (low, high) = convex::bounds(outline);
            (convex::area(outline), (high - low).max_element())
        };
        // Across the cell, and along a line that cuts off its corner.
        assert!(are_thin((0..100).map(|i| of(&stripe(i, 100, 0.3)))));
        let corner = |i: u32| [0.1, 0.2].map(|x| dvec2(x, 0.3 - x + 1e-4 * f64::from(i)));
        assert!(are_thin((0..100).map(|i| {
            let ([a, b], [d, c]) = (corner(i), corner(i + 1));
            of(&[a, b, c, d])
        })));
        // Triangles, each ten times as long as wide.
        assert!(!are_thin((0..100).map(|i| of(&[
            dvec2(0.0, 0.0),
            dvec2(0.1, 0.01 * f64::from(i % 9)),
            dvec2(0.1, 0.01 * f64::from(i % 9 + 1))
        ]))));
    }

    /// The neighbours of each, and whether all pairs were compared.
    fn of_each(outlines: &[Vec<DVec2>]) -> (Vec<Vec<u32>>, bool) {
        let mut neighbours = Neighbours::default();
        let overlap = |a: u32, b: u32| !convex::are_disjoint(&outlines[a as usize], &outlines[b as usize]);
        neighbours.build(outlines.iter().map(Vec::as_slice), overlap);
        (
            (0..outlines.len()).map(|i| neighbours.of(i, |other| other != i, |_| true).to_vec()).collect(),
            neighbours.are_compared,
        )
    }

    /// The same without comparing.
    fn neighbours_by_tree(outlines: &[Vec<DVec2>]) -> Vec<Vec<u32>> {
        let mut neighbours = Neighbours::default();
        neighbours.build(outlines.iter().map(Vec::as_slice), |_, _| true);
        neighbours.build_tree();
        neighbours.are_compared = false;
        (0..outlines.len()).map(|i| neighbours.of(i, |other| other != i, |_| true).to_vec()).collect()
    }

    #[test]
    fn stripes_meet_only_their_neighbours_at_any_slope() {
        for slope in [0.0, 0.3, -1.0, 7.0] {
            let stripes: Vec<_> = (0..100).map(|i| stripe(i * 37 % 100, 100, slope)).collect();
            assert!(of_each(&stripes).0.iter().all(Vec::is_empty), "slope {slope}");
            // Few pairs were compared to find that.
            assert!(neighbours_by_tree(&stripes).iter().all(|found| found.len() <= 2), "slope {slope}");
        }
    }

    #[test]
    fn converging_stripes_meet_only_their_neighbours() {
        for (meet, count) in [(-3.0, 1000), (1.6, 300), (1e6, 1000)] {
            // From x = 0 to x = 1, to a point at x = `meet`.
            let at = |i: u32, x: f64| {
                dvec2(x, 0.5 + (f64::from(i) / f64::from(count) - 0.5) * (x - meet) / (1.0 - meet))
            };
            let stripes: Vec<_> =
                (0..count).map(|i| vec![at(i, 0.0), at(i, 1.0), at(i + 1, 1.0), at(i + 1, 0.0)]).collect();
            assert!(of_each(&stripes).0.iter().all(Vec::is_empty), "{meet}");
            assert!(neighbours_by_tree(&stripes).iter().all(|found| found.len() <= 2), "{meet}");
        }
    }

    #[test]
    fn no_overlap_is_missed() {
        no_overlap_is_missed_of(1.0, 100 * 200, false);
        no_overlap_is_missed_of(0.05, 200, true);
    }

    /// Triangles of all sizes up to `largest`, by a linear congruence.
    fn no_overlap_is_missed_of(largest: f64, most_pairs: usize, are_compared: bool) {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let outlines: Vec<Vec<DVec2>> = (0..200)
            .map(|_| {
                let (at, size) = (dvec2(next(), next()), largest * next().powi(3));
                let [a, b, c] = [(); 3].map(|()| at + dvec2(next() - 0.5, next() - 0.5) * size);
                if (b - a).perp_dot(c - a) > 0.0 { vec![a, b, c] } else { vec![a, c, b] }
            })
            .collect();
        let (found, compared) = of_each(&outlines);
        assert_eq!(compared, are_compared);
        for (i, a) in outlines.iter().enumerate() {
            for (j, b) in outlines.iter().enumerate() {
                let box_of = |o: &[DVec2]| {
                    let fold = |f: fn(DVec2, DVec2) -> DVec2| o.iter().copied().reduce(f).expect("corners");
                    (fold(DVec2::min), fold(DVec2::max))
                };
                let ((al, ah), (bl, bh)) = (box_of(a), box_of(b));
                let apart = !(al.cmplt(bh).all() && bl.cmplt(ah).all()) || convex::are_disjoint(a, b);
                assert!(i == j || apart || found[i].contains(&(j as u32)), "{i} and {j}");
            }
        }
        let pairs: usize = found.iter().map(Vec::len).sum();
        assert!(pairs < most_pairs, "{pairs}");
    }
}
