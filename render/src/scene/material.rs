//! What surfaces are made of.

use super::details::Details;
use super::map_place::{MapPlace, UvSet};
use pointillist_shade as shade;
use pointillist_shade::Wrap;

/// What a surface is made of.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Material {
    /// For error messages.
    pub name: String,
    /// Model and constants; where there is a map, the constant is multiplied by it.
    pub surface: shade::Material,
    /// Index of the texture of the diffuse albedo.
    pub diffuse_map: Option<usize>,
    /// Index of the texture whose alpha is the opacity.
    pub opacity_map: Option<usize>,
    /// What these two textures are outside the unit square. Default: they repeat.
    pub wrap: Wrap,
    /// Where the first of these textures lies on the surface.
    pub diffuse_place: MapPlace,
    /// Where the second of them lies. If that is elsewhere, colours are averaged without regard to holes: those in a hole count.
    pub opacity_place: MapPlace,
    /// Everything else. Default: nothing.
    pub details: Details,
}

impl Material {
    /// A material of constants alone.
    #[must_use]
    pub fn new(name: impl Into<String>, surface: shade::Material) -> Self {
        Self {
            name: name.into(),
            surface,
            diffuse_map: None,
            opacity_map: None,
            wrap: Wrap::Repeat,
            diffuse_place: MapPlace::default(),
            opacity_place: MapPlace::default(),
            details: Details::default(),
        }
    }

    /// The same material with its diffuse albedo multiplied by a texture.
    #[must_use]
    pub fn with_diffuse_map(mut self, texture: usize) -> Self {
        self.diffuse_map = Some(texture);
        self
    }

    /// The same material with its opacity multiplied by the alpha of a texture.
    #[must_use]
    pub fn with_opacity_map(mut self, texture: usize) -> Self {
        self.opacity_map = Some(texture);
        self
    }

    /// The same material with further maps and properties.
    #[must_use]
    pub fn with_details(mut self, details: Details) -> Self {
        self.details = details;
        self
    }

    /// Whether any of its maps asks for these texture coordinates.
    #[must_use]
    pub fn uses(&self, set: UvSet) -> bool {
        let color = self.diffuse_map.map(|_| self.diffuse_place);
        let opacity = self.opacity_map.map(|_| self.opacity_place);
        let mut places = self.details.maps().map(|map| map.place).chain(color).chain(opacity);
        places.any(|place| place.set == set)
    }

    /// Whether any texture is looked up, so that texture coordinates matter.
    #[must_use]
    pub fn has_maps(&self) -> bool {
        self.diffuse_map.is_some() || self.opacity_map.is_some() || self.details.has_maps()
    }
}
