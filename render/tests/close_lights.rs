//! A lamp close to a floor that is seen at a grazing angle: its light varies over what a pixel sees.

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::shade::{self, Falloff, Light};
use pointillist_render::{Camera, DrawOptions, LightSource, Material, Part, Scene, render};

const FINER: u32 = 16;

/// A floor with a board on it, which shades some of what a pixel sees.
fn scene(size: u32, with_board: bool) -> Scene {
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
    let (position, falloff) = (dvec3(0.0, 0.4, 0.0), Falloff::InverseSquare);
    scene.lights.push(LightSource::new("lamp", Light::Point { position, intensity: Vec3::ONE, falloff }));
    scene
}

fn colors(scene: &Scene) -> Vec<[f32; 4]> {
    render(scene, &DrawOptions::DEFAULT, &()).unwrap().color
}

#[test]
fn a_pixel_is_the_mean_of_its_parts() {
    for with_board in [false, true] {
        let size = 24;
        let (coarse, fine) = (colors(&scene(size, with_board)), colors(&scene(size * FINER, with_board)));
        let (mut worst, mut brightest) = (0.0_f64, 0.0_f64);
        for (i, color) in coarse.iter().enumerate() {
            let (x, y) = (i as u32 % size, i as u32 / size);
            let parts = (0..FINER * FINER).map(|k| (x * FINER + k % FINER, y * FINER + k / FINER));
            let sum: f64 = parts.map(|(x, y)| f64::from(fine[(y * size * FINER + x) as usize][0])).sum();
            let mean = sum / f64::from(FINER * FINER);
            worst = worst.max((f64::from(color[0]) - mean).abs());
            brightest = brightest.max(mean);
        }
        // The light at the middles of what is seen is off by 0.24 of the brightest.
        assert!(worst < 1e-3 * brightest, "{worst} of {brightest}");
    }
}

#[test]
fn a_lamp_that_touches_a_floor_gives_finite_light() {
    for height in [0.0, 1e-300, 1e-12, 1e-3] {
        let mut scene = scene(8, false);
        let position = DVec3::Y * height;
        scene.lights[0].light =
            Light::Point { position, intensity: Vec3::ONE, falloff: Falloff::InverseSquare };
        assert!(colors(&scene).iter().flatten().all(|v| v.is_finite()), "{height}");
    }
}
