//! Materials, and the radiance that they reflect towards the eye.

use crate::{Incident, LARGEST_IRRADIANCE, Lobe, brdf, ggx, roughness};
use glam::Vec3;

/// Reflectance of clear lacquer, plastic or glass (index 1.5) at normal incidence: ((1.5 − 1)/(1.5 + 1))².
pub const DIELECTRIC_REFLECTANCE: f32 = 0.04;

/// Which formula a [`Material`] reflects by.
///
/// The normalised Phong models conserve energy when `diffuse + specular ≤ 1`; the plain ones do not promise to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Model {
    /// `diffuse/π`, the same in all directions.
    #[default]
    Lambert,
    /// Lambert plus `specular · (r·v)^m`, with `r` the mirrored light \[1\].
    Phong,
    /// Lambert plus `specular · (m+2)/2π · (r·v)^m` \[3\].
    NormalizedPhong,
    /// Lambert plus `specular · (h·n)^m`, with `h` half way between light and eye \[2\].
    BlinnPhong,
    /// Lambert plus `specular · c(m) · (h·n)^m`, with `c` so that a mirror-like surface returns all light at normal
    /// incidence \[4\].
    NormalizedBlinnPhong,
    /// A rough coat of reflectance `specular` at normal incidence (1 at grazing angles) and perceptual `roughness` over
    /// a Lambert base that gets the light which the coat lets through. Conserves energy for `diffuse ≤ 1` and
    /// `specular ≤ 1`. Light that would bounce more than once between the facets is lost: up to half at roughness 1.
    Ggx,
    /// OpenGL's formula \[5\], of what arrives: `E · (max(l·n,0) · diffuse + max(h·n,0)^m · specular)`, the highlight only where l·n > 0, with `h` half way
    /// between light and eye. Not physical: not divided by π, and the highlight is not weighted by the cosine. [`crate::gl`] has the whole of it.
    OpenGl,
    /// The same with Phong's `max(r·v,0)^m` \[1\], with `r` the mirrored light.
    OpenGlPhong,
}

impl Model {
    /// Whether it is OpenGL's formula, with either highlight.
    #[must_use]
    pub const fn is_opengl(self) -> bool {
        matches!(self, Self::OpenGl | Self::OpenGlPhong)
    }
}

/// What a surface is made of, at one point (textures are looked up before).
///
/// Start from [`Material::lambert`], [`Material::ggx`] or [`Material::metallic_roughness`] and set what differs: further fields may come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Material {
    /// How it reflects.
    pub model: Model,
    /// Diffuse albedo.
    pub diffuse: Vec3,
    /// How ambient light is reflected, if not as `diffuse`: OpenGL's Ma.
    pub ambient: Option<Vec3>,
    /// Specular albedo; for [`Model::Ggx`] the reflectance at normal incidence. Not used by [`Model::Lambert`].
    pub specular: Vec3,
    /// The exponent `m` of the Phong models; negative counts as 0.
    pub shininess: f32,
    /// Perceptual roughness of [`Model::Ggx`], whose α is its square; cut to [[`crate::SMALLEST_ROUGHNESS`], 1].
    pub roughness: f32,
    /// Radiance that the surface sends out by itself.
    pub emission: Vec3,
    /// Opacity: 1 is opaque, 0 invisible.
    pub opacity: f32,
}

impl Default for Material {
    /// A grey Lambert surface of albedo 0.8.
    fn default() -> Self {
        Self::lambert(Vec3::splat(0.8))
    }
}

impl Material {
    /// An opaque Lambert surface.
    #[must_use]
    pub const fn lambert(diffuse: Vec3) -> Self {
        Self {
            model: Model::Lambert,
            diffuse,
            ambient: None,
            specular: Vec3::ZERO,
            shininess: 0.0,
            roughness: 1.0,
            emission: Vec3::ZERO,
            opacity: 1.0,
        }
    }

    /// An opaque surface of [`Model::Ggx`]: a base of albedo `diffuse` under a coat of reflectance `specular` at normal incidence and
    /// this perceptual roughness.
    #[must_use]
    pub const fn ggx(diffuse: Vec3, specular: Vec3, roughness: f32) -> Self {
        let mut surface = Self::lambert(diffuse);
        surface.model = Model::Ggx;
        surface.specular = specular;
        surface.roughness = roughness;
        surface
    }

    /// The same with another diffuse albedo, as read from a texture.
    #[must_use]
    pub const fn with_diffuse(mut self, diffuse: Vec3) -> Self {
        self.diffuse = diffuse;
        self
    }

    /// The same that reflects ambient light by an albedo of its own.
    #[must_use]
    pub const fn with_ambient(mut self, ambient: Vec3) -> Self {
        self.ambient = Some(ambient);
        self
    }

    /// The same with its colours multiplied, as by a texture: the diffuse and the ambient albedo.
    #[must_use]
    pub fn colored(mut self, factor: Vec3) -> Self {
        self.diffuse *= factor;
        self.ambient = self.ambient.map(|ambient| ambient * factor);
        self
    }

    /// What ambient light is reflected by.
    #[must_use]
    pub fn ambient_albedo(&self) -> Vec3 {
        self.ambient.unwrap_or(self.diffuse)
    }

    /// The albedo of the Lambert surface that reflects what this one's diffuse part reflects of light from lights: for OpenGL's formula, π times `diffuse`.
    #[must_use]
    pub fn lambert_albedo(&self) -> Vec3 {
        if self.model.is_opengl() { self.diffuse * std::f32::consts::PI } else { self.diffuse }
    }

    /// The same with another model, specular albedo and exponent.
    #[must_use]
    pub const fn with_specular(mut self, model: Model, specular: Vec3, shininess: f32) -> Self {
        self.model = model;
        self.specular = specular;
        self.shininess = shininess;
        self
    }

    /// The same with another perceptual roughness, for [`Model::Ggx`].
    #[must_use]
    pub const fn with_roughness(mut self, roughness: f32) -> Self {
        self.roughness = roughness;
        self
    }

    /// The same with another radiance that it sends out by itself.
    #[must_use]
    pub const fn with_emission(mut self, emission: Vec3) -> Self {
        self.emission = emission;
        self
    }

    /// The same with another opacity, 0 to 1.
    #[must_use]
    pub const fn with_opacity(mut self, opacity: f32) -> Self {
        self.opacity = opacity;
        self
    }

    /// The same with a highlight that is as wide as those of many normals together: their slopes over the surface vary by `variance`
    /// about the mean, summed over both directions \[18\], \[19\].
    ///
    /// α² of the half vector's distribution grows by the variance, up to 1. For the Phong models α² is 2/(m + 2) of the exponent m for half vectors,
    /// and what the highlight reflects in sum stays the same. No variance (or NaN) gives the same material, bit by bit.
    #[must_use]
    pub fn widened(mut self, variance: f32) -> Self {
        if variance.is_nan() || variance <= 0.0 || !self.depends_on_view() {
            return self;
        }
        let exponent = |m: f32, halves: f32| {
            // Mirrored directions turn by twice the angle: their exponent is a quarter of that of half vectors.
            let alpha2 = 2.0 / (halves * m.max(0.0) + 2.0) + variance;
            ((2.0 / alpha2 - 2.0) / halves).max(0.0)
        };
        let m = self.shininess.max(0.0);
        match self.model {
            Model::Lambert => {}
            Model::Ggx => {
                let alpha = roughness::alpha(self.roughness);
                self.roughness = (alpha * alpha + variance).min(1.0).sqrt().sqrt();
            }
            Model::NormalizedPhong => self.shininess = exponent(m, 4.0),
            Model::NormalizedBlinnPhong => self.shininess = exponent(m, 1.0),
            Model::Phong | Model::OpenGlPhong => {
                self.shininess = exponent(m, 4.0);
                self.specular *= brdf::phong_norm(self.shininess) / brdf::phong_norm(m);
            }
            Model::BlinnPhong | Model::OpenGl => {
                self.shininess = exponent(m, 1.0);
                self.specular *= brdf::blinn_norm(self.shininess) / brdf::blinn_norm(m);
            }
        }
        self
    }

    /// A GGX surface as glTF describes it: `metallic` 0 has `base` as its diffuse albedo under a clear coat of
    /// reflectance [`DIELECTRIC_REFLECTANCE`], 1 mirrors `base` and has no diffuse part.
    #[must_use]
    pub fn metallic_roughness(base: Vec3, metallic: f32, roughness: f32) -> Self {
        let specular = Vec3::splat(DIELECTRIC_REFLECTANCE).lerp(base, metallic);
        Self::ggx(base * (1.0 - metallic), specular, roughness)
    }

    /// The BRDF: radiance towards `to_eye` per irradiance from `to_light`; 0 where either is below the surface.
    ///
    /// All three are unit vectors away from the surface. Reciprocal: exchanging light and eye gives the same; OpenGL's formula is not.
    #[must_use]
    pub fn brdf(&self, normal: Vec3, to_light: Vec3, to_eye: Vec3) -> Vec3 {
        if normal.dot(to_light) <= 0.0 || normal.dot(to_eye) <= 0.0 {
            return Vec3::ZERO;
        }
        let m = self.shininess;
        let lobe = match self.model {
            Model::OpenGl | Model::OpenGlPhong => {
                return self.opengl(normal, to_light, to_eye) / normal.dot(to_light);
            }
            Model::Lambert => return brdf::lambert(self.diffuse),
            Model::Ggx => {
                return ggx::brdf(self.diffuse, self.specular, self.roughness, normal, to_light, to_eye);
            }
            Model::Phong => brdf::phong_lobe(normal, to_light, to_eye, m),
            Model::NormalizedPhong => brdf::phong_norm(m) * brdf::phong_lobe(normal, to_light, to_eye, m),
            Model::BlinnPhong => brdf::blinn_lobe(normal, to_light, to_eye, m),
            Model::NormalizedBlinnPhong => {
                brdf::blinn_norm(m) * brdf::blinn_lobe(normal, to_light, to_eye, m)
            }
        };
        brdf::lambert(self.diffuse) + self.specular * lobe
    }

    /// Radiance towards `to_eye` of what arrives: BRDF · irradiance · cosine. Without emission.
    ///
    /// A surface seen exactly edge-on counts as just visible, so that a Lambert surface keeps its value there.
    #[must_use]
    pub fn reflect(&self, incident: &Incident, normal: Vec3, to_eye: Vec3) -> Vec3 {
        let cos_light = normal.dot(incident.to_light);
        if cos_light <= 0.0 || incident.is_dark() {
            return Vec3::ZERO;
        }
        if self.model.is_opengl() {
            return finite(self.opengl(normal, incident.to_light, to_eye) * incident.irradiance);
        }
        let f = match self.model {
            Model::Lambert => brdf::lambert(self.diffuse),
            _ => self.brdf(normal, incident.to_light, to_eye),
        };
        finite(f * incident.irradiance * cos_light)
    }

    /// OpenGL's formula for light of irradiance 1 that comes from above the surface.
    fn opengl(&self, normal: Vec3, to_light: Vec3, to_eye: Vec3) -> Vec3 {
        let m = self.shininess;
        let highlight = match self.model {
            Model::OpenGlPhong => brdf::phong_lobe(normal, to_light, to_eye, m),
            _ => brdf::blinn_lobe(normal, to_light, to_eye, m),
        };
        self.diffuse * normal.dot(to_light) + self.specular * highlight
    }

    /// The lobe of the specular part, for one direction to the eye.
    ///
    /// Its width is that of the distribution of normals, doubled by mirroring: for the Phong models the angle at which cosᵐ is e^−½.
    #[must_use]
    pub fn lobe(&self, normal: Vec3, to_eye: Vec3) -> Lobe {
        let by_power = 1.0 / self.shininess.max(1.0).sqrt();
        let width_rad = match self.model {
            Model::Lambert => 1.0,
            // Seen from aside the lobe is narrower across, by the cosine.
            Model::Ggx => 2.0 * roughness::alpha(self.roughness) * normal.dot(to_eye).clamp(0.1, 1.0),
            Model::Phong | Model::NormalizedPhong | Model::OpenGlPhong => by_power,
            Model::BlinnPhong | Model::NormalizedBlinnPhong | Model::OpenGl => 2.0 * by_power,
        };
        Lobe { axis: 2.0 * normal.dot(to_eye) * normal - to_eye, width_rad }
    }

    /// Whether reflection depends on where the eye is; if not, one value serves all views.
    #[must_use]
    pub fn depends_on_view(&self) -> bool {
        self.model != Model::Lambert && self.specular != Vec3::ZERO
    }
}

pub(crate) fn finite(color: Vec3) -> Vec3 {
    color.clamp(Vec3::splat(-LARGEST_IRRADIANCE), Vec3::splat(LARGEST_IRRADIANCE))
}
