//! Highlights on curved surfaces, against the mean of many smaller pixels.

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::shade::{self, Interpolation, Light, Model};
use pointillist_render::{Camera, DrawOptions, LightSource, Material, Part, Scene, render};
use std::f64::consts::TAU;

const FINER: u32 = 16;

/// A torus of smooth quadrangles: bent in two directions, inwards and outwards.
fn torus(rows: u32, columns: u32) -> (Vec<DVec3>, Vec<Vec3>, Vec<[u32; 3]>) {
    let turn = |i: u32, n: u32| TAU * f64::from(i) / f64::from(n);
    let places = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    let (corners, normals) = places
        .clone()
        .map(|(i, j)| {
            let (around, within) = (turn(i, rows), turn(j, columns));
            let out = dvec3(around.cos(), around.sin(), 0.0);
            let normal = out * within.cos() + DVec3::Z * within.sin();
            (out + 0.45 * normal, normal.as_vec3())
        })
        .unzip();
    let v = |i: u32, j: u32| i % rows * columns + j % columns;
    let faces = places.flat_map(|(i, j)| {
        let [a, b, c, d] = [v(i, j), v(i + 1, j), v(i + 1, j + 1), v(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    (corners, normals, faces.collect())
}

fn scene(size: u32, material: shade::Material) -> Scene {
    let camera = Camera::perspective(dvec3(1.0, -2.0, 6.0), DVec3::ZERO, 0.55);
    let mut scene = Scene::new(camera, [size, size]);
    scene.render.shading = Interpolation::Phong;
    let metal = scene.add_material(Material::new("metal", material));
    let (corners, normals, faces) = torus(24, 16);
    let part = Part::new("torus", &corners, &faces).with_normals(&normals).with_material(metal);
    scene.mesh.add(&part).unwrap();
    let direction = dvec3(-0.4, -0.5, -1.0);
    scene.lights.push(LightSource::new("sun", Light::Directional { direction, irradiance: Vec3::ONE }));
    scene
}

/// Root of the mean squared difference of pixels from the means of their parts, and the mean of all.
fn errors(size: u32, material: shade::Material) -> (f64, f64) {
    let draw = |size| render(&scene(size, material), &DrawOptions::DEFAULT, &()).unwrap().color;
    let (coarse, fine) = (draw(size), draw(size * FINER));
    let (mut squares, mut whole) = (0.0, 0.0);
    for (i, color) in coarse.iter().enumerate() {
        let (x, y) = (i as u32 % size, i as u32 / size);
        let parts = (0..FINER * FINER).map(|k| (x * FINER + k % FINER, y * FINER + k / FINER));
        let sum: f64 = parts.map(|(x, y)| f64::from(fine[(y * size * FINER + x) as usize][0])).sum();
        let mean = sum / f64::from(FINER * FINER);
        squares += (f64::from(color[0]) - mean).powi(2);
        whole += mean;
    }
    let count = f64::from(size * size);
    ((squares / count).sqrt(), whole / count)
}

#[test]
fn a_pixel_is_closer_to_the_mean_of_a_bent_highlight() {
    let shiny = |model, m| shade::Material::lambert(Vec3::ZERO).with_specular(model, Vec3::ONE, m);
    // Without widening: 7.0, 0.18, 0.69 and 0.59.
    let materials = [
        (shade::Material::ggx(Vec3::ZERO, Vec3::ONE, 0.2), 2.2),
        (shade::Material::ggx(Vec3::ZERO, Vec3::ONE, 0.4), 0.13),
        (shiny(Model::NormalizedBlinnPhong, 200.0), 0.42),
        (shiny(Model::Phong, 50.0), 0.37),
    ];
    for (material, most) in materials {
        let (rms, mean) = errors(64, material);
        assert!(rms < most * mean, "{material:?}: {} of the mean", rms / mean);
    }
}
