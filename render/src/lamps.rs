//! A scene's lights as lamps of radiosity.

use crate::radiosity_surfaces::bands;
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
    /// A rectangle with its exitance.
    Area(Polygon, [f64; 3], bool),
}

impl Lamps {
    /// All lights of a scene. A rectangle with the inverse-square law is one [`Lamp::Area`], or none if its area is 0, which sends out
    /// nothing; a rectangle with another law is its sample points, as in [`crate::render`].
    pub fn new(scene: &Scene) -> Self {
        let mut parts = vec![];
        for source in &scene.lights {
            let light = source.light;
            if let Light::Rect { corner, edge_u, edge_v, radiance, falloff: Falloff::InverseSquare, .. } =
                light
            {
                let ring = [corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v];
                if let Ok(polygon) = Polygon::new(&ring) {
                    let exitance = bands(radiance).map(|r| r * PI);
                    parts.push(Part::Area(polygon, exitance, source.shadow));
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
