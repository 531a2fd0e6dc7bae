//! How long for how much error: a lit checker, seen at a grazing angle, by cells per pixel. The error in each name is the root mean
//! square over pixels against a picture of eight times the size, averaged down.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, Vec3, dvec2, dvec3};
use pointillist_render::shade::{self, Falloff, Light};
use pointillist_render::{
    Camera, DrawOptions, Frame, LightSource, Material, Part, Prepared, Scene, Texture, render,
};
use std::hint::black_box;

const SIDE: u32 = 64;
/// Pixels of the reference along a pixel's side.
const FINER: u32 = 8;

fn scene(side: u32, cells_per_pixel: u32) -> Scene {
    let mut scene = Scene::new(Camera::perspective(dvec3(0.0, 0.6, 3.0), DVec3::ZERO, 0.8), [side, side]);
    let checker = |x, y| if (x + y) % 2 == 0 { [235; 3] } else { [25; 3] };
    let checker = scene.add_texture(Texture::from_srgb("checker", [32, 32], checker));
    let white = Material::new("checker", shade::Material::lambert(Vec3::ONE)).with_diffuse_map(checker);
    let white = scene.add_material(white);
    let corners = [(-2.0, 2.0), (2.0, 2.0), (2.0, -2.0), (-2.0, -2.0)].map(|(x, z)| dvec3(x, 0.0, z));
    let uvs = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
    let floor = Part::new("floor", &corners, &[[0, 1, 2], [0, 2, 3]]).with_uvs(&uvs).with_material(white);
    scene.mesh.add(&floor).expect("the floor fits");
    let fence = corners.map(|p| dvec3(0.15 * p.x, 0.2 + 0.1 * p.z, -0.3));
    let fence = Part::new("fence", &fence, &[[0, 1, 2], [0, 2, 3]]).with_material(white);
    scene.mesh.add(&fence).expect("the fence fits");
    let lamp = Light::Point {
        position: dvec3(1.0, 2.0, -1.5),
        intensity: Vec3::splat(12.0),
        falloff: Falloff::InverseSquare,
    };
    scene.lights.push(LightSource::new("lamp", lamp));
    scene.render.cells_per_pixel = Some(cells_per_pixel);
    scene
}

fn picture(scene: &Scene) -> Frame {
    render(scene, &DrawOptions::DEFAULT, &()).expect("the scene is valid")
}

/// Each pixel as the mean of the finer picture's.
fn averaged(fine: &Frame) -> Vec<f32> {
    let mut means = vec![0.0; (SIDE * SIDE) as usize];
    for (i, color) in fine.color.iter().enumerate() {
        let (x, y) = (i as u32 % (SIDE * FINER) / FINER, i as u32 / (SIDE * FINER) / FINER);
        means[(y * SIDE + x) as usize] += color[0] / (FINER * FINER) as f32;
    }
    means
}

fn time_error(c: &mut Criterion) {
    let reference = averaged(&picture(&scene(SIDE * FINER, 2)));
    let mut group = c.benchmark_group("checker");
    for cells in [1, 2, 4] {
        let scene = scene(SIDE, cells);
        let drawn = picture(&scene);
        let square = |(a, b): (&[f32; 4], &f32)| f64::from(a[0] - b).powi(2);
        let sum: f64 = drawn.color.iter().zip(&reference).map(square).sum();
        let error = (sum / f64::from(SIDE * SIDE)).sqrt();
        let prepared = Prepared::new(&scene, &()).expect("the scene is valid");
        group.bench_function(BenchmarkId::new(format!("{cells} cells"), format!("{error:.2e}")), |b| {
            b.iter(|| black_box(prepared.draw(&DrawOptions::DEFAULT, &())));
        });
    }
    group.finish();
}

criterion_group!(benches, time_error);
criterion_main!(benches);
