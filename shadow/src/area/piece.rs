//! The convex pieces of a receiver: where they are asked, and how they are halved.

use glam::DVec3;
use pointillist_dice::{clip_ring, share_before_crossing};

/// Points this close to a piece are in it, relative to its size: pieces that share an edge have no gap between them.
const SEAM: f64 = 1e-9;

/// Radius of what one point stands for, relative to its distance from the light, up to which light does not vary over it. Where light falls with the
/// square of the distance, the middle is off from the mean by up to the square of this; narrow highlights need more.
const FAR: f64 = 0.02;

/// The same for three points of each triangle: light is as good as a quadratic function there.
const NEAR: f64 = 0.1;

/// How often a receiver is halved at most because a light is close: the light may touch it.
const MOST_HALVINGS: u32 = 8;

/// How light varies over what is within `radius` of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variation {
    /// One point stands for all.
    Even,
    /// [`points`] do.
    Smooth,
    /// Halves are to be asked.
    Steep,
}

impl Variation {
    /// By the distance from the light.
    pub(crate) fn over(radius: f64, distance: f64, halvings: u32) -> Self {
        if radius <= FAR * distance {
            Self::Even
        } else if radius > NEAR * distance && halvings < MOST_HALVINGS {
            Self::Steep
        } else {
            Self::Smooth
        }
    }
}

/// A convex piece of a receiver, in the frame of a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) first_corner: u32,
    pub(crate) corner_count: u32,
    pub(crate) weight: f64,
    pub(crate) middle: DVec3,
}

impl Piece {
    pub(crate) fn corners<'c>(&self, corners: &'c [DVec3]) -> &'c [DVec3] {
        &corners[self.first_corner as usize..][..self.corner_count as usize]
    }
}

/// Weighted mean of the middles of some pieces, and the distance of their farthest corner from it; `None` if it is in none of them, where
/// other surfaces may be.
pub(crate) fn common_middle(pieces: &[Piece], corners: &[DVec3]) -> Option<(DVec3, f64)> {
    let middle = mean(pieces);
    let within = pieces.iter().any(|p| contains(p.corners(corners), middle));
    let all = || pieces.iter().flat_map(|p| p.corners(corners));
    within.then(|| (middle, all().map(|&c| c.distance(middle)).fold(0.0, f64::max)))
}

/// Divides two or more pieces by the sides of their mean that they are on, across their longest extent. Returns the number of the first
/// ones.
pub(crate) fn part(pieces: &mut [Piece], corners: &[DVec3]) -> usize {
    let middle = mean(pieces);
    let along = farthest(pieces.iter().flat_map(|p| p.corners(corners)), middle) - middle;
    let key = |p: &Piece| along.dot(p.middle - middle);
    pieces.sort_by(|a, b| key(a).total_cmp(&key(b)));
    let first = pieces.partition_point(|p| key(p) < 0.0);
    // Where all have the same middle, any division does.
    if first == 0 || first == pieces.len() { pieces.len() / 2 } else { first }
}

pub(crate) fn weight(pieces: &[Piece]) -> f64 {
    pieces.iter().map(|p| p.weight).sum()
}

fn mean(pieces: &[Piece]) -> DVec3 {
    let first = pieces[0].middle;
    first + pieces.iter().map(|p| (p.middle - first) * p.weight).sum::<DVec3>() / weight(pieces)
}

/// Whether a point of a convex polygon's plane is within it; in any order of winding.
fn contains(ring: &[DVec3], point: DVec3) -> bool {
    let size2 = ring.iter().map(|c| c.distance_squared(ring[0])).fold(0.0, f64::max);
    let crosses = ring.iter().zip(ring.iter().cycle().skip(1)).map(|(&a, &b)| (b - a).cross(point - a));
    let longest = |m: DVec3, c: DVec3| if c.length_squared() > m.length_squared() { c } else { m };
    let axis = crosses.clone().fold(DVec3::ZERO, longest).normalize_or_zero();
    let mut turns = crosses.map(|c| c.dot(axis));
    turns.all(|turn| turn >= -SEAM * size2)
}

/// Centroid of a convex polygon in space, and the distance of its farthest corner from it.
pub(crate) fn middle(ring: &[DVec3]) -> (DVec3, f64) {
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
    (2..ring.len()).map(|k| (ring[k - 1] - ring[0]).cross(ring[k] - ring[0]).length()).sum()
}

pub(crate) fn around<'c>(corners: impl Iterator<Item = &'c DVec3>) -> (DVec3, DVec3) {
    let union = |a: (DVec3, DVec3), &c: &DVec3| (a.0.min(c), a.1.max(c));
    corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), union)
}

/// A polygon cut through its middle, across its longest extent; as [`parts`].
pub(crate) fn halves(ring: &[DVec3], middle: DVec3, eye: Option<DVec3>) -> Option<[(Vec<DVec3>, f64); 2]> {
    parts(ring, (middle, farthest(ring.iter(), middle) - middle), eye)
}

/// What of a polygon is above a plane, through a point and with this normal, and what is below: each with its share of what a viewer sees of the
/// whole. `None` if it has no area.
pub(crate) fn parts(
    ring: &[DVec3],
    (point, normal): (DVec3, DVec3),
    eye: Option<DVec3>,
) -> Option<[(Vec<DVec3>, f64); 2]> {
    let crossing = |(a, va): (DVec3, f64), (b, vb): (DVec3, f64)| a + (b - a) * share_before_crossing(va, vb);
    let parts = [1.0, -1.0].map(|sign| {
        let mut part = vec![];
        clip_ring(ring, |p| sign * normal.dot(p - point), crossing, |p| part.push(p));
        let seen = seen_area(&part, eye);
        (part, seen)
    });
    let total = parts[0].1 + parts[1].1;
    (total > 0.0).then(|| parts.map(|(part, seen)| (part, seen / total)))
}

/// The solid angle of a polygon within a pixel from where a viewer's rays meet, or its area where they are parallel, up to a factor that polygons
/// of one plane share. tan(Ω/2) of a triangle is its determinant over the sum below (Van Oosterom and Strackee 1983), and the determinant is the area
/// times the distance of the plane.
fn seen_area(ring: &[DVec3], eye: Option<DVec3>) -> f64 {
    let Some(eye) = eye else { return area(ring) };
    let solid_angle = |corners: [DVec3; 3]| {
        let [a, b, c] = corners.map(|v| v - eye);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        area(&corners) / (la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
    };
    (2..ring.len()).map(|k| solid_angle([ring[0], ring[k - 1], ring[k]])).sum()
}

/// Points of a polygon with the share of what a viewer sees of it that each stands for: exact for what is quadratic in the viewer's picture.
pub(crate) fn points(ring: &[DVec3], eye: Option<DVec3>) -> impl Iterator<Item = (DVec3, f64)> {
    let total = seen_area(ring, eye);
    (2..ring.len()).flat_map(move |k| {
        let corners = [ring[0], ring[k - 1], ring[k]];
        let share = if total > 0.0 { seen_area(&corners, eye) / total } else { 0.0 };
        (0..3).map(move |own| (within(corners, own, eye), share / 3.0))
    })
}

/// The place of a triangle that a viewer sees at barycentric coordinates of 2/3 for one corner and 1/6 for the others.
fn within(corners: [DVec3; 3], own: usize, eye: Option<DVec3>) -> DVec3 {
    let depth = |k: usize| eye.map_or(1.0, |eye| corners[k].distance(eye));
    let weights = [0, 1, 2].map(|k| depth(k) * if k == own { 4.0 } else { 1.0 });
    let [a, b, c] = corners;
    a + ((b - a) * weights[1] + (c - a) * weights[2]) / (weights[0] + weights[1] + weights[2])
}

/// The corner that is farthest from a point.
fn farthest<'c>(corners: impl Iterator<Item = &'c DVec3>, point: DVec3) -> DVec3 {
    let far =
        |a: DVec3, &b: &DVec3| if b.distance_squared(point) > a.distance_squared(point) { b } else { a };
    corners.fold(point, far)
}
