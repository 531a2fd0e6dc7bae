//! What is seen from places all over a site, for choosing probes among them and for fitting these.

use glam::DVec3;
use pointillist_shprobe::place::{self, AdaptiveOptions, Candidates, FitOptions};

use crate::common::scenes::corners;
use crate::shprobe::site::{Baked, Ground};

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Height above a surface of places that are on it: what is seen is what lights it.
pub(crate) const HEIGHT: f64 = 1e-4;

/// Positions on surfaces, with the normals there.
pub(crate) type Places = Vec<(DVec3, DVec3)>;

/// How many places beside a grid of candidates.
pub(crate) struct Counts {
    /// Further candidates where sight changes.
    pub(crate) openings: usize,
    /// In free space, only fitted to.
    pub(crate) free: usize,
    /// On surfaces, only fitted to.
    pub(crate) surfaces: usize,
}

/// Candidates, and after them what is only fitted to.
pub(crate) struct Known {
    seen: Baked,
    /// 0 in free space.
    normals: Vec<DVec3>,
}

impl Known {
    pub(crate) fn look(ground: &Ground<'_>, counts: &Counts) -> Result<Self, Fault> {
        let site = ground.site;
        let is_free = |p: &DVec3| ground.is_free(*p);
        let grid = place::grid(site.low, site.high, site.candidates);
        let mut seen = ground.look(&grid.into_iter().filter(is_free).collect::<Vec<_>>())?;
        let doors = place::near_openings(&seen.positions, &seen.distances, counts.openings, 23)?;
        seen.extend(ground.look(&doors.into_iter().filter(is_free).collect::<Vec<_>>())?);
        seen.extend(ground.look(&ground.random(counts.free, 24))?);
        let mut normals = vec![DVec3::ZERO; seen.positions.len()];
        let on = on_all(ground, counts.surfaces, 25);
        seen.extend(ground.look(&on.iter().map(|p| p.0).collect::<Vec<_>>())?);
        normals.extend(on.iter().map(|p| p.1));
        Ok(Self { seen, normals })
    }

    /// So many chosen probes, as they saw and fitted.
    pub(crate) fn adaptive(&self, count: usize, balance: f64, distances: bool) -> Result<[Baked; 2], Fault> {
        let candidates = candidates(&self.seen, &self.normals, distances);
        let options = AdaptiveOptions::DEFAULT.with_max_count(count).with_balance(balance);
        let chosen = place::adaptive(candidates, &options)?.chosen;
        let seen = self.seen.pick(chosen.iter().map(|&i| i as usize));
        let fit = FitOptions::DEFAULT.with_balance(balance);
        let fitted = Baked { radiance: place::fit(candidates, &chosen, &fit)?, ..seen.clone() };
        Ok([seen, fitted])
    }

    /// Other probes, as they saw and fitted to all that is known.
    pub(crate) fn fitted_to_all(&self, seen: Baked, distances: bool) -> Result<[Baked; 2], Fault> {
        let mut known = seen.clone();
        known.extend(self.seen.clone());
        let mut normals = vec![DVec3::ZERO; seen.positions.len()];
        normals.extend(&self.normals);
        let chosen: Vec<u32> = (0..seen.positions.len() as u32).collect();
        let candidates = candidates(&known, &normals, distances);
        let radiance = place::fit(candidates, &chosen, &FitOptions::DEFAULT)?;
        Ok([seen.clone(), Baked { radiance, ..seen }])
    }
}

fn candidates<'b>(known: &'b Baked, normals: &'b [DVec3], distances: bool) -> Candidates<'b> {
    let mut candidates = Candidates::new(&known.positions, &known.radiance).with_normals(normals);
    candidates.distances = distances.then_some(known.distances.as_slice());
    candidates
}

/// Places just above all surfaces, by area, where there is room.
pub(crate) fn on_all(ground: &Ground<'_>, count: usize, seed: u64) -> Places {
    let scene = &ground.site.scene;
    let mut sum = 0.0;
    let areas: Vec<f64> = (0..scene.mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = corners(scene, t);
            sum += 0.5 * (b - a).cross(c - a).length();
            sum
        })
        .collect();
    let place = |r: DVec3| {
        let [a, b, c] = corners(scene, areas.partition_point(|a| *a <= r.x * sum).min(areas.len() - 1));
        let (u, v) = if r.y + r.z > 1.0 { (1.0 - r.y, 1.0 - r.z) } else { (r.y, r.z) };
        let normal = (b - a).cross(c - a).normalize_or_zero();
        (a + (b - a) * u + (c - a) * v + normal * HEIGHT, normal)
    };
    let is_inside = |&(p, normal): &(DVec3, DVec3)| {
        p.cmpgt(ground.site.low).all() && p.cmplt(ground.site.high).all() && ground.is_free_above(p, normal)
    };
    let drawn = place::random(DVec3::ZERO, DVec3::ONE, 2 * count, seed);
    drawn.into_iter().map(place).filter(is_inside).take(count).collect()
}
