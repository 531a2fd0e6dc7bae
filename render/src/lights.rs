//! The scene's lights as the points and directions that shadows are cast from.

use crate::error::RenderError;
use crate::scene::Scene;
use crate::surfaces::Surfaces;
use pointillist_micropoint::{Geometry, Lens};
use pointillist_shade::{Light, Source};
use pointillist_shadow::{Emitter, ShadowLight, ShadowOptions};

/// One point or direction from which light comes: a light, or a sample of an area light.
pub(crate) struct LightSample<'a> {
    /// Index into [`Scene::lights`].
    pub(crate) light: usize,
    pub(crate) sample: u32,
    /// `None`: casts no shadow.
    pub(crate) shadow: Option<ShadowLight<'a>>,
}

/// All lights, area lights sample by sample, for receivers that `lens` sees.
pub(crate) fn light_samples<'a>(
    scene: &Scene,
    geometry: &'a Geometry,
    surfaces: &'a Surfaces,
    lens: &Lens,
) -> Result<Vec<LightSample<'a>>, RenderError> {
    let mut samples = Vec::new();
    for (light, source) in scene.lights.iter().enumerate() {
        let options = ShadowOptions::default()
            .with_occlusion(scene.render.occlusion())
            .with_resolution(source.resolution);
        for sample in 0..source.light.samples() {
            let shadow = if source.shadow {
                let emitter = emitter(&source.light, sample);
                let named = |e| RenderError::Shadow { name: source.name.clone(), source: e };
                Some(ShadowLight::new(geometry, surfaces, emitter, options).map_err(named)?.seen_from(lens))
            } else {
                None
            };
            samples.push(LightSample { light, sample, shadow });
        }
    }
    Ok(samples)
}

/// One sample of a light as `pointillist-shadow` takes it. Lights of one point or direction have the single sample 0
/// ([`Light::samples`]).
#[must_use]
pub fn emitter(light: &Light, sample: u32) -> Emitter {
    // The axis decides how the six screens lie: along a spot light's beam, or an area light's normal.
    let axis = match light {
        Light::Spot { direction, .. } => *direction,
        Light::Rect { edge_u, edge_v, .. } => edge_u.cross(*edge_v),
        _ => glam::DVec3::NEG_Y,
    };
    match light.source(sample) {
        Source::Direction(direction) => Emitter::Directional { direction },
        Source::Position(position) => Emitter::Point { position, axis },
        _ => unreachable!("light comes from a point or a direction"),
    }
}
