//! The scene's lights as the points and directions that shadows are cast from.

use crate::casters::{Occasion, Origin};
use crate::emitters::{EmittingPolygon, Side};
use crate::error::RenderError;
use crate::prepared::Prepared;
use crate::scene::LightSource;
use crate::shader::Economy;
use crate::surfaces::Surfaces;
use glam::{DVec3, Vec3};
use pointillist_micropoint::{Geometry, Lens};
use pointillist_shade::{Emission, Falloff, Incident, Light, LightOutline, Source};
use pointillist_shadow::{
    AreaLight, AreaOptions, Emitter, LineLight, ShadowError, ShadowLight, ShadowOptions,
};

/// One point or direction from which light comes: a light, or a sample of an area light.
pub(crate) struct LightSample<'a> {
    /// Index into [`Scene::lights`].
    pub(crate) light: usize,
    pub(crate) sample: u32,
    /// 1 for the channels of the light that it brings, 0 for the others.
    pub(crate) channels: Vec3,
    /// The light as highlights of OpenGL's formula have it, if that is another colour.
    pub(crate) of_highlights: Option<Light>,
    pub(crate) occasion: Occasion,
    pub(crate) origin: Origin,
    /// `None`: casts no shadow.
    pub(crate) shadow: Option<ShadowLight<'a>>,
    /// Whether it reaches a part of the world only, so that tiles are asked one by one.
    pub(crate) is_narrow: bool,
}

impl LightSample<'_> {
    /// What arrives at a place of the channels that it brings, with nothing in between; `lamp` is the light itself or as its highlights have it.
    pub(crate) fn incident(&self, lamp: &Light, position: DVec3) -> Incident {
        let mut incident = lamp.illuminate(self.sample, position);
        incident.irradiance *= self.channels;
        incident
    }
}

/// One side of a light with an area, or of an emitting polygon, taken as a whole.
pub(crate) struct WholeLight<'a> {
    /// Index into [`Scene::lights`]; `None` for an emitting polygon.
    pub(crate) light: Option<usize>,
    /// What it lights, if not everything.
    pub(crate) within: Option<(DVec3, DVec3)>,
    /// 1 for the channels of the light that it brings, 0 for the others.
    pub(crate) channels: Vec3,
    pub(crate) occasion: Occasion,
    pub(crate) origin: Origin,
    pub(crate) shape: Shape<'a>,
    /// What the side sends out.
    pub(crate) emission: Emission,
}

/// What a light as a whole is asked as.
pub(crate) enum Shape<'a> {
    Side(AreaLight<'a>),
    Line(LineLight<'a>),
}

/// [`AreaOptions::largest_shift`] of lines: they have sharp shadows across, which what is seen of an area smooths.
const LINE_SHIFT: f64 = 0.03;

/// The lights of a scene for one view.
#[derive(Default)]
pub(crate) struct SceneLights<'a> {
    pub(crate) samples: Vec<LightSample<'a>>,
    pub(crate) whole: Vec<WholeLight<'a>>,
    /// Lights in the colours of the ambient light that they add.
    ambient: Vec<Light>,
}

impl SceneLights<'_> {
    /// Ambient light that the lights add at a place, if nothing weakens it.
    pub(crate) fn ambient_at(&self, position: DVec3) -> Vec3 {
        self.ambient.iter().map(|light| light.illuminate(0, position).irradiance).sum()
    }

    /// Whether something clear may colour the light of some tiles.
    pub(crate) fn are_tinted(&self) -> bool {
        let mut occasions =
            self.samples.iter().map(|l| l.occasion).chain(self.whole.iter().map(|l| l.occasion));
        occasions.any(|occasion| occasion != Occasion::Always)
    }
}

/// What casts the shadows of some channels of light, and when.
type Cast<'a> = (Vec3, &'a Geometry, Occasion);

/// All lights that reach anything or of which `shown` says that a layer shows where they do, for receivers that `lens` sees. Lights with an area and lines are taken as a whole unless they ask for samples, or `economy` does. Where
/// something clear lets colours pass differently, a light comes once for each, and once for tiles where none does.
pub(crate) fn scene_lights<'a>(
    prepared: &'a Prepared<'_>,
    lens: &Lens,
    economy: Option<Economy>,
    shown: &dyn Fn(usize) -> bool,
) -> Result<SceneLights<'a>, RenderError> {
    let (scene, surfaces) = (prepared.scene, &*prepared.surfaces);
    let all = prepared.geometry.bounds();
    let sampled = economy.is_some_and(|economy| economy.samples_areas);
    let mut lights = SceneLights::default();
    for (light, source) in scene.lights.iter().enumerate() {
        if source.ambient != Vec3::ZERO {
            lights.ambient.push(source.light.with_color(source.ambient));
        }
        // Nothing can show that it is there.
        let of_highlights = source.of_highlights();
        let may_reach = |light: &Light| light.may_reach(all.low, all.high);
        let is_idle =
            !shown(light) && !may_reach(&source.light) && !of_highlights.as_ref().is_some_and(may_reach);
        let unhindered = (!source.shadow).then_some((Vec3::ONE, &*prepared.geometry, Occasion::Always));
        let casters = unhindered.into_iter().chain(prepared.casters().filter(|_| source.shadow));
        for cast in casters {
            if !sampled && let Some(area) = source.light.exact_area() {
                let sides = whole_light((light, source), area, cast, surfaces)?;
                lights.whole.extend(sides.into_iter().filter(|_| !is_idle));
                continue;
            }
            if !sampled && let Some(ends) = source.light.exact_line() {
                let line = whole_line((light, source), ends, cast, surfaces)?;
                lights.whole.extend(Some(line).filter(|_| !is_idle));
                continue;
            }
            for sample in 0..source.light.samples() {
                // What is wrong with a light is told also where it is idle.
                let mut found = light_sample(prepared, (light, source), (sample, economy), cast)?;
                if !is_idle {
                    found.shadow = found.shadow.map(|shadow| shadow.seen_from(lens));
                    lights.samples.push(found);
                }
            }
        }
    }
    // Their points would be too many: they are taken as a whole, if need be coarsely.
    let options = AreaOptions::default();
    let options = if sampled { options.with_most_halvings(0) } else { options };
    for emitter in prepared.emitters.iter() {
        for casters in prepared.casters() {
            lights.whole.extend(emitting_sides(prepared, emitter, casters, options)?);
        }
    }
    Ok(lights)
}

/// One sample of a light, for viewers anywhere.
fn light_sample<'a>(
    prepared: &'a Prepared<'_>,
    (light, source): (usize, &LightSource),
    (sample, economy): (u32, Option<Economy>),
    (channels, geometry, occasion): Cast<'a>,
) -> Result<LightSample<'a>, RenderError> {
    let shadow = if source.shadow {
        let options = ShadowOptions::default()
            .with_occlusion(prepared.scene.render.occlusion())
            .with_resolution(source.resolution);
        let options = match economy {
            Some(_) => options.with_squares_under_masks(Economy::SQUARES_UNDER_MASKS),
            None => options,
        };
        let found = ShadowLight::new(geometry, &*prepared.surfaces, emitter(&source.light, sample), options);
        let named = |e| RenderError::Shadow { name: source.name.clone(), source: e };
        Some(found.map_err(named)?)
    } else {
        None
    };
    let origin = match source.light.source(sample) {
        Source::Direction(direction) => Origin::Direction(direction),
        Source::Position(position) => Origin::Within((position, position)),
        _ => unreachable!("light comes from a point or a direction"),
    };
    let is_narrow = matches!(source.light, Light::Spot { .. } | Light::Rect { .. } | Light::Polygon { .. });
    let of_highlights = source.of_highlights();
    Ok(LightSample { light, sample, channels, of_highlights, occasion, origin, shadow, is_narrow })
}

/// The share of a light that these channels are.
pub(crate) fn share(channels: Vec3) -> f64 {
    f64::from(channels.element_sum()) / 3.0
}

/// The sides of a light that shine; none of a rectangle without area.
fn whole_light<'a>(
    (light, source): (usize, &LightSource),
    (outline, two_sided): (LightOutline, bool),
    (channels, geometry, occasion): Cast<'a>,
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
        let shape = Shape::Side(side);
        let origin = around(vertices);
        found.push(WholeLight {
            light: Some(light),
            within: None,
            channels,
            occasion,
            origin,
            shape,
            emission,
        });
    }
    Ok(found)
}

/// A light that is a line.
fn whole_line<'a>(
    (light, source): (usize, &LightSource),
    ends: [DVec3; 2],
    (channels, geometry, occasion): Cast<'a>,
    surfaces: &'a Surfaces,
) -> Result<WholeLight<'a>, RenderError> {
    let line =
        LineLight::new(geometry, surfaces, ends, AreaOptions::default().with_largest_shift(LINE_SHIFT))
            .map_err(|e| RenderError::Shadow { name: source.name.clone(), source: e })?;
    let line = if source.shadow { line } else { line.without_shadows() };
    let radiance = source.light.color() * channels;
    let emission = Emission { front: DVec3::ZERO, radiance, falloff: source.light.falloff() };
    let (shape, origin) = (Shape::Line(line), around(&ends));
    Ok(WholeLight { light: Some(light), within: None, channels, occasion, origin, shape, emission })
}

/// The sides of an emitting polygon that shine.
fn emitting_sides<'a>(
    prepared: &'a Prepared<'_>,
    emitter: &EmittingPolygon,
    (channels, geometry, occasion): Cast<'a>,
    options: AreaOptions,
) -> Result<Vec<WholeLight<'a>>, RenderError> {
    let mut found = vec![];
    let back: Vec<DVec3> = emitter.vertices.iter().rev().copied().collect();
    for (side, vertices) in [(emitter.front, &emitter.vertices), (emitter.back, &back)] {
        let within = match side {
            Side::Dark => continue,
            Side::Lights => None,
            Side::LightsWithin(low, high) => Some((low, high)),
        };
        let name = || {
            let material = prepared.scene.mesh.material(emitter.triangles[0]);
            prepared.scene.materials[material as usize].name.clone()
        };
        let side = AreaLight::new(geometry, &*prepared.surfaces, vertices, options)
            .map_err(|source| RenderError::Shadow { name: name(), source })?
            .of_triangles(&emitter.triangles);
        // Together, the polygons of a lamp are asked as finely as one light of its width.
        let shift = options.largest_shift * (emitter.lamp_width / side.area().sqrt()).max(1.0);
        let side = side.with_options(options.with_largest_shift(shift));
        let radiance = emitter.radiance * channels;
        let emission = Emission { front: side.front(), radiance, falloff: Falloff::InverseSquare };
        let (shape, origin) = (Shape::Side(side), around(vertices));
        found.push(WholeLight { light: None, within, channels, occasion, origin, shape, emission });
    }
    Ok(found)
}

/// The box around some points of a lamp.
fn around(points: &[DVec3]) -> Origin {
    let grow = |(low, high): (DVec3, DVec3), p: &DVec3| (low.min(*p), high.max(*p));
    Origin::Within(points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), grow))
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
        Light::Line { from, to, .. } => (*to - *from).any_orthogonal_vector(),
        _ => DVec3::NEG_Y,
    };
    match light.source(sample) {
        Source::Direction(direction) => Emitter::Directional { direction },
        Source::Position(position) => Emitter::Point { position, axis },
        _ => unreachable!("light comes from a point or a direction"),
    }
}
