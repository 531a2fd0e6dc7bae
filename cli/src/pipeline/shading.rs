//! Shades the micropoints of a tile: each once, and asks for light only where it can matter.

use super::ambient::{Ambient, Spot};
use super::background::Background;
use super::canvas::Pixels;
use super::direct::DirectScratch;
use super::lights::LightSample;
use super::prepared::Prepared;
use super::reflections::Reflections;
use super::surfaces::Surfaces;
use crate::image_io::LayerKind;
use crate::job::{Stats, ThreadClock};
use crate::scene::{NONE, Scene};
use glam::{DVec3, Vec3, Vec4};
use pointillist_delaunay::Hint;
use pointillist_micropoint::{Face, Fragment, LensKind, Micropoint, SurfacePoint, Tile};
use pointillist_shade::{Interpolation, Material, face_normal, interpolate_color, interpolate_normal};
use pointillist_shadow::ShadowCounts;
use pointillist_view::View;

/// What a frame shows of the scene's light.
#[derive(Clone, Copy)]
pub(super) struct Style<'a> {
    /// Light that does not come straight from lights.
    pub(super) ambient: Ambient<'a>,
    /// Surfaces that glow are seen to glow.
    pub(super) emission: bool,
    /// What comes straight from the lights is seen.
    pub(super) lights: bool,
    /// For pictures that are only summed up: fewer questions about details within a pixel.
    pub(super) economy: Option<Economy>,
}

/// How much is asked about details smaller than a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Economy {
    /// Fragments of a pixel whose shadow is computed, for each light.
    pub(super) shadows_per_pixel: usize,
    /// Fragments of a micropoint, the heaviest, whose texels are averaged.
    pub(super) textures_per_micropoint: usize,
}

/// What all tiles share.
pub(super) struct Shader<'a> {
    pub(super) scene: &'a Scene,
    pub(super) surfaces: &'a Surfaces,
    pub(super) reflections: &'a Reflections,
    lights: &'a [LightSample<'a>],
    pub(super) economy: Option<Economy>,
    pub(super) ambient: Ambient<'a>,
    emission: bool,
    pub(super) eye: DVec3,
    pub(super) forward: DVec3,
}

/// Per-thread memory.
#[derive(Default)]
pub(super) struct ShaderScratch {
    pub(super) points: Vec<Point>,
    pub(super) direct: DirectScratch,
    polygon: Vec<SurfacePoint>,
    pub(super) pixels: Pixels,
    hint: Hint,
}

impl ShaderScratch {
    pub(super) fn take_counts(&mut self) -> ShadowCounts {
        self.direct.shadow.take_counts()
    }
}

/// A micropoint while it is shaded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// World position.
    pub(super) position: DVec3,
    pub(super) barycentric: Vec3,
    pub(super) to_eye: Vec3,
    /// Unit face normal, on the eye's side.
    pub(super) face_normal: Vec3,
    /// Unit normal to shade with.
    pub(super) normal: Vec3,
    pub(super) material: Material,
    pub(super) direct: Vec3,
    /// Reflected ambient light.
    pub(super) indirect: Vec3,
}

/// A point of a surface before light is added.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    pub(super) triangle: u32,
    /// Whether its front is seen.
    pub(super) front: bool,
    pub(super) position: DVec3,
    pub(super) to_eye: Vec3,
    pub(super) face_normal: Vec3,
    pub(super) normal: Vec3,
    pub(super) material: Material,
}

impl Surface {
    /// Where ambient light is asked for, from around a direction.
    pub(super) fn spot(&self, normal: Vec3) -> Spot {
        let Self { position, triangle, front, face_normal, .. } = *self;
        Spot { position, triangle, front, face_normal, normal }
    }
}

impl<'a> Shader<'a> {
    pub(super) fn new(
        prepared: &'a Prepared<'_>,
        lights: &'a [LightSample<'a>],
        view: &View,
        style: &Style<'a>,
    ) -> Self {
        let Style { ambient, emission, economy, .. } = *style;
        Self {
            scene: prepared.scene,
            surfaces: &prepared.surfaces,
            reflections: &prepared.reflections,
            lights,
            economy,
            ambient,
            emission,
            eye: view.eye(),
            forward: view.forward(),
        }
    }

    /// Shades a tile.
    pub(super) fn shade<'s>(
        &self,
        tile: &Tile,
        background: &Background<'_>,
        layers: &[LayerKind],
        scratch: &'s mut ShaderScratch,
        clock: &mut ThreadClock,
        stats: &Stats,
    ) -> &'s Pixels {
        let ShaderScratch { points, polygon, hint, .. } = scratch;
        points.clear();
        points.extend(tile.points().iter().map(|m| self.set_up(tile, m, polygon, hint)));
        let lit_layers: Vec<usize> =
            layers.iter().filter_map(|l| if let LayerKind::Lit(i) = l { Some(*i) } else { None }).collect();
        let mut lit =
            vec![vec![0.0; if lit_layers.is_empty() { 0 } else { tile.points().len() }]; lit_layers.len()];
        for light in self.lights {
            let lit = lit_layers.iter().position(|&l| l == light.light).map(|i| &mut lit[i]);
            self.add_light(tile, light, scratch, lit, clock, stats);
        }
        self.gather(tile, background, layers, &lit, scratch);
        clock.book(stats, "shade");
        &scratch.pixels
    }

    fn set_up(&self, tile: &Tile, m: &Micropoint, polygon: &mut Vec<SurfacePoint>, hint: &mut Hint) -> Point {
        let face = &tile.faces()[m.face as usize];
        let at = face.point(tile.lens(), m.grid);
        let relative = tile.position(m.grid, at.nearness);
        let to_eye = match tile.lens().kind {
            LensKind::Perspective => -relative.normalize_or_zero(),
            LensKind::Orthographic => -self.forward,
        };
        let corners = self.corners(face.id);
        let normal = face_normal(corners[0], corners[1], corners[2]);
        let face_normal = if face.front { normal } else { -normal }.as_vec3();
        let (barycentric, to_eye) = (at.barycentric.as_vec3(), to_eye.as_vec3());
        let described = &self.scene.materials[self.scene.mesh.material_of[face.id as usize] as usize];
        let mut material = self.textured(tile, m, face, described.surface, polygon);
        if !self.scene.mesh.colors.is_empty() {
            material.diffuse *= self.vertex_color(face.id, barycentric);
        }
        if !self.emission {
            material.emission = Vec3::ZERO;
        }
        let position = self.eye + relative;
        let normal = self.shading_normal(face, barycentric, face_normal, to_eye);
        if let Some(maps) = self.surfaces.details(face.id) {
            let (triangle, front) = (face.id, face.front);
            let mut s = Surface { triangle, front, position, to_eye, face_normal, normal, material };
            let occlusion = self.apply_maps(&described.details, maps, &mut s, |each| {
                self.for_outlines(tile, m, face, polygon, each);
            });
            let indirect = self.surrounding_light(&described.details, &s, occlusion, hint);
            let Surface { normal, material, .. } = s;
            return Point {
                position,
                barycentric,
                to_eye,
                face_normal,
                normal,
                material,
                direct: Vec3::ZERO,
                indirect,
            };
        }
        // What reflects nothing needs no light.
        let indirect = if material.diffuse == Vec3::ZERO {
            Vec3::ZERO
        } else {
            let spot = Spot { position, triangle: face.id, front: face.front, face_normal, normal };
            self.ambient.at(&spot, hint) * material.diffuse
        };
        Point { position, barycentric, to_eye, face_normal, normal, material, direct: Vec3::ZERO, indirect }
    }

    fn shading_normal(&self, face: &Face, barycentric: Vec3, face_normal: Vec3, to_eye: Vec3) -> Vec3 {
        match self.corner_normals(face.id) {
            Some(normals) if self.scene.render.shading == Interpolation::Phong => {
                interpolate_normal(normals, barycentric, face_normal, to_eye)
            }
            _ => face_normal,
        }
    }

    pub(super) fn corner_normals(&self, triangle: u32) -> Option<[Vec3; 3]> {
        let mesh = &self.scene.mesh;
        let of = mesh.normal_of.get(triangle as usize)?;
        (!of.contains(&NONE)).then(|| of.map(|i| mesh.normals[i as usize]))
    }

    /// The material with its albedo averaged over what is seen of the micropoint.
    fn textured(
        &self,
        tile: &Tile,
        m: &Micropoint,
        face: &Face,
        material: Material,
        polygon: &mut Vec<SurfacePoint>,
    ) -> Material {
        if !self.surfaces.has_color(face.id) {
            return material;
        }
        let (mut sum, mut total) = (Vec4::ZERO, 0.0);
        self.for_outlines(tile, m, face, polygon, &mut |polygon, weight| {
            sum += self.surfaces.premultiplied_color(face.id, polygon) * weight;
            total += weight;
        });
        if total <= 0.0 {
            return material;
        }
        material.with_diffuse(material.diffuse * self.surfaces.straight_color(face.id, sum / total))
    }

    /// What is seen of a micropoint, piece by piece, with the weight of each.
    fn for_outlines(
        &self,
        tile: &Tile,
        m: &Micropoint,
        face: &Face,
        polygon: &mut Vec<SurfacePoint>,
        each: &mut dyn FnMut(&[SurfacePoint], f32),
    ) {
        let fragments = tile.fragments(m);
        let limit = self.economy.map_or(usize::MAX, |e| e.textures_per_micropoint);
        let lightest = heaviest_weights(fragments, limit);
        for fragment in fragments.iter().filter(|f| f.weight >= lightest).take(limit) {
            polygon.clear();
            polygon.extend(tile.outline(fragment).iter().map(|&v| face.point(tile.lens(), v)));
            each(polygon, fragment.weight as f32);
        }
    }

    fn vertex_color(&self, triangle: u32, barycentric: Vec3) -> Vec3 {
        let mesh = &self.scene.mesh;
        interpolate_color(mesh.triangles[triangle as usize].map(|v| mesh.colors[v as usize]), barycentric)
    }

    /// Corners of a triangle.
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let mesh = &self.scene.mesh;
        mesh.triangles[triangle as usize].map(|v| mesh.positions[v as usize])
    }
}

/// The smallest weight among the `count` heaviest fragments; 0 if there are no more than that.
fn heaviest_weights(fragments: &[Fragment], count: usize) -> f64 {
    if fragments.len() <= count {
        return 0.0;
    }
    let mut weights: Vec<f64> = fragments.iter().map(|f| f.weight).collect();
    let (_, nth, _) = weights.select_nth_unstable_by(count - 1, |a, b| b.total_cmp(a));
    *nth
}
