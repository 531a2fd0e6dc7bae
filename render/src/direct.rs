//! Light that comes straight from the lights, asked for only where it can matter.

use crate::lights::LightSample;
use crate::lit_parts::LitParts;
use crate::monitor::Monitor;
use crate::scene::MeasuredBrdf;
use crate::shader::{Economy, Place, Point, Shader};
use glam::{DVec3, Vec3};
use pointillist_micropoint::{Face, Fragment, Micropoint, Tile};
use pointillist_shade::{Incident, Interpolation, Source, interpolate_color, sees_light, turn_to};
use pointillist_shadow::{AreaScratch, LineScratch, Receivers, ShadowScratch, Viewer};
use std::ops::Range;

/// Light that would reach a micropoint if nothing stood in its way, and the part of it that does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrival {
    pub(crate) point: u32,
    pub(crate) radiance: Vec3,
    pub(crate) fraction: f64,
    /// The light varies over the micropoint.
    pub(crate) is_close: bool,
}

/// Light before it is reflected.
struct Arriving {
    diffuse: Incident,
    /// For the highlight, if it is of another colour.
    highlight: Option<Incident>,
}

impl Arriving {
    fn is_dark(&self) -> bool {
        self.diffuse.is_dark() && self.highlight.as_ref().is_none_or(Incident::is_dark)
    }
}

/// Memory for shadows.
#[derive(Default)]
pub(crate) struct DirectScratch {
    pub(crate) shadow: ShadowScratch,
    pub(crate) area: AreaScratch,
    pub(crate) line: LineScratch,
    /// For each micropoint: what it sends to the eye because of a whole light, and the lit area of the light.
    pub(crate) seen: Vec<(Vec3, f64)>,
    /// The micropoints that are asked about, those of one receiver side by side.
    pub(crate) asked: Vec<u32>,
    /// For each piece of a receiver, the receiver's range in `asked`.
    pub(crate) owners: Vec<Range<u32>>,
    pub(crate) receivers: Receivers,
    pub(crate) lit: Vec<f64>,
    pub(crate) arrivals: Vec<Arrival>,
    pub(crate) lit_parts: LitParts,
    /// What each receiver counts in the mean of its pixel, if not all are asked.
    asked_weights: Vec<f64>,
    /// Arrivals of a pixel that share the mean fraction of some receivers.
    shared: Vec<(Range<usize>, Range<usize>)>,
    /// Fragments of one pixel: its micropoint and what it counts.
    candidates: Vec<(u32, Fragment, f64)>,
}

impl Shader<'_> {
    /// Adds one light: what would arrive, times the fraction of it that does.
    pub(crate) fn add_light(
        &self,
        tile: &Tile,
        light: &LightSample<'_>,
        points: &mut [Point],
        direct: &mut DirectScratch,
        mut lit_layer: Option<&mut Vec<DVec3>>,
        monitor: &dyn Monitor,
    ) {
        self.find_arrivals(tile, light, points, lit_layer.is_some(), &mut direct.arrivals);
        monitor.lap("shade");
        if let Some(screens) = &light.shadow {
            direct.receivers.clear();
            match self.economy {
                None => self.ask_for_all(tile, direct),
                Some(economy) => ask_for_some(tile, self.shadows_per_pixel(economy, light), direct),
            }
            let viewer = Viewer { lens: tile.lens(), faces: tile.faces() };
            screens.lit(viewer, &direct.receivers, &mut direct.shadow, &mut direct.lit);
            monitor.lap("shadow");
            match self.economy {
                None => self.take_all(tile, light, points, lit_layer.is_some(), direct),
                Some(_) => shared_fractions(direct),
            }
        }
        let samples = f64::from(self.scene.lights[light.light].light.samples());
        let share = light.channels.as_dvec3() / samples;
        for a in &direct.arrivals {
            let p = &mut points[a.point as usize];
            p.direct += a.radiance * a.fraction as f32;
            if let Some(layer) = lit_layer.as_deref_mut() {
                let to_light =
                    self.scene.lights[light.light].light.illuminate(light.sample, p.place.position).to_light;
                if sees_light(p.place.face_normal, to_light) {
                    layer[a.point as usize] += share * a.fraction;
                }
            }
        }
    }

    /// Finds the micropoints that a light may reach. `with_dark`: also those that reflect nothing of it.
    fn find_arrivals(
        &self,
        tile: &Tile,
        light: &LightSample<'_>,
        points: &[Point],
        with_dark: bool,
        arrivals: &mut Vec<Arrival>,
    ) {
        arrivals.clear();
        let source = self.scene.lights[light.light].light.source(light.sample);
        let after_shadow = self.reflects_after_shadow(light);
        for (i, (p, m)) in points.iter().zip(tile.points()).enumerate() {
            let triangle = tile.faces()[m.face as usize].id;
            if is_turned_away(&p.place, source) || (!with_dark && self.is_black(p, triangle)) {
                continue;
            }
            let is_close = || self.is_close(tile, light, p);
            let (radiance, is_close) = match after_shadow {
                true => (Vec3::ZERO, is_close()),
                false => self.without_shadow(tile, light, p, m, is_close),
            };
            if after_shadow || with_dark || radiance != Vec3::ZERO {
                arrivals.push(Arrival { point: i as u32, radiance, fraction: 1.0, is_close });
            }
        }
    }

    /// Whether what arrives is found only where the shadow lets something through. Not where many micropoints get nothing anyway, whose
    /// shadow need not be asked, nor where the shadow is asked by what arrives.
    pub(crate) fn reflects_after_shadow(&self, light: &LightSample<'_>) -> bool {
        light.shadow.is_some() && !light.is_narrow && self.economy.is_none()
    }

    /// Radiance that a micropoint sends to the eye because of a light, without shadow. If there is any, and `is_close` says that the light
    /// varies over the micropoint, it is the mean over its fragments, and the flag is set.
    pub(crate) fn without_shadow(
        &self,
        tile: &Tile,
        light: &LightSample<'_>,
        p: &Point,
        m: &Micropoint,
        is_close: impl FnOnce() -> bool,
    ) -> (Vec3, bool) {
        let face = &tile.faces()[m.face as usize];
        let radiance = self.arriving(light, p, face);
        if radiance == Vec3::ZERO || !is_close() {
            return (radiance, false);
        }
        let fragments = tile.fragments(m).iter().map(|f| (tile.outline(f), f.weight));
        (self.mean_arriving(tile, light, (p, face), fragments), true)
    }

    /// Samples of an area light are summed up as fragments are: together they get as many shadows as a light of one point, but each one.
    fn shadows_per_pixel(&self, economy: Economy, light: &LightSample<'_>) -> usize {
        let samples = self.scene.lights[light.light].light.samples().max(1) as usize;
        economy.shadows_per_pixel.div_ceil(samples)
    }

    /// Radiance that a micropoint sends to the eye because of a light, without shadow.
    pub(crate) fn arriving(&self, light: &LightSample<'_>, p: &Point, face: &Face) -> Vec3 {
        let source = &self.scene.lights[light.light].light;
        if self.is_black(p, face.id) {
            return Vec3::ZERO;
        }
        let diffuse = light.incident(source, p.place.position);
        if !sees_light(p.place.face_normal, diffuse.to_light) {
            return Vec3::ZERO;
        }
        let of_highlights = light.of_highlights.as_ref().filter(|_| p.material.model.is_opengl());
        let by_corner = match self.scene.render.shading {
            Interpolation::Gouraud => self.corner_normals(face),
            _ => None,
        };
        if of_highlights.is_none() && by_corner.is_none() {
            return self.reflect(p, face.id, &diffuse, p.normal, p.place.to_eye);
        }
        let arrives = |position: DVec3| {
            let from = |lamp| light.incident(lamp, position);
            Arriving { diffuse: from(source), highlight: of_highlights.map(from) }
        };
        let arriving = arrives(p.place.position);
        if arriving.is_dark() {
            return Vec3::ZERO;
        }
        let Some(normals) = by_corner else {
            return self.reflect_arriving(p, face.id, &arriving, p.normal, p.place.to_eye);
        };
        let corners = self.scene.corners(face.id);
        let at = |k: usize| {
            let to_eye = self.to_eye(corners[k]);
            let normal = turn_to(normals[k], p.place.face_normal);
            self.reflect_arriving(p, face.id, &arrives(corners[k]), normal, to_eye)
        };
        interpolate_color([at(0), at(1), at(2)], p.place.barycentric)
    }

    /// As [`Self::reflect`], with light of another colour for the highlight.
    fn reflect_arriving(
        &self,
        p: &Point,
        triangle: u32,
        arriving: &Arriving,
        normal: Vec3,
        to_eye: Vec3,
    ) -> Vec3 {
        let Arriving { diffuse, highlight } = arriving;
        let Some(highlight) = highlight else { return self.reflect(p, triangle, diffuse, normal, to_eye) };
        let mut matt = p.material;
        matt.specular = Vec3::ZERO;
        let shiny = p.material.with_diffuse(Vec3::ZERO);
        matt.reflect(diffuse, normal, to_eye) + shiny.reflect(highlight, normal, to_eye)
    }

    /// Whether a micropoint reflects nothing.
    pub(crate) fn is_black(&self, p: &Point, triangle: u32) -> bool {
        let black = p.material.diffuse == Vec3::ZERO && p.material.specular == Vec3::ZERO;
        black && self.measured(triangle).is_none()
    }

    /// By the material's formula, or as measured.
    pub(crate) fn reflect(
        &self,
        p: &Point,
        triangle: u32,
        incident: &Incident,
        normal: Vec3,
        to_eye: Vec3,
    ) -> Vec3 {
        match self.measured(triangle) {
            Some(measured) => measured.table.reflect(incident, normal, to_eye),
            None => p.material.reflect(incident, normal, to_eye),
        }
    }

    /// The measured reflection of a triangle's material, which takes the place of its constants.
    pub(crate) fn measured(&self, triangle: u32) -> Option<&MeasuredBrdf> {
        let material = self.scene.mesh.material(triangle) as usize;
        self.scene.materials[material].details.measured.as_ref()
    }
}

/// Cosine below which a light is behind a face for certain: directions are rounded by less.
const BEHIND: f64 = -1e-6;

/// Whether a light is behind the face of a place, so that [`sees_light`] would say no. Much less work than to find what arrives.
fn is_turned_away(place: &Place, source: Source) -> bool {
    let to_light = match source {
        Source::Position(from) => from - place.position,
        Source::Direction(direction) => -direction,
        _ => return false,
    };
    place.face_normal.as_dvec3().dot(to_light) < BEHIND * to_light.abs().element_sum()
}

/// Corners of a fragment relative to the eye, in world axes.
pub(crate) fn corners<'t>(
    tile: &'t Tile,
    m: &Micropoint,
    fragment: &Fragment,
) -> impl Iterator<Item = DVec3> + use<'t> {
    let face = &tile.faces()[m.face as usize];
    tile.outline(fragment).iter().map(|&v| tile.position(v, face.nearness_at(v)))
}

/// Asks for shadows of each pixel's fragments: of all if there are no more than `count`, else of `count` at even steps of what they would
/// send to the eye. Their mean fraction, weighted by what each would send, stands for all.
fn ask_for_some(tile: &Tile, count: usize, scratch: &mut DirectScratch) {
    let DirectScratch { receivers, arrivals, shared, candidates, asked_weights, .. } = scratch;
    shared.clear();
    asked_weights.clear();
    let pixel = |a: &Arrival| {
        let m = &tile.points()[a.point as usize];
        (m.x, m.y)
    };
    let mut first = 0;
    for group in arrivals.chunk_by(|a, b| pixel(a) == pixel(b)) {
        candidates.clear();
        for a in group {
            let m = &tile.points()[a.point as usize];
            let bright = f64::from(a.radiance.element_sum());
            candidates.extend(tile.fragments(m).iter().map(|f| (a.point, *f, f.weight * bright)));
        }
        let asked = asked_weights.len();
        choose_asked(candidates, count, |point, fragment, weight| {
            let m = &tile.points()[point as usize];
            receivers.push_outline(m.face, tile.outline(fragment), false);
            asked_weights.push(weight);
        });
        shared.push((first..first + group.len(), asked..asked_weights.len()));
        first += group.len();
    }
}

/// Calls `ask` with fragments and their weights, each fragment at most once.
fn choose_asked(candidates: &[(u32, Fragment, f64)], count: usize, mut ask: impl FnMut(u32, &Fragment, f64)) {
    if candidates.len() <= count {
        candidates.iter().for_each(|(point, fragment, weight)| ask(*point, fragment, *weight));
        return;
    }
    let total: f64 = candidates.iter().map(|c| c.2).sum();
    let (mut sum, mut taken) = (0.0, 0);
    for (point, fragment, weight) in candidates {
        sum += weight;
        let before = taken;
        while taken < count && sum * count as f64 > (taken as f64 + 0.5) * total {
            taken += 1;
        }
        if taken > before {
            ask(*point, fragment, (taken - before) as f64);
        }
    }
}

/// What [`ask_for_some`] asked for.
fn shared_fractions(scratch: &mut DirectScratch) {
    let DirectScratch { arrivals, shared, lit, asked_weights, .. } = scratch;
    for (group, asked) in shared.iter() {
        let (lit, weights) = (&lit[asked.clone()], &asked_weights[asked.clone()]);
        let total: f64 = weights.iter().sum();
        let sum: f64 = lit.iter().zip(weights).map(|(lit, weight)| lit * weight).sum();
        // Where nothing arrives anyway, there is nothing to be asked.
        let mean = if total > 0.0 { sum / total } else { 0.0 };
        arrivals[group.clone()].iter_mut().for_each(|a| a.fraction = mean);
    }
}
