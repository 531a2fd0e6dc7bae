//! A scene's lights as lamps of radiosity.

use crate::emitters::{Side, emitting_polygons};
use crate::radiosity_surfaces::{bands, direct_radiances};
use crate::scene::Scene;
use glam::DVec3;
use pointillist_radiosity::{Lamp, Polygon};
use pointillist_shade::{Falloff, Light, Source};
use std::f64::consts::PI;

type Arrives = Box<dyn Fn(DVec3, DVec3) -> [f64; 3] + Sync>;

/// The lights of a scene for `pointillist-radiosity`, whose [`Lamp`]s borrow from this; [`with_lamps`] hands them out.
pub struct Lamps {
    parts: Vec<Part>,
}

enum Part {
    /// A point or a direction, with what arrives from it.
    Sample(Source, Arrives, bool),
    /// A light with an area, and its exitance.
    Area(Polygon, [f64; 3], bool),
}

impl Lamps {
    /// All lights of a scene. A rectangle or a polygon with the inverse-square law is one [`Lamp::Area`] for each side, or none if its area is 0, which sends out
    /// nothing; one with another law is its sample points, as in [`crate::render`]. The polygons of materials that light others directly
    /// ([`crate::Details::emits`]) are such lamps, too, of the mean emission of their material.
    pub fn new(scene: &Scene) -> Self {
        let mut parts = vec![];
        for source in &scene.lights {
            let light = source.light;
            if let (Some(outline), Falloff::InverseSquare) = (light.outline(), light.falloff()) {
                let exitance = bands(light.color()).map(|r| r * PI);
                let front = outline.vertices().to_vec();
                let back = front.iter().rev().copied().collect();
                let two_sided = matches!(light, Light::Polygon { two_sided: true, .. });
                for ring in [Some(front), two_sided.then_some(back)].into_iter().flatten() {
                    if let Ok(polygon) = Polygon::new(&ring) {
                        parts.push(Part::Area(polygon, exitance, source.shadow));
                    }
                }
                continue;
            }
            for sample in 0..light.samples() {
                let arrives = move |p: DVec3, normal: DVec3| {
                    let incident = light.illuminate(sample, p);
                    let cosine = incident.to_light.as_dvec3().dot(normal).max(0.0);
                    bands(incident.irradiance).map(|e| e * cosine)
                };
                parts.push(Part::Sample(light.source(sample), Box::new(arrives), source.shadow));
            }
        }
        let radiances = direct_radiances(scene);
        let radiance_of = |t: u32| radiances[scene.mesh.material(t) as usize];
        for emitter in emitting_polygons(scene, radiance_of) {
            let exitance = bands(emitter.radiance).map(|r| r * PI);
            let back = emitter.vertices.iter().rev().copied().collect();
            for (side, ring) in [(emitter.front, emitter.vertices), (emitter.back, back)] {
                if let (true, Ok(polygon)) = (side != Side::Dark, Polygon::new(&ring)) {
                    parts.push(Part::Area(polygon, exitance, true));
                }
            }
        }
        Self { parts }
    }
}

/// Calls `f` with the lamps.
pub fn with_lamps<T>(lamps: &Lamps, f: impl FnOnce(&[Lamp<'_>]) -> T) -> T {
    let list: Vec<Lamp<'_>> = lamps.parts.iter().filter_map(to_lamp).collect();
    f(&list)
}

fn to_lamp(part: &Part) -> Option<Lamp<'_>> {
    match part {
        Part::Sample(Source::Position(position), arrives, shadow) => {
            Some(Lamp::Point { position: *position, irradiance: &**arrives, shadow: *shadow })
        }
        Part::Sample(Source::Direction(direction), arrives, shadow) => {
            Some(Lamp::Directional { direction: *direction, irradiance: &**arrives, shadow: *shadow })
        }
        Part::Sample(..) => None,
        Part::Area(polygon, exitance, shadow) => {
            Some(Lamp::Area { polygon, exitance: *exitance, shadow: *shadow })
        }
    }
}
