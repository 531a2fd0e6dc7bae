//! How a model is shown that comes without camera, lights or normals: a key light with shadow from over the left shoulder, a soft
//! sky and ground that fill its shadows, and smooth surfaces between creases.

use super::{AmbientLight, LightSource, Scene, SkyLight};
use glam::Vec3;
use pointillist_shade::Light;

/// Edges that are folded by more than this stay edges, where a file brings no normals: 40°, between the facets of a coarse
/// sphere (of twelve columns: 30°) and the edges of what is built (45° and more).
pub(super) const CREASE_RAD: f64 = 40.0_f64.to_radians();

/// Irradiance of the key light: with the sky, a white surface that faces it gets radiance near 0.9.
const KEY: Vec3 = Vec3::new(2.1, 2.05, 1.95);
/// Radiance from above, a little blue.
const SKY: Vec3 = Vec3::new(0.27, 0.3, 0.35);
/// Radiance from below: what light ground sends back.
const GROUND: Vec3 = Vec3::new(0.13, 0.12, 0.11);

/// The key light, seen from the camera.
pub(crate) fn key_light(scene: &Scene) -> LightSource {
    let [right, up, backward] = scene.camera.axes();
    let towards_light = -0.6 * right + 0.9 * up + 0.8 * backward;
    LightSource::new("light0", Light::Directional { direction: -towards_light, irradiance: KEY })
}

/// The fill light; up is the camera's.
pub(super) fn fill_light(scene: &Scene) -> AmbientLight {
    let up = scene.camera.up.try_normalize().map_or(Vec3::Y, |up| up.as_vec3());
    AmbientLight::Sky(SkyLight { sky: SKY, ground: GROUND, up })
}
