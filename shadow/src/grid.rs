//! The local light grid: the targets of one screen, sorted into cells.

use crate::options::Resolution;
use crate::target::Target;
use glam::DVec2;
use pointillist_micropoint::{Bounds, Interval, Lens, ProjectedVertex};

/// Most cells on a side of the local grid; a batch is a tile's receivers, so more would stay empty.
const MOST_CELLS: f64 = 64.0;

/// A cell of the local light grid: targets that lie close together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group {
    pub(crate) first_target: u32,
    pub(crate) end_target: u32,
    pub(crate) low: DVec2,
    pub(crate) high: DVec2,
    /// Least and largest nearness of its targets.
    pub(crate) nearness: Interval,
    /// Head of its list of casters, if there is any.
    pub(crate) first_link: Option<u32>,
    /// One opaque caster covers all of it, in front of all of it.
    pub(crate) dark: bool,
}

impl Group {
    const EMPTY: Self = Self {
        first_target: 0,
        end_target: 0,
        low: DVec2::INFINITY,
        high: DVec2::NEG_INFINITY,
        nearness: Interval::EMPTY,
        first_link: None,
        dark: false,
    };

    fn is_empty(&self) -> bool {
        self.first_target == self.end_target
    }

    /// Whether some of its targets may lie in the rectangle, no nearer to the light than `nearness`, and are not known to be dark.
    #[inline]
    pub(crate) fn may_be_darkened(&self, low: DVec2, high: DVec2, nearness: f64) -> bool {
        !self.is_empty()
            && !self.dark
            && self.nearness.least <= nearness
            && self.low.cmple(high).all()
            && self.high.cmpge(low).all()
    }
}

/// Where the cells lie.
#[derive(Debug, Default)]
struct Layout {
    columns: usize,
    rows: usize,
    cells_per_unit: f64,
    low: DVec2,
    high: DVec2,
    /// Half the largest target: how far a target reaches beyond the cell of its centre.
    reach: f64,
    /// Indices of the cells that have targets.
    occupied: Vec<u32>,
}

impl Layout {
    /// Calls `visit` with each cell whose targets may overlap a rectangle, until it returns true.
    ///
    /// Small rectangles look at the cells they touch, large ones at all cells with targets: most
    /// cells of a grid over scattered receivers are empty.
    #[inline]
    fn any_near(&self, low: DVec2, high: DVec2, mut visit: impl FnMut(u32) -> bool) -> bool {
        if !(low.cmple(self.high).all() && high.cmpge(self.low).all()) {
            return false;
        }
        let index = |v: f64, first: f64, count: usize| {
            (((v - first) * self.cells_per_unit).max(0.0) as usize).min(count - 1)
        };
        let (low, high) = (low - self.reach, high + self.reach);
        let (x0, x1) = (index(low.x, self.low.x, self.columns), index(high.x, self.low.x, self.columns));
        let (y0, y1) = (index(low.y, self.low.y, self.rows), index(high.y, self.low.y, self.rows));
        if (x1 - x0 + 1) * (y1 - y0 + 1) > self.occupied.len() {
            return self.occupied.iter().any(|&g| visit(g));
        }
        (y0..=y1).any(|y| (x0..=x1).any(|x| visit((y * self.columns + x) as u32)))
    }
}

/// The targets of one screen, sorted into cells.
#[derive(Debug, Default)]
pub(crate) struct LightGrid {
    pub(crate) groups: Vec<Group>,
    /// Indices of the targets, group by group.
    pub(crate) order: Vec<u32>,
    layout: Layout,
    cell_of: Vec<u32>,
    unsorted: Vec<u32>,
    /// Of all targets.
    pub(crate) least_nearness: f64,
    /// Groups that have targets and are not known to be dark.
    pub(crate) open_groups: usize,
}

impl LightGrid {
    /// Sorts the targets of one screen into cells. Returns false if there are none. `size` is that of the whole screen.
    pub(crate) fn sort(
        &mut self,
        targets: &[Target],
        screen: usize,
        resolution: Resolution,
        size: f64,
    ) -> bool {
        self.unsorted.clear();
        let on_screen = |(i, t): (usize, &Target)| (usize::from(t.screen) == screen).then_some(i as u32);
        self.unsorted.extend(targets.iter().enumerate().filter_map(on_screen));
        if self.unsorted.is_empty() {
            return false;
        }
        self.lay_out(targets, resolution, size);
        self.count_targets(targets);
        self.put_in_order();
        let has_targets = |(i, g): (usize, &Group)| (!g.is_empty()).then_some(i as u32);
        self.layout.occupied.clear();
        self.layout.occupied.extend(self.groups.iter().enumerate().filter_map(has_targets));
        true
    }

    fn lay_out(&mut self, targets: &[Target], resolution: Resolution, size: f64) {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (mut extents, mut reach) = (0.0, 0.0_f64);
        self.least_nearness = f64::INFINITY;
        for &i in &self.unsorted {
            let t = &targets[i as usize];
            low = low.min(t.bounds.0);
            high = high.max(t.bounds.1);
            let extent = (t.bounds.1 - t.bounds.0).max_element();
            extents += extent;
            reach = reach.max(0.5 * extent);
            self.least_nearness = self.least_nearness.min(t.nearness.least);
        }
        let mean = extents / self.unsorted.len() as f64;
        let cell = match resolution {
            Resolution::Auto => 2.0 * mean,
            Resolution::Cells(n) => size / f64::from(n),
        };
        let longest = (high - low).max_element();
        let cells_per_unit = 1.0 / cell.max(longest / MOST_CELLS).max(f64::MIN_POSITIVE);
        let cells = |length: f64| ((length * cells_per_unit).ceil() as usize).clamp(1, MOST_CELLS as usize);
        let occupied = std::mem::take(&mut self.layout.occupied);
        let (columns, rows) = (cells(high.x - low.x), cells(high.y - low.y));
        self.layout = Layout { columns, rows, cells_per_unit, low, high, reach, occupied };
        self.open_groups = 0;
    }

    /// Finds the cell of each target; leaves the number of targets of a group in its `end_target`.
    fn count_targets(&mut self, targets: &[Target]) {
        let layout = &self.layout;
        self.groups.clear();
        self.groups.resize(layout.columns * layout.rows, Group::EMPTY);
        self.cell_of.clear();
        for &i in &self.unsorted {
            let t = &targets[i as usize];
            let centre = (0.5 * (t.bounds.0 + t.bounds.1) - layout.low) * layout.cells_per_unit;
            let column = (centre.x as usize).min(layout.columns - 1);
            let cell = (centre.y as usize).min(layout.rows - 1) * layout.columns + column;
            self.cell_of.push(cell as u32);
            let group = &mut self.groups[cell];
            group.end_target += 1;
            group.low = group.low.min(t.bounds.0);
            group.high = group.high.max(t.bounds.1);
            group.nearness = group.nearness.union(t.nearness);
        }
    }

    /// The second half of a counting sort: the ends of the groups become their starts while targets are put in place.
    fn put_in_order(&mut self) {
        let mut end = 0;
        for group in &mut self.groups {
            self.open_groups += usize::from(group.end_target > 0);
            group.first_target = end;
            end += group.end_target;
            group.end_target = group.first_target;
        }
        self.order.clear();
        self.order.resize(self.unsorted.len(), 0);
        for (&i, &cell) in self.unsorted.iter().zip(&self.cell_of) {
            let group = &mut self.groups[cell as usize];
            self.order[group.end_target as usize] = i;
            group.end_target += 1;
        }
    }

    /// Bounds of all targets.
    pub(crate) fn bounds(&self) -> (DVec2, DVec2) {
        (self.layout.low, self.layout.high)
    }

    /// Whether a triangle that needs no clipping misses all targets.
    #[inline]
    pub(crate) fn is_missed_by(&self, v: [&ProjectedVertex; 3]) -> bool {
        if !(v[0].in_front && v[1].in_front && v[2].in_front) {
            return false;
        }
        let low = v[0].grid.min(v[1].grid).min(v[2].grid);
        let high = v[0].grid.max(v[1].grid).max(v[2].grid);
        !(low.cmplt(self.layout.high).all() && high.cmpgt(self.layout.low).all())
    }

    /// Whether some open group may lie behind a box.
    pub(crate) fn may_be_darkened_by(&self, lens: &Lens, bounds: &Bounds) -> bool {
        let Some(image) = lens.shadow_of_box(bounds) else { return true };
        let concerned =
            |g: u32| self.groups[g as usize].may_be_darkened(image.low, image.high, image.nearest);
        self.layout.any_near(image.low, image.high, concerned)
    }

    /// Calls `visit` with every open group that a caster with these bounds may darken; it returns whether the group is now dark.
    #[inline]
    pub(crate) fn darken_near(
        &mut self,
        (low, high): (DVec2, DVec2),
        nearness: f64,
        mut visit: impl FnMut(&mut Group) -> bool,
    ) {
        let Self { groups, layout, open_groups, .. } = self;
        layout.any_near(low, high, |g| {
            let group = &mut groups[g as usize];
            if group.may_be_darkened(low, high, nearness) && visit(group) {
                group.dark = true;
                *open_groups -= 1;
            }
            false
        });
    }
}
