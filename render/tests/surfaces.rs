//! What materials come to: in pictures, and as surfaces of radiosity.

use glam::{DAffine3, DVec3, Vec3, Vec4, dvec2, dvec3, vec3};
use pointillist_render::radiosity::{Baked, BakedTriangle};
use pointillist_render::shade::{self, Light, MerlTable};
use pointillist_render::{
    AmbientLight, BakedLight, BakedSide, Bump, BumpHeight, Camera, Channel, DrawOptions, LayerKind,
    LightSource, Lightmap, LightmapError, Map, Material, MeasuredBrdf, Part, Scene, SceneError, Surroundings,
    Texels, Texture, Transmission, fingerprint, render, scene_surfaces,
};
use std::f64::consts::PI;
use std::sync::Arc;

const CORNERS: [DVec3; 4] =
    [dvec3(-1.0, -1.0, 0.0), dvec3(1.0, -1.0, 0.0), dvec3(1.0, 1.0, 0.0), dvec3(-1.0, 1.0, 0.0)];

/// A square that fills the picture, of this material, in sunlight.
fn square(material: Material) -> Scene {
    let camera = Camera::perspective(DVec3::Z, DVec3::ZERO, std::f64::consts::FRAC_PI_2);
    let mut scene = Scene::new(camera, [8, 8]);
    scene.add_material(material);
    scene.mesh.add(&Part::new("square", &CORNERS, &[[0, 1, 2], [0, 2, 3]])).unwrap();
    for (name, level) in [("sun", 1.0), ("moon", 0.5)] {
        let light = Light::Directional { direction: DVec3::NEG_Z, irradiance: Vec3::splat(level) };
        scene.lights.push(LightSource::new(name, light));
    }
    scene
}

fn grey(albedo: f32) -> Material {
    Material::new("grey", shade::Material::lambert(Vec3::splat(albedo)))
}

/// A map of this one colour.
fn map(scene: &mut Scene, color: Vec4) -> Map {
    let texture =
        scene.add_texture(Texture::new("even", [2, 2], Texels::Float(vec![color.to_array(); 4].into())));
    Map { channel: Channel::Green, ..Map::new(texture) }
}

#[test]
fn a_layer_that_is_asked_for_twice_is_delivered_twice() {
    let scene = square(grey(0.5));
    let kinds =
        [LayerKind::Lit(1), LayerKind::Direct, LayerKind::Lit(1), LayerKind::Lit(0), LayerKind::Direct];
    let frame = render(&scene, &DrawOptions::DEFAULT.with_layers(kinds.to_vec()), &()).unwrap();
    assert!(frame.layers[0].planes[0].iter().all(|&v| (v - 1.0).abs() < 1e-6));
    assert_eq!(frame.layers[0], frame.layers[2]);
    assert_eq!(frame.layers[0].planes, frame.layers[3].planes);
    assert_eq!(frame.layers[1], frame.layers[4]);
}

#[test]
fn measured_reflection_takes_the_place_of_black_constants() {
    let table = MerlTable::tabulate(|_, _| vec3(0.1, 0.2, 0.3));
    let mut material = grey(0.0);
    material.details.measured = Some(MeasuredBrdf { table: Arc::new(table), fingerprint: 1 });
    let frame = render(&square(material), &DrawOptions::DEFAULT, &()).unwrap();
    let [r, g, b, _] = frame.color[8 * 4 + 4];
    // Irradiance 1.5 at normal incidence.
    assert!((vec3(r, g, b) - vec3(0.15, 0.3, 0.45)).abs().max_element() < 1e-5, "{r} {g} {b}");
}

#[test]
fn surroundings_that_are_captured_are_mirrored_by_what_others_capture() {
    // A sky of one colour, and two mirrors that face each other: each shows the other one showing the sky.
    let mut mirror = grey(0.0);
    mirror.details.reflection = Some(Vec3::ONE);
    mirror.details.surroundings = Surroundings::Capture;
    let mut scene = square(mirror);
    let sky = map(&mut scene, vec3(0.2, 0.4, 0.6).extend(1.0));
    scene.image.environment = Some(sky.texture);
    let behind: Vec<DVec3> = CORNERS.iter().map(|&p| dvec3(-p.x, p.y, 3.0) * dvec3(4.0, 4.0, 1.0)).collect();
    scene.mesh.add(&Part::new("other", &behind, &[[0, 1, 2], [0, 2, 3]])).unwrap();
    let frame = render(&scene, &DrawOptions::DEFAULT, &()).unwrap();
    let [r, g, b, _] = frame.color[8 * 4 + 4];
    assert!((vec3(r, g, b) - vec3(0.2, 0.4, 0.6)).abs().max_element() < 1e-2, "{r} {g} {b}");
}

#[test]
fn surfaces_of_radiosity_have_what_pictures_show() {
    let mut scene = square(grey(0.8));
    let (glow, metal) = (map(&mut scene, vec3(1.0, 0.5, 0.0).extend(1.0)), map(&mut scene, Vec4::splat(0.5)));
    let material = &mut scene.materials[0];
    material.surface.emission = Vec3::splat(2.0);
    material.details.emission_map = Some(glow);
    (material.details.metallic, material.details.metallic_map) = (Some(0.5), Some(metal));
    material.details.one_sided = true;
    scene.mesh.colors = vec![Vec3::ONE, Vec3::ONE, Vec3::ZERO, Vec3::ONE];
    let found = scene_surfaces(&scene).unwrap();
    assert_eq!((found.surfaces.len(), found.faces[0].len()), (1, 2));
    let surface = &found.surfaces[0];
    assert!(!surface.two_sided);
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    // Three quarters of 0.8 are not metal; one of three vertices of each triangle is black.
    assert!(near(surface.reflectance, [0.8 * 0.75 * 2.0 / 3.0; 3]), "{:?}", surface.reflectance);
    assert!(near(surface.emission, [2.0 * PI, PI, 0.0]), "{:?}", surface.emission);
    scene.mesh.colors.fill(Vec3::splat(2.0));
    assert!(matches!(scene_surfaces(&scene), Err(SceneError::Albedo { .. })));
}

#[test]
fn baked_light_depends_on_which_material_is_where() {
    let mut scene = square(grey(0.2));
    scene.add_material(grey(0.8));
    let before = fingerprint::of_sources(&scene);
    scene.mesh.material_of[1] = 1;
    assert_ne!(before, fingerprint::of_sources(&scene));
    // What no triangle has does not count, nor does what only others have.
    assert_eq!(before, fingerprint::of_sources_for(&scene, [0, 0]));
    scene.mesh.material_of[1] = 0;
    assert_eq!(before, fingerprint::of_sources(&scene));
}

#[test]
fn baked_light_without_area_or_numbers_lights_nothing_wrong() {
    let normals = [[0.0, 0.0, 1.0]; 4];
    let irradiance = [[1.0; 3], [1.0; 3], [1.0; 3], [100.0; 3]];
    let sides = [BakedSide { faces: &[0], back: false, count: 2 }];
    let light = |positions: &[[f64; 3]; 4]| {
        // The first triangle has no area: a, b, b.
        let triangles = [[3, 0, 0], [0, 1, 2]];
        let light =
            BakedLight { positions, normals: &normals, irradiance: &irradiance, triangles: &triangles };
        Lightmap::new(&light, &sides, 1).unwrap().irradiance(0, true, dvec3(0.2, 0.2, 0.0))
    };
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.2, 0.0]];
    assert!((light(&corners) - Vec3::ONE).abs().max_element() < 1e-6);
    // Sizes that overflow: no number comes out that is not one.
    assert!(light(&corners.map(|p| p.map(|v| (v - 0.5) * f64::MAX))).is_finite());

    let positions = [[0.0; 3]; 4];
    let wrong = [[0.0, f32::NAN, 1.0]; 4];
    let light =
        BakedLight { positions: &positions, normals: &wrong, irradiance: &irradiance, triangles: &[] };
    assert_eq!(light.check(&[], 1), Err(LightmapError::NotFinite { list: "normals", index: 0 }));
}

#[test]
fn light_of_a_surface_without_faces_is_refused() {
    let mut baked = Baked::default();
    baked.triangles.push(BakedTriangle { surface: 3, back: false, vertices: [0; 3] });
    let error = Lightmap::of_baked(&baked, &[vec![0]], 1).unwrap_err();
    assert_eq!(error, LightmapError::Surface { surface: 3, count: 1 });
}

#[test]
fn numbers_of_details_and_ambient_light_are_checked() {
    let message = |change: fn(&mut Scene)| {
        let mut scene = square(grey(0.5));
        change(&mut scene);
        scene.check().unwrap_err().to_string()
    };
    assert_eq!(
        message(|s| s.materials[0].details.metallic = Some(f32::NAN)),
        "material `grey`: metallic is not finite"
    );
    assert_eq!(
        message(|s| s.materials[0].details.reflection = Some(Vec3::INFINITY)),
        "material `grey`: reflection is not finite"
    );
    assert_eq!(
        message(|s| s.materials[0].details.transmission = Some(Transmission { color: Vec3::ONE, index: 0.0 })),
        "material `grey`: a refraction index of 0 is not above 0"
    );
    assert_eq!(message(|s| s.ambient = AmbientLight::Color(Vec3::NAN)), "ambient is not finite");
}

#[test]
fn bumps_within_a_pixel_widen_the_highlight_by_the_variance_of_their_slopes() {
    let surface = shade::Material::ggx(Vec3::ZERO, Vec3::splat(0.9), 0.3);
    let mut bumpy = square(Material::new("metal", surface));
    bumpy.mesh.uvs = [(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)].map(|(u, v)| dvec2(u, v)).to_vec();
    bumpy.mesh.uv_of = vec![[0, 1, 2], [0, 2, 3]];
    // A pixel sees the texture once: eight waves with the slopes s, 0, −s, 0.
    let waves = (0..32 * 4).map(|i| [100, 150, 100, 50][i % 4]).collect();
    let texture = bumpy.add_texture(Texture::new("waves", [32, 4], Texels::from_grays(waves)));
    let map = Map::new(texture);
    let height = 0.01;
    bumpy.materials[0].details.bump = Some(Bump { map, height: BumpHeight::World(height) });
    // A difference of 100 steps over two texels; a texture spans a quarter.
    let slope = 100.0 / 255.0 / (2.0 * 0.25 / 32.0) * height;
    let widened = square(Material::new("metal", surface.widened(0.5 * slope * slope)));
    let [bumpy, widened, plain] = [bumpy, widened, square(Material::new("metal", surface))]
        .map(|scene| render(&scene, &DrawOptions::DEFAULT, &()).unwrap());
    for (i, a) in bumpy.color.iter().enumerate() {
        let (b, c) = (widened.color[i], plain.color[i]);
        // Along the triangles' common edge each sees a part of the waves, whose mean is not level.
        if i % 8 + i / 8 != 7 {
            assert!((a[0] - b[0]).abs() < 2e-3 * b[0], "{i}: {a:?} {b:?}");
            assert!((a[0] - c[0]).abs() > 0.05 * c[0], "{i}: {a:?} {c:?}");
        }
    }
}

#[test]
fn slopes_that_do_not_vary_change_no_highlight() {
    let surface = shade::Material::ggx(Vec3::ZERO, Vec3::splat(0.9), 0.3);
    let with_normals = |texels: Option<(u32, [u8; 3])>| {
        let mut scene = square(Material::new("metal", surface));
        scene.mesh.uvs = CORNERS.map(|p| p.truncate()).to_vec();
        scene.mesh.uv_of = vec![[0, 1, 2], [0, 2, 3]];
        if let Some((size, texel)) = texels {
            let texels = Texels::OpaqueLinear8(vec![texel; (size * size) as usize].into());
            let texture = scene.add_texture(Texture::new("even", [size; 2], texels));
            let map = Map::new(texture);
            scene.materials[0].details.normal = Some((map, 1.0));
        }
        render(&scene, &DrawOptions::DEFAULT, &()).unwrap().color
    };
    let none = with_normals(None);
    assert_eq!(none, with_normals(Some((4, [128, 127, 255]))));
    let [many, one] = [4, 1].map(|size| with_normals(Some((size, [150, 120, 250]))));
    assert!(many.iter().zip(&one).all(|(a, b)| (a[0] - b[0]).abs() < 1e-5 * b[0]), "{many:?} {one:?}");
    assert_ne!(many, none);
}

#[test]
fn layers_tell_instances_apart() {
    let mut scene = Scene::new(Camera::perspective(DVec3::Z * 4.0, DVec3::ZERO, 1.0), [16, 8]);
    let shape = {
        let mut mesh = pointillist_render::Mesh::default();
        mesh.add(&Part::new("", &CORNERS, &[[0, 1, 2], [0, 2, 3]]).with_two_sided(false)).unwrap();
        mesh
    };
    scene.add_material(grey(0.5));
    assert!(matches!(
        scene.mesh.clone().add_shape(Default::default()),
        Err(SceneError::Shape { objects: 0, .. })
    ));
    let shape = scene.mesh.add_shape(shape).unwrap();
    let at = |x: f64| DAffine3::from_translation(DVec3::X * x);
    assert!(matches!(scene.mesh.add_instance(7, "none", at(0.0)), Err(SceneError::Index { index: 7, .. })));
    let nowhere = scene.mesh.add_instance(shape, "nowhere", at(f64::NAN));
    assert!(matches!(nowhere, Err(SceneError::NotFinite { .. })));
    scene.mesh.add_instance(shape, "left", at(-1.5)).unwrap();
    // Mirrored, it still shows its front.
    scene.mesh.add_instance(shape, "right", at(1.5) * DAffine3::from_scale(dvec3(-1.0, 1.0, 1.0))).unwrap();
    assert_eq!((scene.mesh.triangle_count(), scene.mesh.object(1), scene.mesh.object(2)), (4, 0, 1));
    let kinds = vec![LayerKind::Id, LayerKind::Normal, LayerKind::Back];
    let draw = |scene: &Scene| render(scene, &DrawOptions::DEFAULT.with_layers(kinds.clone()), &()).unwrap();
    let frame = draw(&scene);
    let [left, right] = [4 * 16 + 4, 4 * 16 + 11];
    assert_eq!([left, right].map(|i| frame.layers[0].planes[0][i]), [1.0, 2.0]);
    assert_eq!([left, right].map(|i| frame.layers[1].planes[2][i]), [1.0, 1.0]);
    let mut expanded = scene.clone();
    expanded.mesh = scene.mesh.expanded().unwrap().into_owned();
    assert!(expanded.mesh.instances().is_empty() && expanded.mesh.triangles.len() == 4);
    assert_eq!(frame.layers, draw(&expanded).layers);
    let objects = fingerprint::of_objects(&scene.mesh);
    assert_eq!(objects, fingerprint::of_objects(&expanded.mesh));
    assert_eq!(objects.iter().map(|o| o.triangles.clone()).collect::<Vec<_>>(), [0..2, 2..4]);
    // What is baked triangle by triangle is not light of the same triangles elsewhere.
    let mut moved = scene.mesh.clone();
    moved.add_instance(shape, "third", at(9.0)).unwrap();
    assert_ne!(fingerprint::of_geometry(&moved), fingerprint::of_geometry(&scene.mesh));
    let more = fingerprint::of_objects(&moved);
    assert_eq!(more[..2], objects);
    assert!(objects.iter().all(|object| object.fingerprint != more[2].fingerprint));
}
