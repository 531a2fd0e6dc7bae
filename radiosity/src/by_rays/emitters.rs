//! Light of surfaces that emit: they are small and bright, and are not left to chance hits of rays.
//!
//! At a point, each emitter's share of the hemisphere is Lambert's formula; how much of it is visible is found by rays to points that are spread over it,
//! more for those that give more.

use glam::DVec3;
use pointillist_dice::lambert;

use super::surroundings::Surroundings;
use crate::kernel::pair;
use crate::polygon::Polygon;
use crate::rays::sequence::{lattice, point_of};
use crate::rgb::{Rgb, add};
use crate::scene::Scene;

/// Most emitters that are looked at from every place; those of less power are found by rays only.
const MOST: usize = 1024;
/// Rays of a place, shared by the emitters by what they give.
const RAYS: f64 = 24.0;
/// Emitters nearer than this many times the radii of both have their exact share of a patch.
const NEAR: f64 = 2.0;
/// Points of a patch where it is lit by emitters farther away.
const POINTS: u32 = 8;
/// Relative error of an exact share.
const EXACT: f64 = 1e-6;

/// The emitters of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Emitters {
    list: Vec<Emitter>,
    /// Whether each side is in the list.
    pub(crate) known: Vec<bool>,
}

#[derive(Clone, Debug)]
struct Emitter {
    polygon: Polygon,
    emission: Rgb,
}

impl Emitters {
    pub(crate) fn new(scene: &Scene) -> Self {
        let sum = |e: Rgb| e.iter().sum::<f64>();
        let mut power = vec![0.0; scene.sides.len()];
        for &root in &scene.tree.roots {
            let element = &scene.tree.elements[root as usize];
            power[element.side as usize] +=
                element.polygon.area() * sum(scene.sides[element.side as usize].emission);
        }
        let mut order: Vec<usize> = (0..power.len()).filter(|&i| power[i] > 0.0).collect();
        order.sort_by(|&a, &b| power[b].total_cmp(&power[a]).then(a.cmp(&b)));
        order.truncate(MOST);
        let mut known = vec![false; power.len()];
        order.iter().for_each(|&side| known[side] = true);
        let of = |&root: &u32| {
            let element = &scene.tree.elements[root as usize];
            let emission = scene.sides[element.side as usize].emission;
            known[element.side as usize].then(|| Emitter { polygon: element.polygon.clone(), emission })
        };
        let list = scene.tree.roots.iter().filter_map(of).collect();
        Self { list, known }
    }

    /// Irradiance at a point that lies in front of its surface.
    pub(crate) fn at(&self, around: &Surroundings, point: DVec3, normal: DVec3, shift: [f64; 2]) -> Rgb {
        let share = |e: &Emitter| {
            if e.polygon.height(point) <= 0.0 {
                return 0.0;
            }
            lambert::share_above_horizon(point, normal, e.polygon.vertices()).max(0.0)
        };
        let shares: Vec<f64> = self.list.iter().map(share).collect();
        let light = |i: usize| shares[i] * self.list[i].emission.iter().sum::<f64>();
        let whole: f64 = (0..shares.len()).map(light).sum();
        let mut sum = [0.0; 3];
        for (i, emitter) in self.list.iter().enumerate() {
            if shares[i] > 0.0 {
                let rays = (RAYS * light(i) / whole).ceil().clamp(1.0, RAYS) as u32;
                let seen = emitter.seen_from(around, (point, normal), rays, shift);
                sum = add(sum, shares[i] * seen, emitter.emission);
            }
        }
        sum
    }

    /// Mean irradiance of a patch.
    pub(crate) fn on(&self, around: &Surroundings, patch: &Polygon, lift: f64, shift: [f64; 2]) -> Rgb {
        let mut sum = [0.0; 3];
        let normal = patch.normal();
        for emitter in &self.list {
            let distance = (emitter.polygon.centre() - patch.centre()).length();
            let near = distance < NEAR * (emitter.polygon.radius() + patch.radius());
            let (mut open, mut seen) = (0.0, 0.0);
            for k in 0..POINTS {
                let point = point_of(patch.vertices(), lattice(k, shift)) + normal * lift;
                if emitter.polygon.height(point) <= 0.0 {
                    continue;
                }
                let share = lambert::share_above_horizon(point, normal, emitter.polygon.vertices()).max(0.0);
                if share > 0.0 {
                    let turned = [shift[0] + f64::from(k) * 0.618_034, shift[1] + f64::from(k) * 0.324_718];
                    open += share;
                    seen += share * emitter.seen_from(around, (point, normal), 3, turned);
                }
            }
            let mean = if near {
                let exact = pair::mutual(patch, &emitter.polygon, EXACT).value / patch.area();
                exact.max(0.0) * if open > 0.0 { seen / open } else { 1.0 }
            } else {
                seen / f64::from(POINTS)
            };
            sum = add(sum, mean, emitter.emission);
        }
        sum
    }
}

impl Emitter {
    /// Which part of its light reaches a point.
    fn seen_from(
        &self,
        around: &Surroundings,
        (point, normal): (DVec3, DVec3),
        rays: u32,
        shift: [f64; 2],
    ) -> f64 {
        let (mut all, mut seen) = (0.0, 0.0);
        for k in 0..rays {
            let target = point_of(self.polygon.vertices(), lattice(k, shift));
            let way = target - point;
            let weight = normal.dot(way).max(0.0) * self.polygon.normal().dot(-way).max(0.0)
                / way.length_squared().powi(2);
            if weight > 0.0 && weight.is_finite() {
                all += weight;
                seen += if around.is_blocked(point, target) { 0.0 } else { weight };
            }
        }
        if all > 0.0 { seen / all } else { 1.0 }
    }
}
