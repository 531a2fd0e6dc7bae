//! Receivers in groups, each with the casters that may matter to it.

use super::light::{AreaLight, SeenLight, above_horizon};
use super::light_cells::LightCells;
use super::masks::Masks;
use super::outline::Outline;
use super::piece::{self, Piece, around};
use super::shaft::Shaft;
use super::sheets::{Beyond, Sheets};
use super::sweep::Sweep;
use super::targets::{Box3, Target, Targets, bounds, split};
use crate::counts::AreaCounts;
use crate::receiver::{Receivers, Viewer};
use glam::{DVec2, DVec3};
use pointillist_dice::convex;
use std::ops::Range;

/// Groups of this many receivers are not divided further, unless they have more than `MANY_SHEETS` casters.
const FEW_RECEIVERS: usize = 8;

/// Groups with more casters than this are divided down to single receivers: each caster costs more in a question than in a test.
const MANY_SHEETS: usize = 300;

/// Groups with no more casters than this are not divided further.
const FEW_SHEETS: usize = 12;

/// Reusable memory of [`AreaLight::visit`], one per thread.
#[derive(Debug, Default)]
pub struct AreaScratch {
    targets: Targets,
    sheets: Sheets,
    beyond: Beyond,
    /// Stack of the sheets of nested groups.
    stack: Vec<u32>,
    point: PointScratch,
    pub(crate) counts: AreaCounts,
}

impl AreaScratch {
    /// What has been done since the last call.
    #[must_use]
    pub fn take_counts(&mut self) -> AreaCounts {
        std::mem::take(&mut self.counts)
    }
}

/// Memory for one point.
#[derive(Debug, Default)]
struct PointScratch {
    outline: Outline,
    masks: Masks,
    cells: LightCells,
    sweep: Sweep,
    polygon: Vec<DVec2>,
    seen: SeenLight,
}

/// See [`AreaLight::visit`].
pub(crate) fn visit(
    light: &AreaLight<'_>,
    viewer: Viewer<'_>,
    receivers: &Receivers,
    scratch: &mut AreaScratch,
    visit: &mut impl FnMut(usize, f64, &SeenLight),
) {
    let AreaScratch { targets, sheets, beyond, stack, point, counts } = scratch;
    // Behind the light, edge-on, or the light below the horizon of all of it.
    let is_lit = |own: &[DVec3], highest: DVec3, normal: DVec3| {
        let towards = light.outline.iter().map(|v| v.extend(0.0));
        let faces = |v: DVec3| own.iter().any(|&c| normal.dot(v - c) > 0.0);
        highest.z > light.coincident && towards.into_iter().any(faces)
    };
    targets.collect((light.geometry, &light.frame), viewer, receivers, |face, own, highest, normal| {
        is_lit(own, highest, normal) && !light.is_own(face.id)
    });
    let Targets { list: targets, pieces, corners } = targets;
    counts.batch(receivers.wholes(), targets.len());
    if targets.is_empty() {
        return;
    }
    let shaft = Shaft::new(bounds(targets), convex::bounds(&light.outline));
    sheets.clear();
    if light.casts {
        sheets.gather(light, &shaft);
    }
    beyond.start(sheets);
    stack.clear();
    stack.extend(0..sheets.list.len() as u32);
    point.outline.start(sheets, light.coincident);
    point.masks.start(sheets);
    point.cells.start();
    point.seen.frame = light.frame;
    Groups { light, pieces, corners, sheets, beyond, stack, point, counts, has_casters: false, visit }
        .divide(targets, 0);
}

/// A batch of receivers while it is divided.
struct Groups<'s, F> {
    light: &'s AreaLight<'s>,
    /// Those of a receiver, in any order.
    pieces: &'s mut [Piece],
    corners: &'s [DVec3],
    sheets: &'s Sheets,
    beyond: &'s mut Beyond,
    stack: &'s mut Vec<u32>,
    point: &'s mut PointScratch,
    counts: &'s mut AreaCounts,
    /// The group at hand has some.
    has_casters: bool,
    visit: &'s mut F,
}

impl<F: FnMut(usize, f64, &SeenLight)> Groups<'_, F> {
    /// A group of receivers, with the sheets from `first` on the stack. Groups are divided into four at a time: half as many tests of
    /// sheets as with two.
    fn divide(&mut self, targets: &mut [Target], first: usize) {
        let around = bounds(targets);
        let shaft = Shaft::new(around, convex::bounds(&self.light.outline));
        let own = self.stack.len();
        self.beyond.turn_to_next();
        for i in first..own {
            let sheet = self.stack[i];
            if !self.beyond.misses(self.sheets, &shaft, sheet) {
                self.stack.push(sheet);
            }
        }
        let count = self.stack.len() - own;
        let few = if count > MANY_SHEETS { 1 } else { FEW_RECEIVERS };
        if targets.len() <= few || count <= FEW_SHEETS {
            self.settle(targets, own, (around, &shaft));
        } else {
            let (low, high) = split(targets, around);
            for half in [low, high] {
                let (low, high) = split(half, bounds(half));
                self.divide(low, own);
                self.divide(high, own);
            }
        }
        self.stack.truncate(own);
    }

    /// Asks the points of a group one by one.
    fn settle(&mut self, targets: &[Target], first: usize, (around, shaft): (Box3, &Shaft)) {
        let group = &self.stack[first..];
        self.has_casters = !group.is_empty();
        self.counts.casters += group.len() as u64;
        let opaque = |&&s: &&u32| self.sheets.list[s as usize].mask.is_none();
        self.point.outline.take(self.sheets, group.iter().filter(opaque).copied(), around, shaft);
        self.point.masks.take(self.sheets, group);
        for target in targets {
            let first = target.first_piece as usize;
            self.ask_pieces(target, first..first + target.piece_count as usize, 1.0, 0);
        }
    }

    /// Asks one point for some pieces of a receiver that stand for this share of it, or each half of them.
    fn ask_pieces(&mut self, target: &Target, pieces: Range<usize>, share: f64, halvings: u32) {
        let corners = self.corners;
        let own = &self.pieces[pieces.clone()];
        if let [only] = own {
            let ring = only.corners(corners);
            return self.ask(target, ring, share, halvings);
        }
        if let Some((middle, radius)) = piece::common_middle(own, corners) {
            let all = own.iter().flat_map(|p| p.corners(corners));
            let around = around(all.clone());
            let shaft = Shaft::new(around, convex::bounds(&self.light.outline));
            let most = self.most_movement(target, radius, halvings);
            let passes = self.point.outline.passes_between(self.sheets, all.copied(), around, &shaft);
            if !passes && self.cast((middle, target.normal), &shaft, (around.0.z, around.1.z), most) {
                return self.report(target, share);
            }
        }
        let own = &mut self.pieces[pieces.clone()];
        let first = piece::part(own, corners);
        let share_of_first = piece::weight(&own[..first]) / piece::weight(own);
        let parted = pieces.start + first;
        self.ask_pieces(target, pieces.start..parted, share * share_of_first, halvings + 1);
        self.ask_pieces(target, parted..pieces.end, share * (1.0 - share_of_first), halvings + 1);
    }

    /// Asks the middle of a convex piece of a receiver, or the middles of its halves.
    fn ask(&mut self, target: &Target, ring: &[DVec3], share: f64, halvings: u32) {
        let (middle, radius) = piece::middle(ring);
        let around = around(ring.iter());
        let shaft = Shaft::new(around, convex::bounds(&self.light.outline));
        let heights = (around.0.z, around.1.z);
        let most = self.most_movement(target, radius, halvings);
        if !self.cast((middle, target.normal), &shaft, heights, most) {
            let halves = piece::halves(ring, middle);
            let areas = halves.each_ref().map(|h| piece::area(h));
            let total = areas[0] + areas[1];
            if total > 0.0 {
                for (half, own) in halves.iter().zip(areas) {
                    if own > 0.0 {
                        self.ask(target, half, share * own / total, halvings + 1);
                    }
                }
                return;
            }
            self.cast((middle, target.normal), &shaft, heights, f64::INFINITY);
        }
        self.report(target, share);
    }

    /// The share of its way by which outlines may move if one point is to be enough for all that is within this radius.
    fn most_movement(&self, target: &Target, radius: f64, halvings: u32) -> f64 {
        let options = &self.light.options;
        if halvings >= options.most_halvings {
            return f64::INFINITY;
        }
        options.largest_shift * self.light.width / (radius * target.visibility)
    }

    fn report(&mut self, target: &Target, share: f64) {
        self.counts.point(self.has_casters, self.point.seen.is_empty());
        if !self.point.seen.is_empty() {
            (self.visit)(target.receiver as usize, share, &self.point.seen);
        }
    }

    /// What a point of a surface sees, if it stands for points between these heights over the light and within `shaft`: false if outlines move by
    /// more than `most` times its way.
    fn cast(
        &mut self,
        (point, normal): (DVec3, DVec3),
        shaft: &Shaft,
        (lowest, highest): (f64, f64),
        most: f64,
    ) -> bool {
        let PointScratch { outline, masks, cells, sweep, polygon, seen } = &mut *self.point;
        seen.clear();
        seen.point = point;
        if point.z <= self.light.coincident {
            // Some of what it stands for may be in front of the light.
            return most == f64::INFINITY || highest <= self.light.coincident;
        }
        above_horizon(&self.light.outline, point, normal, polygon);
        if convex::area(polygon) <= 0.0 {
            return true;
        }
        outline.turn_to(point);
        // Some of what it stands for may be behind the light.
        let crosses = lowest < -self.light.coincident;
        if most < f64::INFINITY && (crosses || outline.moves_by_more(most, (point, normal), shaft)) {
            return false;
        }
        cells.clear();
        outline.cast(self.sheets, point, |edge| cells.push(edge));
        cells.see(polygon, self.sheets, sweep, seen);
        masks.dim(self.light, self.sheets, seen);
        true
    }
}
