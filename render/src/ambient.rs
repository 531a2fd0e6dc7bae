//! Light that does not come straight from lights: a constant, or what probes or surfaces hold.

use crate::lightmap::Lightmap;
use crate::scene::SkyLight;
use glam::{DVec3, Vec3};
use pointillist_delaunay::Hint;
use pointillist_shade::Environment;
use pointillist_shprobe::Field;
use std::f32::consts::FRAC_1_PI;

/// Where ambient light comes from.
#[derive(Clone, Copy)]
pub enum Ambient<'a> {
    /// The same everywhere; reflected as albedo · colour.
    Color(Vec3),
    /// From a sky and a ground, by the normal; reflected as albedo · what is seen of them.
    Sky(SkyLight),
    /// Between probes; reflected as albedo/π · E(n).
    Probes(&'a Field),
    /// From an environment, by the normal; reflected as albedo/π · E(n).
    Environment(&'a Environment),
    /// On the surfaces themselves; reflected as albedo/π · irradiance.
    Radiosity(&'a Lightmap),
}

/// Where on a surface light is asked for.
pub(crate) struct Spot {
    /// In the world.
    pub(crate) position: DVec3,
    /// The scene's triangle.
    pub(crate) triangle: u32,
    /// Which side of it is seen.
    pub(crate) front: bool,
    /// Away from the surface, on the side that is seen: what is in front of it lights it.
    pub(crate) side: Vec3,
    /// What it is shaded with.
    pub(crate) normal: Vec3,
}

impl Ambient<'_> {
    /// What a surface reflects of it, over its albedo.
    pub(crate) fn at(&self, spot: &Spot, hint: &mut Hint) -> Vec3 {
        let Spot { position, triangle, front, side, normal } = *spot;
        match self {
            Self::Radiosity(light) => light.irradiance(triangle, front, position) * FRAC_1_PI,
            Self::Color(color) => *color,
            Self::Sky(light) => light.seen_by(normal),
            Self::Environment(map) => map.irradiance(normal) * FRAC_1_PI,
            // Only a position that is not finite is refused; geometry with such positions is refused before.
            Self::Probes(field) => {
                field.irradiance(position, side, normal, hint).unwrap_or_default() * FRAC_1_PI
            }
        }
    }
}
