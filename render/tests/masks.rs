//! Leaves that are modelled as two cards back to back: in a mask's holes both have holes.

use glam::{DVec2, DVec3, Vec3, dvec2, dvec3};
use pointillist_render::shade::{self, Light};
use pointillist_render::{
    AmbientLight, Camera, DrawOptions, Frame, LightSource, Material, Part, Scene, Texels, Texture, render,
};

const CARD: [DVec3; 4] =
    [dvec3(-1.0, 1.0, -1.0), dvec3(1.0, 1.0, -1.0), dvec3(1.0, 1.3, 1.0), dvec3(-1.0, 1.3, 1.0)];
const UVS: [DVec2; 4] = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];

/// A leaf card over a floor in the sun; `back` is a second card in its place, turned over, with these coordinates.
fn picture(back: Option<[DVec2; 4]>, change: impl Fn(&mut Scene)) -> Frame {
    let mut scene = Scene::new(Camera::perspective(dvec3(1.0, 3.0, 4.0), DVec3::ZERO, 0.8), [40, 30]);
    let holes: Vec<u8> = (0..64).map(|i| if (i * 37 + i / 8 * 11) % 5 < 2 { 0 } else { 255 }).collect();
    let holes = scene.add_texture(Texture::new("holes", [8, 8], Texels::Opacity8(holes)));
    let leaf = shade::Material::lambert(Vec3::new(0.2, 0.7, 0.1));
    let leaf = scene.add_material(Material::new("leaf", leaf).with_opacity_map(holes));
    let floor = scene.add_material(Material::new("floor", shade::Material::lambert(Vec3::ONE)));
    let triangles = [[0, 1, 2], [0, 2, 3]];
    scene.mesh.add(&Part::new("leaf", &CARD, &triangles).with_uvs(&UVS).with_material(leaf)).unwrap();
    if let Some(uvs) = back {
        let turned = [[2, 1, 0], [3, 2, 0]];
        scene.mesh.add(&Part::new("back", &CARD, &turned).with_uvs(&uvs).with_material(leaf)).unwrap();
    }
    let ground = [dvec3(-3.0, 0.0, 3.0), dvec3(3.0, 0.0, 3.0), dvec3(3.0, 0.0, -3.0), dvec3(-3.0, 0.0, -3.0)];
    scene.mesh.add(&Part::new("floor", &ground, &triangles).with_material(floor)).unwrap();
    let sun = Light::Directional { direction: dvec3(0.3, -1.0, 0.2), irradiance: Vec3::ONE };
    scene.lights.push(LightSource::new("sun", sun));
    scene.ambient = AmbientLight::Color(Vec3::splat(0.1));
    change(&mut scene);
    render(&scene, &DrawOptions::DEFAULT, &()).unwrap()
}

#[test]
fn two_cards_back_to_back_are_one_leaf() {
    assert_eq!(picture(Some(UVS), |_| {}).color, picture(None, |_| {}).color);
}

#[test]
fn cards_with_other_coordinates_or_plain_glass_are_two_layers() {
    let turned = UVS.map(|uv| dvec2(1.0 - uv.x, uv.y));
    assert_ne!(picture(Some(turned), |_| {}).color, picture(None, |_| {}).color);
    let glass = |scene: &mut Scene| {
        scene.materials[0].opacity_map = None;
        scene.materials[0].surface.opacity = 0.5;
    };
    assert_ne!(picture(Some(UVS), glass).color, picture(None, glass).color);
}
