//! A cube map of distances as nearness, and the planes that it shows.
//!
//! In the metric of the cube, ‖x‖∞, the nearness of a plane is linear on each face, so that windows of 3×3 texels tell whether
//! what they show is flat, and which plane it is. A window across an edge or an outline does not look flat: the plane of a
//! direction is taken from a window next to it that does ([`NearCube::plane`]).

use crate::DistanceMap;
use crate::sh::{CubePoint, cube_direction, cube_point};
use glam::{DVec2, DVec3, dvec2};

/// Least distance that counts, over the mean of all: visibility is continuous also where a probe touches a surface.
const LEAST: f64 = 1e-3;

/// RMS departure from a plane, over the mean nearness, up to which a window is flat. Captures show flat walls to 1e-6; a ball that fills a
/// quarter of a face of 32² departs by 2e-3.
const FLAT: f64 = 5e-4;

/// How far from a direction windows are looked for, in texels along either axis: with less, next to an edge none lies on one
/// side of it.
const REACH: isize = 2;

/// Texels that a window may be farther away for each part of the nearness by which it shows the nearest texel better.
const MISMATCH: f64 = 20.0;

/// Nearness of the texels of a cube map, in the metric of the cube.
pub(crate) struct NearCube {
    /// Texels on a side.
    size: usize,
    texels: Vec<f64>,
}

/// A flat window: its middle on the face, its plane as in [`NearCube::plane`].
struct Window {
    middle: DVec3,
    value: f64,
    plane: DVec3,
    cost: f64,
}

impl NearCube {
    /// From distances of `6 · size²` texels, at least 0, of which none counts as more than `far`.
    pub(crate) fn new(size: usize, distances: &[f32], far: f32) -> Self {
        let area = size * size;
        let least = LEAST * mean_of(distances, far);
        let nearness = |i: usize| {
            let distance = f64::from(distances[i].min(far)).max(least);
            let way = texel_way(i / area, (i % area % size) as f64, (i % area / size) as f64, size);
            way.length() / distance
        };
        Self { size, texels: (0..6 * area).map(nearness).collect() }
    }

    /// Texels on a side.
    pub(crate) const fn size(&self) -> usize {
        self.size
    }

    /// Nearness 1/‖x‖₁ in a direction: on a face linear between the middles of texels, and beyond the outer ones.
    pub(crate) fn at(&self, way: DVec3) -> f64 {
        self.between_texels(way) * way.abs().max_element() / way.abs().element_sum()
    }

    /// The plane q·x = 1 that is met in a direction, if there is one; the nearness of a plane is q·p for ‖p‖₁ = 1.
    ///
    /// 1. Windows about the direction that are flat are found, and of these the one that is nearest and shows the nearest
    ///    texel best.
    /// 2. Where another window's plane meets this one in an edge as of a room, seen from inside, and is nearer in the direction, it is
    ///    that one: an edge does not lie midway between windows.
    pub(crate) fn plane(&self, way: DVec3) -> Option<DVec3> {
        let point = cube_point(way)?;
        let way = way / way.abs().max_element();
        let windows = self.flat_windows(&point, way);
        let mut best = windows.iter().min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        for other in &windows {
            let lower = |plane: &Window, at: &Window| plane.plane.dot(at.middle) <= at.value * (1.0 + FLAT);
            if lower(other, best) && lower(best, other) && other.plane.dot(way) > best.plane.dot(way) {
                best = other;
            }
        }
        // Beyond its horizon a plane is not met.
        (best.plane.dot(way) > 0.0).then_some(best.plane)
    }

    fn flat_windows(&self, point: &CubePoint, way: DVec3) -> Vec<Window> {
        if self.size < 3 {
            return vec![];
        }
        let at = dvec2(self.column(point.s), self.column(point.t));
        let middle =
            |v: f64, step: isize| (v.round() as isize + step).clamp(1, self.size as isize - 2) as usize;
        let steps = || -REACH..=REACH;
        let mut tried: Vec<[usize; 2]> =
            steps().flat_map(|j| steps().map(move |i| [middle(at.x, i), middle(at.y, j)])).collect();
        tried.sort_unstable();
        tried.dedup();
        let (nearest_way, nearest) = self.nearest_texel(point);
        let flat = tried.into_iter().filter_map(|middle| {
            let mut window = self.window(point.face, middle)?;
            let mismatch = (window.plane.dot(nearest_way) / nearest - 1.0) * MISMATCH;
            window.cost = (at - DVec2::from(middle.map(|v| v as f64))).length_squared() + mismatch * mismatch;
            window.plane.dot(way).is_finite().then_some(window)
        });
        flat.collect()
    }

    /// The window of 3×3 texels about one, if it is flat.
    fn window(&self, face: usize, [x, y]: [usize; 2]) -> Option<Window> {
        let value = |i: usize, j: usize| self.texel(face, x + i - 1, y + j - 1);
        let sum = |f: &dyn Fn(usize) -> f64| (0..3).map(f).sum::<f64>();
        let mean = sum(&|i| sum(&|j| value(i, j))) / 9.0;
        let along = sum(&|j| value(2, j) - value(0, j)) / 6.0;
        let down = sum(&|i| value(i, 2) - value(i, 0)) / 6.0;
        let off = |i: usize, j: usize| {
            let linear = mean + along * (i as f64 - 1.0) + down * (j as f64 - 1.0);
            (value(i, j) - linear).powi(2)
        };
        let departure = (sum(&|i| sum(&|j| off(i, j))) / 9.0).sqrt();
        if departure.is_nan() || departure > FLAT * mean {
            return None;
        }
        // On a face x = forward + s·right + t·below, and nearness is q·x.
        let to_unit = |v: usize| (2 * v + 1) as f64 / self.size as f64 - 1.0;
        let slope = dvec2(along, down) * (self.size as f64 * 0.5);
        let forward = cube_direction(CubePoint { face, s: 0.0, t: 0.0 });
        let right = cube_direction(CubePoint { face, s: 1.0, t: 0.0 }) - forward;
        let below = cube_direction(CubePoint { face, s: 0.0, t: 1.0 }) - forward;
        let ahead = mean - slope.dot(dvec2(to_unit(x), to_unit(y)));
        let plane = forward * ahead + right * slope.x + below * slope.y;
        let middle = texel_way(face, x as f64, y as f64, self.size);
        Some(Window { middle, value: mean, plane, cost: 0.0 })
    }

    /// The point ‖p‖₁ = 1 in the middle of the texel that a direction meets, and the nearness there.
    pub(crate) fn nearest(&self, way: DVec3) -> (DVec3, f64) {
        let Some(point) = cube_point(way) else { return (DVec3::X, 0.0) };
        let (way, value) = self.nearest_texel(&point);
        let sum = way.abs().element_sum();
        (way / sum, value / sum)
    }

    /// The way to the middle of the texel about a point, ‖way‖∞ = 1, and the nearness there in the metric of the cube.
    fn nearest_texel(&self, point: &CubePoint) -> (DVec3, f64) {
        let whole = |s: f64| self.column(s).round().clamp(0.0, (self.size - 1) as f64);
        let (x, y) = (whole(point.s), whole(point.t));
        (texel_way(point.face, x, y, self.size), self.texel(point.face, x as usize, y as usize))
    }

    fn texel(&self, face: usize, x: usize, y: usize) -> f64 {
        self.texels[(face * self.size + y.min(self.size - 1)) * self.size + x.min(self.size - 1)]
    }

    /// Where a coordinate of a face lies among the middles of texels.
    fn column(&self, s: f64) -> f64 {
        (s + 1.0) * 0.5 * self.size as f64 - 0.5
    }

    /// In the metric of the cube; at least 0.
    fn between_texels(&self, way: DVec3) -> f64 {
        let Some(point) = cube_point(way) else { return 0.0 };
        let split = |s: f64| {
            let x = self.column(s);
            let low = x.floor().clamp(0.0, self.size.saturating_sub(2) as f64);
            (low as usize, if self.size > 1 { x - low } else { 0.0 })
        };
        let ((x, s), (y, t)) = (split(point.s), split(point.t));
        let texel = |x: usize, y: usize| self.texel(point.face, x, y);
        let row = |y: usize| texel(x, y) + (texel(x + 1, y) - texel(x, y)) * s;
        (row(y) + (row(y + 1) - row(y)) * t).max(0.0)
    }
}

/// The way to a place among the middles of texels of a face, ‖way‖∞ = 1.
fn texel_way(face: usize, x: f64, y: f64, size: usize) -> DVec3 {
    let to_unit = |v: f64| (2.0 * v + 1.0) / size as f64 - 1.0;
    cube_direction(CubePoint { face, s: to_unit(x), t: to_unit(y) })
}

/// The mean of distances of which none counts as more than `far`; above 0.
fn mean_of(distances: &[f32], far: f32) -> f64 {
    let sum: f64 = distances.iter().map(|d| f64::from(d.min(far))).sum();
    (sum / distances.len() as f64).max(f64::from(DistanceMap::FARTHEST.recip()))
}
