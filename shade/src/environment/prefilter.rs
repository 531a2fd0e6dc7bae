//! What surfaces of each roughness see of a map.

use super::CubeMap;
use super::cube::texel_direction;
use crate::roughness::{self, SMALLEST_ROUGHNESS};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// Perceptual roughness of each blurred level, the texels on a side that hold it, and the half vectors that make it.
///
/// Chosen: a lobe of roughness r is about 2r² radians wide, and a texel is a quarter of that at most. Between levels,
/// lookups interpolate.
const LEVELS: [(f32, u32, u32); 8] = [
    (0.1, 128, 32),
    (0.2, 64, 64),
    (0.3, 64, 96),
    (0.4, 32, 192),
    (0.55, 32, 256),
    (0.7, 16, 384),
    (0.85, 16, 512),
    (1.0, 16, 512),
];

/// Texels on a side from which irradiance is summed up: the cosine lobe is far wider.
const IRRADIANCE_SOURCE: u32 = 32;
/// Texels on a side of the map of irradiances.
const IRRADIANCE_SIZE: u32 = 16;

/// A map of all directions, ready to be mirrored by surfaces of any roughness.
///
/// Rough levels hold ∫ L(l) D(h) (n·l) dl over its own weight with normal and eye both along the mirrored
/// direction, the first of the two sums of \[7\]; the second is [`crate::coat_albedo`]. What that gives away
/// are the stretched reflections at grazing angles.
#[derive(Clone, Debug)]
pub struct Environment {
    sharp: CubeMap,
    /// By growing roughness.
    rough: Vec<CubeMap>,
    irradiance: Option<CubeMap>,
}

impl Environment {
    /// A map for mirrors only: [`Environment::radiance`] is then sharp at any roughness.
    #[must_use]
    pub fn sharp(map: CubeMap) -> Self {
        Self { sharp: map, rough: Vec::new(), irradiance: None }
    }

    /// The same with its levels for rough surfaces; some hundred milliseconds for any size.
    #[must_use]
    pub fn with_rough_levels(mut self) -> Self {
        let chain = chain(&self.sharp);
        self.rough = LEVELS
            .iter()
            .map(|&(roughness, size, samples)| level(&chain, roughness, size, samples))
            .collect();
        self
    }

    /// The same with what [`Environment::irradiance`] says.
    #[must_use]
    pub fn with_irradiance(mut self) -> Self {
        let source = chain(&self.sharp).into_iter().find(|map| map.size() <= IRRADIANCE_SOURCE);
        let source = source.unwrap_or_else(|| self.sharp.clone());
        self.irradiance = Some(CubeMap::from_function(IRRADIANCE_SIZE, |n| irradiance(&source, n)));
        self
    }

    /// Radiance that a surface of this perceptual roughness mirrors from about a direction.
    #[must_use]
    pub fn radiance(&self, direction: Vec3, roughness: f32) -> Vec3 {
        let direction = direction.as_dvec3();
        let sharp = || self.sharp.sample(direction);
        let smooth = roughness.is_nan() || roughness <= SMALLEST_ROUGHNESS;
        if self.rough.is_empty() || smooth {
            return sharp();
        }
        let above = LEVELS.iter().position(|l| roughness < l.0).unwrap_or(LEVELS.len() - 1);
        let (low, below) = match above {
            0 => (SMALLEST_ROUGHNESS, sharp()),
            k => (LEVELS[k - 1].0, self.rough[k - 1].sample(direction)),
        };
        let share = (roughness.min(1.0) - low) / (LEVELS[above].0 - low);
        below.lerp(self.rough[above].sample(direction), share)
    }

    /// Irradiance of a surface that faces this way; 0 without [`Environment::with_irradiance`].
    #[must_use]
    pub fn irradiance(&self, normal: Vec3) -> Vec3 {
        self.irradiance.as_ref().map_or(Vec3::ZERO, |map| map.sample(normal.as_dvec3()))
    }
}

/// The map, and the means of its texels down to one a face.
fn chain(map: &CubeMap) -> Vec<CubeMap> {
    let mut chain = vec![map.clone()];
    while let Some(last) = chain.last().filter(|m| m.size() > 1 && m.size().is_multiple_of(2)) {
        chain.push(last.halved());
    }
    chain
}

/// A direction about +Z with its weight and the level of the chain to ask.
struct Sample {
    l: DVec3,
    weight: f64,
    level: f64,
}

fn level(chain: &[CubeMap], roughness: f32, size: u32, samples: u32) -> CubeMap {
    let alpha = f64::from(roughness::alpha(roughness));
    let texel_area = 4.0 * PI / (6.0 * f64::from(chain[0].size()).powi(2));
    let samples = lobe(alpha, samples, texel_area);
    let total: f64 = samples.iter().map(|s| s.weight).sum();
    let size = size.min(chain[0].size().max(1));
    CubeMap::from_function(size, |n| {
        let x = n.any_orthonormal_vector();
        let y = n.cross(x);
        let mut sum = DVec3::ZERO;
        for s in &samples {
            let l = x * s.l.x + y * s.l.y + n * s.l.z;
            sum += between(chain, l, s.level).as_dvec3() * s.weight;
        }
        (sum / total).as_vec3()
    })
}

/// Half vectors by the density of the distribution, each asking a level whose texels are as large as its share of
/// directions \[16\].
fn lobe(alpha: f64, count: u32, texel_area: f64) -> Vec<Sample> {
    let a2 = alpha * alpha;
    let mut samples = Vec::with_capacity(count as usize);
    for i in 0..count {
        let u = (f64::from(i) + 0.5) / f64::from(count);
        // Golden ratio steps: even in the angle for any count.
        let phi = TAU * (f64::from(i) * 0.618_033_988_749_894_9).fract();
        let cos2 = (1.0 - u) / (1.0 + (a2 - 1.0) * u);
        let (cos, sin) = (cos2.sqrt(), (1.0 - cos2).max(0.0).sqrt());
        let h = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
        let l = 2.0 * cos * h - DVec3::Z;
        if l.z <= 0.0 {
            continue;
        }
        let d = a2 / (PI * (cos2 * (a2 - 1.0) + 1.0).powi(2));
        // The density of l is D/4 here, where h·n = h·v.
        let share = 4.0 / (f64::from(count) * d);
        let level = (0.5 * (share / texel_area).log2() + 0.5).max(0.0);
        samples.push(Sample { l, weight: l.z, level });
    }
    samples
}

/// Interpolated between two maps of the chain.
fn between(chain: &[CubeMap], l: DVec3, level: f64) -> Vec3 {
    let last = chain.len() - 1;
    let low = (level as usize).min(last);
    let value = chain[low].sample(l);
    if low == last { value } else { value.lerp(chain[low + 1].sample(l), (level - low as f64) as f32) }
}

/// ∫ L (n·l) dl as the sum over all texels.
fn irradiance(map: &CubeMap, n: DVec3) -> Vec3 {
    let size = map.size() as usize;
    let (mut sum, mut whole) = (DVec3::ZERO, 0.0);
    for (face, y, x) in (0..6).flat_map(|f| (0..size).flat_map(move |y| (0..size).map(move |x| (f, y, x)))) {
        let d = texel_direction(size, face, x, y);
        let length2 = d.length_squared();
        let cos = n.dot(d) / length2.sqrt();
        if cos > 0.0 {
            // The solid angle of a texel falls with the third power of its distance; the common factor drops out.
            let weight = cos / (length2 * length2.sqrt());
            sum += map.texel(face, x as u32, y as u32).as_dvec3() * weight;
            whole += weight;
        }
    }
    // The cosines over the hemisphere make π.
    (sum * (PI / whole)).as_vec3()
}
