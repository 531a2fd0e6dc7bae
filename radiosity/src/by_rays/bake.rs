//! Irradiance and radiosity per vertex of a scene in transport.

use std::collections::HashMap;

use glam::DVec3;

use super::gather::{BLACK, FIRST, Gathered, Gatherer, mean};
use super::neighbours::Neighbours;
use super::parts::{self, Plan};
use super::smooth::Places;
use super::solution::RaySolution;
use super::surroundings::LIFT;
use crate::bake::{Baked, INWARD};
use crate::mesh::{Facets, Mesh, Place};
use crate::rays::sequence::mix;
use crate::rgb::Rgb;
use crate::scene::Scene;
use crate::tree::ElementId;
use pointillist_parallel as parallel;

/// Places between two reports of progress.
const BLOCK: usize = 2048;
/// Where facets of a hollow surface join at a vertex, rays start this share of the shift inward off the mean plane: the tangent of the
/// largest angle that is smoothed, halved.
const HOLLOW: f64 = 0.35;
/// Rounds of division of patches, at most.
const ROUNDS: usize = 4;
/// A patch is divided if irradiance at its corners differs by more than this share of its mean, and it is not small against the distances from which light comes.
const UNEVEN: f64 = 0.18;
/// A vertex counts as covered by another surface if the distance from which its light comes is below this share of the size of its patches: in a
/// corner of three walls it is more, since rays start inward of it.
const COVERED: f64 = 0.01;
/// The size of a patch is at least this share of its longest edge: light changes along long, narrow ones, too.
const LENGTH: f64 = 0.5;
/// The size of a patch is small if it is below this share of that distance.
const SMALL: f64 = 0.25;

/// Patches smaller than this many times [`RayOptions::finest`](crate::RayOptions::finest) are details: what is asked for is the error of the mean over a square
/// of that size, in which several of them count.
const DETAIL: f64 = 2.0;
/// The error of a detail may be larger by this, at most.
const MOST_SLACK: f64 = 4.0;
/// Rays that are lacking for the error asked for are exceeded by this, since both are estimates.
const AMPLE: f64 = 1.1;
/// At least this share of a place's rays is added, at most as many as it has.
const LEAST_MORE: f64 = 0.125;

/// Where a place is and which way it faces, as far as rays are concerned, and on which side of what stands there.
type Key = [u64; 7];

impl RaySolution<'_> {
    /// Irradiance and radiosity at every vertex. Patches are divided down to
    /// [`RayOptions::finest`](crate::RayOptions::finest) where irradiance changes fast. `done` is told the share of the work that is done (0 to 1).
    /// Facets of a curved surface share vertices, whose normal is the mean of theirs.
    #[must_use]
    pub fn bake_with(&self, done: &(dyn Fn(f64) + Sync)) -> Baked {
        let (mut scene, mut direct) = self.transport.for_vertices();
        let gatherer = Gatherer::new(self);
        let mut known = Known::default();
        for round in 0..=ROUNDS {
            let leaves = scene.tree.leaves();
            let mesh = Mesh::new(&scene, &leaves, Facets::Joined(&self.transport.around));
            let shares = |share: f64| done((round as f64 + share) / (ROUNDS + 1) as f64);
            let lights = self.lights(&scene, &mesh, &gatherer, &mut known, &shares);
            let uneven =
                if round == ROUNDS { vec![] } else { self.uneven(&scene, &mesh, &lights, gatherer.floor) };
            if uneven.is_empty() {
                let mut light: Vec<Rgb> = lights.iter().map(|l| l.light).collect();
                let covered = |(place, own): (&Place, &Light)| {
                    own.reach < COVERED * sizes_around(&scene, place).fold(f64::INFINITY, f64::min)
                };
                let covered: Vec<bool> = mesh.places.iter().zip(&lights).map(covered).collect();
                mesh.lift(&covered, &mut light);
                mesh.lift_buried(&mut light);
                let direct: Vec<Rgb> = leaves.iter().map(|&l| direct[l as usize]).collect();
                return mesh.finish(&direct, &light);
            }
            for leaf in uneven {
                if scene.tree.divide(leaf) {
                    direct.resize(scene.tree.elements.len(), direct[leaf as usize]);
                }
            }
        }
        unreachable!("the last round divides nothing");
    }

    /// As [`RaySolution::bake_with`], without word of progress.
    #[must_use]
    pub fn bake(&self) -> Baked {
        self.bake_with(&|_| ())
    }

    /// Light at all places, each with as many rays as it takes with those of its neighbours.
    fn lights(
        &self,
        scene: &Scene,
        mesh: &Mesh<'_>,
        gatherer: &Gatherer<'_>,
        known: &mut Known,
        done: &dyn Fn(f64),
    ) -> Vec<Light> {
        let keys: Vec<Key> = mesh.places.iter().map(|p| key(scene, mesh, p)).collect();
        let starts: Vec<(DVec3, DVec3, u64)> =
            (0..keys.len()).map(|i| start(scene, mesh, &mesh.places[i], &keys[i])).collect();
        let positions: Vec<DVec3> = mesh.places.iter().map(|p| p.position).collect();
        let normals: Vec<DVec3> = starts.iter().map(|s| s.1).collect();
        let sides: Vec<u64> = keys.iter().map(|k| k[6]).collect();
        let mut gathered: Vec<Gathered> = keys.iter().map(|k| known.of(k)).collect();
        *known = Known::default();
        let mut open: Vec<(usize, Plan, f64)> = (0..keys.len())
            .filter(|&i| gathered[i].rays() == 0)
            .map(|i| (i, parts::even(FIRST), 0.0))
            .collect();
        let (places, around) = (Places::new(&positions, &sides), Neighbours::new(scene, mesh));
        while !open.is_empty() {
            for (number, block) in open.chunks(BLOCK).enumerate() {
                let more = parallel::map_heavy(block.len(), |k| {
                    let (i, plan, precision) = &block[k];
                    let place = starts[*i];
                    let mut own = gathered[*i];
                    if own.rays() == 0 {
                        own = gatherer.start(place.0, place.1, place.2);
                    }
                    gatherer.go_on(place, (plan, *precision), &mut own);
                    own
                });
                block.iter().zip(more).for_each(|(open, own)| gathered[open.0] = own);
                done((number * BLOCK) as f64 / open.len() as f64);
            }
            let which: Vec<usize> = open.iter().map(|open| open.0).collect();
            let seen = parallel::map(which.len(), |k| around.parts(which[k], &gathered).variances());
            for (&i, seen) in which.iter().zip(&seen) {
                gathered[i].weigh_first(gatherer.precision(seen, &parts::even(FIRST)));
            }
            let neighbours = places.smooth(&normals, &gathered, &which);
            let next = which.iter().zip(&seen).zip(neighbours).filter_map(|((&i, seen), (light, error))| {
                let aim = mean(light).max(gatherer.floor) * self.tolerance(scene, &mesh.places[i]);
                let lit = mean(light) > BLACK * gatherer.floor;
                let plan = seen.plan(self.more_rays(gathered[i].rays(), error / aim, lit)?);
                Some((i, plan, gatherer.precision(seen, &plan)))
            });
            open = next.collect();
        }
        let all: Vec<usize> = (0..gathered.len()).collect();
        let lights = places.smooth(&normals, &gathered, &all);
        let light =
            |((light, error), own): ((Rgb, f64), &Gathered)| Light { light, error, reach: own.reach() };
        let lights = lights.into_iter().zip(&gathered).map(light).collect();
        known.places = keys.into_iter().zip(0..).collect();
        known.gathered = gathered;
        lights
    }

    /// Relative error of the light at a place: larger where all patches around it are details.
    fn tolerance(&self, scene: &Scene, place: &Place) -> f64 {
        let options = &self.transport.options;
        let size = sizes_around(scene, place).fold(f64::MIN_POSITIVE, f64::max);
        // Infinite where patches are not divided for drawing: then there are no details.
        let detail = if options.finest.is_finite() { DETAIL * options.finest * scene.scale } else { 0.0 };
        options.tolerance * (detail / size).clamp(1.0, MOST_SLACK)
    }

    /// How many more rays a place takes that has so many, whose error is so large against what is asked for.
    fn more_rays(&self, rays: u32, error: f64, lit: bool) -> Option<u32> {
        let first = rays == FIRST && lit;
        let left = self.transport.options.most_rays.saturating_sub(rays);
        if left < FIRST || (error <= 1.0 && !first) {
            return None;
        }
        let share = if first { 1.0 } else { (AMPLE * error * error - 1.0).clamp(LEAST_MORE, 1.0) };
        Some(((f64::from(rays) * share) as u32).clamp(FIRST, left))
    }

    /// Leaves over which irradiance changes too fast to be interpolated.
    fn uneven(&self, scene: &Scene, mesh: &Mesh<'_>, lights: &[Light], floor: f64) -> Vec<ElementId> {
        let smallest = self.transport.options.finest * scene.scale;
        let is_uneven = |(leaf, ring, _): &(ElementId, Vec<u32>, Option<u32>)| {
            let element = &scene.tree.elements[*leaf as usize];
            let at = || ring.iter().map(|&place| &lights[place as usize]);
            let reach = at().fold(f64::INFINITY, |m, l| m.min(l.reach));
            // Of two thirds of a square's side for an equilateral triangle of that edge; long ones are divided for their length.
            let size = element.polygon.area().sqrt().max(LENGTH * element.size);
            if size <= smallest || size < SMALL * reach {
                return false;
            }
            let low = at().fold(f64::INFINITY, |m, l| m.min(mean(l.light) + l.error));
            let high = at().fold(0.0, |m: f64, l| m.max(mean(l.light) - l.error));
            high - low > UNEVEN * (0.5 * (low + high)).max(floor)
        };
        let room = scene.options.max_elements.saturating_sub(scene.tree.elements.len()) / 4;
        mesh.rings.iter().filter(|r| is_uneven(r)).map(|r| r.0).take(room).collect()
    }
}

/// What the places of the last round have gathered. It is large, and there is one of it.
#[derive(Default)]
struct Known {
    places: HashMap<Key, u32>,
    gathered: Vec<Gathered>,
}

impl Known {
    fn of(&self, key: &Key) -> Gathered {
        self.places.get(key).map_or_else(Gathered::default, |&place| self.gathered[place as usize])
    }
}

/// What is known of a place.
struct Light {
    light: Rgb,
    /// Standard error of the mean of the bands.
    error: f64,
    /// Harmonic mean of the distances from which light comes.
    reach: f64,
}

/// Sizes of the patches around a place: sides of squares of their areas.
fn sizes_around(scene: &Scene, place: &Place) -> impl Iterator<Item = f64> {
    place.leaves.iter().map(|&leaf| scene.tree.elements[leaf as usize].polygon.area().sqrt())
}

fn key(scene: &Scene, mesh: &Mesh<'_>, place: &Place) -> Key {
    // Patches are added to places in another order after a division, which rounds the sum of normals differently.
    let normal = (mesh.normal(place) * 1e6).round();
    let [x, y, z] = (place.position + 0.0).to_array().map(f64::to_bits);
    let [u, v, w] = (normal + 0.0).to_array().map(f64::to_bits);
    let side = |leaf: &ElementId| u64::from(scene.tree.elements[*leaf as usize].side) + 1;
    let side = if place.parted { place.leaves.iter().map(side).min().unwrap_or_default() } else { 0 };
    [x, y, z, u, v, w, side]
}

/// Where the rays of a place start: towards the middle of its patches, and off them.
fn start(scene: &Scene, mesh: &Mesh<'_>, place: &Place, key: &Key) -> (DVec3, DVec3, u64) {
    let normal = mesh.normal(place);
    let of = |leaf: &ElementId| &scene.tree.elements[*leaf as usize].polygon;
    let centre = place.leaves.iter().map(|l| of(l).centre()).sum::<DVec3>() / place.leaves.len() as f64;
    let way = (centre - place.position) * INWARD;
    let shift = way - normal * normal.dot(way);
    let curved = place.leaves.iter().any(|l| of(l).normal().dot(normal) < 1.0 - 1e-9);
    let lift = LIFT + if curved { HOLLOW * shift.length() } else { 0.0 };
    (
        place.position + shift + normal * lift,
        normal,
        key[..6].iter().fold(0, |m, bits| mix(m ^ bits)) ^ key[6],
    )
}
