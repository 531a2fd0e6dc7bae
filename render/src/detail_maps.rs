//! The maps of a material beyond colour and opacity, summed up for exact means.
//!
//! Each is averaged by itself over what is seen of a micropoint, and shading works with the means. Bump maps are averaged as
//! slopes and normal maps as vectors, not as heights and colours: the mean of slopes is the slope of the mean height, and
//! a mean of normals is the normal of what they cover together.

use crate::scene::{Details, Map, Scene, Texture};
use crate::uvs::{Uvs, texel_wrap};
use glam::{Vec2, Vec3, Vec4, vec3};
use pointillist_micropoint::{MicropointError, SurfacePoint, TexelSums};
use pointillist_parallel as parallel;
use pointillist_shade::slope_of_heights;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// A map of numbers.
type Numbers = Option<Arc<TexelSums<1>>>;
/// A map of colours.
type Colors = Option<Arc<TexelSums<3>>>;

/// The maps of one material.
#[derive(Default)]
pub(crate) struct DetailMaps {
    specular: Colors,
    emission: Colors,
    shininess: Numbers,
    roughness: Numbers,
    metallic: Numbers,
    occlusion: Numbers,
    /// Slopes along u and v, each as what is above and below 0: sums take no negative values.
    slope: Option<Arc<TexelSums<4>>>,
    /// x and y like slopes, then z.
    normal: Option<Arc<TexelSums<5>>>,
}

/// Means over what is seen; where there is no map, what changes nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DetailMeans {
    pub(crate) specular: Vec3,
    pub(crate) emission: Vec3,
    pub(crate) shininess: f32,
    pub(crate) roughness: f32,
    pub(crate) metallic: f32,
    pub(crate) occlusion: f32,
    /// Of the heights from 0 to 1, per unit of u and v.
    pub(crate) slope: Vec2,
    /// Of the normal map; not of unit length.
    pub(crate) normal: Vec3,
}

/// Maps that materials share, each summed up once.
pub(crate) struct DetailTable {
    numbers: HashMap<Map, Arc<TexelSums<1>>>,
    colors: HashMap<Map, Arc<TexelSums<3>>>,
    slopes: HashMap<Map, Arc<TexelSums<4>>>,
    normals: HashMap<Map, Arc<TexelSums<5>>>,
}

impl DetailTable {
    /// Sums up the maps of all materials, on all cores.
    pub(crate) fn new(scene: &Scene) -> Result<Self, MicropointError> {
        let maps = |of: fn(&Details) -> [Option<Map>; 4]| -> HashSet<Map> {
            scene.materials.iter().flat_map(|m| of(&m.details)).flatten().collect()
        };
        let numbers =
            maps(|d| [d.shininess_map, d.roughness_map, d.metallic_map, d.occlusion.map(|(map, _)| map)]);
        let colors = maps(|d| [d.specular_map, d.emission_map, None, None]);
        // Heights that are all the same have no slope.
        let mut slopes = maps(|d| [d.bump.map(|bump| bump.map), None, None, None]);
        slopes.retain(|map| !scene.textures[map.texture].is_constant());
        let normals = maps(|d| [d.normal.map(|(map, _)| map), None, None, None]);
        let (numbers, (colors, (slopes, normals))) = parallel::join(
            || all(&numbers, |map| sums(map, scene, |t, x, y| [map.channel.of(t.texel(x, y))])),
            || {
                parallel::join(
                    || all(&colors, |map| sums(map, scene, |t, x, y| t.texel(x, y).truncate().to_array())),
                    || {
                        parallel::join(
                            || all(&slopes, |map| sums(map, scene, |t, x, y| slope(map, t, x, y))),
                            || all(&normals, |map| sums(map, scene, normal)),
                        )
                    },
                )
            },
        );
        Ok(Self { numbers: numbers?, colors: colors?, slopes: slopes?, normals: normals? })
    }

    pub(crate) fn maps(&self, details: &Details) -> DetailMaps {
        let number = |map: Option<Map>| map.and_then(|map| self.numbers.get(&map).cloned());
        let color = |map: Option<Map>| map.and_then(|map| self.colors.get(&map).cloned());
        DetailMaps {
            specular: color(details.specular_map),
            emission: color(details.emission_map),
            shininess: number(details.shininess_map),
            roughness: number(details.roughness_map),
            metallic: number(details.metallic_map),
            occlusion: number(details.occlusion.map(|(map, _)| map)),
            slope: details.bump.and_then(|bump| self.slopes.get(&bump.map).cloned()),
            normal: details.normal.and_then(|(map, _)| self.normals.get(&map).cloned()),
        }
    }
}

fn all<const N: usize>(
    maps: &HashSet<Map>,
    make: impl Fn(Map) -> Result<TexelSums<N>, MicropointError> + Sync,
) -> Result<HashMap<Map, Arc<TexelSums<N>>>, MicropointError> {
    let maps: Vec<Map> = maps.iter().copied().collect();
    let one = |i: usize| Ok((maps[i], Arc::new(make(maps[i])?)));
    parallel::map_heavy(maps.len(), one).into_iter().collect()
}

fn slope(map: Map, t: &Texture, x: u32, y: u32) -> [f32; 4] {
    let height =
        |x: i64, y: i64| map.channel.of(t.texel(map.wrap.texel(x, t.width), map.wrap.texel(y, t.height)));
    let slope = slope_of_heights([t.width, t.height], x, y, height);
    [slope.x.max(0.0), (-slope.x).max(0.0), slope.y.max(0.0), (-slope.y).max(0.0)]
}

fn normal(t: &Texture, x: u32, y: u32) -> [f32; 5] {
    let n = normal_of_texel(t.texel(x, y));
    [n.x.max(0.0), (-n.x).max(0.0), n.y.max(0.0), (-n.y).max(0.0), n.z.max(0.0)]
}

fn sums<const N: usize>(
    map: Map,
    scene: &Scene,
    texel: impl Fn(&Texture, u32, u32) -> [f32; N],
) -> Result<TexelSums<N>, MicropointError> {
    let texture = &scene.textures[map.texture];
    TexelSums::new(texture.width, texture.height, texel_wrap(map.wrap), |x, y| texel(texture, x, y))
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
        let colors = self.specular.is_some() || self.emission.is_some();
        let numbers = [&self.shininess, &self.roughness, &self.metallic, &self.occlusion];
        colors || numbers.iter().any(|map| map.is_some()) || self.slope.is_some() || self.normal.is_some()
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
        shininess: 0.0,
        roughness: 0.0,
        metallic: 0.0,
        occlusion: 0.0,
        slope: Vec2::ZERO,
        normal: Vec3::ZERO,
    };

    /// The factors of no maps.
    pub(crate) const NEUTRAL: Self = Self {
        specular: Vec3::ONE,
        emission: Vec3::ONE,
        shininess: 1.0,
        roughness: 1.0,
        metallic: 1.0,
        occlusion: 1.0,
        slope: Vec2::ZERO,
        normal: Vec3::Z,
    };

    fn add(&mut self, maps: &DetailMaps, uvs: &Uvs, triangle: u32, polygon: &[SurfacePoint], weight: f32) {
        let number =
            |map: &Numbers| map.as_ref().map_or(0.0, |m| weight * uvs.mean(triangle, polygon, m)[0] as f32);
        let color = |map: &Colors| {
            let mean = |m: &Arc<TexelSums<3>>| vector(uvs.mean(triangle, polygon, m)) * weight;
            map.as_ref().map_or(Vec3::ZERO, mean)
        };
        self.specular += color(&maps.specular);
        self.emission += color(&maps.emission);
        self.shininess += number(&maps.shininess);
        self.roughness += number(&maps.roughness);
        self.metallic += number(&maps.metallic);
        self.occlusion += number(&maps.occlusion);
        if let Some(map) = &maps.slope {
            let [right, left, up, down] = uvs.mean(triangle, polygon, map);
            self.slope += Vec2::new((right - left) as f32, (up - down) as f32) * weight;
        }
        if let Some(map) = &maps.normal {
            let [right, left, up, down, out] = uvs.mean(triangle, polygon, map);
            self.normal += vector([right - left, up - down, out]) * weight;
        }
    }

    fn scaled(self, f: f32) -> Self {
        Self {
            specular: self.specular * f,
            emission: self.emission * f,
            shininess: self.shininess * f,
            roughness: self.roughness * f,
            metallic: self.metallic * f,
            occlusion: self.occlusion * f,
            slope: self.slope * f,
            normal: self.normal * f,
        }
    }

    fn without_absent(self, maps: &DetailMaps) -> Self {
        let none = Self::NEUTRAL;
        Self {
            specular: if maps.specular.is_some() { self.specular } else { none.specular },
            emission: if maps.emission.is_some() { self.emission } else { none.emission },
            shininess: if maps.shininess.is_some() { self.shininess } else { none.shininess },
            roughness: if maps.roughness.is_some() { self.roughness } else { none.roughness },
            metallic: if maps.metallic.is_some() { self.metallic } else { none.metallic },
            occlusion: if maps.occlusion.is_some() { self.occlusion } else { none.occlusion },
            slope: self.slope,
            normal: if maps.normal.is_some() { self.normal } else { none.normal },
        }
    }
}

fn vector(v: [f64; 3]) -> Vec3 {
    vec3(v[0] as f32, v[1] as f32, v[2] as f32)
}
