//! How large a disc must be so that no gap stays between it and its neighbours' discs.
//!
//! On a plane, discs leave no gap exactly if each reaches to the farthest corner of its point's Voronoi cell: the place
//! that is as near to two neighbours, the farthest that are needed. The cell is cut out of the tangent plane, neighbour
//! by neighbour, up to the distance at which none can cut any more.

use crate::SurfacePoint;
use crate::eliminate::OTHER_SIDE;
use crate::neighbours::{Near, Places, Sides};
use crate::rows::Rows;
use glam::{DVec2, DVec3, Vec3};
use pointillist_parallel as parallel;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Corners of the square that a cell begins as, and of what the cell is cut to where it has no neighbours.
const SQUARE: [DVec2; 4] =
    [DVec2::new(1.0, 1.0), DVec2::new(-1.0, 1.0), DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0)];

/// What is nearer to the square's side than this is on it.
const ROUNDING: f64 = 1e-9;

/// Cosine of the angle between the normals of neighbours above which their discs cover for each other: 60°. Beyond it
/// the surface has a crease between them: each side has to be covered by its own discs, but only up to the crease.
const SAME_SURFACE: f64 = 0.5;

/// Points between two calls of `done`.
const TOLD: usize = 1 << 14;

/// Parts of the reach that are tried first.
const PARTS: [f64; 2] = [1.0 / 3.0, 0.5];

/// Gives every point its radius, at most `reach`: no place of the surface is farther from its nearest point. Points on
/// a border, where no neighbours close their cells, get another. `done` is called with the share of the work that is
/// done, 0 to 1.
pub(crate) fn assign(points: &mut [SurfacePoint], reach: f64, on_border: f64, done: &(dyn Fn(f64) + Sync)) {
    let count = AtomicUsize::new(0);
    let rows = Rows::new(points.len(), reach, |i| points[i].position);
    let normals: Vec<DVec3> = rows.order().iter().map(|&i| rows.turned(points[i as usize].normal)).collect();
    let radii = parallel::map(points.len(), |place| {
        let finished = count.fetch_add(1, Ordering::Relaxed);
        if finished.is_multiple_of(TOLD) {
            done(finished as f64 / points.len() as f64);
        }
        // Most cells are small: a part of the reach finds all that cuts them, in a part of the time.
        let cell2 = |part: f64| VoronoiCell::in_rows(&rows, &normals, place, part * reach).farthest2();
        let is_closed = |part: f64, cell2: f64| cell2 <= (part * reach).powi(2);
        let early = PARTS.into_iter().map(|part| (part, cell2(part))).find(|&(part, c)| is_closed(part, c));
        let (part, cell2) = early.unwrap_or_else(|| (1.0, cell2(1.0)));
        if is_closed(part, cell2) { cell2.sqrt() } else { on_border }
    });
    for (place, radius) in radii.into_iter().enumerate() {
        points[rows.order()[place] as usize].radius = rounded_up(radius);
    }
}

/// The next number of `f32`, or the largest.
fn rounded_up(radius: f64) -> f32 {
    let near = radius as f32;
    let up = if f64::from(near) < radius { near.next_up() } else { near };
    up.min(f32::MAX)
}

/// Of a cloud, how far a disc may reach, in parts of the distance of its point's [`REACH_RANK`]th neighbour. Cells of
/// lattices, also of those four times as long as wide, reach to 0.5 to 0.7 of it. Of a sphere of 4000 random points,
/// the most uneven there are, 0.3 % is bare with 1 and nothing with 1.5.
const REACH: f64 = 1.5;
const REACH_RANK: usize = 6;

/// No disc of a cloud is larger than this many times the median spacing, which is the distance of the [`REACH_RANK`]th
/// neighbour: enough for places six times as sparse as most are, and no more for a few points far from all others.
const MOST_MEDIANS: f64 = 4.0;

/// No disc of a cloud is larger than this many times the largest spacing of those neighbours: enough beside a scan that
/// is four times as dense, and no more for one point far from all others.
const MOST_NEIGHBOURS: f64 = 2.0;

/// How many of the nearest places are tried, until no other could cut the cell. The first closes most cells; the last
/// is for borders, where a cell stays open.
const TRIES: [usize; 3] = [14, 32, 96];

/// The radius of each point of a cloud, in the caller's order and the cloud's unit, from its normal: the discs leave no
/// gap that a disc can close which reaches no farther than 1.5 times to the point's sixth neighbour.
///
/// What lies farther from all points is a border or a hole and stays uncovered; a point on a border has about the
/// radius of one inside. Radii of points far from all others are limited by the spacing of the other points: see the
/// constants. A point whose cell no neighbour limits within reach gets half the distance to the nearest one, and at
/// most half the median spacing; a single place gets 1. All radii are normal numbers of `f32`, above 0. Points that
/// coincide and face the same way have the same radius. The result does not depend on the order of points.
///
/// `two_sided`: the sign of a normal has no meaning. `usual` is the median spacing of a larger cloud of which these are
/// some points, in the cloud's unit: it then counts in the place of theirs, and a single place gets half of it.
pub(crate) fn of_cloud(places: &Places, normals: &[Vec3], two_sided: bool, usual: Option<f64>) -> Vec<f32> {
    if places.len() < 2 {
        let radius = usual.map_or(1.0, |usual| rounded_up(0.5 * usual).max(f32::MIN_POSITIVE));
        return vec![radius; places.point_count()];
    }
    let sides = Sides::new(places, normals, two_sided);
    let discs = parallel::map(sides.len(), |side| disc(places, &sides, side));
    let mut spacings = vec![0.0; places.len()];
    discs.iter().zip(&sides.places).for_each(|(d, &place)| spacings[place as usize] = d.spacing);
    let median = usual.map_or_else(|| median(&spacings), |usual| usual * places.scale());
    let radius = |disc: &Disc| {
        let around = disc.nearest.iter().map(|&place| spacings[place as usize]).fold(0.0, f64::max);
        let own = disc.radius.unwrap_or((0.5 * disc.to_nearest).min(0.5 * median));
        // Rounded up, as for meshes; radii below the normal numbers of `f32` become the smallest of these.
        let units = own.min(MOST_NEIGHBOURS * around).min(MOST_MEDIANS * median) / places.scale();
        rounded_up(units.min(f64::from(f32::MAX))).max(f32::MIN_POSITIVE)
    };
    sides.of_points.iter().map(|&side| radius(&discs[side as usize])).collect()
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    *sorted.select_nth_unstable_by(values.len() / 2, f64::total_cmp).1
}

/// The limits that neighbours set to the disc of a point of a cloud, in units of the places.
struct Disc {
    /// None if no neighbour limits its cell within reach.
    radius: Option<f64>,
    /// Distance of the nearest neighbour.
    to_nearest: f64,
    /// Distance of the [`REACH_RANK`]th neighbour, or the last one.
    spacing: f64,
    /// Places of the neighbours up to that one; the point's own place where there are fewer.
    nearest: [u32; REACH_RANK],
}

fn disc(places: &Places, sides: &Sides, side: usize) -> Disc {
    let place = sides.places[side];
    let mut near = Vec::with_capacity(TRIES[0]);
    places.nearest(place as usize, TRIES[0], f64::INFINITY, &mut near);
    let spacing = near[REACH_RANK.min(near.len() - 1)].distance2.sqrt();
    let mut disc = Disc {
        radius: None,
        to_nearest: near[1].distance2.sqrt(),
        spacing,
        nearest: std::array::from_fn(|i| near.get(i + 1).map_or(place, |n| n.place as u32)),
    };
    let reach = REACH * spacing;
    for (i, count) in TRIES.into_iter().enumerate() {
        if i > 0 {
            places.nearest(place as usize, count, 2.0 * reach, &mut near);
        }
        let (cell, is_done) = VoronoiCell::in_cloud(places, sides, side, &near, reach);
        disc.radius = cell.farthest_within(reach);
        if is_done || near.len() < count {
            break;
        }
    }
    disc
}

/// A neighbour in the frame of its point.
struct Neighbour {
    distance2: f64,
    offset: DVec3,
    normal: DVec3,
}

/// A Voronoi cell in a tangent plane, about its point.
#[derive(Default)]
struct VoronoiCell {
    corners: Vec<DVec2>,
    scratch: Vec<DVec2>,
}

impl VoronoiCell {
    /// The cell among these neighbours, nearest first, within a square of half side `reach`. Whether there are
    /// neighbours that are too far to cut any more comes with it.
    fn among(neighbours: impl Iterator<Item = Neighbour>, normal: DVec3, reach: f64) -> (Self, bool) {
        let (right, up) = normal.any_orthonormal_pair();
        let flat = |v: DVec3| DVec2::new(right.dot(v), up.dot(v));
        let mut cell = Self { corners: SQUARE.map(|c| c * reach).to_vec(), ..Self::default() };
        for n in neighbours {
            // A neighbour at twice the distance of a corner cannot cut it off.
            if n.distance2 > 4.0 * cell.farthest2() {
                return (cell, true);
            }
            if normal.dot(n.normal) > SAME_SURFACE {
                cell.cut(flat(n.offset), 0.5 * n.distance2);
            } else {
                cell.cut_at_crease(flat(n.offset), flat(n.normal), n.offset.dot(n.normal));
            }
        }
        (cell, false)
    }

    /// The cell among all points on this side that are near enough to cut it.
    fn in_rows(rows: &Rows, normals: &[DVec3], place: usize, reach: f64) -> Self {
        let (p, normal) = (rows.at(place), normals[place]);
        let mut near = Vec::with_capacity(32);
        rows.near(p, 2.0 * reach, |other, distance2| {
            if other != place && normal.dot(normals[other]) > OTHER_SIDE {
                near.push((distance2, other));
            }
        });
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let neighbour = |(distance2, other): (f64, usize)| Neighbour {
            distance2,
            offset: rows.at(other) - p,
            normal: normals[other],
        };
        Self::among(near.into_iter().map(neighbour), normal, reach).0
    }

    /// The cell among the points of a cloud, as [`VoronoiCell::among`] gives it.
    fn in_cloud(places: &Places, sides: &Sides, side: usize, near: &[Near], reach: f64) -> (Self, bool) {
        let (place, normal) = (sides.places[side] as usize, sides.normals[side]);
        let neighbours = near.iter().filter(|n| n.place != place).flat_map(|n| {
            let offset = places.at(n.place) - places.at(place);
            let facing = sides.seen_from(normal, n.place).filter(move |s| normal.dot(s.1) > OTHER_SIDE);
            facing.map(move |(_, normal)| Neighbour { distance2: n.distance2, offset, normal })
        });
        Self::among(neighbours, normal, reach)
    }

    /// Keeps what has `x · direction ≤ limit`.
    fn cut(&mut self, direction: DVec2, limit: f64) {
        let beyond = |p: DVec2| p.dot(direction) - limit;
        if self.corners.iter().all(|&p| beyond(p) <= 0.0) {
            return;
        }
        self.scratch.clear();
        for (i, &p) in self.corners.iter().enumerate() {
            let q = self.corners[(i + 1) % self.corners.len()];
            let (bp, bq) = (beyond(p), beyond(q));
            if bp <= 0.0 {
                self.scratch.push(p);
            }
            if (bp <= 0.0) != (bq <= 0.0) {
                self.scratch.push(p + (q - p) * (bp / (bp - bq)));
            }
        }
        std::mem::swap(&mut self.corners, &mut self.scratch);
    }

    /// Keeps what lies before the line in which a neighbour's plane, with this normal and height above the point, meets
    /// this one, and never less than half the way to the neighbour.
    fn cut_at_crease(&mut self, offset: DVec2, normal: DVec2, height: f64) {
        // Zero for parallel planes, whose line is infinitely far.
        let Some(across) = normal.try_normalize() else { return };
        let line = height / normal.length();
        let (across, line) = if line < 0.0 { (-across, -line) } else { (across, line) };
        self.cut(across, line.max(0.5 * offset.length()));
    }

    /// The farthest of those corners, and of those nearest places of edges, that are less than `reach` away.
    fn farthest_within(&self, reach: f64) -> Option<f64> {
        let count = self.corners.len();
        let edges = (0..count).map(|i| (self.corners[i], self.corners[(i + 1) % count]));
        let nearest_of = |(a, b): (DVec2, DVec2)| {
            let along = b - a;
            let length2 = along.length_squared();
            let share = if length2 > 0.0 { (-a.dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
            a + along * share
        };
        let places = edges.flat_map(|edge| [edge.0, nearest_of(edge)]);
        let within = places.map(|p| p.length()).filter(|&distance| distance < (1.0 - ROUNDING) * reach);
        within.max_by(f64::total_cmp)
    }

    fn farthest2(&self) -> f64 {
        self.corners.iter().map(|p| p.length_squared()).fold(0.0, f64::max)
    }
}
