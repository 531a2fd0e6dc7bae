//! Memory for one batch of receivers on the screens of one light: the local light grid.

use crate::layers::LightCells;
use crate::light::Resolution;
use glam::DVec2;
use pointillist_dice::hide::{Blocker, Regions};
use pointillist_dice::{ConvexPolygon, convex};
use pointillist_micropoint::{Bounds, ClusterQueue, Face, Lens, ProjectedVertex};

/// Which side of a face the viewer sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Unknown,
    Lit,
    Dark,
}

/// A receiver on a light screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    pub(crate) receiver: u32,
    pub(crate) screen: u8,
    /// The viewer's face.
    pub(crate) face: u32,
    first_vertex: u32,
    vertex_count: u32,
    pub(crate) bounds: (DVec2, DVec2),
    pub(crate) nearness: (f64, f64),
    pub(crate) area: f64,
    /// The receiver lies on more than one screen: parts must be weighed against each other.
    pub(crate) shared: bool,
}

/// A receiver's face in the frame of one screen.
#[derive(Clone, Debug)]
pub(crate) struct LitFace {
    pub(crate) screen: u8,
    pub(crate) face: Face,
}

/// A triangle that may stand in the light.
#[derive(Clone, Debug)]
pub(crate) struct Caster {
    pub(crate) face: Face,
    pub(crate) bounds: (DVec2, DVec2),
    pub(crate) polygon: ConvexPolygon,
    /// `None`: textured.
    pub(crate) opacity: Option<f64>,
}

/// What decides about most casters of a group, side by side in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearby {
    pub(crate) bounds: (DVec2, DVec2),
    /// Largest nearness.
    pub(crate) nearest: f64,
    /// The caster's triangle.
    pub(crate) id: u32,
    pub(crate) index: u32,
}

/// A cell of the local light grid: targets that lie close together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group {
    pub(crate) first_target: u32,
    pub(crate) end_target: u32,
    low: DVec2,
    high: DVec2,
    nearness: (f64, f64),
    first_link: u32,
    /// One opaque caster covers all of it, in front of all of it.
    pub(crate) dark: bool,
}

impl Group {
    const EMPTY: Self = Self {
        first_target: 0,
        end_target: 0,
        low: DVec2::INFINITY,
        high: DVec2::NEG_INFINITY,
        nearness: (f64::INFINITY, f64::NEG_INFINITY),
        first_link: NO_LINK,
        dark: false,
    };

    fn is_empty(&self) -> bool {
        self.first_target == self.end_target
    }

    fn overlaps(&self, low: DVec2, high: DVec2) -> bool {
        self.low.cmple(high).all() && self.high.cmpge(low).all()
    }
}

const NO_LINK: u32 = u32::MAX;

/// Lit and whole share of a receiver.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum {
    pub(crate) lit: f64,
    pub(crate) total: f64,
}

impl Sum {
    /// The lit fraction. What rounding leaves of a receiver on the border of two screens is neither light
    /// nor shadow.
    pub(crate) fn fraction(&self) -> f64 {
        const ROUNDING: f64 = 1e-12;
        let fraction = if self.total > 0.0 { self.lit / self.total } else { 0.0 };
        if fraction < ROUNDING {
            0.0
        } else if fraction > 1.0 - ROUNDING {
            1.0
        } else {
            fraction
        }
    }
}

/// Memory of the resolve rules.
#[derive(Debug, Default)]
pub(crate) struct Work {
    pub(crate) regions: Regions,
    pub(crate) blockers: Vec<Blocker>,
    pub(crate) layers: Vec<crate::layers::Cast>,
    pub(crate) partial: u64,
    /// The caster that hid the last target.
    pub(crate) last_hider: u32,
}

/// What was done and what was not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShadowCounts {
    /// Receivers asked about.
    pub receivers: u64,
    /// Receivers that show a side turned away from the light.
    pub facing_away: u64,
    /// Light screens used, summed over batches.
    pub screens: u64,
    /// Clusters looked into.
    pub clusters: u64,
    /// Clusters refused: outside the receivers' light, or behind them.
    pub clusters_skipped: u64,
    /// Triangles that may stand in the light of some group.
    pub casters: u64,
    /// Triangles refused: away from receivers, behind them, or the lit side of a solid.
    pub casters_culled: u64,
    /// Receivers without a caster near: lit without a test.
    pub lit_by_group: u64,
    /// Receivers behind one caster that covers their whole group: dark without a test.
    pub dark_by_group: u64,
    /// Receivers that had to be cut.
    pub partial: u64,
}

impl std::ops::AddAssign for ShadowCounts {
    fn add_assign(&mut self, o: Self) {
        self.receivers += o.receivers;
        self.facing_away += o.facing_away;
        self.screens += o.screens;
        self.clusters += o.clusters;
        self.clusters_skipped += o.clusters_skipped;
        self.casters += o.casters;
        self.casters_culled += o.casters_culled;
        self.lit_by_group += o.lit_by_group;
        self.dark_by_group += o.dark_by_group;
        self.partial += o.partial;
    }
}

/// Reusable memory of [`ShadowLight::lit`](crate::ShadowLight::lit), one per thread.
#[derive(Debug, Default)]
pub struct ShadowScratch {
    pub(crate) counts: ShadowCounts,
    light_cells: Option<LightCells>,
    pub(crate) sides: Vec<Side>,
    pub(crate) targets: Vec<Target>,
    target_vertices: Vec<DVec2>,
    pub(crate) lit_faces: Vec<LitFace>,
    lit_face_of: Vec<u32>,
    pub(crate) sums: Vec<Sum>,
    pub(crate) target_order: Vec<u32>,
    pub(crate) groups: Vec<Group>,
    /// Indices of the groups that have targets.
    occupied: Vec<u32>,
    columns: usize,
    rows: usize,
    cell_of: Vec<u32>,
    cells_per_unit: f64,
    /// Half the largest target: how far a target reaches beyond the cell of its centre.
    reach: f64,
    pub(crate) low: DVec2,
    pub(crate) high: DVec2,
    pub(crate) least_nearness: f64,
    pub(crate) open_groups: usize,
    pub(crate) casters: Vec<Caster>,
    pub(crate) copy_keys: Vec<(u64, u32)>,
    links: Vec<(u32, u32)>,
    pub(crate) queue: ClusterQueue,
    pub(crate) projected: Vec<ProjectedVertex>,
    pub(crate) nearby: Vec<Nearby>,
    pub(crate) work: Work,
}

/// Most cells on a side of the local grid; a batch is a tile's receivers, so more would stay empty.
const MOST_CELLS: f64 = 64.0;

impl ShadowScratch {
    /// What has been done since the last call.
    pub fn take_counts(&mut self) -> ShadowCounts {
        self.counts.partial += std::mem::take(&mut self.work.partial);
        std::mem::take(&mut self.counts)
    }

    pub(crate) fn begin(&mut self, receivers: usize, faces: usize, light_cells: Option<LightCells>) {
        self.light_cells = light_cells;
        self.sides.clear();
        self.sides.resize(faces, Side::Unknown);
        self.lit_face_of.clear();
        self.lit_face_of.resize(faces, NO_LINK);
        self.lit_faces.clear();
        self.targets.clear();
        self.target_vertices.clear();
        self.sums.clear();
        self.sums.resize(receivers, Sum::default());
    }

    /// Adds a target; its outline in either winding, with the nearness of each corner.
    pub(crate) fn push_target(
        &mut self,
        (receiver, face): (u32, u32),
        screen: usize,
        shared: bool,
        outline: impl Iterator<Item = (DVec2, f64)>,
    ) {
        let first = self.target_vertices.len();
        let mut nearness = (f64::INFINITY, f64::NEG_INFINITY);
        for (v, q) in outline {
            self.target_vertices.push(v);
            nearness = (nearness.0.min(q), nearness.1.max(q));
        }
        let outline = &mut self.target_vertices[first..];
        let area = convex::area(outline);
        // A receiver without corners, or with one that is nowhere, gets no light.
        if outline.is_empty() || !area.is_finite() || !outline.iter().all(|v| v.is_finite()) {
            self.target_vertices.truncate(first);
            return;
        }
        if area < 0.0 {
            outline.reverse();
        }
        let mut bounds = convex::bounds(outline);
        if let Some(cells) = &self.light_cells {
            // Whatever shares a cell with the target may merge into a layer with its casters.
            bounds = cells.around(bounds);
            nearness = (f64::NEG_INFINITY, f64::INFINITY);
        }
        self.targets.push(Target {
            receiver,
            screen: screen as u8,
            face,
            first_vertex: first as u32,
            vertex_count: outline.len() as u32,
            bounds,
            nearness,
            area: area.abs(),
            shared,
        });
    }

    /// Outline of a target on its screen, in positive order.
    #[inline]
    pub(crate) fn outline(&self, target: &Target) -> &[DVec2] {
        &self.target_vertices[target.first_vertex as usize..][..target.vertex_count as usize]
    }

    /// The index of a face in the frame of a screen, made when first needed.
    pub(crate) fn lit_face(&mut self, face: u32, screen: usize, make: impl FnOnce() -> Face) -> u32 {
        let known = self.lit_face_of[face as usize];
        if known != NO_LINK && usize::from(self.lit_faces[known as usize].screen) == screen {
            return known;
        }
        let index = self.lit_faces.len() as u32;
        self.lit_faces.push(LitFace::new(screen, make()));
        self.lit_face_of[face as usize] = index;
        index
    }

    /// Sorts the targets of one screen into the cells of a local grid. Returns false if there are none.
    pub(crate) fn sort_targets_into_groups(
        &mut self,
        screen: usize,
        resolution: Resolution,
        size: f64,
    ) -> bool {
        self.casters.clear();
        self.links.clear();
        self.target_order.clear();
        let on_screen = |(i, t): (usize, &Target)| (usize::from(t.screen) == screen).then_some(i as u32);
        self.target_order.extend(self.targets.iter().enumerate().filter_map(on_screen));
        if self.target_order.is_empty() {
            return false;
        }
        self.lay_out_grid(resolution, size);
        self.groups.clear();
        self.groups.resize(self.columns * self.rows, Group::EMPTY);
        self.cell_of.clear();
        for &i in &self.target_order {
            let t = &self.targets[i as usize];
            let centre = (0.5 * (t.bounds.0 + t.bounds.1) - self.low) * self.cells_per_unit;
            let column = (centre.x as usize).min(self.columns - 1);
            let cell = (centre.y as usize).min(self.rows - 1) * self.columns + column;
            self.cell_of.push(cell as u32);
            let group = &mut self.groups[cell];
            group.end_target += 1;
            group.low = group.low.min(t.bounds.0);
            group.high = group.high.max(t.bounds.1);
            group.nearness = (group.nearness.0.min(t.nearness.0), group.nearness.1.max(t.nearness.1));
        }
        // A counting sort: the ends of the groups become their starts while targets are put in place.
        let mut end = 0;
        for group in &mut self.groups {
            self.open_groups += usize::from(group.end_target > 0);
            group.first_target = end;
            end += group.end_target;
            group.end_target = group.first_target;
        }
        let unsorted = std::mem::take(&mut self.target_order);
        self.target_order.resize(unsorted.len(), 0);
        for (&i, &cell) in unsorted.iter().zip(&self.cell_of) {
            let group = &mut self.groups[cell as usize];
            self.target_order[group.end_target as usize] = i;
            group.end_target += 1;
        }
        let has_targets = |(i, g): (usize, &Group)| (!g.is_empty()).then_some(i as u32);
        self.occupied.clear();
        self.occupied.extend(self.groups.iter().enumerate().filter_map(has_targets));
        true
    }

    fn lay_out_grid(&mut self, resolution: Resolution, size: f64) {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (mut extents, mut reach) = (0.0, 0.0_f64);
        self.least_nearness = f64::INFINITY;
        for &i in &self.target_order {
            let t = &self.targets[i as usize];
            low = low.min(t.bounds.0);
            high = high.max(t.bounds.1);
            let extent = (t.bounds.1 - t.bounds.0).max_element();
            extents += extent;
            reach = reach.max(0.5 * extent);
            self.least_nearness = self.least_nearness.min(t.nearness.0);
        }
        let mean = extents / self.target_order.len() as f64;
        let cell = match resolution {
            Resolution::Auto => 2.0 * mean,
            Resolution::Cells(n) => size / f64::from(n),
        };
        let longest = (high - low).max_element();
        self.cells_per_unit = 1.0 / cell.max(longest / MOST_CELLS).max(f64::MIN_POSITIVE);
        let cells =
            |length: f64| ((length * self.cells_per_unit).ceil() as usize).clamp(1, MOST_CELLS as usize);
        (self.columns, self.rows) = (cells(high.x - low.x), cells(high.y - low.y));
        (self.low, self.high, self.reach) = (low, high, reach);
        self.open_groups = 0;
    }

    /// Calls `visit` with each group whose targets may overlap a rectangle, until it returns true.
    ///
    /// Small rectangles look at the cells they touch, large ones at all groups with targets: most
    /// cells of a grid over scattered receivers are empty.
    #[inline]
    fn any_group_near(&self, low: DVec2, high: DVec2, mut visit: impl FnMut(u32) -> bool) -> bool {
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

    /// Whether a triangle that needs no clipping misses all targets.
    #[inline]
    pub(crate) fn misses_targets(&self, v: [&ProjectedVertex; 3]) -> bool {
        if !(v[0].in_front && v[1].in_front && v[2].in_front) {
            return false;
        }
        let low = v[0].grid.min(v[1].grid).min(v[2].grid);
        let high = v[0].grid.max(v[1].grid).max(v[2].grid);
        !(low.cmplt(self.high).all() && high.cmpgt(self.low).all())
    }

    /// Whether some open group may lie behind a box.
    pub(crate) fn concerns_any_group(&self, lens: &Lens, bounds: &Bounds) -> bool {
        let Some((low, high, nearness)) = lens.shadow_of_box(bounds) else { return true };
        let concerned =
            |g: &Group| !g.is_empty() && !g.dark && g.nearness.0 <= nearness && g.overlaps(low, high);
        self.any_group_near(low, high, |g| concerned(&self.groups[g as usize]))
    }

    /// Links a caster to the groups that it may darken.
    pub(crate) fn link(&mut self, caster: Caster) {
        let (low, high) = caster.bounds;
        let index = self.casters.len() as u32;
        let mut groups = std::mem::take(&mut self.groups);
        let mut links = std::mem::take(&mut self.links);
        let (mut used, mut darkened) = (false, 0);
        self.any_group_near(low, high, |g| {
            let group = &mut groups[g as usize];
            let behind = group.nearness.0 <= caster.face.nearness.1;
            if group.is_empty() || group.dark || !behind || !group.overlaps(low, high) {
                return false;
            }
            match covers(&caster, group) {
                Cover::Nothing => {}
                Cover::All => {
                    group.dark = true;
                    darkened += 1;
                }
                Cover::Some => {
                    links.push((index, group.first_link));
                    group.first_link = links.len() as u32 - 1;
                    used = true;
                }
            }
            false
        });
        self.groups = groups;
        self.links = links;
        self.open_groups -= darkened;
        if used {
            self.counts.casters += 1;
            self.casters.push(caster);
        } else {
            self.counts.casters_culled += 1;
        }
    }

    /// The casters of a group.
    pub(crate) fn casters_of(&self, group: &Group, nearby: &mut Vec<Nearby>) {
        nearby.clear();
        let mut link = group.first_link;
        while link != NO_LINK {
            let (index, next) = self.links[link as usize];
            let caster = &self.casters[index as usize];
            link = next;
            // Merged into a copy of itself.
            if caster.opacity == Some(0.0) {
                continue;
            }
            let (bounds, nearest, id) = (caster.bounds, caster.face.nearness.1, caster.face.id);
            nearby.push(Nearby { bounds, nearest, id, index });
        }
    }
}

/// What a caster does to a group.
enum Cover {
    /// Its outline misses the group's rectangle.
    Nothing,
    Some,
    /// It is opaque and covers the rectangle, in front of all its targets. Then it also covers each
    /// target alone, and cutting would leave exactly nothing.
    All,
}

fn covers(caster: &Caster, group: &Group) -> Cover {
    let mut all_inside = true;
    for half in pointillist_dice::convex::half_planes(caster.polygon.vertices()) {
        // The corners of the rectangle farthest along the normal, and farthest against it.
        let along = DVec2::select(half.normal.cmpgt(DVec2::ZERO), group.high, group.low);
        let against = group.low + group.high - along;
        if half.value(along) < 0.0 {
            return Cover::Nothing;
        }
        all_inside &= half.value(against) >= 0.0;
    }
    let clearly_before = caster.face.nearness.0 > group.nearness.1 + 1e-6 * group.nearness.1.abs();
    if all_inside && clearly_before && caster.opacity == Some(1.0) { Cover::All } else { Cover::Some }
}
