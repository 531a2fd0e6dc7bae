//! Maps under a shadow's edge: what the light meets is the texels of the lit part.

use glam::{DVec3, Vec3, dvec2, dvec3};
use pointillist_render::shade::{self, Light};
use pointillist_render::{
    Camera, DrawOptions, Frame, LightSource, Material, Part, Projection, Scene, Texels, Texture, render,
};

/// Half a side of the floor that is seen.
const HALF: f64 = 1.0;

/// Cards that the sun meets above the floor, beside what is seen.
const CASTERS: [[DVec3; 3]; 3] = [
    [dvec3(-3.0, 1.5, -4.0), dvec3(-1.2, 1.5, 0.5), dvec3(-4.0, 1.5, 3.0)],
    [dvec3(-2.1, 2.0, -1.0), dvec3(-1.3, 2.0, 0.2), dvec3(-1.9, 2.0, 0.9)],
    [dvec3(-1.1, 1.2, -0.9), dvec3(-1.4, 1.2, 0.7), dvec3(-1.05, 1.2, -0.2)],
];

/// A textured floor seen from above, with shadows of cards that the eye does not see.
fn floor(size: [u32; 2], material: impl Fn(&mut Scene) -> Material, casters: &[[DVec3; 3]]) -> Frame {
    let mut camera = Camera::perspective(dvec3(0.0, 5.0, 0.0), DVec3::ZERO, 1.0);
    camera.up = DVec3::NEG_Z;
    camera.projection = Projection::Orthographic { height: 2.0 * HALF };
    let mut scene = Scene::new(camera, size);
    let corners = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, z)| dvec3(x, 0.0, z) * HALF);
    let uvs = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
    let material = material(&mut scene);
    let material = scene.add_material(material);
    let part = Part::new("floor", &corners, &[[0, 1, 2], [0, 2, 3]]).with_uvs(&uvs).with_material(material);
    scene.mesh.add(&part).unwrap();
    let card = scene.add_material(white("card"));
    for caster in casters {
        scene.mesh.add(&Part::new("card", caster, &[[0, 1, 2]]).with_material(card)).unwrap();
    }
    let sun = Light::Directional { direction: dvec3(1.0, -1.0, 0.0), irradiance: Vec3::splat(4.0) };
    scene.lights.push(LightSource::new("sun", sun));
    render(&scene, &DrawOptions::DEFAULT, &()).unwrap()
}

fn white(name: &str) -> Material {
    Material::new(name, shade::Material::lambert(Vec3::ONE))
}

/// Texels of 0 and 255.
fn pattern(x: u32, y: u32) -> u8 {
    if (x * 5 + y * y * 3 + x * y) % 7 < 3 { 0 } else { 255 }
}

/// The coarse frame is the mean of the fine one, block by block.
fn assert_mean(coarse: &Frame, fine: &Frame, size: [u32; 2], factor: u32, tolerance: f64) {
    for (y, x) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (y, x))) {
        let at = |x: u32, y: u32| fine.color[(y * size[0] * factor + x) as usize][0];
        let block = (0..factor * factor).map(|i| at(x * factor + i % factor, y * factor + i / factor));
        let mean = block.map(f64::from).sum::<f64>() / f64::from(factor * factor);
        let got = f64::from(coarse.color[(y * size[0] + x) as usize][0]);
        assert!((got - mean).abs() < tolerance, "pixel ({x}, {y}): {got} instead of {mean}");
    }
}

#[test]
fn a_shadow_on_the_white_half_of_a_pixel_leaves_it_black() {
    // Texels of a column each; the shadow covers the left half of the single pixel.
    let half = |white_left: bool| {
        let color = |x: u32, _| [if (x == 0) == white_left { 255 } else { 0 }; 3];
        let material = |scene: &mut Scene| {
            let texture = scene.add_texture(Texture::from_srgb("halves", [2, 1], color));
            white("floor").with_diffuse_map(texture)
        };
        let shadow = [dvec3(-1.0, 1.0, -90.0), dvec3(-1.0, 1.0, 90.0), dvec3(-90.0, 1.0, 0.0)];
        floor([1, 1], material, &[shadow]).color[0][0]
    };
    assert!(half(true).abs() < 1e-6, "{}", half(true));
    let lit_half = 0.5 * 4.0 * std::f32::consts::FRAC_1_SQRT_2 * std::f32::consts::FRAC_1_PI;
    assert!((half(false) - lit_half).abs() < 1e-5, "{} instead of {lit_half}", half(false));
}

#[test]
fn a_pixel_of_texels_under_shadow_edges_is_the_mean_of_small_ones() {
    let material = |scene: &mut Scene| {
        let color = |x: u32, y: u32| [pattern(x, y); 3];
        let texture = scene.add_texture(Texture::from_srgb("pattern", [7, 5], color));
        white("floor").with_diffuse_map(texture)
    };
    let [coarse, fine] = [1, 8].map(|f| floor([3 * f, 3 * f], material, &CASTERS));
    assert_mean(&coarse, &fine, [3, 3], 8, 1e-6);
}

#[test]
fn a_pixel_of_holes_under_shadow_edges_is_the_mean_of_small_ones() {
    let material = |scene: &mut Scene| {
        let bytes = (0..35).map(|i| pattern(i % 7, i / 7)).collect();
        let holes = scene.add_texture(Texture::new("holes", [7, 5], Texels::from_opacities(bytes)));
        white("floor").with_opacity_map(holes)
    };
    let [coarse, fine] = [1, 8].map(|f| floor([3 * f, 3 * f], material, &CASTERS));
    assert_mean(&coarse, &fine, [3, 3], 8, 1e-6);
}
