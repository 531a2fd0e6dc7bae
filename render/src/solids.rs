//! Which positions lie in matter: light probes see nothing but backs of surfaces there.

use crate::prepared::Prepared;
use glam::{DVec3, dvec3};
use pointillist_micropoint::Geometry;
use pointillist_shade::Source;

/// Distances that are tried to get out of a solid, as shares of the scene's diagonal.
const STEPS: [f64; 14] =
    [0.001, 0.002, 0.004, 0.008, 0.012, 0.016, 0.024, 0.032, 0.048, 0.064, 0.096, 0.128, 0.256, 0.512];

/// The closed components of a scene's triangles that are matter.
///
/// A closed component with a light or the camera in it is not: it is a room whose walls have no thickness.
#[derive(Clone, Debug)]
pub struct Solids<'a> {
    geometry: &'a Geometry,
    rooms: Vec<u32>,
    diagonal: f64,
}

impl<'a> Solids<'a> {
    /// How far places that [`Solids::nearest_free`] finds are from solids, over the scene's diagonal. A probe in a surface holds what lights
    /// that one place, and shows it around.
    pub const MARGIN: f64 = 0.01;

    /// Those of a scene.
    #[must_use]
    pub fn new(prepared: &'a Prepared<'_>) -> Self {
        let (scene, geometry) = (prepared.scene, prepared.geometry());
        let lights = scene.lights.iter().filter_map(|l| match l.light.source(0) {
            Source::Position(p) => Some(p),
            _ => None,
        });
        let inside = lights.chain([scene.camera.eye]);
        let mut rooms: Vec<u32> = inside.flat_map(|p| geometry.solids_around(p)).collect();
        rooms.sort_unstable();
        rooms.dedup();
        let bounds = geometry.bounds();
        Self { geometry, rooms, diagonal: (bounds.high - bounds.low).length() }
    }

    /// Whether a position lies in no solid.
    #[must_use]
    pub fn is_free(&self, p: DVec3) -> bool {
        self.geometry.solids_around(p).iter().all(|solid| self.rooms.contains(solid))
    }

    /// The first place on ever larger spheres around `p` that is free and [`Solids::MARGIN`] times the scene's diagonal away from all
    /// solids; where there is none, as in gaps narrower than that, the first free one.
    #[must_use]
    pub fn nearest_free(&self, p: DVec3) -> Option<DVec3> {
        let margin = Self::MARGIN * self.diagonal;
        let places = || STEPS.iter().flat_map(|s| directions().map(move |d| p + d * (s * self.diagonal)));
        let is_clear = |q: &DVec3| self.is_free(*q) && directions().all(|d| self.is_free(*q + d * margin));
        places().find(is_clear).or_else(|| places().find(|&q| self.is_free(q)))
    }
}

/// To the middles of the faces, edges and corners of a cube, faces first.
fn directions() -> impl Iterator<Item = DVec3> {
    let all = (0..27).map(|i| dvec3(f64::from(i % 3 - 1), f64::from(i / 3 % 3 - 1), f64::from(i / 9 - 1)));
    let mut sorted: Vec<DVec3> = all.filter(|d| *d != DVec3::ZERO).collect();
    sorted.sort_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    sorted.into_iter().map(DVec3::normalize)
}
