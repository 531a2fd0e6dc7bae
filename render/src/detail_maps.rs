//! The maps of a material beyond colour and opacity, summed up for exact means.
//!
//! Each is averaged by itself over what is seen of a micropoint, and shading works with the means. Bump maps are averaged as
//! slopes and normal maps as vectors, not as heights and colours: the mean of slopes is the slope of the mean height, and
//! a mean of normals is the normal of what they cover together. How far slopes are spread about their mean widens the highlight: the
//! means of their products say so (LEAN mapping, M. Olano, D. Baker, I3D 2010).

use crate::scene::{Channel, Details, Map, MapPlace, Material, Scene, Texels, Texture, unit_of_byte};
use crate::texel_sums::{self, Lazy, color_sums, when_needed};
use crate::uvs::{Uvs, texel_wrap};
use glam::{Vec2, Vec3, Vec4, vec3};
use pointillist_micropoint::{MicropointError, SurfacePoint, TexelSums};
use pointillist_parallel as parallel;
use pointillist_shade::{Model, Wrap, slope_of_heights};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The sums of a map, shared by the materials that have it.
type Sums<const N: usize> = Arc<Lazy<TexelSums<N>>>;

/// A map's sums and where it lies on the surface.
struct Placed<const N: usize> {
    sums: Sums<N>,
    place: MapPlace,
}

impl<const N: usize> Placed<N> {
    fn mean(&self, uvs: &Uvs, triangle: u32, polygon: &[SurfacePoint]) -> [f64; N] {
        uvs.mean(triangle, polygon, &self.sums, &self.place)
    }
}

/// What sums are made of: a map, wherever it lies.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Source {
    texture: usize,
    wrap: Wrap,
    channel: Channel,
}

impl Source {
    fn of(Map { texture, wrap, channel, .. }: Map) -> Self {
        Self { texture, wrap, channel }
    }
}

/// The maps of one material.
#[derive(Default)]
pub(crate) struct DetailMaps {
    specular: Option<Placed<3>>,
    emission: Option<Placed<3>>,
    reflection: Option<Placed<3>>,
    light: Option<Placed<3>>,
    shininess: Option<Placed<1>>,
    roughness: Option<Placed<1>>,
    metallic: Option<Placed<1>>,
    occlusion: Option<Placed<1>>,
    /// Slopes along u and v.
    slope: Option<Placed<2>>,
    /// Their products u², u v and v², where there is a highlight to widen.
    slope_products: Option<Placed<3>>,
    normal: Option<Placed<3>>,
    /// Slopes x and y of the normals and their square in sum, likewise.
    normal_slopes: Option<Placed<3>>,
}

/// Means over what is seen; where there is no map, what changes nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DetailMeans {
    pub(crate) specular: Vec3,
    pub(crate) emission: Vec3,
    pub(crate) reflection: Vec3,
    /// Light that arrives, in the place of ambient light; nothing without a light map.
    pub(crate) light: Option<Vec3>,
    pub(crate) shininess: f32,
    pub(crate) roughness: f32,
    pub(crate) metallic: f32,
    pub(crate) occlusion: f32,
    /// Of the heights from 0 to 1, per unit of u and v.
    pub(crate) slope: Vec2,
    /// u², u v and v² of the slopes.
    pub(crate) slope_products: Vec3,
    /// Of the normal map; not of unit length.
    pub(crate) normal: Vec3,
    /// Slopes x and y of the normal map, and x² + y².
    pub(crate) normal_slopes: Vec3,
}

/// Maps that materials share, each summed up once.
pub(crate) struct DetailTable {
    numbers: HashMap<Source, Sums<1>>,
    colors: HashMap<Source, Sums<3>>,
    slopes: HashMap<Source, Sums<2>>,
    slope_products: HashMap<Source, Sums<3>>,
    normals: HashMap<Source, Sums<3>>,
    normal_slopes: HashMap<Source, Sums<3>>,
}

impl DetailTable {
    /// The maps of all materials.
    pub(crate) fn new(scene: &Scene) -> Result<Self, MicropointError> {
        let maps = |of: fn(&Details) -> [Option<Map>; 4]| -> HashSet<Source> {
            scene.materials.iter().flat_map(|m| of(&m.details)).flatten().map(Source::of).collect()
        };
        let in_highlights = |of: fn(&Details) -> Option<Map>| -> HashSet<Source> {
            let shiny = scene.materials.iter().filter(|m| has_highlight(m));
            shiny.filter_map(|m| of(&m.details)).map(Source::of).collect()
        };
        let numbers =
            maps(|d| [d.shininess_map, d.roughness_map, d.metallic_map, d.occlusion.map(|(map, _)| map)]);
        let colors = maps(|d| [d.specular_map, d.emission_map, d.reflection_map, d.light_map]);
        // Heights that are all the same have no slope.
        let mut slopes = maps(|d| [d.bump.map(|bump| bump.map), None, None, None]);
        slopes.retain(|map| !scene.textures[map.texture].is_constant());
        let mut widening = in_highlights(|d| d.bump.map(|bump| bump.map));
        widening.retain(|map| slopes.contains(map));
        let normals = maps(|d| [d.normal.map(|(map, _)| map), None, None, None]);
        Ok(Self {
            numbers: all(&numbers, scene, number_sums)?,
            colors: all(&colors, scene, |map, t| color_sums(t, texel_wrap(map.wrap)))?,
            slopes: all(&slopes, scene, slope_sums)?,
            slope_products: all(&widening, scene, slope_product_sums)?,
            normals: all(&normals, scene, normal_sums)?,
            normal_slopes: all(&in_highlights(|d| d.normal.map(|(map, _)| map)), scene, normal_slope_sums)?,
        })
    }

    /// The maps of a material.
    pub(crate) fn maps(&self, material: &Material) -> DetailMaps {
        let details = &material.details;
        let bump = details.bump.map(|bump| bump.map);
        let normal = details.normal.map(|(map, _)| map);
        let in_highlight = |map: Option<Map>| map.filter(|_| has_highlight(material));
        DetailMaps {
            specular: placed(&self.colors, details.specular_map),
            emission: placed(&self.colors, details.emission_map),
            reflection: placed(&self.colors, details.reflection_map),
            light: placed(&self.colors, details.light_map),
            shininess: placed(&self.numbers, details.shininess_map),
            roughness: placed(&self.numbers, details.roughness_map),
            metallic: placed(&self.numbers, details.metallic_map),
            occlusion: placed(&self.numbers, details.occlusion.map(|(map, _)| map)),
            slope: placed(&self.slopes, bump),
            slope_products: placed(&self.slope_products, in_highlight(bump)),
            normal: placed(&self.normals, normal),
            normal_slopes: placed(&self.normal_slopes, in_highlight(normal)),
        }
    }
}

fn placed<const N: usize>(sums: &HashMap<Source, Sums<N>>, map: Option<Map>) -> Option<Placed<N>> {
    let map = map?;
    Some(Placed { sums: sums.get(&Source::of(map))?.clone(), place: map.place })
}

/// Whether a material has a highlight. A metallic map may give a GGX surface the reflectance that it lacks.
fn has_highlight(material: &Material) -> bool {
    material.surface.model == Model::Ggx || material.surface.depends_on_view()
}

fn all<const N: usize>(
    maps: &HashSet<Source>,
    scene: &Scene,
    sums: fn(Source, &Texture) -> Result<TexelSums<N>, MicropointError>,
) -> Result<HashMap<Source, Sums<N>>, MicropointError> {
    let maps: Vec<Source> = maps.iter().copied().collect();
    let one = |i: usize| {
        let map = maps[i];
        let sums = when_needed([&scene.textures[map.texture]], move |[texture]| sums(map, texture))?;
        Ok((map, Arc::new(sums)))
    };
    parallel::map_heavy(maps.len(), one).into_iter().collect()
}

fn number_sums(map: Source, t: &Texture) -> Result<TexelSums<1>, MicropointError> {
    let wrap = texel_wrap(map.wrap);
    let Texture { width, height, .. } = *t;
    if let Texels::Gray8(texels) = &t.texels {
        let values = texel_sums::values(|byte| map.channel.of(Vec3::splat(unit_of_byte(byte)).extend(1.0)));
        let texels = texels.clone();
        return match values == texel_sums::values(unit_of_byte) {
            true => TexelSums::of_levels(width, height, wrap, texels),
            false => TexelSums::from_bytes(width, height, wrap, texels, &values),
        };
    }
    TexelSums::new(width, height, wrap, |x, y| [map.channel.of(t.texel(x, y))])
}

fn slope_sums(map: Source, t: &Texture) -> Result<TexelSums<2>, MicropointError> {
    let wrap = texel_wrap(map.wrap);
    match &t.texels {
        // All channels are the grey.
        Texels::Gray8(heights) => TexelSums::slopes_of_bytes(t.width, t.height, wrap, heights.clone()),
        _ => TexelSums::new_signed(t.width, t.height, wrap, |x, y| slope(map, t, x, y).to_array()),
    }
}

fn slope_product_sums(map: Source, t: &Texture) -> Result<TexelSums<3>, MicropointError> {
    let texel = |x, y| {
        let slope = slope(map, t, x, y);
        [slope.x * slope.x, slope.x * slope.y, slope.y * slope.y]
    };
    TexelSums::new_signed(t.width, t.height, texel_wrap(map.wrap), texel)
}

fn slope(map: Source, t: &Texture, x: u32, y: u32) -> Vec2 {
    let height =
        |x: i64, y: i64| map.channel.of(t.texel(map.wrap.texel(x, t.width), map.wrap.texel(y, t.height)));
    slope_of_heights([t.width, t.height], x, y, height)
}

fn normal_sums(map: Source, t: &Texture) -> Result<TexelSums<3>, MicropointError> {
    TexelSums::new_signed(t.width, t.height, texel_wrap(map.wrap), |x, y| normal(t, x, y))
}

/// Steepest normal of a map, as its smallest z: slopes grow without limit towards the horizon, and few such texels would widen all highlights.
const LEAST_Z: f32 = 0.1;

fn normal_slope_sums(map: Source, t: &Texture) -> Result<TexelSums<3>, MicropointError> {
    let texel = |x, y| {
        let [x, y, z] = normal(t, x, y);
        let slope = Vec2::new(x, y) / z.max(LEAST_Z);
        [slope.x, slope.y, slope.length_squared()]
    };
    TexelSums::new_signed(t.width, t.height, texel_wrap(map.wrap), texel)
}

/// A normal map's vector, on the front.
fn normal(t: &Texture, x: u32, y: u32) -> [f32; 3] {
    let n = normal_of_texel(t.texel(x, y));
    [n.x, n.y, n.z.max(0.0)]
}

/// A normal map's vector: −1 to 1 stored as 0 to 1.
fn normal_of_texel(texel: Vec4) -> Vec3 {
    // Eight bits have no middle: 127 and 128 both mean 0, or flat maps would tilt by a quarter of a degree.
    const HALF_A_STEP: f32 = 0.5 / 255.0 + 1e-6;
    let centred = |v: f32| if (v - 0.5).abs() <= HALF_A_STEP { 0.0 } else { 2.0 * v - 1.0 };
    vec3(centred(texel.x), centred(texel.y), 2.0 * texel.z - 1.0)
}

impl DetailMaps {
    /// Whether any map is to be looked up.
    pub(crate) fn any(&self) -> bool {
        let colors = [&self.specular, &self.emission, &self.reflection, &self.light];
        let numbers = [&self.shininess, &self.roughness, &self.metallic, &self.occlusion];
        colors.iter().any(|map| map.is_some())
            || numbers.iter().any(|map| map.is_some())
            || self.slope.is_some()
            || self.normal.is_some()
    }

    /// The factor on the emission over a polygon of a triangle.
    pub(crate) fn emission(&self, uvs: &Uvs, triangle: u32, polygon: &[SurfacePoint]) -> Vec3 {
        self.emission.as_ref().map_or(Vec3::ONE, |map| vector(map.mean(uvs, triangle, polygon)))
    }

    /// Means over outlines, each with its weight.
    pub(crate) fn means(
        &self,
        uvs: &Uvs,
        triangle: u32,
        mut outlines: impl FnMut(&mut dyn FnMut(&[SurfacePoint], f32)),
    ) -> DetailMeans {
        let mut sum = DetailMeans::NOTHING;
        let mut total = 0.0;
        outlines(&mut |polygon, weight| {
            sum.add(self, uvs, triangle, polygon, weight);
            total += weight;
        });
        let mean = if total > 0.0 { sum.scaled(1.0 / total) } else { DetailMeans::NEUTRAL };
        mean.without_absent(self)
    }
}

impl DetailMeans {
    const NOTHING: Self = Self {
        specular: Vec3::ZERO,
        emission: Vec3::ZERO,
        reflection: Vec3::ZERO,
        light: None,
        shininess: 0.0,
        roughness: 0.0,
        metallic: 0.0,
        occlusion: 0.0,
        slope: Vec2::ZERO,
        slope_products: Vec3::ZERO,
        normal: Vec3::ZERO,
        normal_slopes: Vec3::ZERO,
    };

    /// The factors of no maps.
    pub(crate) const NEUTRAL: Self = Self {
        specular: Vec3::ONE,
        emission: Vec3::ONE,
        reflection: Vec3::ONE,
        light: None,
        shininess: 1.0,
        roughness: 1.0,
        metallic: 1.0,
        occlusion: 1.0,
        slope: Vec2::ZERO,
        slope_products: Vec3::ZERO,
        normal: Vec3::Z,
        normal_slopes: Vec3::ZERO,
    };

    fn add(&mut self, maps: &DetailMaps, uvs: &Uvs, triangle: u32, polygon: &[SurfacePoint], weight: f32) {
        let number = |map: &Option<Placed<1>>| {
            map.as_ref().map_or(0.0, |map| weight * map.mean(uvs, triangle, polygon)[0] as f32)
        };
        let three = |map: &Option<Placed<3>>| {
            map.as_ref().map_or(Vec3::ZERO, |map| vector(map.mean(uvs, triangle, polygon)) * weight)
        };
        self.specular += three(&maps.specular);
        self.emission += three(&maps.emission);
        self.reflection += three(&maps.reflection);
        if maps.light.is_some() {
            self.light = Some(self.light.unwrap_or_default() + three(&maps.light));
        }
        self.shininess += number(&maps.shininess);
        self.roughness += number(&maps.roughness);
        self.metallic += number(&maps.metallic);
        self.occlusion += number(&maps.occlusion);
        self.slope_products += three(&maps.slope_products);
        self.normal_slopes += three(&maps.normal_slopes);
        if let Some(map) = &maps.slope {
            let [u, v] = map.mean(uvs, triangle, polygon);
            self.slope += Vec2::new(u as f32, v as f32) * weight;
        }
        self.normal += three(&maps.normal);
    }

    fn scaled(self, f: f32) -> Self {
        Self {
            specular: self.specular * f,
            emission: self.emission * f,
            reflection: self.reflection * f,
            light: self.light.map(|light| light * f),
            shininess: self.shininess * f,
            roughness: self.roughness * f,
            metallic: self.metallic * f,
            occlusion: self.occlusion * f,
            slope: self.slope * f,
            slope_products: self.slope_products * f,
            normal: self.normal * f,
            normal_slopes: self.normal_slopes * f,
        }
    }

    fn without_absent(self, maps: &DetailMaps) -> Self {
        let none = Self::NEUTRAL;
        Self {
            specular: if maps.specular.is_some() { self.specular } else { none.specular },
            emission: if maps.emission.is_some() { self.emission } else { none.emission },
            reflection: if maps.reflection.is_some() { self.reflection } else { none.reflection },
            shininess: if maps.shininess.is_some() { self.shininess } else { none.shininess },
            roughness: if maps.roughness.is_some() { self.roughness } else { none.roughness },
            metallic: if maps.metallic.is_some() { self.metallic } else { none.metallic },
            occlusion: if maps.occlusion.is_some() { self.occlusion } else { none.occlusion },
            normal: if maps.normal.is_some() { self.normal } else { none.normal },
            ..self
        }
    }
}

fn vector(v: [f64; 3]) -> Vec3 {
    vec3(v[0] as f32, v[1] as f32, v[2] as f32)
}
