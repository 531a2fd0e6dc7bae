//! Range scans of a known surface, with the faults of scanners.

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

use crate::common::true_surface::Surface;

/// Steepest incidence that a scanner measures.
const MOST_INCIDENCE_DEG: f64 = 75.0;

/// Neighbouring rays whose depths differ by more spacings have a step between them.
const STEP: f64 = 5.0;

/// What a scanner gets wrong; nothing by default.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Faults {
    /// Standard deviation of depth along the scan, in spacings.
    pub(crate) noise: f64,
    /// Standard deviation of each scan's shift, and of what its turn moves at the far end, in spacings.
    pub(crate) registration: f64,
    /// Points anywhere in the box, per point of the surface.
    pub(crate) outliers: f64,
    /// Share of the points beside a depth step that are a mean of both sides.
    pub(crate) flying: f64,
}

/// What a perfect scanner measures from each of several directions.
pub(crate) struct Survey {
    grids: Vec<Grid>,
    low: DVec3,
    high: DVec3,
    /// Between neighbouring rays, in world units.
    pub(crate) spacing: f64,
}

/// A scan as its caller gets it.
pub(crate) struct RangeScan {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) towards_scanner: DVec3,
}

/// Depths along a square grid of parallel rays, +∞ where they miss or are too steep.
struct Grid {
    towards: DVec3,
    /// Start of the first ray, and the steps to the next one in its row and column.
    origin: DVec3,
    right: DVec3,
    up: DVec3,
    side: usize,
    depths: Vec<f64>,
}

/// Eight directions around the object, from a little above and from its height, one from the top and
/// one from below.
fn directions() -> Vec<DVec3> {
    let around = |azimuth_deg: f64, elevation_deg: f64| {
        let ((s, c), (up, flat)) = (azimuth_deg.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
        DVec3::new(s * flat, up, c * flat)
    };
    let mut list: Vec<_> =
        (0..8).map(|k| around(45.0 * f64::from(k), if k % 2 == 0 { 0.0 } else { 30.0 })).collect();
    list.extend([around(20.0, 80.0), around(30.0, -40.0)]);
    list
}

impl Survey {
    /// Casts rays from ten directions, so far apart that about `points` points come out.
    pub(crate) fn new(surface: &Surface, points: usize) -> Self {
        const COARSE: f64 = 100.0;
        let try_spacing = surface.diagonal() / COARSE;
        let found: usize =
            directions().into_iter().map(|d| Grid::cast(surface, d, try_spacing).count()).sum();
        let spacing = try_spacing * (found as f64 / points as f64).sqrt();
        let grids = directions().into_iter().map(|d| Grid::cast(surface, d, spacing)).collect();
        Self { grids, low: surface.low, high: surface.high, spacing }
    }

    /// The same scans with faults; equal seeds give equal scans.
    pub(crate) fn measured(&self, faults: Faults, seed: u64) -> Vec<RangeScan> {
        self.grids.iter().enumerate().map(|(i, g)| self.scan(g, faults, seed + 1000 * i as u64)).collect()
    }

    /// Whether any scan has a ray that ends within two spacings of `p`.
    pub(crate) fn saw(&self, p: DVec3) -> bool {
        self.grids.iter().any(|g| g.saw(p, self.spacing))
    }

    fn scan(&self, grid: &Grid, faults: Faults, seed: u64) -> RangeScan {
        let mut random = Random(seed);
        let (centre, radius) = (0.5 * (self.low + self.high), 0.5 * self.low.distance(self.high));
        let amount = faults.registration * self.spacing;
        let (shift, turn) = (random.gaussians() * amount, random.gaussians() * (amount / radius));
        let turn = DMat3::from_axis_angle(turn.normalize_or(DVec3::X), turn.length());
        let mut positions = vec![];
        for i in (0..grid.depths.len()).filter(|i| grid.depths[*i] < f64::INFINITY) {
            let mut depth = grid.depths[i];
            if random.uniform() < faults.flying
                && let Some(other) = grid.across_a_step(i, STEP * self.spacing)
            {
                depth = 0.5 * (depth + other);
            }
            depth += random.gaussians().x * faults.noise * self.spacing;
            positions.push(centre + shift + turn * (grid.position(i, depth) - centre));
        }
        let size = self.high - self.low;
        for _ in 0..(faults.outliers * positions.len() as f64) as usize {
            let place = DVec3::new(random.uniform(), random.uniform(), random.uniform());
            positions.push(self.low + place * size);
        }
        RangeScan { positions, towards_scanner: grid.towards }
    }
}

impl Grid {
    fn cast(surface: &Surface, towards: DVec3, spacing: f64) -> Self {
        let right = DVec3::Y.cross(towards).normalize();
        let up = towards.cross(right);
        let half = 0.5 * surface.diagonal();
        let side = (2.0 * half / spacing).ceil() as usize + 1;
        let corner = surface.centre() + towards * surface.diagonal() - (right + up) * half;
        let mut grid =
            Self { towards, origin: corner, right: right * spacing, up: up * spacing, side, depths: vec![] };
        let steep = MOST_INCIDENCE_DEG.to_radians().cos();
        let depth = |i: usize| {
            let hit = surface.cast(grid.position(i, 0.0), -towards);
            hit.filter(|h| h.normal.dot(towards) >= steep).map_or(f64::INFINITY, |h| h.distance)
        };
        grid.depths = (0..side * side).into_par_iter().map(depth).collect();
        grid
    }

    fn count(&self) -> usize {
        self.depths.iter().filter(|d| **d < f64::INFINITY).count()
    }

    fn position(&self, i: usize, depth: f64) -> DVec3 {
        let (column, row) = ((i % self.side) as f64, (i / self.side) as f64);
        self.origin + column * self.right + row * self.up - depth * self.towards
    }

    fn saw(&self, p: DVec3, spacing: f64) -> bool {
        let from_origin = p - self.origin;
        let along = |step: DVec3| (from_origin.dot(step) / step.length_squared()).round() as usize;
        let (column, row) = (along(self.right), along(self.up));
        let depth = self.depths.get(row * self.side + column);
        depth.is_some_and(|d| (d + from_origin.dot(self.towards)).abs() < 2.0 * spacing)
    }

    /// Depth of a neighbour that lies on the other side of a step.
    fn across_a_step(&self, i: usize, step: f64) -> Option<f64> {
        let neighbours = [i.wrapping_sub(1), i + 1, i.wrapping_sub(self.side), i + self.side];
        let depths = neighbours.into_iter().filter_map(|n| self.depths.get(n)).copied();
        depths.filter(|d| d.is_finite()).find(|d| (d - self.depths[i]).abs() > step)
    }
}

/// Steele, Lea and Flood's SplitMix64.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// 0 to 1.
    fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Box and Muller's, three at a time.
    fn gaussians(&mut self) -> DVec3 {
        let mut pair = || {
            let length = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
            let (s, c) = (TAU * self.uniform()).sin_cos();
            (length * s, length * c)
        };
        let ((x, y), (z, _)) = (pair(), pair());
        DVec3::new(x, y, z)
    }
}
