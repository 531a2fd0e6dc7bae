//! Scenes that do not fit together are refused with the element that is wrong, before anything is drawn.

use glam::{DVec3, Vec3};
use pointillist_render::shade::{self, Falloff, Light, LightOutline};
use pointillist_render::{
    Camera, DrawOptions, LayerKind, LightSource, Material, NONE, Part, RenderError, Scene, SceneError,
    Surroundings, Texels, Texture, Watch, render,
};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// A triangle with a lamp.
fn scene() -> Scene {
    let mut scene = Scene::new(Camera::perspective(DVec3::Z * 3.0, DVec3::ZERO, 1.0), [40, 40]);
    scene.add_material(Material::new("grey", shade::Material::default()));
    scene.mesh.add(&Part::new("triangle", &[DVec3::X, DVec3::Y, DVec3::ZERO], &[[0, 1, 2]])).unwrap();
    let light = Light::Directional { direction: DVec3::NEG_Z, irradiance: Vec3::ONE };
    scene.lights.push(LightSource::new("sun", light));
    scene
}

fn refusal(change: impl FnOnce(&mut Scene)) -> SceneError {
    let mut scene = scene();
    change(&mut scene);
    match render(&scene, &DrawOptions::DEFAULT, &()) {
        Err(RenderError::Scene(error)) => error,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_scene_that_fits_together_is_drawn() {
    assert!(render(&scene(), &DrawOptions::DEFAULT, &()).is_ok());
    assert!(render(&Scene::new(scene().camera, [8, 8]), &DrawOptions::DEFAULT, &()).is_ok());
}

#[test]
fn lists_of_the_wrong_length_are_named() {
    let error = refusal(|s| s.mesh.material_of.push(0));
    assert_eq!(error, SceneError::Length { list: "material_of", length: 2, expected: 1 });
    assert_eq!(error.to_string(), "`material_of` has 2 entries, 1 are needed");
    let error = refusal(|s| s.mesh.object_of.clear());
    assert_eq!(error, SceneError::Length { list: "object_of", length: 0, expected: 1 });
    let error = refusal(|s| s.mesh.normal_of.push([NONE; 3]));
    assert_eq!(error, SceneError::Length { list: "normal_of", length: 2, expected: 1 });
    let error = refusal(|s| s.mesh.uv_of.push([NONE; 3]));
    assert_eq!(error, SceneError::Length { list: "uv_of", length: 2, expected: 1 });
    let error = refusal(|s| s.mesh.second_uv_of = vec![[NONE; 3]; 2]);
    assert_eq!(error, SceneError::Length { list: "second_uv_of", length: 2, expected: 1 });
    let error = refusal(|s| s.mesh.colors = vec![Vec3::ONE]);
    assert_eq!(error, SceneError::Length { list: "colors", length: 1, expected: 3 });
}

#[test]
fn indices_beyond_their_list_are_named() {
    let corner = |list, count| SceneError::Corner { list, triangle: 0, count };
    assert_eq!(refusal(|s| s.mesh.triangles[0][1] = 3), corner("triangles", 3));
    assert_eq!(refusal(|s| s.mesh.triangles[0][1] = NONE), corner("triangles", 3));
    assert_eq!(refusal(|s| s.mesh.normal_of[0] = [0, NONE, NONE]), corner("normal_of", 0));
    assert_eq!(refusal(|s| s.mesh.uv_of[0] = [0, NONE, NONE]), corner("uv_of", 0));
    assert_eq!(refusal(|s| s.mesh.second_uv_of = vec![[0; 3]]), corner("second_uv_of", 0));
    let index = |list, index, count| SceneError::Index { list, triangle: 0, index, count };
    assert_eq!(refusal(|s| s.mesh.material_of[0] = 7), index("material_of", 7, 1));
    assert_eq!(refusal(|s| s.mesh.object_of[0] = 1), index("object_of", 1, 1));
}

#[test]
fn textures_that_do_not_exist_are_named_with_who_wants_them() {
    let missing = |user: &str, texture| SceneError::TextureIndex { user: user.to_owned(), texture, count: 0 };
    assert_eq!(refusal(|s| s.materials[0].diffuse_map = Some(2)), missing("material `grey`", 2));
    assert_eq!(refusal(|s| s.materials[0].opacity_map = Some(0)), missing("material `grey`", 0));
    let own = |s: &mut Scene| s.materials[0].details.surroundings = Surroundings::Texture(1);
    assert_eq!(refusal(own), missing("material `grey`", 1));
    assert_eq!(refusal(|s| s.image.environment = Some(0)), missing("image.environment", 0));
}

#[test]
fn textures_have_as_many_texels_as_they_say() {
    let texels = |width, height, texels: Vec<u8>| {
        refusal(|s| {
            s.add_texture(Texture::new("holes.png", [width, height], Texels::from_opacities(texels)));
        })
    };
    let error = texels(2, 2, vec![0; 3]);
    assert_eq!(error.to_string(), "texture `holes.png` of 2×2 texels has 3");
    assert!(matches!(texels(0, 0, vec![]), SceneError::Texels { .. }));
    assert!(matches!(texels(u32::MAX, u32::MAX, vec![1]), SceneError::Texels { .. }));
}

#[test]
fn numbers_that_are_not_finite_are_named() {
    let what = |change: fn(&mut Scene)| refusal(change).to_string();
    assert_eq!(
        what(|s| s.materials[0].surface.emission.x = f32::NAN),
        "material `grey`: emission is not finite"
    );
    let infinite =
        LightSource::new("lamp", Light::Directional { direction: DVec3::X, irradiance: Vec3::INFINITY });
    assert_eq!(refusal(|s| s.lights[0] = infinite).to_string(), "light `lamp` is not finite");
    assert_eq!(
        what(|s| s.materials[0].diffuse_place.map_from_uv.translation.x = f64::NAN),
        "material `grey`: the place of a map is not finite"
    );
    assert_eq!(what(|s| s.image.background.y = f32::NAN), "image.background is not finite");
    assert_eq!(what(|s| s.mesh.normals.push(Vec3::NAN)), "`normals[0]` is not finite");
    // Positions are checked where geometry is built from them.
    let mut scene = scene();
    scene.mesh.positions[1].z = f64::NAN;
    assert!(matches!(render(&scene, &DrawOptions::DEFAULT, &()), Err(RenderError::Micropoint(_))));
}

#[test]
fn parts_that_do_not_fit_are_not_added() {
    let mut scene = scene();
    let before = scene.mesh.clone();
    let positions = [DVec3::X, DVec3::Y, DVec3::ZERO];
    let normals = [Vec3::Z; 2];
    let short = scene.mesh.add(&Part::new("short", &positions, &[[0, 1, 2]]).with_normals(&normals));
    assert_eq!(short, Err(SceneError::Length { list: "normals", length: 2, expected: 3 }));
    let beyond = scene.mesh.add(&Part::new("beyond", &positions, &[[0, 1, 2], [0, 1, 3]]));
    assert_eq!(beyond, Err(SceneError::Corner { list: "triangles", triangle: 1, count: 3 }));
    assert_eq!(scene.mesh, before);
}

#[test]
fn a_layer_of_a_light_that_does_not_exist_is_refused() {
    let options = DrawOptions::DEFAULT.with_layers(vec![LayerKind::Lit(1)]);
    let error = render(&scene(), &options, &()).unwrap_err();
    assert!(matches!(error, RenderError::Layer { index: 1, count: 1 }), "{error}");
}

#[test]
fn progress_ends_at_the_total_and_a_flag_ends_the_work() {
    let (most, last) = (AtomicU64::new(0), AtomicU64::new(0));
    let report = |done, total| {
        most.store(total, Ordering::Relaxed);
        last.fetch_max(done, Ordering::Relaxed);
    };
    let watch = Watch::new().with_progress(&report);
    render(&scene(), &DrawOptions::DEFAULT, &watch).unwrap();
    // 40 pixels are three tiles of 16.
    assert_eq!((last.into_inner(), most.into_inner()), (9, 9));

    let mut large = scene();
    [large.image.width, large.image.height] = [400; 2];
    let stop = AtomicBool::new(false);
    let done = AtomicU64::new(0);
    let report = |n, _| {
        done.fetch_max(n, Ordering::Relaxed);
        stop.store(n > 0, Ordering::Relaxed);
    };
    let watch = Watch::new().with_progress(&report).with_cancel(&stop);
    let result = render(&large, &DrawOptions::DEFAULT, &watch);
    assert!(matches!(result, Err(RenderError::Cancelled)), "{result:?}");
    // Threads end what they have begun: of 625 tiles one each.
    let done = done.load(Ordering::Relaxed);
    assert!((1..300).contains(&done), "{done}");
}

#[test]
fn polygons_that_cannot_shine_are_named() {
    let add = |vertices: &[DVec3], radiance: f32| {
        let light = Light::Polygon {
            outline: LightOutline::new(vertices).unwrap(),
            radiance: Vec3::splat(radiance),
            two_sided: false,
            samples: None,
            falloff: Falloff::InverseSquare,
        };
        refusal(|s| s.lights.push(LightSource::new("panel", light)))
    };
    let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    assert_eq!(add(&square, -1.0).to_string(), "light `panel` has a negative radiance");
    let mut bent = square;
    bent[2].z = 0.5;
    assert!(add(&bent, 1.0).to_string().contains("light `panel`: vertex"));
    let dent = [DVec3::ZERO, DVec3::X, (DVec3::X + DVec3::Y) * 0.2, DVec3::Y];
    assert!(add(&dent, 1.0).to_string().contains("not convex at vertex 2"));
}
