//! The convex pieces of a receiver: where they are asked, and how they are halved.

use glam::DVec3;
use pointillist_dice::{clip_ring, share_before_crossing};

/// Points this close to a piece are in it, relative to its size: pieces that share an edge have no gap between them.
const SEAM: f64 = 1e-9;

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

pub(crate) fn area(ring: &[DVec3]) -> f64 {
    ring.get(1..)
        .unwrap_or_default()
        .windows(2)
        .map(|p| (p[0] - ring[0]).cross(p[1] - ring[0]).length())
        .sum()
}

pub(crate) fn around<'c>(corners: impl Iterator<Item = &'c DVec3>) -> (DVec3, DVec3) {
    let union = |a: (DVec3, DVec3), &c: &DVec3| (a.0.min(c), a.1.max(c));
    corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), union)
}

/// A polygon cut through its middle, across its longest extent.
pub(crate) fn halves(ring: &[DVec3], middle: DVec3) -> [Vec<DVec3>; 2] {
    let along = farthest(ring.iter(), middle) - middle;
    let crossing = |(a, va): (DVec3, f64), (b, vb): (DVec3, f64)| a + (b - a) * share_before_crossing(va, vb);
    [1.0, -1.0].map(|sign| {
        let mut half = vec![];
        clip_ring(ring, |p| sign * along.dot(p - middle), crossing, |p| half.push(p));
        half
    })
}

/// The corner that is farthest from a point.
fn farthest<'c>(corners: impl Iterator<Item = &'c DVec3>, point: DVec3) -> DVec3 {
    let far =
        |a: DVec3, &b: &DVec3| if b.distance_squared(point) > a.distance_squared(point) { b } else { a };
    corners.fold(point, far)
}
