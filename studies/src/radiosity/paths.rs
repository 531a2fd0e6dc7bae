//! Light by paths at points of a building, in two halves that are drawn apart, so that its own noise can be told from an error.

use glam::DVec3;
use pointillist_radiosity::invariants::paths::Paths;
use pointillist_radiosity::{Lamp, Surface};
use rayon::prelude::*;

use crate::common::ray_reference::random;

/// Points at which light is compared.
pub(crate) const POINTS: usize = 500;
/// Paths of each, in either half.
pub(crate) const PATHS: usize = 1024;
/// Points darker than this share of the mean are left out: most are inside walls.
const DARK: f64 = 0.02;
/// So are points that another surface covers at less than this share of the scene's size.
const COVERED: f64 = 1e-4;
/// Most points that are looked at for each that is chosen, and paths of a look.
const LOOKS: usize = 12;
const LOOK_PATHS: usize = 49;
/// Rays start this far off their surface, as a share of the scene's size.
const OFF: f64 = 1e-6;
/// Share of the points that are the worst.
const WORST: f64 = 0.05;
/// Groups of points whose errors are compared.
const GROUPS: usize = 10;

/// A point of one side of a surface.
pub(crate) struct Point {
    pub(crate) surface: usize,
    pub(crate) front: bool,
    pub(crate) at: DVec3,
    pub(crate) normal: DVec3,
}

/// Points and their light.
pub(crate) struct Reference {
    pub(crate) points: Vec<Point>,
    /// Mean of the bands, by either half of the paths.
    halves: Vec<[f64; 2]>,
    /// How far off their surfaces points are looked from.
    pub(crate) lift: f64,
}

/// Root mean squares.
pub(crate) struct Error {
    /// Over the root mean square of the light.
    pub(crate) relative: f64,
    /// Standard error of that.
    pub(crate) doubt: f64,
    /// Without the points of the largest errors, a twentieth of all.
    pub(crate) without_worst: f64,
    /// Over the mean of the light.
    pub(crate) to_mean: f64,
    /// Of the mean of both halves, over the root mean square of the light.
    pub(crate) noise: f64,
}

impl Reference {
    /// At points that are spread over all sides of surfaces by area.
    pub(crate) fn new(surfaces: &[Surface], paths: &Paths<'_>) -> Self {
        let mean = |v: [f64; 3]| v.iter().sum::<f64>() / 3.0;
        let candidates = spread(surfaces, LOOKS * POINTS);
        let looked: Vec<f64> = candidates
            .par_iter()
            .map(|p| match paths.clearance(p.at, p.normal) > COVERED {
                true => mean(paths.irradiance(p.at, p.normal, LOOK_PATHS, 1).0),
                false => 0.0,
            })
            .collect();
        let lit = looked.iter().filter(|&&l| l > 0.0).count().max(1);
        let usual = looked.iter().sum::<f64>() / lit as f64;
        let chosen = candidates.into_iter().zip(looked).filter(|(_, light)| *light > DARK * usual);
        let points: Vec<Point> = chosen.map(|(point, _)| point).take(POINTS).collect();
        let half = |p: &Point, seed: usize| mean(paths.irradiance(p.at, p.normal, PATHS, seed as u64).0);
        let both = |(k, p): (usize, &Point)| [half(p, 2 * k + 7), half(p, 2 * k + 8)];
        let halves = points.par_iter().enumerate().map(both).collect();
        Self { points, halves, lift: OFF * size_of(surfaces) }
    }

    /// Of the `light` that is said to arrive at a surface, on its front or not, at a position.
    pub(crate) fn error(&self, light: &dyn Fn(usize, bool, DVec3) -> f64) -> Error {
        let lights: Vec<f64> = self.points.iter().map(|p| light(p.surface, p.front, p.at)).collect();
        self.error_of(&lights)
    }

    /// Of the light that is said to arrive at each point.
    pub(crate) fn error_of(&self, lights: &[f64]) -> Error {
        let mut groups = [[0.0; 5]; GROUPS];
        let mut products = vec![];
        for (k, (found, [a, b])) in lights.iter().zip(&self.halves).enumerate() {
            let own = [(found - a) * (found - b), a * b, 0.5 * (a + b), 0.25 * (a - b) * (a - b), 1.0];
            groups[k % GROUPS].iter_mut().zip(own).for_each(|(s, o)| *s += o);
            products.push(own[0]);
        }
        products.sort_by(f64::total_cmp);
        products.truncate(products.len() - (WORST * products.len() as f64) as usize);
        let [off, squares, total, noise, count] =
            groups.iter().fold([0.0; 5], |m, s| [0, 1, 2, 3, 4].map(|i| m[i] + s[i]));
        let relative = (off / squares).max(0.0).sqrt();
        // Standard error of the sum over groups, through the square root.
        let apart = groups.iter().map(|g| (g[0] - relative * relative * g[1]).powi(2)).sum::<f64>();
        let spread = (apart * GROUPS as f64 / (GROUPS - 1) as f64).sqrt() / squares;
        Error {
            relative,
            doubt: spread / (2.0 * relative.max(1e-9)),
            without_worst: (products.iter().sum::<f64>() / squares).max(0.0).sqrt(),
            to_mean: (off / count).max(0.0).sqrt() / (total / count),
            noise: (noise / squares).sqrt(),
        }
    }
}

/// Points on surfaces, by area, on sides that are lit at all.
fn spread(surfaces: &[Surface], count: usize) -> Vec<Point> {
    let area = |s: &Surface| (1..s.vertices.len() - 1).map(|i| cross(&s.vertices, i).length()).sum::<f64>();
    let mut sums = vec![];
    let mut whole = 0.0;
    for surface in surfaces {
        whole += area(surface);
        sums.push(whole);
    }
    let mut state = 0x1234_5678_9abc_def1;
    let mut point = |_| {
        let wanted = random(&mut state) * whole;
        let surface = sums.partition_point(|&s| s < wanted).min(sums.len() - 1);
        let ring = &surfaces[surface].vertices;
        let i = 1 + (random(&mut state) * (ring.len() - 2) as f64) as usize;
        let (x, y) = (random(&mut state).sqrt(), random(&mut state));
        let at = ring[0] * (1.0 - x) + ring[i] * (x * (1.0 - y)) + ring[i + 1] * (x * y);
        let front = !surfaces[surface].two_sided || random(&mut state) < 0.5;
        let normal = cross(ring, i).normalize_or_zero() * if front { 1.0 } else { -1.0 };
        Point { surface, front, at, normal }
    };
    (0..count).map(&mut point).collect()
}

fn cross(ring: &[DVec3], i: usize) -> DVec3 {
    (ring[i] - ring[0]).cross(ring[i + 1] - ring[0])
}

/// Longest side of the box around all surfaces.
pub(crate) fn size_of(surfaces: &[Surface]) -> f64 {
    let all = surfaces.iter().flat_map(|s| &s.vertices);
    let (low, high) = all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    (high - low).max_element()
}

/// How near and how closed what is around the point lamps is.
pub(crate) fn room_around(surfaces: &[Surface], lamps: &[Lamp<'_>]) -> String {
    const WAYS: usize = 400;
    let paths = Paths::new(surfaces, &[]);
    let size = size_of(surfaces);
    let mut list = vec![];
    for lamp in lamps {
        let Lamp::Point { position, .. } = lamp else { continue };
        let mut state = 0x9e37_79b9_7f4a_7c15;
        let way = |_| {
            let z = 1.0 - 2.0 * random(&mut state);
            let (sine, cosine) = (std::f64::consts::TAU * random(&mut state)).sin_cos();
            let flat = (1.0 - z * z).sqrt();
            paths.clearance(*position, DVec3::new(flat * cosine, z, flat * sine))
        };
        let ways: Vec<f64> = (0..WAYS).map(way).collect();
        let met = ways.iter().filter(|d| d.is_finite()).count() as f64 / WAYS as f64;
        let nearest = ways.iter().copied().fold(f64::INFINITY, f64::min);
        list.push(format!("{:.0} % of all directions meet a surface, the nearest {:.3} of the longest side ({:.3} in its unit) away", 100.0 * met, nearest, nearest * size));
    }
    list.join(", ")
}
