//! Light that does not come straight from lights: a constant, or what probes hold.

use glam::{DVec3, Vec3};
use pointillist_shade::Environment;
use pointillist_shprobe::{Field, Hint};
use std::f32::consts::FRAC_1_PI;

/// Where ambient light comes from.
#[derive(Clone, Copy)]
pub enum Ambient<'a> {
    /// The same everywhere; reflected as albedo · colour.
    Color(Vec3),
    /// Between probes; reflected as albedo/π · E(n).
    Probes(&'a Field),
    /// From an environment, by the normal; reflected as albedo/π · E(n).
    Environment(&'a Environment),
}

impl Ambient<'_> {
    /// What a surface reflects of it, over its albedo. `face_normal` points away from the surface, on the side that is
    /// seen, and `normal` is what it is shaded with.
    pub(super) fn at(&self, position: DVec3, face_normal: Vec3, normal: Vec3, hint: &mut Hint) -> Vec3 {
        match self {
            Self::Color(color) => *color,
            Self::Environment(map) => map.irradiance(normal) * FRAC_1_PI,
            // Only a position beyond all numbers is refused, and nothing of it is seen.
            Self::Probes(field) => {
                field.irradiance(position, face_normal, normal, hint).unwrap_or_default() * FRAC_1_PI
            }
        }
    }
}
