//! Direct light of lamps: points, directions, and areas that are not surfaces of the scene.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use crate::by_rays::surroundings::{LIFT, Surroundings};
use crate::error::RadiosityError;
use crate::factor;
use crate::kernel::gauss;
use crate::polygon::{Polygon, edges};
use crate::rays::sequence::{lattice, lattice_of_pairs, point_of};
use crate::rgb::{Rgb, add, is_light};
use crate::scene::Scene;
use crate::tree::{Element, ElementId};
use crate::visible::cubature;
use crate::visible::parts::{Eye, Pieces, Source};
use crate::visible::shaft::Shaft;
use pointillist_parallel as parallel;

/// Gauss points along each side of a visible piece of a patch.
const ORDER: usize = 4;
/// The same where the lamp is nearer than twice the size of the patch.
const NEAR_ORDER: usize = 10;

/// Most surfaces between a patch and a lamp whose shadows are cut exactly; past more, points of the patch are looked at.
const MOST_CUT: usize = 96;

/// The same between a patch and a lamp with an area, whose shadows take cells of many points each. Direct light of
/// `book/scenes/guests.toml` takes 1.3 s, and 9 s with 96.
const MOST_CUT_FOR_AREAS: usize = 24;

/// How many points.
const POINTS: u32 = 64;

/// How many rays between a patch and a lamp with an area, and how many more for each of these where some are blocked and some are not. Past a ball
/// of 1150 triangles the light of patches errs by at most 2.3 % of what arrives unshadowed (`regressions.rs`).
const AREA_RAYS: u32 = 256;
const IN_HALF_SHADOW: u32 = 4;

/// Irradiance at an unshadowed point with this unit normal.
pub type Irradiance<'l> = &'l (dyn Fn(DVec3, DVec3) -> Rgb + Sync);

/// A light source that is not a surface of the scene.
#[derive(Clone, Copy)]
pub enum Lamp<'l> {
    /// A point source.
    Point {
        /// Position, in the scene's coordinates.
        position: DVec3,
        /// What it gives where nothing shadows it.
        irradiance: Irradiance<'l>,
        /// Whether surfaces shadow it.
        shadow: bool,
    },
    /// A directional source.
    Directional {
        /// The way the light travels.
        direction: DVec3,
        /// What it gives where nothing shadows it.
        irradiance: Irradiance<'l>,
        /// Whether surfaces shadow it.
        shadow: bool,
    },
    /// A polygon that emits diffusely from its front and hides nothing.
    Area {
        /// Its outline.
        polygon: &'l Polygon,
        /// Exitance: power per area.
        exitance: Rgb,
        /// Whether surfaces shadow it.
        shadow: bool,
    },
}

/// A lamp's irradiance that is NaN, negative or too large.
struct NoLight {
    lamp: usize,
    value: f64,
}

impl Scene {
    /// Mean irradiance of every patch from lamps, shadows by exact clipping, in the order of patches. Patches on the edge of
    /// a shadow are divided down to [`SceneOptions::smallest_patch`](crate::SceneOptions::smallest_patch) first.
    ///
    /// # Errors
    /// [`RadiosityError::BadLamp`], [`RadiosityError::LampIrradiance`], [`RadiosityError::TooManyPatches`].
    pub fn direct(&mut self, lamps: &[Lamp<'_>]) -> Result<Vec<Rgb>, RadiosityError> {
        self.direct_with(lamps, &|_| ())
    }

    /// As [`Scene::direct`]; `done` is told the share of the work that is done (0 to 1), from any thread.
    ///
    /// # Errors
    /// As [`Scene::direct`].
    pub fn direct_with(
        &mut self,
        lamps: &[Lamp<'_>],
        done: &(dyn Fn(f64) + Sync),
    ) -> Result<Vec<Rgb>, RadiosityError> {
        for (lamp, kind) in lamps.iter().enumerate() {
            let usable = match kind {
                Lamp::Point { position, .. } => position.is_finite(),
                Lamp::Directional { direction, .. } => direction.try_normalize().is_some(),
                Lamp::Area { exitance, .. } => exitance.iter().all(|&e| is_light(e)),
            };
            if !usable {
                return Err(RadiosityError::BadLamp { lamp });
            }
        }
        let rays = Surroundings::without_patches(self);
        let mut of_element = vec![None; self.tree.elements.len()];
        loop {
            let open: Vec<ElementId> =
                self.tree.leaves().into_iter().filter(|&e| of_element[e as usize].is_none()).collect();
            if open.is_empty() {
                break;
            }
            let ended = AtomicUsize::new(0);
            let (before, all) = (of_element.iter().flatten().count(), self.tree.elements.len() as f64);
            let found = parallel::map_with(open.len(), Pieces::default, |pieces, i| {
                let lit = self.lit(open[i], lamps, &rays, pieces);
                done((before + ended.fetch_add(1, Ordering::Relaxed) + 1) as f64 / all);
                lit
            });
            for (&leaf, found) in open.iter().zip(found) {
                let (irradiance, edge) = found.map_err(|problem| self.not_lit(leaf, problem))?;
                of_element[leaf as usize] = Some(irradiance);
                let Element { size, polygon, .. } = &self.tree.elements[leaf as usize];
                let smallest = self.options.smallest_patch * self.scale;
                if edge && *size > smallest && polygon.area() > self.options.sliver(smallest) {
                    self.tree.divide(leaf);
                }
            }
            if self.tree.elements.len() > self.options.max_elements {
                return Err(RadiosityError::TooManyPatches { limit: self.options.max_elements });
            }
            of_element.resize(self.tree.elements.len(), None);
        }
        let of = |leaf: u32| of_element[leaf as usize].unwrap_or_default();
        Ok(self.tree.leaves().into_iter().map(of).collect())
    }

    /// The error for a lamp whose irradiance on a patch is NaN, negative or too large.
    fn not_lit(&self, leaf: ElementId, problem: NoLight) -> RadiosityError {
        let patch = self.tree.leaves().iter().position(|&l| l == leaf).unwrap_or_default();
        let centre = self.outward(self.tree.elements[leaf as usize].polygon.centre()).to_array();
        RadiosityError::LampIrradiance { lamp: problem.lamp, patch, centre, value: problem.value }
    }

    /// Mean irradiance of one leaf, and whether an edge of a shadow crosses it.
    fn lit(
        &self,
        leaf: ElementId,
        lamps: &[Lamp<'_>],
        rays: &Surroundings,
        pieces: &mut Pieces,
    ) -> Result<(Rgb, bool), NoLight> {
        let element = &self.tree.elements[leaf as usize];
        let mut sum = [0.0; 3];
        let mut edge = false;
        for (number, lamp) in lamps.iter().enumerate() {
            let (light, cut) = match *lamp {
                Lamp::Point { position, irradiance, shadow } => self.lit_from(
                    element,
                    Eye::Point(self.inward(position)),
                    irradiance,
                    shadow,
                    (rays, &mut *pieces),
                ),
                Lamp::Directional { direction, irradiance, shadow } => self.lit_from(
                    element,
                    Eye::Along(direction.normalize()),
                    irradiance,
                    shadow,
                    (rays, &mut *pieces),
                ),
                Lamp::Area { polygon, exitance, shadow } => {
                    (self.lit_by_area(element, (polygon, exitance), shadow, (rays, &mut *pieces)), false)
                }
            };
            edge |= cut;
            if let Some(&value) = light.iter().find(|&&l| !is_light(l)) {
                return Err(NoLight { lamp: number, value });
            }
            for (s, l) in sum.iter_mut().zip(light) {
                *s += l;
            }
        }
        Ok((sum, edge))
    }

    fn lit_from(
        &self,
        element: &Element,
        eye: Eye,
        irradiance: Irradiance<'_>,
        shadow: bool,
        (rays, pieces): (&Surroundings, &mut Pieces),
    ) -> (Rgb, bool) {
        let polygon = &element.polygon;
        let (faces, near) = match eye {
            Eye::Point(p) => {
                (polygon.height(p) > 0.0, (p - polygon.centre()).length() < 4.0 * polygon.radius())
            }
            Eye::Along(d) => (polygon.normal().dot(d) < 0.0, false),
        };
        if !faces {
            return ([0.0; 3], false);
        }
        let source = Source::new(polygon);
        let mut near_by = vec![];
        if shadow {
            self.between(eye, polygon, &mut near_by);
        }
        if near_by.len() > MOST_CUT {
            return self.sampled(polygon, eye, irradiance, rays);
        }
        let (seen, cut) = source.see(eye, near_by.iter().map(|&i| &self.occluders[i as usize]), pieces);
        let order = if near { NEAR_ORDER } else { ORDER };
        let mut sum = [0.0; 3];
        for piece in seen {
            let ring: Vec<DVec3> = piece.vertices().iter().map(|&v| source.in_space(v)).collect();
            let Some(part) = Polygon::unchecked(ring) else { continue };
            for quad in part.quads() {
                for (u, weight_u) in gauss::rule(order).iter() {
                    for (v, weight_v) in gauss::rule(order).iter() {
                        let (p, area) = gauss::on_quad(&quad, u, v);
                        let light = irradiance(self.outward(p), polygon.normal());
                        let weight = weight_u * weight_v * area / polygon.area();
                        for (s, l) in sum.iter_mut().zip(light) {
                            *s += weight * l;
                        }
                    }
                }
            }
        }
        (sum, cut && !seen.is_empty())
    }

    /// Occluders that may be between a patch and a lamp.
    fn between(&self, eye: Eye, polygon: &Polygon, found: &mut Vec<u32>) {
        let ring = polygon.vertices();
        let mut planes = vec![(-polygon.normal(), -polygon.normal().dot(polygon.centre()))];
        for (a, b) in edges(ring) {
            let normal = match eye {
                Eye::Point(p) => (b - a).cross(p - a),
                Eye::Along(d) => d.cross(b - a),
            };
            planes.push((normal, normal.dot(a)));
        }
        let mut low = ring.iter().fold(DVec3::INFINITY, |m, &v| m.min(v));
        let mut high = ring.iter().fold(DVec3::NEG_INFINITY, |m, &v| m.max(v));
        match eye {
            Eye::Point(p) => (low, high) = (low.min(p), high.max(p)),
            Eye::Along(d) => {
                low = DVec3::select(d.cmpgt(DVec3::ZERO), DVec3::NEG_INFINITY, low);
                high = DVec3::select(d.cmplt(DVec3::ZERO), DVec3::INFINITY, high);
            }
        }
        self.boxes.in_planes(&planes, (low, high), MOST_CUT + 1, found);
    }

    /// As [`Scene::lit_from`], where so much is between that points are looked at in the place of outlines.
    fn sampled(
        &self,
        polygon: &Polygon,
        eye: Eye,
        irradiance: Irradiance<'_>,
        rays: &Surroundings,
    ) -> (Rgb, bool) {
        let normal = polygon.normal();
        let (mut sum, mut seen) = ([0.0; 3], 0);
        for k in 0..POINTS {
            let at = point_of(polygon.vertices(), lattice(k, [0.5; 2]));
            let from = at + normal * LIFT;
            let hidden = match eye {
                Eye::Point(p) => rays.is_blocked(from, p),
                Eye::Along(d) => rays.is_shaded(from, -d),
            };
            if !hidden {
                seen += 1;
                sum = add(sum, 1.0 / f64::from(POINTS), irradiance(self.outward(at), normal));
            }
        }
        (sum, seen > 0 && seen < POINTS)
    }

    /// Past more than [`MOST_CUT_FOR_AREAS`] surfaces, exact but for the shadows, which rays find: what each
    /// surface hides is cut by all those before it.
    fn lit_by_area(
        &self,
        element: &Element,
        (lamp, exitance): (&Polygon, Rgb),
        shadow: bool,
        (rays, pieces): (&Surroundings, &mut Pieces),
    ) -> Rgb {
        let near = lamp.moved(self.by, self.scale);
        let shaft = Shaft::new(&element.polygon, &near).with_planes();
        let list = if shadow { self.boxes.in_shaft(&shaft, &self.occluders) } else { vec![] };
        let is_crowded = list.len() > MOST_CUT_FOR_AREAS;
        let cut = if is_crowded { &[][..] } else { &list };
        let all: Vec<&Polygon> = cut.iter().map(|&i| &self.occluders[i as usize]).collect();
        let goal = self.options.factors.goal(element.polygon.area(), 1);
        let (mutual, _) = cubature::mutual(&element.polygon, &near, &all, goal, pieces);
        let share = factor::of_mutual(mutual, element.polygon.area()).value;
        let open = if is_crowded && share > 0.0 { open_share(&element.polygon, &near, rays) } else { 1.0 };
        exitance.map(|e| e * share * open)
    }
}

/// The share of the light from a lamp to a patch that arrives, by [`AREA_RAYS`] between points spread evenly over both, or
/// [`IN_HALF_SHADOW`] times as many.
fn open_share(patch: &Polygon, lamp: &Polygon, rays: &Surroundings) -> f64 {
    let (mut arriving, mut sent) = (0.0, 0.0);
    for k in 0..AREA_RAYS * IN_HALF_SHADOW {
        if k == AREA_RAYS && (arriving == 0.0 || arriving == sent) {
            break;
        }
        let [on_patch, on_lamp] = lattice_of_pairs(k);
        let from = point_of(patch.vertices(), on_patch);
        let to = point_of(lamp.vertices(), on_lamp);
        let way = to - from;
        let cosines = patch.normal().dot(way).max(0.0) * (-lamp.normal().dot(way)).max(0.0);
        if cosines <= 0.0 {
            continue;
        }
        let weight = cosines / way.length_squared().powi(2);
        sent += weight;
        arriving += if rays.is_blocked(from + patch.normal() * LIFT, to) { 0.0 } else { weight };
    }
    // Where no point of the patch sees the front of the lamp, what the whole patch gets is next to nothing.
    if sent > 0.0 { arriving / sent } else { 0.0 }
}
