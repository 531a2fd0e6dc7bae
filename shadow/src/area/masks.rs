//! Casters whose opacity depends on the place: they divide what is visible of a light, and weaken it by the mean of their masks. Where they are many, as in
//! foliage, they do so in the cells of a grid ([`TransmittanceGrid`]).
//!
//! They do not decide how finely a receiver is divided: foliage has outlines everywhere.

use super::joined::{Joined, PaneEdge};
use super::light::{AreaLight, SeenLight};
use super::outline::{highest_caster, projected};
use super::sheets::{Sheet, Sheets, at_height};
use super::transmittance::TransmittanceGrid;
use glam::{DVec2, DVec3};
use pointillist_dice::hide::{Blocker, Occluders, Regions};
use pointillist_dice::{ConvexPolygon, convex};
use pointillist_micropoint::{ClusterFace, SurfacePoint};
use std::cmp::Ordering;

/// Overlaps with an area below this, times that of the part or the cell of the light, are taken for rounding.
const NEGLIGIBLE: f64 = 1e-9;

/// Most panes that divide a part of a light. Behind more, dividing takes hundreds of regions, each with a mean for every pane: the part is divided by the
/// cells of a grid, and in each its light is weakened by what each pane covers of the cell times the mean of its mask there.
const MOST_DIVIDING: usize = 4;

/// A masked caster as a point sees it.
#[derive(Clone, Copy, Debug)]
struct Pane {
    /// Its projection onto the light's plane, and that one's bounding rectangle.
    polygon: ConvexPolygon,
    bounds: (DVec2, DVec2),
    face: ClusterFace,
    sheet: u32,
    /// The point is on the side of the sheet's normal.
    front: bool,
    /// All of the caster is below the point.
    is_whole: bool,
}

impl Pane {
    /// Whether it overlaps a convex polygon with these bounds.
    fn overlaps(&self, part: &[DVec2], bounds: (DVec2, DVec2)) -> bool {
        meet(self.bounds, bounds) && !convex::are_disjoint(part, self.polygon.vertices())
    }
}

/// Whether two rectangles, by their lower and upper corners, overlap.
fn meet(a: (DVec2, DVec2), b: (DVec2, DVec2)) -> bool {
    a.0.cmplt(b.1).all() && b.0.cmplt(a.1).all()
}

/// The masked sheets of a group, and memory.
#[derive(Debug, Default)]
pub(crate) struct Masks {
    sheets: Vec<u32>,
    /// The mean opacity of each sheet of all that are at hand, once it was asked for; NaN before.
    means: Vec<f64>,
    panes: Vec<Pane>,
    blockers: Vec<Blocker>,
    /// For each part where its blockers end.
    ends: Vec<usize>,
    regions: Regions,
    joined: Joined,
    grid: TransmittanceGrid,
    dimmed: SeenLight,
}

/// The panes before one point.
struct View<'a> {
    light: &'a AreaLight<'a>,
    point: DVec3,
    panes: &'a [Pane],
}

impl Masks {
    /// Begins with the sheets before a batch of receivers.
    pub(crate) fn start(&mut self, sheets: &Sheets) {
        self.means.clear();
        self.means.resize(sheets.list.len(), f64::NAN);
    }

    /// Takes the masked ones among the sheets of a group.
    pub(crate) fn take(&mut self, sheets: &Sheets, group: &[u32]) {
        self.sheets.clear();
        self.sheets.extend(group.iter().filter(|&&s| sheets.list[s as usize].mask.is_some()));
    }

    /// Divides what a point sees by the panes in front of it.
    pub(crate) fn dim(&mut self, light: &AreaLight<'_>, sheets: &Sheets, seen: &mut SeenLight) {
        if self.sheets.is_empty() || seen.is_empty() {
            return;
        }
        self.collect(light, sheets, seen);
        if self.panes.is_empty() {
            return;
        }
        self.panes.sort_unstable_by(compare);
        self.find_blockers(light, seen);
        let Self { means, panes, blockers, ends, regions, joined, grid, dimmed, .. } = self;
        let view = View { light, point: seen.point, panes };
        if grid.is_needed() {
            view.fill(grid, joined, sheets, means);
        }
        dimmed.clear();
        let mut first = 0;
        for ((part, transmittance), &end) in seen.plane_parts().zip(&*ends) {
            let own = &blockers[first..end];
            first = end;
            if own.is_empty() {
                dimmed.push(part.iter().copied(), transmittance);
                continue;
            }
            let polygon = ConvexPolygon::from_vertices(part);
            if own.len() > MOST_DIVIDING {
                grid.divide(&polygon, |piece, passed| {
                    dimmed.push(piece.iter().copied(), transmittance * passed);
                });
                continue;
            }
            let negligible = NEGLIGIBLE * convex::area(part);
            regions.hide(polygon, negligible, own, &view);
            for r in regions.list() {
                dimmed.push(r.polygon.vertices().iter().copied(), transmittance * r.transmittance);
            }
        }
        seen.take_parts(dimmed);
    }

    /// The panes before each part, as many as it takes to tell how the part is divided, and the cells of the grid that parts with more of them need.
    fn find_blockers(&mut self, light: &AreaLight<'_>, seen: &SeenLight) {
        self.blockers.clear();
        self.ends.clear();
        self.grid.start(&light.outline);
        for (part, _) in seen.plane_parts() {
            let first = self.blockers.len();
            let bounds = convex::bounds(part);
            let before = (0..).zip(&self.panes).filter(|(_, pane)| pane.overlaps(part, bounds));
            let blockers = before.map(|(number, _)| Blocker { number, front: None });
            self.blockers.extend(blockers.take(MOST_DIVIDING + 1));
            if self.blockers.len() - first > MOST_DIVIDING {
                self.grid.need(&ConvexPolygon::from_vertices(part));
            }
            self.ends.push(self.blockers.len());
        }
    }

    /// The panes that overlap the visible parts' rectangle.
    fn collect(&mut self, light: &AreaLight<'_>, sheets: &Sheets, seen: &SeenLight) {
        self.panes.clear();
        let around = seen.bounds();
        for &s in &self.sheets {
            let sheet = &sheets.list[s as usize];
            let Some(face) = sheets.mask(sheet) else { continue };
            let distance = sheet.normal.dot(seen.point) - sheet.offset;
            if distance.abs() <= light.coincident {
                continue;
            }
            let front = distance > 0.0;
            let (polygon, is_whole) = projection(sheets, sheet, seen.point, front);
            let bounds = polygon.bounds();
            if polygon.vertices().len() >= 3 && meet(bounds, around) {
                self.panes.push(Pane { polygon, bounds, face, sheet: s, front, is_whole });
            }
        }
    }
}

/// The projection of what of a sheet is below a point, in positive order, and whether that is all of it; `front`: the point is on the side of the sheet's
/// normal.
fn projection(sheets: &Sheets, sheet: &Sheet, point: DVec3, front: bool) -> (ConvexPolygon, bool) {
    let top = highest_caster(point.z);
    let mut is_whole = true;
    let mut ring = [DVec2::ZERO; 8];
    let mut count = 0;
    for e in sheet.edges() {
        let [a, b] = sheets.ends(e.edge());
        let (from, to) = if e.turn() > 0 { (a, b) } else { (b, a) };
        if from.z <= top {
            ring[count] = projected(point, from);
            count += 1;
        } else {
            is_whole = false;
        }
        if (from.z <= top) != (to.z <= top) {
            ring[count] = projected(point, at_height(a, b, top));
            count += 1;
        }
    }
    let ring = &mut ring[..count];
    // A point in front of the light looks down on its plane: what it sees the front of is counter-clockwise there.
    if !front {
        ring.reverse();
    }
    (ConvexPolygon::from_vertices(ring), is_whole)
}

/// An order by place, which does not depend on that of triangles.
fn compare(a: &Pane, b: &Pane) -> Ordering {
    let ((la, ha), (lb, hb)) = (a.bounds, b.bounds);
    let sum = |p: &Pane| p.polygon.vertices().iter().fold(DVec2::ZERO, |s, &v| s + v);
    let (sa, sb) = (sum(a), sum(b));
    let numbers = [(la.x, lb.x), (la.y, lb.y), (ha.x, hb.x), (ha.y, hb.y), (sa.x, sb.x), (sa.y, sb.y)];
    let by_place = numbers.into_iter().map(|(a, b)| a.total_cmp(&b)).fold(Ordering::Equal, Ordering::then);
    by_place.then((a.face.surface, a.face.id).cmp(&(b.face.surface, b.face.id)))
}

impl Occluders for View<'_> {
    fn outline(&self, number: u32) -> &[DVec2] {
        self.panes[number as usize].polygon.vertices()
    }

    fn is_opaque(&self, _: u32) -> bool {
        false
    }

    fn opacity(&self, number: u32, over: &ConvexPolygon) -> f64 {
        self.mask(&self.panes[number as usize].face, over.vertices(), true)
    }
}

impl View<'_> {
    /// What of the light passes all panes, cell by cell.
    fn fill(&self, grid: &mut TransmittanceGrid, joined: &mut Joined, sheets: &Sheets, means: &mut [f64]) {
        let edges = |pane: &Pane| {
            let front = pane.front;
            let own = sheets.list[pane.sheet as usize].edges().iter();
            own.map(move |e| PaneEdge { number: e.edge(), on_left: (e.turn() > 0) == front })
        };
        joined.find(sheets.edge_count(), self.panes.iter().map(edges));
        for set in joined.sets() {
            for pane in set.map(|number| &self.panes[number as usize]) {
                // Most masks of a tree are small in the light: the mean over all of one is known.
                if pane.is_whole
                    && let Some(cell) = grid.cell_around(pane.bounds)
                {
                    let mean = || known(&mut means[pane.sheet as usize], || self.whole_mask(&pane.face));
                    grid.cover_within(cell, pane.polygon.area(), NEGLIGIBLE, mean);
                } else {
                    grid.cover(&pane.polygon, NEGLIGIBLE, |part| self.mask(&pane.face, part, false));
                }
            }
            grid.weaken();
        }
    }

    /// Mean opacity of a mask where it is in front of a polygon of the light's plane, by area there or, unless `in_perspective`, by area on the
    /// mask: less time, and what that changes in a cell among many panes is lost among them (2e-5 of 4.6e-4 below an oak).
    fn mask(&self, face: &ClusterFace, polygon: &[DVec2], in_perspective: bool) -> f64 {
        let AreaLight { geometry, frame, .. } = self.light;
        let [a, b, c] = geometry.corners(face.source).map(|p| frame.local(p) - self.point);
        let normal = (b - a).cross(c - a);
        let at = |&grid: &DVec2| {
            let towards = grid.extend(0.0) - self.point;
            let along = normal.dot(a) / normal.dot(towards);
            // Depth along the light's axis: a corner of the polygon is at the point's height over the light.
            let depth = if in_perspective { (along * self.point.z).abs() } else { 1.0 };
            surface_point([a, b, c], towards, grid, depth)
        };
        let zero = SurfacePoint { grid: DVec2::ZERO, nearness: 0.0, rational: 1.0, barycentric: DVec3::ZERO };
        let mut points = [zero; convex::MAX_VERTICES];
        for (to, v) in points.iter_mut().zip(polygon) {
            *to = at(v);
        }
        self.behind_mask(face, self.light.opacity.rough_opacity(face.id, &points[..polygon.len()]))
    }

    /// Mean opacity of a whole mask by its own area.
    fn whole_mask(&self, face: &ClusterFace) -> f64 {
        let corner = |barycentric: DVec3| SurfacePoint {
            grid: barycentric.truncate(),
            nearness: 1.0,
            rational: 1.0,
            barycentric,
        };
        let corners = [DVec3::X, DVec3::Y, DVec3::Z].map(corner);
        self.behind_mask(face, self.light.opacity.mean_opacity(face.id, &corners))
    }

    fn behind_mask(&self, face: &ClusterFace, mean: f32) -> f64 {
        f64::from(self.light.geometry.surfaces()[face.surface as usize].behind_mask(mean))
    }
}

/// A number that is computed when it is first asked for.
fn known(number: &mut f64, compute: impl FnOnce() -> f64) -> f64 {
    if number.is_nan() {
        *number = compute();
    }
    *number
}

/// Where the line from a point towards a place meets a triangle's plane, on the triangle; corners are relative to the point.
pub(crate) fn surface_point([a, b, c]: [DVec3; 3], towards: DVec3, grid: DVec2, depth: f64) -> SurfacePoint {
    // a + t·(b − a) + s·(c − a) on the line, by Cramer's rule; a common factor cancels.
    let weights = DVec3::new(towards.dot(b.cross(c)), towards.dot(c.cross(a)), towards.dot(a.cross(b)));
    let sum = weights.element_sum();
    let kept = if sum < 0.0 { -weights } else { weights }.max(DVec3::ZERO);
    let total = kept.element_sum();
    let barycentric = if total > 0.0 { kept / total } else { DVec3::splat(1.0 / 3.0) };
    let nearness = 1.0 / depth.max(f64::MIN_POSITIVE);
    SurfacePoint { grid, nearness, rational: nearness, barycentric }
}
