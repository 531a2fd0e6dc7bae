//! Whether the lists of a scene fit one another.

use super::error::SceneError;
use super::{
    AmbientLight, Bump, BumpHeight, Details, LightSource, MapPlace, Material, Mesh, NONE, Scene,
    Surroundings, Transmission,
};
use glam::Vec3;
use pointillist_shade::Light;
use pointillist_shadow::{ShadowError, check_outline};

impl Scene {
    /// Whether lists fit one another, indices refer to something, and numbers are finite. Linear in the size of the scene
    /// without its texels.
    ///
    /// # Errors
    /// [`SceneError`] with the first element that is wrong.
    pub fn check(&self) -> Result<(), SceneError> {
        self.mesh.check(self.materials.len())?;
        self.textures.iter().try_for_each(|texture| {
            let found = texture.texels.len();
            super::texture::check_size(&texture.name, texture.width, texture.height, found)
        })?;
        let textures = self.textures.len();
        self.materials.iter().try_for_each(|material| material.check(textures))?;
        let environment = self.image.environment.into_iter();
        check_textures("image.environment", environment, textures)?;
        let background = self.image.background.is_finite();
        finite(background, || "image.background".to_owned())?;
        let ambient = match &self.ambient {
            AmbientLight::Color(color) => color.is_finite(),
            AmbientLight::Sky(light) => [light.sky, light.ground, light.up].iter().all(|v| v.is_finite()),
            // These were checked when they were made.
            AmbientLight::Environment
            | AmbientLight::Probes { .. }
            | AmbientLight::Radiosity { .. }
            | AmbientLight::RadiosityAndProbes { .. } => true,
        };
        finite(ambient, || "ambient".to_owned())?;
        self.lights.iter().try_for_each(check_light)
    }
}

impl Mesh {
    fn check(&self, materials: usize) -> Result<(), SceneError> {
        let count = self.triangles.len();
        let needed = |list, length, expected| {
            if length == expected { Ok(()) } else { Err(SceneError::Length { list, length, expected }) }
        };
        needed("material_of", self.material_of.len(), count)?;
        needed("object_of", self.object_of.len(), count)?;
        if !self.normal_of.is_empty() {
            needed("normal_of", self.normal_of.len(), count)?;
        }
        if !self.uv_of.is_empty() {
            needed("uv_of", self.uv_of.len(), count)?;
        }
        if !self.second_uv_of.is_empty() {
            needed("second_uv_of", self.second_uv_of.len(), count)?;
        }
        if !self.colors.is_empty() {
            needed("colors", self.colors.len(), self.positions.len())?;
        }
        check_corners("triangles", &self.triangles, self.positions.len(), false)?;
        check_corners("normal_of", &self.normal_of, self.normals.len(), true)?;
        check_corners("uv_of", &self.uv_of, self.uvs.len(), true)?;
        check_corners("second_uv_of", &self.second_uv_of, self.uvs.len(), true)?;
        check_indices("material_of", &self.material_of, materials)?;
        check_indices("object_of", &self.object_of, self.objects.len())?;
        let all_finite = |list: &'static str, wrong: Option<usize>| match wrong {
            Some(i) => Err(SceneError::NotFinite { what: format!("`{list}[{i}]`") }),
            None => Ok(()),
        };
        all_finite("normals", self.normals.iter().position(|n| !n.is_finite()))?;
        all_finite("uvs", self.uvs.iter().position(|uv| !uv.is_finite()))?;
        all_finite("colors", self.colors.iter().position(|c| !c.is_finite()))?;
        self.shapes().iter().try_for_each(|shape| shape.check(materials))
    }
}

impl Material {
    fn check(&self, textures: usize) -> Result<(), SceneError> {
        let user = format!("material `{}`", self.name);
        check_textures(&user, self.textures(), textures)?;
        let s = &self.surface;
        let numbers = Vec3::new(s.shininess, s.roughness, s.opacity);
        for (name, value) in [
            ("diffuse", s.diffuse),
            ("ambient", s.ambient_albedo()),
            ("specular", s.specular),
            ("emission", s.emission),
            ("a constant", numbers),
        ] {
            finite(value.is_finite(), || format!("{user}: {name}"))?;
        }
        for place in self.places() {
            finite(place.map_from_uv.is_finite(), || format!("{user}: the place of a map"))?;
        }
        self.details
            .numbers()
            .try_for_each(|(name, value)| finite(value.is_finite(), || format!("{user}: {name}")))?;
        if self.details.emits && s.emission == Vec3::ZERO {
            return Err(SceneError::NoEmission { material: self.name.clone() });
        }
        if self.details.emits && s.emission.min_element() < 0.0 {
            return Err(SceneError::NegativeEmission { material: self.name.clone() });
        }
        match self.details.transmission {
            Some(Transmission { index, .. }) if index <= 0.0 => {
                Err(SceneError::RefractionIndex { material: self.name.clone(), value: index })
            }
            _ => Ok(()),
        }
    }

    /// Where its maps lie.
    fn places(&self) -> impl Iterator<Item = MapPlace> {
        let own = [self.diffuse_place, self.opacity_place];
        self.details.maps().map(|map| map.place).chain(own)
    }

    /// All textures that it refers to.
    pub(crate) fn textures(&self) -> impl Iterator<Item = usize> {
        let own = match self.details.surroundings {
            Surroundings::Texture(texture) => Some(texture),
            Surroundings::Scene | Surroundings::Capture => None,
        };
        let maps = self.details.maps().map(|map| map.texture);
        maps.chain(own).chain(self.diffuse_map).chain(self.opacity_map)
    }
}

impl Details {
    /// Its numbers with their names; numbers that stand alone as three equal ones.
    fn numbers(&self) -> impl Iterator<Item = (&'static str, Vec3)> {
        let one = |name, value: Option<f32>| value.map(|v| (name, Vec3::splat(v)));
        let height = |bump: Bump| match bump.height {
            BumpHeight::World(height) | BumpHeight::OfTexture(height) => height,
        };
        [
            one("occlusion", self.occlusion.map(|(_, strength)| strength)),
            one("bump", self.bump.map(height)),
            one("normal", self.normal.map(|(_, scale)| scale)),
            one("metallic", self.metallic),
            self.reflection.map(|color| ("reflection", color)),
            self.transmission.map(|t| ("transmission", t.color)),
            one("refraction index", self.transmission.map(|t| t.index)),
        ]
        .into_iter()
        .flatten()
    }
}

fn check_textures(user: &str, used: impl Iterator<Item = usize>, count: usize) -> Result<(), SceneError> {
    let mut used = used;
    match used.find(|&texture| texture >= count) {
        Some(texture) => Err(SceneError::TextureIndex { user: user.to_owned(), texture, count }),
        None => Ok(()),
    }
}

fn check_corners(
    list: &'static str,
    corners: &[[u32; 3]],
    count: usize,
    may_be_absent: bool,
) -> Result<(), SceneError> {
    let beyond = |&v: &u32| v as usize >= count && !(may_be_absent && v == NONE);
    match corners.iter().position(|t| t.iter().any(beyond)) {
        Some(triangle) => Err(SceneError::Corner { list, triangle, count }),
        None => Ok(()),
    }
}

fn check_indices(list: &'static str, indices: &[u32], count: usize) -> Result<(), SceneError> {
    match indices.iter().position(|&i| i as usize >= count) {
        Some(triangle) => Err(SceneError::Index { list, triangle, index: indices[triangle], count }),
        None => Ok(()),
    }
}

fn finite(is_finite: bool, what: impl FnOnce() -> String) -> Result<(), SceneError> {
    if is_finite { Ok(()) } else { Err(SceneError::NotFinite { what: what() }) }
}

fn check_light(source: &LightSource) -> Result<(), SceneError> {
    let LightSource { name, light, ambient, specular, .. } = source;
    let colors_are_finite = ambient.is_finite() && specular.is_none_or(Vec3::is_finite);
    finite(is_finite(light) && colors_are_finite, || format!("light `{name}`"))?;
    let (Light::Polygon { radiance, .. } | Light::Line { radiance, .. }) = light else { return Ok(()) };
    if radiance.min_element() < 0.0 {
        return Err(SceneError::NegativeLight { name: name.clone() });
    }
    let fault = match light {
        Light::Polygon { outline, .. } => check_outline(outline.vertices()),
        Light::Line { from, to, .. } if from == to => Err(ShadowError::LineWithoutLength),
        _ => Ok(()),
    };
    fault.map_err(|fault| SceneError::LightOutline { name: name.clone(), fault })
}

fn is_finite(light: &Light) -> bool {
    let color = light.color().is_finite();
    color
        && match *light {
            Light::Directional { direction, .. } => direction.is_finite(),
            Light::Point { position, .. } => position.is_finite(),
            Light::Spot { position, direction, beam_rad, cutoff_rad, exponent, .. } => {
                position.is_finite()
                    && direction.is_finite()
                    && exponent.is_finite()
                    && beam_rad.is_finite()
                    && cutoff_rad.is_finite()
            }
            Light::Rect { corner, edge_u, edge_v, .. } => {
                corner.is_finite() && edge_u.is_finite() && edge_v.is_finite()
            }
            Light::Line { from, to, .. } => from.is_finite() && to.is_finite(),
            Light::Polygon { outline, .. } => outline.vertices().iter().all(|v| v.is_finite()),
            _ => true,
        }
}
