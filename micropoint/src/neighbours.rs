//! Which parts of a cell may overlap, found without comparing each with each.
//!
//! 1. The axis: parts are projected on the direction across which their edges run, so that long thin parts (stripes, wires, a mesh
//!    seen at a grazing angle) have short intervals. It is the minor axis of the tensor Σ e eᵀ over all edges e.
//! 2. The tree: the intervals, sorted by their lower ends, form an implicit balanced binary tree; each node knows the highest upper end
//!    below it.
//! 3. The query: subtrees that end before the interval or begin after it are left out. It takes O(log n + k) for k parts found.

use glam::DVec2;

/// With fewer parts, comparing each with each is faster.
pub(crate) const WORTH_IT: usize = 32;

/// Intervals are this much longer than computed, in cells: more than projections are rounded by.
const SLACK: f64 = 1e-12;

/// Memory of the tree, reused from cell to cell.
#[derive(Debug, Default)]
pub(crate) struct Neighbours {
    /// By rank: the part's interval.
    intervals: Vec<[f64; 2]>,
    /// Ranks by lower end.
    sorted: Vec<u32>,
    /// The highest upper end in the subtree whose root is at this place of `sorted`.
    reach: Vec<f64>,
    found: Vec<u32>,
}

impl Neighbours {
    /// Takes the outlines of parts; a part's rank is its place among them.
    pub(crate) fn build<'a>(&mut self, outlines: impl Iterator<Item = &'a [DVec2]> + Clone) {
        let axis = axis_across(outlines.clone());
        self.intervals.clear();
        self.intervals.extend(outlines.map(|outline| interval(outline, axis)));
        let intervals = &self.intervals;
        self.sorted.clear();
        self.sorted.extend(0..intervals.len() as u32);
        let low = |i: u32| intervals[i as usize][0];
        self.sorted.sort_unstable_by(|&a, &b| low(a).total_cmp(&low(b)).then(a.cmp(&b)));
        self.reach.clear();
        self.reach.resize(self.sorted.len(), f64::NEG_INFINITY);
        self.raise(0, self.sorted.len());
    }

    /// Sets the reach of a subtree, and returns that of its root.
    fn raise(&mut self, from: usize, to: usize) -> f64 {
        if from == to {
            return f64::NEG_INFINITY;
        }
        let root = from.midpoint(to);
        let below = self.raise(from, root).max(self.raise(root + 1, to));
        self.reach[root] = below.max(self.intervals[self.sorted[root] as usize][1]);
        self.reach[root]
    }

    /// The ranks of all parts that may overlap a part, itself among them, rising.
    pub(crate) fn of(&mut self, rank: usize) -> &[u32] {
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        self.collect(0, self.sorted.len(), self.intervals[rank], &mut found);
        found.sort_unstable();
        self.found = found;
        &self.found
    }

    fn collect(&self, from: usize, to: usize, [low, high]: [f64; 2], found: &mut Vec<u32>) {
        if from == to {
            return;
        }
        let root = from.midpoint(to);
        if self.reach[root] < low {
            return;
        }
        self.collect(from, root, [low, high], found);
        let rank = self.sorted[root];
        let [start, end] = self.intervals[rank as usize];
        if start > high {
            return;
        }
        if end >= low {
            found.push(rank);
        }
        self.collect(root + 1, to, [low, high], found);
    }
}

fn interval(outline: &[DVec2], axis: DVec2) -> [f64; 2] {
    let places = outline.iter().map(|v| v.dot(axis));
    let [low, high] =
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], t| [low.min(t), high.max(t)]);
    [low - SLACK, high + SLACK]
}

/// The unit vector along which the edges of all outlines together are shortest.
fn axis_across<'a>(outlines: impl Iterator<Item = &'a [DVec2]>) -> DVec2 {
    // Of the tensor [[a + c, s], [s, a − c]] only the angle of (c, s) matters: twice that of the major axis.
    let (mut c, mut s) = (0.0, 0.0);
    for outline in outlines {
        let mut before = outline[outline.len() - 1];
        for &v in outline {
            let e = v - before;
            c += e.x * e.x - e.y * e.y;
            s += 2.0 * e.x * e.y;
            before = v;
        }
    }
    DVec2::from_angle(0.5 * s.atan2(c)).perp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    fn stripe(i: u32, count: u32, slope: f64) -> Vec<DVec2> {
        let at = |i: u32| f64::from(i) / f64::from(count);
        vec![
            dvec2(0.0, at(i)),
            dvec2(1.0, at(i) + slope),
            dvec2(1.0, at(i + 1) + slope),
            dvec2(0.0, at(i + 1)),
        ]
    }

    fn of_each(outlines: &[Vec<DVec2>]) -> Vec<Vec<u32>> {
        let mut neighbours = Neighbours::default();
        neighbours.build(outlines.iter().map(Vec::as_slice));
        (0..outlines.len()).map(|i| neighbours.of(i).to_vec()).collect()
    }

    #[test]
    fn stripes_meet_only_their_neighbours_at_any_slope() {
        for slope in [0.0, 0.3, -1.0, 7.0] {
            let stripes: Vec<_> = (0..100).map(|i| stripe(i * 37 % 100, 100, slope)).collect();
            for (i, found) in of_each(&stripes).iter().enumerate() {
                assert!(found.contains(&(i as u32)));
                assert!(found.len() <= 3, "slope {slope}: {found:?}");
            }
        }
    }

    #[test]
    fn no_overlap_is_missed() {
        // Triangles of all sizes, by a linear congruence.
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let outlines: Vec<Vec<DVec2>> = (0..200)
            .map(|_| {
                let (at, size) = (dvec2(next(), next()), next().powi(3));
                let [a, b, c] = [(); 3].map(|()| at + dvec2(next() - 0.5, next() - 0.5) * size);
                if (b - a).perp_dot(c - a) > 0.0 { vec![a, b, c] } else { vec![a, c, b] }
            })
            .collect();
        let found = of_each(&outlines);
        for (i, a) in outlines.iter().enumerate() {
            for (j, b) in outlines.iter().enumerate() {
                let box_of = |o: &[DVec2]| {
                    let fold = |f: fn(DVec2, DVec2) -> DVec2| o.iter().copied().reduce(f).expect("corners");
                    (fold(DVec2::min), fold(DVec2::max))
                };
                let ((al, ah), (bl, bh)) = (box_of(a), box_of(b));
                let apart = !(al.cmplt(bh).all() && bl.cmplt(ah).all())
                    || pointillist_dice::convex::are_disjoint(a, b);
                assert!(apart || found[i].contains(&(j as u32)), "{i} and {j}");
            }
        }
        let pairs: usize = found.iter().map(Vec::len).sum();
        assert!(pairs < 200 * 100, "{pairs}");
    }
}
