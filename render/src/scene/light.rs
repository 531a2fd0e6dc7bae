//! The lights of a scene.

use glam::Vec3;
use pointillist_shade::Light;
use pointillist_shadow::Resolution;

/// A light and how its shadow is made.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LightSource {
    /// Names the layer `lit.<name>` and is part of error messages.
    pub name: String,
    /// What it sends out.
    pub light: Light,
    /// What it adds to ambient light, weakened as its light is, but not by shadows and wherever a surface faces: OpenGL's La. Only surfaces of
    /// OpenGL's formula see it. Default: nothing.
    pub ambient: Vec3,
    /// What highlights of surfaces of OpenGL's formula are of, in the place of the light's own colour and in the same unit: OpenGL's Ls. Only lights of
    /// one point or direction have it. Default: the light's own colour.
    pub specular: Option<Vec3>,
    /// Whether it casts shadows. Default: it does.
    pub shadow: bool,
    /// Cells of its shadow grid; only the paper's rule ([`crate::Occlusion::Paper`]) has one. Default: as fine as its receivers.
    pub resolution: Resolution,
}

impl LightSource {
    /// A light that casts shadows.
    #[must_use]
    pub fn new(name: impl Into<String>, light: Light) -> Self {
        Self {
            name: name.into(),
            light,
            ambient: Vec3::ZERO,
            specular: None,
            shadow: true,
            resolution: Resolution::Auto,
        }
    }

    /// The same light with ambient light of its own.
    #[must_use]
    pub fn with_ambient(mut self, ambient: Vec3) -> Self {
        self.ambient = ambient;
        self
    }

    /// The same light with highlights of another colour on surfaces of OpenGL's formula.
    #[must_use]
    pub fn with_specular(mut self, specular: Option<Vec3>) -> Self {
        self.specular = specular;
        self
    }

    /// The light in the colour of its highlights on surfaces of OpenGL's formula, if that is another.
    pub(crate) fn of_highlights(&self) -> Option<Light> {
        self.specular.map(|color| self.light.with_color(color))
    }

    /// The same light with or without shadows.
    #[must_use]
    pub fn with_shadow(mut self, shadow: bool) -> Self {
        self.shadow = shadow;
        self
    }

    /// The same light with so many cells in its shadow grid.
    #[must_use]
    pub fn with_resolution(mut self, resolution: Resolution) -> Self {
        self.resolution = resolution;
        self
    }
}
