//! A lamp close to a floor that is seen at a grazing angle: its light varies over what a pixel sees.

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::shade::{self, Falloff, Light};
use pointillist_render::{Camera, DrawOptions, LightSource, Material, Part, Scene, render};

const FINER: u32 = 16;

fn lamp(position: DVec3) -> Light {
    Light::Point { position, intensity: Vec3::ONE, falloff: Falloff::InverseSquare }
}

/// A floor with a board on it, which shades some of what a pixel sees.
fn scene(size: u32, with_board: bool, light: Light) -> Scene {
    let camera = Camera::perspective(dvec3(0.0, 0.25, 4.0), dvec3(0.0, 0.1, 0.0), 0.5);
    let mut scene = Scene::new(camera, [size, size]);
    let gray = scene.add_material(Material::new("gray", shade::Material::lambert(Vec3::splat(0.8))));
    let faces = [[0, 1, 2], [0, 2, 3]];
    let floor = [(-4.0, 4.0), (4.0, 4.0), (4.0, -4.0), (-4.0, -4.0)].map(|(x, z)| dvec3(x, 0.0, z));
    scene.mesh.add(&Part::new("floor", &floor, &faces).with_material(gray)).unwrap();
    if with_board {
        let board = [(0.1, 0.3), (0.1, -0.3), (0.25, -0.3), (0.25, 0.3)].map(|(y, z)| dvec3(0.3, y, z));
        scene.mesh.add(&Part::new("board", &board, &faces).with_material(gray)).unwrap();
    }
    scene.lights.push(LightSource::new("lamp", light));
    scene
}

fn colors(scene: &Scene) -> Vec<[f32; 4]> {
    render(scene, &DrawOptions::DEFAULT, &()).unwrap().color
}

/// The largest difference of a pixel from the mean of its parts, relative to the brightest.
fn worst(light: &Light, with_board: bool) -> f64 {
    let size = 24;
    let at = |size| colors(&scene(size, with_board, *light));
    let (coarse, fine) = (at(size), at(size * FINER));
    let (mut worst, mut brightest) = (0.0_f64, 0.0_f64);
    for (i, color) in coarse.iter().enumerate() {
        let (x, y) = (i as u32 % size, i as u32 / size);
        let parts = (0..FINER * FINER).map(|k| (x * FINER + k % FINER, y * FINER + k / FINER));
        let sum: f64 = parts.map(|(x, y)| f64::from(fine[(y * size * FINER + x) as usize][0])).sum();
        let mean = sum / f64::from(FINER * FINER);
        worst = worst.max((f64::from(color[0]) - mean).abs());
        brightest = brightest.max(mean);
    }
    worst / brightest
}

#[test]
fn a_pixel_is_the_mean_of_its_parts() {
    for with_board in [false, true] {
        // The light at the middles of what is seen is off by 0.24 of the brightest.
        let worst = worst(&lamp(0.4 * DVec3::Y), with_board);
        assert!(worst < 1e-3, "{with_board}: {worst:e}");
    }
}

#[test]
fn a_lamp_that_touches_a_floor_gives_finite_light() {
    for height in [0.0, 1e-300, 1e-12, 1e-3] {
        let scene = scene(8, false, lamp(DVec3::Y * height));
        assert!(colors(&scene).iter().flatten().all(|v| v.is_finite()), "{height}");
    }
}
