//! What a material has beyond its constants: further maps, mirrored surroundings, measured reflection.

use super::map_place::MapPlace;
use glam::{Vec3, Vec4};
use pointillist_shade::{AutoUv, MerlTable, Wrap};
use std::fmt;
use std::sync::Arc;

/// What a material has beyond its constants; the default is nothing, and then nothing is computed for it.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Details {
    /// Multiplies the specular albedo.
    pub specular_map: Option<Map>,
    /// Multiplies the exponent.
    pub shininess_map: Option<Map>,
    /// Multiplies the roughness.
    pub roughness_map: Option<Map>,
    /// Multiplies `metallic`; ignored without it.
    pub metallic_map: Option<Map>,
    /// Multiplies the emission.
    pub emission_map: Option<Map>,
    /// Multiplies `reflection`; for GGX and where light is transmitted, what is mirrored.
    pub reflection_map: Option<Map>,
    /// Light that arrives on the surface besides that of the lights, in the place of ambient light: reflected as albedo · texel. What it lights is seen
    /// by probes, as that which emits; to `radiosity` the map is nothing.
    pub light_map: Option<Map>,
    /// The share of ambient and mirrored light that arrives, and how much of the map counts.
    pub occlusion: Option<(Map, f32)>,
    /// Heights.
    pub bump: Option<Bump>,
    /// Normals in the texture's own frame, and the factor on their x and y.
    pub normal: Option<(Map, f32)>,
    /// How metallic a GGX surface is, 0 to 1: what of the diffuse albedo becomes reflectance instead.
    pub metallic: Option<f32>,
    /// Measured reflection, in the place of a formula.
    pub measured: Option<MeasuredBrdf>,
    /// The share of its surroundings that it mirrors; for GGX a factor on what its roughness and reflectance say.
    pub reflection: Option<Vec3>,
    /// What passes of the light from behind, by refraction. Direct light passes straight, in its colour at each surface; to `radiosity` the
    /// material is opaque.
    pub transmission: Option<Transmission>,
    /// What is mirrored and seen through the surface.
    pub surroundings: Surroundings,
    /// The surroundings are looked up along the normal, not along the mirrored view: as a map of what arrives from each side, and not as a mirror.
    pub mirrors_by_normal: bool,
    /// Texture coordinates made from positions instead of those of the mesh.
    pub uv: Option<AutoUv>,
    /// Whether the back is not drawn.
    pub one_sided: bool,
    /// Whether its polygons are lights: they light others directly, with exact shadows, and are no light sources of probes and radiosity
    /// besides. Each sends out the mean of its emission, from its front, and from its back if that is drawn. Needs an emission.
    ///
    /// Coplanar neighbours are joined to convex polygons, of which each costs about what a rectangular light costs: a flat lamp is one,
    /// a round bulb has as many as triangles.
    pub emits: bool,
}

/// One number or colour per texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// Index into [`super::Scene::textures`].
    pub texture: usize,
    /// Outside the unit square.
    pub wrap: Wrap,
    /// What of the texel counts where a number is wanted.
    pub channel: Channel,
    /// Where it lies on the surface.
    pub place: MapPlace,
}

impl Map {
    /// A texture that repeats, by the first texture coordinates; where a number is wanted, the mean of red, green and blue counts.
    #[must_use]
    pub fn new(texture: usize) -> Self {
        Self { texture, wrap: Wrap::Repeat, channel: Channel::Mean, place: MapPlace::default() }
    }
}

/// What of a texel is taken as a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Channel {
    /// The mean of red, green and blue.
    #[default]
    Mean,
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
}

impl Channel {
    /// The number that a texel stands for.
    #[must_use]
    pub fn of(self, texel: Vec4) -> f32 {
        match self {
            Self::Mean => (texel.x + texel.y + texel.z) / 3.0,
            Self::Red => texel.x,
            Self::Green => texel.y,
            Self::Blue => texel.z,
        }
    }
}

/// A height map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bump {
    /// Heights from 0 to 1.
    pub map: Map,
    /// What 1 stands for.
    pub height: BumpHeight,
}

/// How high a bump is whose texel is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BumpHeight {
    /// In world units.
    World(f32),
    /// As a share of the length in the world that the texture spans on the triangle.
    OfTexture(f32),
}

/// Light from behind a clear surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission {
    /// The share of each colour that passes, 0 to 1. What passes straight is lost to the diffuse albedo: that counts by 1 − the largest share.
    pub color: Vec3,
    /// Refraction index of what is behind the front. 1 is a thin sheet, which light passes straight: what is behind is seen through it. With
    /// any other, the surroundings are seen, refracted once.
    pub index: f32,
}

impl Transmission {
    /// Whether what is behind is seen through it.
    #[must_use]
    pub fn is_straight(&self) -> bool {
        self.index == 1.0
    }
}

impl Details {
    /// The share of each colour that passes straight: 0 where the surface is not clear, or refracts.
    #[must_use]
    pub fn passes_straight(&self) -> Vec3 {
        self.transmission.filter(Transmission::is_straight).map_or(Vec3::ZERO, |t| t.color)
    }
}

/// Where mirrored light comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Surroundings {
    /// The scene's environment map.
    #[default]
    Scene,
    /// A map of its own, as [`super::ImageSettings::environment`] has one: index into [`super::Scene::textures`].
    Texture(usize),
    /// Six pictures of the scene from the middle of the object, without the object.
    Capture,
}

/// A measured BRDF, shared by the materials that have it.
#[derive(Clone)]
pub struct MeasuredBrdf {
    /// The table.
    pub table: Arc<MerlTable>,
    /// Stands for the table in comparisons and in [`crate::fingerprint`]: a hash of its file, for instance.
    pub fingerprint: u64,
}

impl PartialEq for MeasuredBrdf {
    fn eq(&self, other: &Self) -> bool {
        self.fingerprint == other.fingerprint
    }
}

impl fmt::Debug for MeasuredBrdf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Not the table, which has a million entries.
        write!(f, "MeasuredBrdf({:016x})", self.fingerprint)
    }
}

impl Details {
    /// Whether any map needs texture coordinates.
    #[must_use]
    pub fn has_maps(&self) -> bool {
        self.maps().next().is_some()
    }

    /// All maps that lie on the surface.
    pub(super) fn maps(&self) -> impl Iterator<Item = Map> {
        [
            self.specular_map,
            self.shininess_map,
            self.roughness_map,
            self.metallic_map,
            self.emission_map,
            self.reflection_map,
            self.light_map,
            self.occlusion.map(|(map, _)| map),
            self.bump.map(|bump| bump.map),
            self.normal.map(|(map, _)| map),
        ]
        .into_iter()
        .flatten()
    }
}
