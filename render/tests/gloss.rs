//! What glossy surfaces see of probes and of skies, against closed forms.

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::sh::{Lobe, Panorama, PanoramaProjector, Sh, Weights};
use pointillist_render::shade;
use pointillist_render::shprobe::Field;
use pointillist_render::{
    AmbientLight, Camera, DrawOptions, Material, Part, Projection, Scene, SkyLight, Texels, Texture, Unbaked,
    render,
};

/// A mirror on the ground, seen at 45° from +Z: it shows what is towards −Z, at 45°. Its reflectance is 1, and it is as rough as asked.
fn mirror(roughness: f32, ambient: AmbientLight) -> Scene {
    let mut camera = Camera::perspective(dvec3(0.0, 5.0, 5.0), DVec3::ZERO, 1.0);
    camera.projection = Projection::Orthographic { height: 0.2 };
    let mut scene = Scene::new(camera, [3, 3]);
    let metal = shade::Material::ggx(Vec3::ZERO, Vec3::ONE, roughness);
    let metal = scene.add_material(Material::new("metal", metal));
    let corners = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, z)| dvec3(x, 0.0, z));
    scene.mesh.add(&Part::new("ground", &corners, &[[0, 1, 2], [0, 2, 3]]).with_material(metal)).unwrap();
    scene.ambient = ambient;
    scene
}

fn shown(scene: &Scene) -> Vec3 {
    let frame = render(scene, &DrawOptions::DEFAULT, &()).unwrap();
    let [r, g, b, alpha] = frame.color[4];
    assert_eq!(alpha, 1.0);
    Vec3::new(r, g, b)
}

fn mirrored() -> DVec3 {
    dvec3(0.0, 1.0, -1.0).normalize()
}

/// One probe holds this everywhere.
fn probe(radiance: &Sh) -> Field {
    Field::new(&[DVec3::Y], std::slice::from_ref(radiance)).unwrap()
}

fn lit_by(field: Field) -> AmbientLight {
    AmbientLight::Probes { field: Box::new(field), unbaked: Unbaked::NONE, fingerprint: 1 }
}

const LIGHT: Vec3 = Vec3::new(0.5, 1.0, 2.0);

#[test]
fn constant_light_is_mirrored_as_it_is_at_any_roughness_and_order() {
    for roughness in [0.0, 0.3, 0.62, 1.0] {
        let even = shown(&mirror(roughness, AmbientLight::Color(LIGHT)));
        for order in [0, 2, 8] {
            let constant = Sh::constant(LIGHT.as_dvec3(), order).unwrap();
            let seen = shown(&mirror(roughness, lit_by(probe(&constant))));
            assert!((seen - even).abs().max_element() < 2e-6, "{roughness} {order}: {seen} {even}");
        }
        let sky = SkyLight { sky: LIGHT, ground: LIGHT, up: Vec3::Y };
        let seen = shown(&mirror(roughness, AmbientLight::Sky(sky)));
        assert!((seen - even).abs().max_element() < 2e-6, "{roughness}, sky: {seen} {even}");
    }
    // What reflects everything and loses nothing between its facets shows all of it.
    assert!((shown(&mirror(0.0, AmbientLight::Color(LIGHT))) - LIGHT).abs().max_element() < 2e-3);
}

#[test]
fn each_band_is_mirrored_with_the_factor_of_the_lobe() {
    for order in 1..=8_usize {
        // A constant keeps the light above 0.
        let mut sh = Sh::constant(DVec3::splat(4.0), order).unwrap().into_coefficients();
        sh[order * order + order] = DVec3::splat(1.0);
        let sh = Sh::new(sh).unwrap();
        for roughness in [0.0_f32, 0.25, 0.5, 1.0] {
            let lobe = match roughness {
                0.0 => Lobe::MIRROR,
                r => Lobe::ggx(f64::from(r).powi(2)).unwrap(),
            };
            let wanted = sh.glossy(mirrored(), &lobe).as_vec3();
            let even = shown(&mirror(roughness, AmbientLight::Color(wanted)));
            let seen = shown(&mirror(roughness, lit_by(probe(&sh))));
            assert!((seen - even).abs().max_element() < 1e-3, "{order} {roughness}: {seen} {even}");
        }
    }
}

#[test]
fn a_mirror_shows_no_diffuse_light() {
    // Light from the ground only: what the mirror faces is black, though it would light a matt surface that faces that way.
    let mut sh = Sh::constant(DVec3::ONE, 1).unwrap().into_coefficients();
    let slope = (4.0 * std::f64::consts::PI / 3.0).sqrt();
    sh[1] = DVec3::splat(-slope / mirrored().y);
    let sh = Sh::new(sh).unwrap();
    assert!(sh.irradiance(mirrored()).x > 0.5 && sh.at(mirrored()).x.abs() < 1e-12);
    assert!(shown(&mirror(0.0, lit_by(probe(&sh)))).max_element() < 1e-5);
    let sky = SkyLight { sky: Vec3::ZERO, ground: LIGHT, up: Vec3::Y };
    assert_eq!(shown(&mirror(0.0, AmbientLight::Sky(sky))), Vec3::ZERO);
}

/// A scene with a map that is brightest where the mirror looks.
fn under_a_map(roughness: f32, ambient: AmbientLight) -> Scene {
    let mut scene = mirror(roughness, ambient);
    let (width, height) = (64, 32);
    let texel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let bright = x.abs_diff(width / 2) < 6 && y.abs_diff(height / 4) < 4;
        if bright { [9.0, 6.0, 3.0, 1.0] } else { [0.2, 0.3, 0.5, 1.0] }
    };
    let texels = Texels::Float((0..width * height).map(texel).collect::<Vec<_>>().into());
    scene.image.environment = Some(scene.add_texture(Texture::new("sky", [width, height], texels)));
    scene
}

fn bands_of_map(order: usize) -> Sh {
    let scene = under_a_map(0.0, AmbientLight::Color(Vec3::ZERO));
    let t = &scene.textures[0];
    let pixels: Vec<[f32; 3]> = (0..64 * 32).map(|i| t.texel(i % 64, i / 64).truncate().to_array()).collect();
    let map = Panorama::new(64, 32, &pixels).unwrap();
    PanoramaProjector::new(64, 32, order, Weights::Exact).unwrap().project(&map).unwrap()
}

#[test]
fn mirrors_indoors_see_what_probes_hold_and_not_the_sky_through_walls() {
    let dim = Sh::constant(DVec3::splat(0.05), 2).unwrap();
    let no_sky = Sh::zero(2).unwrap();
    for roughness in [0.0, 0.4] {
        let indoors = lit_by(probe(&dim).with_sky(std::slice::from_ref(&no_sky)).unwrap());
        let seen = shown(&under_a_map(roughness, indoors));
        let even = shown(&under_a_map(roughness, AmbientLight::Color(Vec3::ZERO)));
        let wanted = shown(&mirror(roughness, AmbientLight::Color(Vec3::splat(0.05))));
        assert!((seen - wanted).abs().max_element() < 1e-6, "{roughness}: {seen} {wanted}");
        assert!(even.x > 1.0, "without probes the map is mirrored: {even}");
    }
}

#[test]
fn in_the_open_a_mirror_sees_the_whole_map_and_half_occluded_half_of_its_detail() {
    for order in [2, 6] {
        let bands = bands_of_map(order);
        for roughness in [0.0, 0.4] {
            let whole = shown(&under_a_map(roughness, AmbientLight::Color(Vec3::ZERO)));
            let open = |share: f64| {
                let sky = Sh::constant(share, order).unwrap();
                shown(&under_a_map(roughness, lit_by(probe(&bands).with_sky(&[sky]).unwrap())))
            };
            assert!((open(1.0) - whole).abs().max_element() < 1e-4, "{order} {roughness}");
            let middle = 0.5 * (open(1.0) + open(0.0));
            assert!((open(0.5) - middle).abs().max_element() < 1e-4, "{order} {roughness}");
        }
    }
}
