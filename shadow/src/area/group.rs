//! Receivers in groups, each with the casters that may matter to it.

use super::light::{AreaLight, SeenLight, above_horizon};
use super::masks::Masks;
use super::outline::Outline;
use super::shaft::Shaft;
use super::sheets::Sheets;
use super::sweep::Sweep;
use crate::receiver::{Receivers, Viewer};
use glam::{DVec2, DVec3};
use pointillist_dice::{clip_ring, convex, share_before_crossing};
use pointillist_micropoint::Face;

/// Groups of this many receivers are not divided further.
const FEW_RECEIVERS: usize = 8;

/// Groups with no more casters than this are not divided further.
const FEW_SHEETS: usize = 12;

type Box3 = (DVec3, DVec3);

/// A receiver in the frame of a light.
#[derive(Clone, Copy, Debug)]
struct Target {
    receiver: u32,
    /// Unit normal of its surface, on the side that is seen.
    normal: DVec3,
    bounds: Box3,
    first_corner: u32,
    corner_count: u32,
}

/// Reusable memory of [`AreaLight::visit`], one per thread.
#[derive(Debug, Default)]
pub struct AreaScratch {
    targets: Vec<Target>,
    corners: Vec<DVec3>,
    sheets: Sheets,
    /// Stack of the sheets of nested groups.
    stack: Vec<u32>,
    point: PointScratch,
}

/// Memory for one point.
#[derive(Debug, Default)]
struct PointScratch {
    outline: Outline,
    masks: Masks,
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
    let AreaScratch { targets, corners, sheets, stack, point } = scratch;
    collect(light, viewer, receivers, targets, corners);
    if targets.is_empty() {
        return;
    }
    let shaft = Shaft::new(bounds(targets), convex::bounds(&light.outline));
    sheets.clear();
    if light.casts {
        sheets.gather(light.geometry, &light.frame, &shaft, light.coincident);
    }
    stack.clear();
    stack.extend(0..sheets.list.len() as u32);
    point.outline.start(sheets, light.coincident);
    point.seen.frame = light.frame;
    Groups { light, corners, sheets, stack, point, visit }.divide(targets, 0);
}

/// Receivers that may see something of the light.
fn collect(
    light: &AreaLight<'_>,
    viewer: Viewer<'_>,
    receivers: &Receivers,
    targets: &mut Vec<Target>,
    corners: &mut Vec<DVec3>,
) {
    targets.clear();
    corners.clear();
    for (index, receiver) in receivers.list.iter().enumerate() {
        let first = corners.len();
        let world = receivers.corners(receiver);
        let offset = viewer.lens.origin - light.frame.origin;
        corners.extend(world.iter().map(|&c| light.frame.local_vector(c + offset)));
        let own = &corners[first..];
        let low = own.iter().fold(DVec3::INFINITY, |m, &c| m.min(c));
        let high = own.iter().fold(DVec3::NEG_INFINITY, |m, &c| m.max(c));
        let normal = seen_normal(light, &viewer.faces[receiver.face as usize]);
        // Behind the light, edge-on, or the light below the horizon of all of it.
        let towards = light.outline.iter().map(|v| v.extend(0.0));
        let faces = |v: DVec3| own.iter().any(|&c| normal.dot(v - c) > 0.0);
        let lit = high.z > light.coincident && towards.into_iter().any(faces);
        if !(lit && low.is_finite() && high.is_finite()) {
            corners.truncate(first);
            continue;
        }
        targets.push(Target {
            receiver: index as u32,
            normal,
            bounds: (low, high),
            first_corner: first as u32,
            corner_count: (corners.len() - first) as u32,
        });
    }
}

/// Unit normal of a face on the side that the viewer sees, in the light's frame.
fn seen_normal(light: &AreaLight<'_>, face: &Face) -> DVec3 {
    let [a, b, c] = light.geometry.corners(face.source);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    light.frame.local_vector(if face.front { normal } else { -normal })
}

fn bounds(targets: &[Target]) -> Box3 {
    let union = |a: Box3, t: &Target| (a.0.min(t.bounds.0), a.1.max(t.bounds.1));
    targets.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), union)
}

/// A batch of receivers while it is divided.
struct Groups<'s, F> {
    light: &'s AreaLight<'s>,
    corners: &'s [DVec3],
    sheets: &'s Sheets,
    stack: &'s mut Vec<u32>,
    point: &'s mut PointScratch,
    visit: &'s mut F,
}

impl<F: FnMut(usize, f64, &SeenLight)> Groups<'_, F> {
    /// A group of receivers, with the sheets from `first` on the stack. Groups are divided into four at a time: half as many tests of
    /// sheets as with two.
    fn divide(&mut self, targets: &mut [Target], first: usize) {
        let around = bounds(targets);
        let shaft = Shaft::new(around, convex::bounds(&self.light.outline));
        let own = self.stack.len();
        for i in first..own {
            let sheet = self.stack[i];
            if !shaft.misses(self.sheets.corners(&self.sheets.list[sheet as usize])) {
                self.stack.push(sheet);
            }
        }
        let count = self.stack.len() - own;
        if targets.len() <= FEW_RECEIVERS || count <= FEW_SHEETS {
            self.settle(targets, own, around);
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
    fn settle(&mut self, targets: &[Target], first: usize, around: Box3) {
        let group = &self.stack[first..];
        let opaque = |&&s: &&u32| self.sheets.list[s as usize].mask.is_none();
        self.point.outline.take(self.sheets, group.iter().filter(opaque).copied(), around);
        self.point.masks.take(self.sheets, group);
        for target in targets {
            let corners = &self.corners[target.first_corner as usize..][..target.corner_count as usize];
            self.ask(target, corners, 1.0, 0);
        }
    }

    /// Asks the middle of a convex piece of a receiver, or the middles of its halves.
    fn ask(&mut self, target: &Target, piece: &[DVec3], weight: f64, halvings: u32) {
        let (middle, radius) = middle(piece);
        let shaft = Shaft::new(around(piece), convex::bounds(&self.light.outline));
        let factor = self.cast((middle, target.normal), &shaft);
        let options = &self.light.options;
        if factor * radius > options.largest_shift * self.light.width && halvings < options.most_halvings {
            let halves = halves(piece, middle);
            let areas = halves.each_ref().map(|h| area(h));
            let total = areas[0] + areas[1];
            if total > 0.0 {
                for (half, own) in halves.iter().zip(areas) {
                    if own > 0.0 {
                        self.ask(target, half, weight * own / total, halvings + 1);
                    }
                }
                return;
            }
        }
        if !self.point.seen.is_empty() {
            (self.visit)(target.receiver as usize, weight, &self.point.seen);
        }
    }

    /// What a point of a surface sees. Returns the factor of [`Outline::cast`].
    fn cast(&mut self, (point, normal): (DVec3, DVec3), shaft: &Shaft) -> f64 {
        let PointScratch { outline, masks, sweep, polygon, seen } = &mut *self.point;
        seen.clear();
        seen.point = point;
        if point.z <= self.light.coincident {
            return 0.0;
        }
        above_horizon(&self.light.outline, point, normal, polygon);
        if convex::area(polygon) <= 0.0 {
            return 0.0;
        }
        sweep.start(polygon);
        let factor = outline.cast(self.sheets, (point, normal), shaft, sweep);
        sweep.finish(polygon, self.sheets, seen);
        masks.dim(self.light, self.sheets, seen);
        factor
    }
}

/// Two halves of a group, side by side along the longest side of the box around it.
fn split(targets: &mut [Target], (low, high): Box3) -> (&mut [Target], &mut [Target]) {
    let middle = targets.len() / 2;
    let size = high - low;
    let axis = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
    let key = |t: &Target| t.bounds.0[axis] + t.bounds.1[axis];
    targets.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
    targets.split_at_mut(middle)
}

/// Centroid of a convex polygon in space, and the distance of its farthest corner from it.
fn middle(ring: &[DVec3]) -> (DVec3, f64) {
    let mut sum = DVec3::ZERO;
    let mut total = 0.0;
    for pair in ring[1..].windows(2) {
        let own = (pair[0] - ring[0]).cross(pair[1] - ring[0]).length();
        sum += (pair[0] - ring[0] + (pair[1] - ring[0])) * (own / 3.0);
        total += own;
    }
    let mean = || ring.iter().map(|&c| c - ring[0]).sum::<DVec3>() / ring.len() as f64;
    let middle = ring[0] + if total > 0.0 { sum / total } else { mean() };
    (middle, ring.iter().map(|&c| c.distance(middle)).fold(0.0, f64::max))
}

fn area(ring: &[DVec3]) -> f64 {
    ring.get(1..)
        .unwrap_or_default()
        .windows(2)
        .map(|p| (p[0] - ring[0]).cross(p[1] - ring[0]).length())
        .sum()
}

fn around(ring: &[DVec3]) -> Box3 {
    let union = |a: Box3, &c: &DVec3| (a.0.min(c), a.1.max(c));
    ring.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), union)
}

/// A polygon cut through its middle, across its longest extent.
fn halves(ring: &[DVec3], middle: DVec3) -> [Vec<DVec3>; 2] {
    let far =
        |a: DVec3, &b: &DVec3| if b.distance_squared(middle) > a.distance_squared(middle) { b } else { a };
    let along = ring.iter().fold(middle, far) - middle;
    let crossing = |(a, va): (DVec3, f64), (b, vb): (DVec3, f64)| a + (b - a) * share_before_crossing(va, vb);
    [1.0, -1.0].map(|sign| {
        let mut half = vec![];
        clip_ring(ring, |p| sign * along.dot(p - middle), crossing, |p| half.push(p));
        half
    })
}
