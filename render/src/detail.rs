//! What a material has beyond its constants, at one micropoint: further maps, tilted normals, mirrored surroundings.

use crate::detail_maps::{DetailMaps, DetailMeans};
use crate::reflections::Mirrored;
use crate::scene::{BumpHeight, Details};
use crate::shader::{ShadedSurface, Shader};
use glam::Vec3;
use pointillist_delaunay::Hint;
use pointillist_micropoint::SurfacePoint;
use pointillist_shade::{Material, Model, UvFrame, coat_albedo, keep_visible, mirror, refract};

/// Directions to ask the surroundings about, and what each counts.
type Looks = [(Vec3, Vec3); 2];

impl Shader<'_> {
    /// Applies the maps to material and normal; the share of ambient light that is left comes back.
    pub(crate) fn apply_maps(
        &self,
        details: &Details,
        maps: &DetailMaps,
        surface: &mut ShadedSurface,
        outlines: impl FnMut(&mut dyn FnMut(&[SurfacePoint], f32)),
    ) -> f32 {
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
        1.0 + share * (means.occlusion - 1.0)
    }

    fn tilt(&self, details: &Details, means: &DetailMeans, s: &mut ShadedSurface) {
        if details.bump.is_none() && details.normal.is_none() {
            return;
        }
        let corners = self.scene.corners(s.triangle);
        let Some(frame) = UvFrame::new(corners, self.surfaces.uvs().of(s.triangle)) else { return };
        let side = if s.front { 1.0 } else { -1.0 };
        let mut normal = s.normal;
        let mut variance = 0.0;
        if let Some((_, scale)) = details.normal {
            let v = means.normal;
            normal = frame.mapped(normal, side, Vec3::new(scale * v.x, scale * v.y, v.z));
            let slopes = means.normal_slopes;
            variance += scale * scale * (slopes.z - slopes.truncate().length_squared());
        }
        if let Some(bump) = details.bump {
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
        occlusion: f32,
        hint: &mut Hint,
    ) -> Vec3 {
        let s = surface;
        let is_ggx = s.material.model == Model::Ggx;
        let coat = if is_ggx { coat(&s.material, s) } else { Vec3::ZERO };
        let through = s.material.diffuse * (Vec3::ONE - coat);
        let mut light = if through == Vec3::ZERO {
            Vec3::ZERO
        } else {
            self.ambient.at(&s.spot(s.normal), hint) * through
        };
        for (direction, weight) in looks(details, surface, coat) {
            if weight != Vec3::ZERO {
                light += self.seen_towards(details, surface, direction, hint) * weight;
            }
        }
        light * occlusion
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
fn looks(details: &Details, s: &ShadedSurface, coat: Vec3) -> Looks {
    let is_ggx = s.material.model == Model::Ggx;
    let mirrored = above(mirror(s.to_eye, s.normal), s.face_normal);
    let tint = details.reflection;
    let Some(glass) = details.transmission.filter(|t| !t.is_straight()) else {
        let weight = if is_ggx { coat * tint.unwrap_or(Vec3::ONE) } else { tint.unwrap_or(Vec3::ZERO) };
        return [(mirrored, weight), (mirrored, Vec3::ZERO)];
    };
    // Seen from behind, the look goes out of what is behind the front.
    let index = if s.front { glass.index } else { 1.0 / glass.index };
    let onward = refract(s.to_eye, s.normal, index);
    let tint = tint.unwrap_or(Vec3::ONE);
    let reflectance = if is_ggx { coat } else { Vec3::splat(onward.reflectance) };
    let passed = if onward.reflectance < 1.0 { glass.color * (Vec3::ONE - reflectance) } else { Vec3::ZERO };
    [(mirrored, reflectance * tint), (onward.direction, passed)]
}

/// A mirrored direction that a tilted normal sends into the surface, brought back up to it.
fn above(direction: Vec3, face_normal: Vec3) -> Vec3 {
    let depth = direction.dot(face_normal);
    if depth >= 0.0 { direction } else { (direction - 2.0 * depth * face_normal).normalize_or(face_normal) }
}
