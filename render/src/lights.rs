//! The scene's lights as the points and directions that shadows are cast from.

use crate::error::RenderError;
use crate::prepared::Prepared;
use crate::scene::LightSource;
use crate::surfaces::Surfaces;
use glam::{DVec3, Vec3};
use pointillist_micropoint::{Geometry, Lens};
use pointillist_shade::{Emission, Light, LightOutline, Source};
use pointillist_shadow::{AreaLight, AreaOptions, Emitter, ShadowError, ShadowLight, ShadowOptions};

/// One point or direction from which light comes: a light, or a sample of an area light.
pub(crate) struct LightSample<'a> {
    /// Index into [`Scene::lights`].
    pub(crate) light: usize,
    pub(crate) sample: u32,
    /// 1 for the channels of the light that it brings, 0 for the others.
    pub(crate) channels: Vec3,
    /// `None`: casts no shadow.
    pub(crate) shadow: Option<ShadowLight<'a>>,
}

/// One side of a light with an area, taken as a whole.
pub(crate) struct WholeLight<'a> {
    /// Index into [`Scene::lights`].
    pub(crate) light: usize,
    /// 1 for the channels of the light that it brings, 0 for the others.
    pub(crate) channels: Vec3,
    pub(crate) side: AreaLight<'a>,
    /// What the side sends out.
    pub(crate) emission: Emission,
}

/// The lights of a scene for one view.
#[derive(Default)]
pub(crate) struct SceneLights<'a> {
    pub(crate) samples: Vec<LightSample<'a>>,
    pub(crate) whole: Vec<WholeLight<'a>>,
}

/// All lights, for receivers that `lens` sees. Lights with an area are taken as a whole unless they ask for samples, or `sampled` does. Where
/// something clear lets colours pass differently, a light comes once for each.
pub(crate) fn scene_lights<'a>(
    prepared: &'a Prepared<'_>,
    lens: &Lens,
    sampled: bool,
) -> Result<SceneLights<'a>, RenderError> {
    let (scene, surfaces) = (prepared.scene, &*prepared.surfaces);
    let mut lights = SceneLights::default();
    for (light, source) in scene.lights.iter().enumerate() {
        let unhindered = (!source.shadow).then_some((Vec3::ONE, &prepared.geometry));
        let casters = unhindered.into_iter().chain(prepared.casters().filter(|_| source.shadow));
        for (channels, geometry) in casters {
            if !sampled && let Some(area) = source.light.exact_area() {
                lights.whole.extend(whole_light((light, source), area, channels, geometry, surfaces)?);
                continue;
            }
            for sample in 0..source.light.samples() {
                let shadow = if source.shadow {
                    let options = ShadowOptions::default()
                        .with_occlusion(scene.render.occlusion())
                        .with_resolution(source.resolution);
                    let named = |e| RenderError::Shadow { name: source.name.clone(), source: e };
                    let shadow =
                        ShadowLight::new(geometry, surfaces, emitter(&source.light, sample), options);
                    Some(shadow.map_err(named)?.seen_from(lens))
                } else {
                    None
                };
                lights.samples.push(LightSample { light, sample, channels, shadow });
            }
        }
    }
    Ok(lights)
}

/// The share of a light that these channels are.
pub(crate) fn share(channels: Vec3) -> f64 {
    f64::from(channels.element_sum()) / 3.0
}

/// The sides of a light that shine; none of a rectangle without area.
fn whole_light<'a>(
    (light, source): (usize, &LightSource),
    (outline, two_sided): (LightOutline, bool),
    channels: Vec3,
    geometry: &'a Geometry,
    surfaces: &'a Surfaces,
) -> Result<Vec<WholeLight<'a>>, RenderError> {
    let back: Vec<DVec3> = outline.vertices().iter().rev().copied().collect();
    let sides = [Some(outline.vertices()), two_sided.then_some(&back[..])];
    let mut found = vec![];
    for vertices in sides.into_iter().flatten() {
        let side = match AreaLight::new(geometry, surfaces, vertices, AreaOptions::default()) {
            Err(ShadowError::OutlineWithoutArea) if matches!(source.light, Light::Rect { .. }) => continue,
            side => side.map_err(|e| RenderError::Shadow { name: source.name.clone(), source: e })?,
        };
        let side = if source.shadow { side } else { side.without_shadows() };
        let radiance = source.light.color() * channels;
        let emission = Emission { front: side.front(), radiance, falloff: source.light.falloff() };
        found.push(WholeLight { light, channels, side, emission });
    }
    Ok(found)
}

/// One sample of a light as `pointillist-shadow` takes it. Lights of one point or direction have the single sample 0
/// ([`Light::samples`]).
#[must_use]
pub fn emitter(light: &Light, sample: u32) -> Emitter {
    // The axis decides how the six screens lie: along a spot light's beam, or an area light's normal.
    let axis = match light {
        Light::Spot { direction, .. } => *direction,
        Light::Rect { edge_u, edge_v, .. } => edge_u.cross(*edge_v),
        Light::Polygon { outline, .. } => outline.area_vector(),
        _ => DVec3::NEG_Y,
    };
    match light.source(sample) {
        Source::Direction(direction) => Emitter::Directional { direction },
        Source::Position(position) => Emitter::Point { position, axis },
        _ => unreachable!("light comes from a point or a direction"),
    }
}
