//! What a material has beyond its constants, at one micropoint: further maps, tilted normals, mirrored surroundings.

use crate::detail_maps::{DetailMaps, DetailMeans};
use crate::reflections::Mirrored;
use crate::scene::{BumpHeight, Details, Map};
use crate::shader::{ShadedSurface, Shader};
use glam::Vec3;
use pointillist_delaunay::Hint;
use pointillist_micropoint::SurfacePoint;
use pointillist_shade::{Material, Model, UvFrame, coat_albedo, keep_visible, mirror, refract};

/// What the maps of a material say of light that does not come straight from lights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mapped {
    /// The share of ambient and mirrored light that arrives.
    pub(crate) occlusion: f32,
    /// What arrives in the place of ambient light, if the material says so.
    pub(crate) light: Option<Vec3>,
    /// Factor on what is mirrored.
    pub(crate) reflection: Vec3,
}

impl Mapped {
    /// What no maps say.
    pub(crate) const NOTHING: Self = Self { occlusion: 1.0, light: None, reflection: Vec3::ONE };
}

/// Directions to ask the surroundings about, and what each counts.
type Looks = [(Vec3, Vec3); 2];

impl Shader<'_> {
    /// Applies the maps to material and normal; what they say of ambient light comes back.
    pub(crate) fn apply_maps(
        &self,
        details: &Details,
        maps: &DetailMaps,
        surface: &mut ShadedSurface,
        outlines: impl FnMut(&mut dyn FnMut(&[SurfacePoint], f32)),
    ) -> Mapped {
        let means = if maps.any() {
            maps.means(self.surfaces.uvs(), surface.triangle, outlines)
        } else {
            DetailMeans::NEUTRAL
        };
        let m = &mut surface.material;
        m.specular *= means.specular;
        m.emission *= means.emission;
        m.shininess *= means.shininess;
        m.roughness *= means.roughness;
        if let Some(metallic) = details.metallic {
            let metallic = (metallic * means.metallic).clamp(0.0, 1.0);
            m.specular = m.specular.lerp(m.diffuse, metallic);
            m.diffuse *= 1.0 - metallic;
        }
        self.tilt(details, &means, surface);
        let share = details.occlusion.map_or(1.0, |(_, strength)| strength);
        Mapped {
            occlusion: 1.0 + share * (means.occlusion - 1.0),
            light: means.light,
            reflection: means.reflection,
        }
    }

    fn tilt(&self, details: &Details, means: &DetailMeans, s: &mut ShadedSurface) {
        if details.bump.is_none() && details.normal.is_none() {
            return;
        }
        let corners = self.scene.corners(s.triangle);
        let frame = |map: Map| UvFrame::new(corners, self.surfaces.uvs().of(s.triangle, &map.place));
        let side = if s.front { 1.0 } else { -1.0 };
        let mut normal = s.normal;
        let mut variance = 0.0;
        if let Some((map, scale)) = details.normal
            && let Some(frame) = frame(map)
        {
            let v = means.normal;
            normal = frame.mapped(normal, side, Vec3::new(scale * v.x, scale * v.y, v.z));
            let slopes = means.normal_slopes;
            variance += scale * scale * (slopes.z - slopes.truncate().length_squared());
        }
        if let Some(bump) = details.bump
            && let Some(frame) = frame(bump.map)
        {
            let height = match bump.height {
                BumpHeight::World(height) => height,
                BumpHeight::OfTexture(share) => share * frame.span,
            };
            normal = frame.bumped(normal, side, means.slope * height);
            variance += height * height * spread(&frame, means);
        }
        if variance > LEAST_VARIANCE {
            s.material = s.material.widened(variance);
        }
        if normal != s.normal {
            s.normal = keep_visible(normal, s.to_eye, s.face_normal);
        }
    }

    /// Ambient light and surroundings, as the surface sends them to the eye.
    pub(crate) fn surrounding_light(
        &self,
        details: &Details,
        surface: &ShadedSurface,
        mapped: &Mapped,
        hint: &mut Hint,
    ) -> Vec3 {
        let s = surface;
        let is_ggx = s.material.model == Model::Ggx;
        let coat = if is_ggx { coat(&s.material, s) } else { Vec3::ZERO };
        let through = s.material.ambient_albedo() * (Vec3::ONE - coat);
        let mut light = if through == Vec3::ZERO {
            Vec3::ZERO
        } else {
            mapped.light.unwrap_or_else(|| self.ambient.at(&s.spot(s.normal), hint)) * through
        };
        for (direction, weight) in looks(details, surface, coat, mapped.reflection) {
            if weight != Vec3::ZERO {
                light += self.seen_towards(details, surface, direction, hint) * weight;
            }
        }
        light * mapped.occlusion
    }

    /// What comes from about a direction. Without a map of the surroundings, it is ambient light from there.
    fn seen_towards(&self, details: &Details, s: &ShadedSurface, direction: Vec3, hint: &mut Hint) -> Vec3 {
        let (spot, roughness) = (s.spot(s.normal), s.material.roughness);
        match self.reflections.of(self.scene, details, s.triangle) {
            Some(Mirrored::Around(map)) => map.radiance(direction, roughness),
            Some(Mirrored::Scene(map)) => self.ambient.towards_map(&spot, direction, roughness, map, hint),
            None => self.ambient.towards(&spot, direction, roughness, hint),
        }
    }
}

/// Variance of slopes that counts as none: an eighth of the narrowest highlight's α². What is left of a difference of means by rounding is less.
const LEAST_VARIANCE: f32 = 1e-7;

/// The variance of the slopes of a height map about their mean, summed over both directions on the surface, for a height of 1.
fn spread(frame: &UvFrame, means: &DetailMeans) -> f32 {
    let (u, v) = (frame.gradient_u, frame.gradient_v);
    let mean = means.slope;
    let about_mean = means.slope_products - Vec3::new(mean.x * mean.x, mean.x * mean.y, mean.y * mean.y);
    about_mean.dot(Vec3::new(u.length_squared(), 2.0 * u.dot(v), v.length_squared()))
}

/// The share of even light that a GGX surface mirrors to the eye.
fn coat(material: &Material, s: &ShadedSurface) -> Vec3 {
    if material.specular == Vec3::ZERO {
        return Vec3::ZERO;
    }
    coat_albedo(material.specular, material.roughness, s.normal.dot(s.to_eye))
}

/// Where the eye looks on from a surface: mirrored, and through it.
fn looks(details: &Details, s: &ShadedSurface, coat: Vec3, factor: Vec3) -> Looks {
    let is_ggx = s.material.model == Model::Ggx;
    let mirrored = match details.mirrors_by_normal {
        true => s.normal,
        false => above(mirror(s.to_eye, s.normal), s.face_normal),
    };
    // 1 without a map.
    let tint = |without: Vec3| details.reflection.unwrap_or(without) * factor;
    let Some(glass) = details.transmission.filter(|t| !t.is_straight()) else {
        let weight = if is_ggx { coat * tint(Vec3::ONE) } else { tint(Vec3::ZERO) };
        return [(mirrored, weight), (mirrored, Vec3::ZERO)];
    };
    // Seen from behind, the look goes out of what is behind the front.
    let index = if s.front { glass.index } else { 1.0 / glass.index };
    let onward = refract(s.to_eye, s.normal, index);
    let reflectance = if is_ggx { coat } else { Vec3::splat(onward.reflectance) };
    let passed = if onward.reflectance < 1.0 { glass.color * (Vec3::ONE - reflectance) } else { Vec3::ZERO };
    [(mirrored, reflectance * tint(Vec3::ONE)), (onward.direction, passed)]
}

/// A mirrored direction that a tilted normal sends into the surface, brought back up to it.
fn above(direction: Vec3, face_normal: Vec3) -> Vec3 {
    let depth = direction.dot(face_normal);
    if depth >= 0.0 { direction } else { (direction - 2.0 * depth * face_normal).normalize_or(face_normal) }
}
