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
    let holes = scene.add_texture(Texture::new("holes", [8, 8], Texels::from_opacities(holes)));
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

#[test]
fn each_side_of_a_leaf_shows_the_normals_of_the_card_that_faces_the_eye() {
    let seen = |eye: DVec3, cards: &[bool]| {
        let mut scene = Scene::new(Camera::perspective(eye, dvec3(0.0, 1.0, 0.0), 0.8), [24, 18]);
        let holes = (0..16).map(|i| if i % 3 == 0 { 0 } else { 255 }).collect();
        let holes = scene.add_texture(Texture::new("holes", [4, 4], Texels::from_opacities(holes)));
        let leaf = scene
            .add_material(Material::new("leaf", shade::Material::lambert(Vec3::ONE)).with_opacity_map(holes));
        for &front in cards {
            // The first card faces down. Normals lean outward, as foliage has them: they are not opposite on the two sides.
            let up = if front { -1.0 } else { 1.0 };
            let normals = CARD.map(|p| Vec3::new(p.x as f32, up, p.z as f32).normalize());
            let triangles = if front { [[0, 1, 2], [0, 2, 3]] } else { [[2, 1, 0], [0, 3, 2]] };
            let part = Part::new("card", &CARD, &triangles).with_uvs(&UVS).with_normals(&normals);
            scene.mesh.add(&part.with_material(leaf)).unwrap();
        }
        scene.render.shading = shade::Interpolation::Phong;
        for direction in [dvec3(0.5, -1.0, 0.3), dvec3(-0.4, 1.0, 0.1)] {
            let light = Light::Directional { direction, irradiance: Vec3::ONE };
            let mut light = LightSource::new("sun", light);
            light.shadow = false;
            scene.lights.push(light);
        }
        let options = DrawOptions::DEFAULT.with_layers(vec![pointillist_render::LayerKind::Back]);
        let frame = render(&scene, &options, &()).unwrap();
        (frame.color, frame.layers[0].planes[0].iter().sum::<f32>())
    };
    for (eye, facing) in [(dvec3(0.5, 4.0, 1.0), false), (dvec3(0.5, -2.0, 1.0), true)] {
        for both in [[true, false], [false, true]] {
            let ((both, back), (alone, _)) = (seen(eye, &both), seen(eye, &[facing]));
            let close = |(a, b): (&[f32; 4], &[f32; 4])| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(both.iter().zip(&alone).all(close), "eye {eye}");
            assert_eq!(back, 0.0);
        }
    }
}

#[test]
fn a_mask_without_holes_is_none() {
    let with = |texels: Texels| {
        move |scene: &mut Scene| {
            let mask = scene.add_texture(Texture::new("full", [2, 2], texels.clone()));
            scene.materials[0].opacity_map = Some(mask);
        }
    };
    let bare = picture(None, |scene| scene.materials[0].opacity_map = None);
    let full = |last: u8| {
        let alphas = [255, 255, 255, last];
        let rgba = alphas.map(|alpha| [9, 80, 200, alpha]).to_vec();
        [
            Texels::from_opacities(alphas.to_vec()),
            Texels::Srgb8(rgba.clone().into()),
            Texels::Linear8(rgba.into()),
            Texels::Float(alphas.map(|alpha| [0.5, 0.1, 0.2, f32::from(alpha) / 255.0]).to_vec().into()),
        ]
    };
    for texels in full(255).into_iter().chain([Texels::from_grays(vec![7; 4])]) {
        assert!(texels.are_opaque());
        assert_eq!(picture(None, with(texels.clone())).color, bare.color, "{texels:?}");
    }
    for texels in full(254) {
        assert!(!texels.are_opaque());
        assert_ne!(picture(None, with(texels.clone())).color, bare.color, "{texels:?}");
    }
}
