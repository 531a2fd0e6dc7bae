//! Shades the micropoints of a tile: each once, and asks for light only where it can matter.

use crate::background::Background;
use crate::direct::{DirectScratch, corners};
use crate::face_look::FaceLooks;
use crate::frame::LayerKind;
use crate::lights::LightSample;
use crate::monitor::Monitor;
use crate::partial::Pixels;
use crate::shader::{Point, Shader};
use crate::shaft::Box3;
use glam::DVec3;
use pointillist_delaunay::Hint;
use pointillist_micropoint::{SurfacePoint, Tile};
use pointillist_shade::Interpolation;
use pointillist_shadow::{AreaCounts, ShadowCounts};
use std::collections::BTreeMap;

/// Per-thread memory.
#[derive(Default)]
pub(crate) struct ShaderScratch {
    points: Vec<Point>,
    looks: FaceLooks,
    direct: DirectScratch,
    polygon: Vec<SurfacePoint>,
    hint: Hint,
}

impl ShaderScratch {
    pub(crate) fn take_counts(&mut self) -> (ShadowCounts, AreaCounts) {
        let mut whole = self.direct.area.take_counts();
        whole += self.direct.line.take_counts();
        (self.direct.shadow.take_counts(), whole)
    }
}

impl Shader<'_> {
    /// Shades a tile.
    pub(crate) fn shade(
        &self,
        tile: &Tile,
        background: &Background<'_>,
        layers: &[LayerKind],
        scratch: &mut ShaderScratch,
        pixels: &mut Pixels,
        monitor: &dyn Monitor,
    ) {
        let ShaderScratch { points, looks, direct, polygon, hint } = scratch;
        points.clear();
        looks.start(tile.faces().len());
        points.extend(tile.points().iter().map(|m| {
            let look = looks.of(m.face, || self.face_look(&tile.faces()[m.face as usize]));
            self.set_up(tile, m, look, !layers.is_empty(), polygon, hint)
        }));
        let mut lit = BTreeMap::new();
        for layer in layers {
            if let LayerKind::Lit(light) = layer {
                lit.insert(*light, vec![DVec3::ZERO; tile.points().len()]);
            }
        }
        let within = if self.lights.are_tinted() { self.bounds(tile) } else { (DVec3::ZERO, DVec3::ZERO) };
        let mut places = None;
        for light in
            self.lights.samples.iter().filter(|l| self.counts(l.channels, l.occasion, l.origin, within))
        {
            let layer = lit.get_mut(&light.light);
            if layer.is_some() || self.reaches(light, points, &mut places) {
                self.add_light(tile, light, points, direct, layer, monitor);
            }
        }
        let mut asked = None;
        for light in
            self.lights.whole.iter().filter(|l| self.counts(l.channels, l.occasion, l.origin, within))
        {
            let layer = light.light.and_then(|number| lit.get_mut(&number));
            if asked != Some(layer.is_some()) {
                self.ask_for_whole(tile, points, layer.is_some(), direct);
                asked = Some(layer.is_some());
            }
            self.add_whole_light(tile, light, points, direct, layer, monitor);
        }
        self.gather(tile, background, points, pixels);
        self.gather_layers(tile, layers, &lit, points, pixels);
        monitor.lap("shade");
    }

    /// Whether a light reaches any of the points; `places` is the box around them, once it is known.
    fn reaches(&self, light: &LightSample<'_>, points: &[Point], places: &mut Option<Box3>) -> bool {
        // Gouraud's rule lights the corners of triangles, which may be far away.
        if !light.is_narrow || self.scene.render.shading == Interpolation::Gouraud {
            return true;
        }
        let (low, high) = *places.get_or_insert_with(|| {
            let grow = |(low, high): Box3, p: &Point| (low.min(p.place.position), high.max(p.place.position));
            points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), grow)
        });
        self.scene.lights[light.light].light.may_reach(low, high)
    }

    /// The box around all that a tile sees, in the world.
    fn bounds(&self, tile: &Tile) -> Box3 {
        let corners =
            tile.points().iter().flat_map(|m| tile.fragments(m).iter().flat_map(|f| corners(tile, m, f)));
        let grow = |(low, high): Box3, c: DVec3| (low.min(self.eye + c), high.max(self.eye + c));
        corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), grow)
    }
}
