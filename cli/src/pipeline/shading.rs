//! Shades the micropoints of a tile: each once, and asks for light only where it can matter.

use super::LightSample;
use super::background::Background;
use super::canvas::Pixels;
use super::surfaces::Surfaces;
use crate::image_io::LayerKind;
use crate::job::{Stats, ThreadClock};
use crate::scene::{NONE, Scene};
use glam::{DVec3, Vec3};
use pointillist_micropoint::{Face, LensKind, Micropoint, SurfacePoint, Tile, View};
use pointillist_shade::{
    Interpolation, Material, face_normal, interpolate_color, interpolate_normal, sees_light, turn_to,
};
use pointillist_shadow::{Receivers, ShadowCounts, ShadowScratch, Viewer};

/// What all tiles share.
pub(crate) struct Shader<'a> {
    scene: &'a Scene,
    surfaces: &'a Surfaces,
    lights: &'a [LightSample<'a>],
    eye: DVec3,
    forward: DVec3,
}

/// Per-thread memory.
#[derive(Default)]
pub(crate) struct ShaderScratch {
    points: Vec<Point>,
    receivers: Receivers,
    shadow: ShadowScratch,
    lit: Vec<f64>,
    arrivals: Vec<Arrival>,
    polygon: Vec<SurfacePoint>,
    pixels: Pixels,
}

impl ShaderScratch {
    pub(crate) fn take_counts(&mut self) -> ShadowCounts {
        self.shadow.take_counts()
    }
}

/// A micropoint while it is shaded.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// World position.
    position: DVec3,
    barycentric: Vec3,
    to_eye: Vec3,
    /// Unit face normal, on the eye's side.
    face_normal: Vec3,
    /// Unit normal to shade with.
    normal: Vec3,
    material: Material,
    direct: Vec3,
}

/// Light that would reach a micropoint if nothing stood in its way.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    point: u32,
    radiance: Vec3,
}

impl<'a> Shader<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        surfaces: &'a Surfaces,
        lights: &'a [LightSample<'a>],
        view: &View,
    ) -> Self {
        Self { scene, surfaces, lights, eye: view.eye(), forward: view.forward() }
    }

    /// Shades a tile.
    pub(crate) fn shade<'s>(
        &self,
        tile: &Tile,
        background: &Background,
        layers: &[LayerKind],
        scratch: &'s mut ShaderScratch,
        clock: &mut ThreadClock,
        stats: &Stats,
    ) -> &'s Pixels {
        let ShaderScratch { points, polygon, .. } = scratch;
        points.clear();
        points.extend(tile.points().iter().map(|m| self.set_up(tile, m, polygon)));
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

    fn set_up(&self, tile: &Tile, m: &Micropoint, polygon: &mut Vec<SurfacePoint>) -> Point {
        let face = &tile.faces()[m.face as usize];
        let at = face.point(tile.lens(), m.grid);
        let relative = tile.position(m.grid, at.nearness);
        let to_eye = match tile.lens().kind {
            LensKind::Perspective => -relative.normalize_or_zero(),
            LensKind::Orthographic => -self.forward,
        };
        let mesh = &self.scene.mesh;
        let corners = mesh.triangles[face.id as usize].map(|v| mesh.positions[v as usize]);
        let normal = face_normal(corners[0], corners[1], corners[2]);
        let face_normal = if face.front { normal } else { -normal }.as_vec3();
        let (barycentric, to_eye) = (at.barycentric.as_vec3(), to_eye.as_vec3());
        let material = &self.scene.materials[mesh.material_of[face.id as usize] as usize];
        Point {
            position: self.eye + relative,
            barycentric,
            to_eye,
            face_normal,
            normal: self.shading_normal(face, barycentric, face_normal, to_eye),
            material: self.textured(tile, m, face, material.surface, polygon),
            direct: Vec3::ZERO,
        }
    }

    fn shading_normal(&self, face: &Face, barycentric: Vec3, face_normal: Vec3, to_eye: Vec3) -> Vec3 {
        match self.corner_normals(face.id) {
            Some(normals) if self.scene.render.shading == Interpolation::Phong => {
                interpolate_normal(normals, barycentric, face_normal, to_eye)
            }
            _ => face_normal,
        }
    }

    fn corner_normals(&self, triangle: u32) -> Option<[Vec3; 3]> {
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
        let (mut sum, mut total) = (Vec3::ZERO, 0.0);
        for fragment in tile.fragments(m) {
            polygon.clear();
            polygon.extend(tile.outline(fragment).iter().map(|&v| face.point(tile.lens(), v)));
            let weight = fragment.weight as f32;
            sum += self.surfaces.color(face.id, polygon).color * weight;
            total += weight;
        }
        if total > 0.0 { material.with_diffuse(material.diffuse * (sum / total)) } else { material }
    }

    /// Adds one light: what would arrive, times the fraction of it that does.
    fn add_light(
        &self,
        tile: &Tile,
        light: &LightSample<'_>,
        scratch: &mut ShaderScratch,
        mut lit_layer: Option<&mut Vec<f64>>,
        clock: &mut ThreadClock,
        stats: &Stats,
    ) {
        let ShaderScratch { points, receivers, shadow, lit, arrivals, .. } = scratch;
        arrivals.clear();
        receivers.clear();
        for (i, p) in points.iter().enumerate() {
            let radiance = self.arriving(light, p, &tile.faces()[tile.points()[i].face as usize]);
            if radiance == Vec3::ZERO && lit_layer.is_none() {
                continue;
            }
            arrivals.push(Arrival { point: i as u32, radiance });
            if light.shadow.is_some() {
                let m = &tile.points()[i];
                let face = &tile.faces()[m.face as usize];
                for f in tile.fragments(m) {
                    let corner = |&v: &glam::DVec2| tile.position(v, face.nearness_at(v));
                    receivers.push(m.face, tile.outline(f).iter().map(corner));
                }
            }
        }
        clock.book(stats, "shade");
        if let Some(screens) = &light.shadow {
            let viewer = Viewer { lens: tile.lens(), faces: tile.faces() };
            screens.lit(viewer, receivers, shadow, lit);
            clock.book(stats, "shadow");
        }
        let samples = f64::from(self.scene.lights[light.light].light.samples());
        let mut next = 0;
        for a in arrivals.iter() {
            let m = &tile.points()[a.point as usize];
            let mut fraction = 1.0;
            if light.shadow.is_some() {
                let fragments = tile.fragments(m);
                let reached: f64 = fragments.iter().zip(&lit[next..]).map(|(f, l)| f.weight * l).sum();
                next += fragments.len();
                // Without a division where it would cost the last bit of a plain 0 or 1.
                let single = fragments.len() == 1;
                fraction = if single {
                    lit[next - 1]
                } else {
                    reached / fragments.iter().map(|f| f.weight).sum::<f64>()
                };
            }
            points[a.point as usize].direct += a.radiance * fraction as f32;
            if let Some(layer) = lit_layer.as_deref_mut() {
                let p = &points[a.point as usize];
                let to_light =
                    self.scene.lights[light.light].light.illuminate(light.sample, p.position).to_light;
                layer[a.point as usize] +=
                    if sees_light(p.face_normal, to_light) { fraction / samples } else { 0.0 };
            }
        }
    }

    /// Radiance that a micropoint sends to the eye because of a light, without shadow.
    fn arriving(&self, light: &LightSample<'_>, p: &Point, face: &Face) -> Vec3 {
        let source = &self.scene.lights[light.light].light;
        if p.material.diffuse == Vec3::ZERO && p.material.specular == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let incident = source.illuminate(light.sample, p.position);
        if incident.is_dark() || !sees_light(p.face_normal, incident.to_light) {
            return Vec3::ZERO;
        }
        if self.scene.render.shading == Interpolation::Gouraud
            && let Some(normals) = self.corner_normals(face.id)
        {
            let mesh = &self.scene.mesh;
            let corners = mesh.triangles[face.id as usize].map(|v| mesh.positions[v as usize]);
            let at = |k: usize| {
                let to_eye = (self.eye - corners[k]).normalize_or_zero().as_vec3();
                let incident = source.illuminate(light.sample, corners[k]);
                p.material.reflect(&incident, turn_to(normals[k], p.face_normal), to_eye)
            };
            return interpolate_color([at(0), at(1), at(2)], p.barycentric);
        }
        p.material.reflect(&incident, p.normal, p.to_eye)
    }

    /// Sums up micropoints into pixels.
    fn gather(
        &self,
        tile: &Tile,
        background: &Background,
        layers: &[LayerKind],
        lit: &[Vec<f64>],
        scratch: &mut ShaderScratch,
    ) {
        let ShaderScratch { points, pixels, .. } = scratch;
        let rect = tile.rect();
        let count = (rect.width() * rect.height()) as usize;
        let index = |m: &Micropoint| ((m.y - rect.y0) * rect.width() + (m.x - rect.x0)) as usize;
        let mut sums = vec![[0.0_f64; 4]; count];
        let mut heaviest = vec![(0.0_f64, 0_u32); count];
        for (i, (m, p)) in tile.points().iter().zip(points.iter()).enumerate() {
            let color = p.material.emission + self.scene.ambient * p.material.diffuse + p.direct;
            let s = &mut sums[index(m)];
            for (c, v) in color.to_array().into_iter().enumerate() {
                s[c] += m.weight * f64::from(v);
            }
            s[3] += m.weight;
            if m.weight > heaviest[index(m)].0 {
                heaviest[index(m)] = (m.weight, i as u32);
            }
        }
        pixels.color.clear();
        pixels.depth.clear();
        for (i, s) in sums.iter().enumerate() {
            let open = (1.0 - s[3]).max(0.0);
            let (x, y) = (rect.x0 + i as u32 % rect.width(), rect.y0 + i as u32 / rect.width());
            let behind = if open > 0.0 { background.behind(x, y) } else { Vec3::ZERO }.to_array();
            let color = std::array::from_fn(|c| {
                if c < 3 { (s[c] + open * f64::from(behind[c])) as f32 } else { s[3].min(1.0) as f32 }
            });
            pixels.color.push(color);
            let depth = |point: u32| (points[point as usize].position - self.eye).dot(self.forward) as f32;
            pixels.depth.push(if heaviest[i].0 > 0.0 { depth(heaviest[i].1) } else { f32::INFINITY });
        }
        self.gather_layers(tile, layers, lit, &heaviest, scratch);
    }

    /// The further layers: colours are means over the micropoints of a pixel, geometry is that of the
    /// one with the largest weight.
    fn gather_layers(
        &self,
        tile: &Tile,
        layers: &[LayerKind],
        lit: &[Vec<f64>],
        heaviest: &[(f64, u32)],
        scratch: &mut ShaderScratch,
    ) {
        let ShaderScratch { points, pixels, .. } = scratch;
        let rect = tile.rect();
        pixels.planes.clear();
        let mut lit = lit.iter();
        let mean = |value: &dyn Fn(usize, &Point) -> Vec3, channels: usize| {
            let mut planes = vec![vec![0.0; heaviest.len()]; channels];
            for (i, (m, p)) in tile.points().iter().zip(points.iter()).enumerate() {
                let pixel = ((m.y - rect.y0) * rect.width() + (m.x - rect.x0)) as usize;
                let value = value(i, p).to_array();
                planes.iter_mut().zip(value).for_each(|(plane, v)| plane[pixel] += m.weight as f32 * v);
            }
            planes
        };
        for layer in layers {
            let planes = match layer {
                LayerKind::Albedo => mean(&|_, p| p.material.diffuse, 3),
                LayerKind::Direct => mean(&|_, p| p.direct, 3),
                LayerKind::Indirect => mean(&|_, p| self.scene.ambient * p.material.diffuse, 3),
                LayerKind::Lit(_) => {
                    let values = lit.next().map_or(&[][..], Vec::as_slice);
                    mean(&|i, _| Vec3::splat(values.get(i).map_or(0.0, |&v| v as f32)), 1)
                }
                LayerKind::Normal | LayerKind::Position | LayerKind::Id => {
                    let value = |&(weight, i): &(f64, u32)| {
                        let p = &points.get(i as usize).filter(|_| weight > 0.0);
                        let m = tile.points().get(i as usize);
                        match (p, m) {
                            (Some(p), Some(m)) => self.geometry_value(*layer, tile, p, m),
                            _ => Vec3::ZERO,
                        }
                    };
                    let values: Vec<Vec3> = heaviest.iter().map(value).collect();
                    let channels = if *layer == LayerKind::Id { 1 } else { 3 };
                    (0..channels).map(|c| values.iter().map(|v| v[c]).collect()).collect()
                }
            };
            pixels.planes.extend(planes);
        }
    }

    fn geometry_value(&self, layer: LayerKind, tile: &Tile, p: &Point, m: &Micropoint) -> Vec3 {
        match layer {
            LayerKind::Normal => p.normal,
            LayerKind::Position => p.position.as_vec3(),
            _ => {
                let triangle = tile.faces()[m.face as usize].id as usize;
                Vec3::splat(self.scene.mesh.object_of[triangle] as f32 + 1.0)
            }
        }
    }
}
