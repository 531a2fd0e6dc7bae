//! Light that does not come straight from lights.

use crate::lightmap::Lightmap;
use crate::unbaked::Unbaked;
use glam::Vec3;
use pointillist_shprobe::Field;

/// Light that does not come straight from the lights.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum AmbientLight {
    /// The same everywhere; reflected as albedo · colour.
    Color(Vec3),
    /// From a sky and a ground, by the normal; reflected as albedo times what the normal sees of them.
    Sky(SkyLight),
    /// Between light probes; reflected as albedo/π · irradiance.
    Probes {
        /// The light.
        field: Box<Field>,
        /// What was not there when it was baked.
        unbaked: Unbaked,
        /// Stands for the light in [`crate::fingerprint`]: a hash of the file that it is from, or any number.
        fingerprint: u64,
    },
    /// From [`crate::ImageSettings::environment`], by the normal; reflected as albedo/π · irradiance.
    Environment,
    /// Baked on the scene's own triangles; reflected as albedo/π · irradiance.
    Radiosity {
        /// The light.
        light: Box<Lightmap>,
        /// Stands for the light in [`crate::fingerprint`]: a hash of the file that it is from, or any number.
        fingerprint: u64,
    },
    /// Baked on triangles where it is known there, as on what stands still; elsewhere, as on what came later, and in mirrors, between light
    /// probes.
    RadiosityAndProbes {
        /// The light of triangles.
        light: Box<Lightmap>,
        /// The light of all else.
        field: Box<Field>,
        /// What was not there when these were baked.
        unbaked: Unbaked,
        /// Stands for both in [`crate::fingerprint`].
        fingerprint: u64,
    },
}

impl AmbientLight {
    /// The probes that it is between, if it is.
    pub(crate) fn field(&self) -> Option<&Field> {
        match self {
            Self::Probes { field, .. } | Self::RadiosityAndProbes { field, .. } => Some(field),
            _ => None,
        }
    }
}

/// Light from two half spaces of one radiance each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyLight {
    /// Radiance from above.
    pub sky: Vec3,
    /// Radiance from below.
    pub ground: Vec3,
    /// Unit vector away from the ground.
    pub up: Vec3,
}

impl SkyLight {
    /// Irradiance/π of a surface with this unit normal: it sees a share of (1 + cos)/2 of the sky, weighted by the cosine.
    #[must_use]
    pub fn seen_by(&self, normal: Vec3) -> Vec3 {
        self.ground.lerp(self.sky, 0.5 + 0.5 * normal.dot(self.up))
    }
}
