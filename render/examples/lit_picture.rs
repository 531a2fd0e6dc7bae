//! A chequered floor, a ball and the ball's shadow: a lit, shadowed, textured picture as a PNG.
//! `cargo run --release -p pointillist-render --example lit_picture` writes `lit_picture.png`.

use glam::{DVec3, Vec3, dvec2, dvec3};
use pointillist_render::shade::{self, Falloff, Light};
use pointillist_render::{
    AmbientLight, Camera, DrawOptions, LightSource, Material, Part, Scene, Texture, render, srgb_from_linear,
};

const SIZE: [u32; 2] = [480, 320];

/// A unit sphere: positions, which are its normals, too, and triangles.
fn sphere(rings: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let place = |i: u32, j: u32| {
        let (down, around) = (f64::from(i) / f64::from(rings), f64::from(j) / f64::from(2 * rings));
        let (sin, cos) = (down * std::f64::consts::PI).sin_cos();
        let (x, z) = (around * std::f64::consts::TAU).sin_cos();
        dvec3(sin * x, cos, sin * z)
    };
    let columns = 2 * rings + 1;
    let positions = (0..=rings).flat_map(|i| (0..columns).map(move |j| place(i, j))).collect();
    let cells = (0..rings).flat_map(|i| (0..2 * rings).map(move |j| i * columns + j));
    (
        positions,
        cells.flat_map(|a| [[a, a + columns, a + 1], [a + 1, a + columns, a + columns + 1]]).collect(),
    )
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = Scene::new(Camera::perspective(dvec3(3.0, 2.4, 5.0), dvec3(0.0, 0.7, 0.0), 0.7), SIZE);
    let tiles = |x, y| if (x + y) % 2 == 0 { [225, 215, 200] } else { [90, 60, 50] };
    let tiles = scene.add_texture(Texture::from_srgb("tiles", [8, 8], tiles));
    let matt = |albedo| shade::Material::lambert(albedo);
    let floor = scene.add_material(Material::new("floor", matt(Vec3::ONE)).with_diffuse_map(tiles));
    let red = scene.add_material(Material::new("red", matt(Vec3::new(0.75, 0.12, 0.08))));

    let corners =
        [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, z)| dvec3(4.0 * x, 0.0, 4.0 * z));
    let uvs = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
    scene
        .mesh
        .add(&Part::new("floor", &corners, &[[0, 1, 2], [0, 2, 3]]).with_uvs(&uvs).with_material(floor))?;
    let (unit, triangles) = sphere(48);
    let normals: Vec<Vec3> = unit.iter().map(|p| p.as_vec3()).collect();
    let ball: Vec<DVec3> = unit.iter().map(|p| *p + DVec3::Y).collect();
    scene.mesh.add(&Part::new("ball", &ball, &triangles).with_normals(&normals).with_material(red))?;

    let (position, falloff) = (dvec3(3.5, 5.0, 2.5), Falloff::InverseSquare);
    let lamp = Light::Point { position, intensity: Vec3::new(100.0, 95.0, 85.0), falloff };
    scene.lights.push(LightSource::new("lamp", lamp));
    scene.ambient = AmbientLight::Color(Vec3::splat(0.12));
    scene.render.shading = shade::Interpolation::Phong;
    scene.image.background = Vec3::new(0.35, 0.45, 0.6);

    let frame = render(&scene, &DrawOptions::DEFAULT, &())?;
    let byte = |v: f32| (255.0 * srgb_from_linear(v.clamp(0.0, 1.0))).round() as u8;
    let bytes: Vec<u8> = frame.color.iter().flat_map(|c| [byte(c[0]), byte(c[1]), byte(c[2])]).collect();
    image::save_buffer("lit_picture.png", &bytes, SIZE[0], SIZE[1], image::ColorType::Rgb8)?;
    Ok(())
}
