//! Which part of each micropoint a light reaches, and what the maps of its material hold there.
//!
//! The mean of a texture over a micropoint times the fraction of it that is lit is not what the light meets where a shadow's edge runs across
//! texels. Maps of micropoints that are lit in part are averaged over their lit regions once more, for each light.

use crate::direct::DirectScratch;
use crate::lights::LightSample;
use crate::shader::{Point, Shader};
use crate::surfaces::Surfaces;
use glam::{DVec2, Vec3};
use pointillist_micropoint::{Face, Fragment, SurfacePoint, TexturedOpacity, Tile};
use pointillist_shadow::ShadowScratch;
use std::ops::Range;

/// The fragments of a micropoint, and what of a light reaches each.
struct LitFragments<'a> {
    tile: &'a Tile,
    face: &'a Face,
    fragments: &'a [Fragment],
    lit: &'a [f64],
    /// Number of the first of them among the receivers.
    first: usize,
}

impl LitFragments<'_> {
    /// The fraction of the light that reaches the micropoint, 0..=1.
    fn fraction(&self) -> f64 {
        if let [single] = self.lit {
            // Without a division, which would cost the last bit of a plain 0 or 1.
            return *single;
        }
        let reached: f64 = self.fragments.iter().zip(self.lit).map(|(f, lit)| f.weight * lit).sum();
        reached / self.weight()
    }

    fn weight(&self) -> f64 {
        self.fragments.iter().map(|f| f.weight).sum()
    }
}

/// The lit parts of one micropoint.
#[derive(Default)]
pub(crate) struct LitParts {
    corners: Vec<SurfacePoint>,
    /// The same corners in the picture.
    outlines: Vec<DVec2>,
    /// The corners of each, and its weight: its share of the pixel times the transmittance on the way from the light.
    list: Vec<(Range<usize>, f64)>,
}

impl LitParts {
    /// Collects the lit parts of a micropoint; its lit fraction comes back.
    fn collect(&mut self, of: &LitFragments<'_>, shadow: &ShadowScratch, surfaces: &Surfaces) -> f64 {
        self.corners.clear();
        self.outlines.clear();
        self.list.clear();
        let masked = surfaces.is_masked(of.face.id);
        for (i, (fragment, lit)) in of.fragments.iter().zip(of.lit).enumerate() {
            let outline = of.tile.outline(fragment);
            let regions = || shadow.lit_regions((of.first + i) as u32);
            let total: f64 = regions().map(|region| region.weight).sum();
            if total <= 0.0 {
                self.push(of, outline, fragment.weight * lit);
                continue;
            }
            // What shows through the holes of the receiver's own mask is not lit.
            let opacity = |corners: &[SurfacePoint]| f64::from(surfaces.rough_opacity(of.face.id, corners));
            let whole = if masked { opacity(self.push(of, outline, 0.0)) } else { 1.0 };
            for region in regions() {
                let share = fragment.weight * lit * (region.weight / total);
                let corners = self.push(of, region.outline, share);
                if masked && whole > 0.0 {
                    let weight = share * opacity(corners) / whole;
                    self.list.last_mut().expect("pushed above").1 = weight;
                }
            }
        }
        self.list.iter().map(|part| part.1).sum::<f64>() / of.weight()
    }

    fn push(&mut self, of: &LitFragments<'_>, outline: &[DVec2], weight: f64) -> &[SurfacePoint] {
        let first = self.corners.len();
        self.corners.extend(of.face.points(of.tile.lens(), outline.iter().copied()));
        self.outlines.extend(outline);
        self.list.push((first..self.corners.len(), weight));
        &self.corners[first..]
    }

    /// Outlines in the picture, with their weight.
    fn outlines(&self) -> impl Iterator<Item = (&[DVec2], f64)> {
        self.list.iter().map(|(corners, weight)| (&self.outlines[corners.clone()], *weight))
    }

    fn for_each(&self, each: &mut dyn FnMut(&[SurfacePoint], f32)) {
        for (corners, weight) in self.list.iter().filter(|part| part.1 > 0.0) {
            each(&self.corners[corners.clone()], *weight as f32);
        }
    }
}

impl Shader<'_> {
    /// Asks for the light on every fragment of every arrival.
    pub(crate) fn ask_for_all(&self, tile: &Tile, direct: &mut DirectScratch) {
        let DirectScratch { receivers, arrivals, .. } = direct;
        for a in arrivals.iter() {
            let m = &tile.points()[a.point as usize];
            let varies = a.is_close || self.surfaces.varies(tile.faces()[m.face as usize].id);
            for fragment in tile.fragments(m) {
                receivers.push_outline(m.face, tile.outline(fragment), varies);
            }
        }
    }

    /// Takes what [`Shader::ask_for_all`] asked for: the fraction of each arrival, and its radiance where the lit part differs from the whole.
    pub(crate) fn take_all(
        &self,
        tile: &Tile,
        light: &LightSample<'_>,
        points: &[Point],
        with_dark: bool,
        direct: &mut DirectScratch,
    ) {
        let after_shadow = self.reflects_after_shadow(light);
        let DirectScratch { shadow, lit, arrivals, lit_parts, .. } = direct;
        let mut first = 0;
        for a in arrivals {
            let m = &tile.points()[a.point as usize];
            let (face, fragments) = (&tile.faces()[m.face as usize], tile.fragments(m));
            let lit = &lit[first..][..fragments.len()];
            let of = LitFragments { tile, face, fragments, lit, first };
            first += fragments.len();
            a.fraction = of.fraction();
            if after_shadow {
                if a.fraction == 0.0 {
                    continue;
                }
                let p = &points[a.point as usize];
                (a.radiance, a.is_close) = self.without_shadow(tile, light, p, m, || a.is_close);
                if a.radiance == Vec3::ZERO && !with_dark {
                    continue;
                }
            }
            // What is evenly lit is seen as without shadow.
            let is_even = || fragments.len() == 1 && shadow.lit_regions(of.first as u32).next().is_none();
            let is_partly_lit = a.fraction > 0.0 && a.fraction < 1.0 && !is_even();
            let varies = is_partly_lit && self.surfaces.varies(face.id);
            if varies || (is_partly_lit && a.is_close) {
                a.fraction = lit_parts.collect(&of, shadow, self.surfaces).min(1.0);
                let mut lit_part = points[a.point as usize];
                if varies {
                    let look = self.face_look(face);
                    let (surface, _) =
                        self.surface(face, &look, &lit_part.place, |each| lit_parts.for_each(each));
                    (lit_part.normal, lit_part.material) = (surface.normal, surface.material);
                }
                a.radiance = match a.is_close {
                    true => self.mean_arriving(tile, light, (&lit_part, face), lit_parts.outlines()),
                    false => self.arriving(light, &lit_part, face),
                };
            }
        }
    }
}
