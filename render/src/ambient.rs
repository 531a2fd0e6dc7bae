//! Light that does not come straight from lights: a constant, or what probes or surfaces hold.

use crate::lightmap::Lightmap;
use crate::scene::SkyLight;
use crate::unbaked::Unbaked;
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
    Probes(&'a Field, &'a Unbaked),
    /// From an environment, by the normal; reflected as albedo/π · E(n).
    Environment(&'a Environment),
    /// On the surfaces themselves; reflected as albedo/π · irradiance.
    Radiosity(&'a Lightmap),
    /// On the surfaces where it is known there, elsewhere and in mirrors between probes.
    RadiosityAndProbes(&'a Lightmap, &'a Field, &'a Unbaked),
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
        let Spot { position, triangle, front, normal, .. } = *spot;
        // Only a position that is not finite is refused; geometry with such positions is refused before.
        let mut between = |field: &Field| {
            field.irradiance(position, self.side(spot), normal, hint).unwrap_or_default() * FRAC_1_PI
        };
        match self {
            Self::Color(color) => *color,
            Self::Sky(light) => light.seen_by(normal),
            Self::Environment(map) => map.irradiance(normal) * FRAC_1_PI,
            Self::Probes(field, _) => between(field),
            Self::Radiosity(light) => light.irradiance(triangle, front, position) * FRAC_1_PI,
            Self::RadiosityAndProbes(light, field, _) => match light.known(triangle, front, position) {
                Some(irradiance) => irradiance * FRAC_1_PI,
                None => between(field),
            },
        }
    }

    /// Whether it differs between places of the same normal.
    pub(crate) fn depends_on_place(&self) -> bool {
        match self {
            Self::Color(_) | Self::Sky(_) | Self::Environment(_) => false,
            Self::Probes(..) | Self::Radiosity(_) | Self::RadiosityAndProbes(..) => true,
        }
    }

    /// The side of a surface from which probes light it; 0 for all sides.
    pub(crate) fn side(&self, spot: &Spot) -> Vec3 {
        match self {
            Self::Probes(_, new) | Self::RadiosityAndProbes(_, _, new) if new.contains(spot.triangle) => {
                Vec3::ZERO
            }
            _ => spot.side,
        }
    }

    /// The probes that it is between, if it is.
    pub(crate) fn field(&self) -> Option<&Field> {
        match self {
            Self::Probes(field, _) | Self::RadiosityAndProbes(_, field, _) => Some(field),
            _ => None,
        }
    }
}
