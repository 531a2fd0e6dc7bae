//! Light after any number of diffuse reflections, by paths of rays: a reference that shares no code with the renderer.

use glam::{DVec3, dvec2, dvec3};
use pointillist_render::Scene;
use rayon::prelude::*;

use crate::common::picture::Picture;
use crate::common::point_sampling::Pinhole;
use crate::common::ray_reference::Tree;
use crate::common::scenes::{SurfaceSample, normal_towards, radiance};

/// Paths end by chance from this reflection on.
const SURE: u32 = 4;

/// Numbers from 0 to 1: `splitmix64`.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Irradiance for each normal from `count` paths whose first directions are spread evenly, with all reflections. The light that lamps
/// send straight to the position is not in it.
pub(crate) fn irradiance(
    scene: &Scene,
    tree: &Tree,
    position: DVec3,
    normals: &[DVec3],
    count: u32,
    random: &mut Random,
) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; normals.len()];
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let turn = std::f64::consts::TAU * random.next();
    for i in 0..count {
        // A spiral with one direction somewhere in each of its steps.
        let y = 1.0 - 2.0 * (f64::from(i) + random.next()) / f64::from(count);
        let (sin, cos) = (golden * f64::from(i) + turn).sin_cos();
        let r = (1.0 - y * y).max(0.0).sqrt();
        let way = dvec3(r * cos, y, r * sin);
        let light = arriving(scene, tree, position, way, random);
        for (sum, normal) in sums.iter_mut().zip(normals) {
            *sum += light * normal.dot(way).max(0.0);
        }
    }
    sums.into_iter().map(|sum| sum * (4.0 * std::f64::consts::PI / f64::from(count))).collect()
}

/// A picture of a scene without maps by so many paths a pixel, each through a place of its own.
pub(crate) fn picture(scene: &Scene, tree: &Tree, per_pixel: u32, seed: u64) -> Picture {
    let (width, camera) = (scene.image.width as usize, Pinhole::new(scene));
    let pixel = |i: usize| {
        let mut random = Random(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ (i as u64) << 20);
        let mut sum = DVec3::ZERO;
        for _ in 0..per_pixel {
            let place = dvec2((i % width) as f64 + random.next(), (i / width) as f64 + random.next());
            let way = camera.direction(place).normalize();
            sum += arriving(scene, tree, camera.eye, way, &mut random);
        }
        sum / f64::from(per_pixel)
    };
    Picture { width, pixels: (0..width * scene.image.height as usize).into_par_iter().map(pixel).collect() }
}

/// Radiance from a direction.
fn arriving(scene: &Scene, tree: &Tree, from: DVec3, way: DVec3, random: &mut Random) -> DVec3 {
    let (mut from, mut way) = (from, way);
    let (mut light, mut share) = (DVec3::ZERO, DVec3::ONE);
    for reflection in 0.. {
        let Some((triangle, distance)) = tree.nearest(from, way, 1e-9) else {
            return light + share * scene.image.background.as_dvec3();
        };
        let at = SurfaceSample { triangle, position: from + way * distance, to_eye: -way };
        let visible = |at: &SurfaceSample, light: usize, sample: u32| {
            tree.transmittance(at, scene.lights[light].light.source(sample))
        };
        light += share * radiance(scene, &at, &visible);
        let material = scene.mesh.material_of[triangle as usize] as usize;
        share *= scene.materials[material].surface.diffuse.as_dvec3();
        if reflection >= SURE {
            let stays = share.max_element().min(1.0);
            if random.next() >= stays {
                break;
            }
            share /= stays;
        }
        let normal = normal_towards(scene, triangle as usize, at.to_eye).normalize();
        from = at.position + normal * 1e-9 * distance.max(1.0);
        way = about(normal, random);
    }
    light
}

/// A direction with the density of the cosine about a normal.
fn about(normal: DVec3, random: &mut Random) -> DVec3 {
    let (u, angle) = (random.next(), std::f64::consts::TAU * random.next());
    let x = normal.any_orthonormal_vector();
    let y = normal.cross(x);
    let r = u.sqrt();
    (x * (r * angle.cos()) + y * (r * angle.sin()) + normal * (1.0 - u).sqrt()).normalize()
}
