//! Lines that shine, against many point lights along them.

use glam::{DVec3, Vec3, dvec2, dvec3};
use pointillist_render::shade::{self, Falloff, Interpolation, Light, Model};
use pointillist_render::{
    Camera, DrawOptions, Frame, LayerKind, LightSource, Material, Part, Projection, RenderError, Scene,
    SceneError, Texels, Texture, render,
};
use std::num::NonZeroU32;

const ENDS: [DVec3; 2] = [DVec3::new(-1.0, 1.5, -0.3), DVec3::new(1.2, 1.2, 0.4)];

fn line(samples: Option<u32>, falloff: Falloff) -> Light {
    let samples = samples.and_then(NonZeroU32::new);
    Light::Line { from: ENDS[0], to: ENDS[1], radiance: Vec3::new(3.0, 2.0, 1.0), samples, falloff }
}

/// A floor and three boards between it and the light: one opaque, one translucent, one with a mask.
fn scene(floor: shade::Material, light: Light) -> Scene {
    let camera = Camera::perspective(dvec3(0.3, 2.0, 3.0), dvec3(0.0, 0.0, 0.0), 0.8);
    // So many pixels that no light is close to what one sees, and averaged over it.
    let mut scene = Scene::new(camera, [96, 96]);
    let floor = scene.add_material(Material::new("floor", floor));
    let plain = shade::Material::lambert(Vec3::ONE);
    let faces = [[0, 1, 2], [0, 2, 3]];
    let square = |half: f64, at: DVec3| {
        [(-half, half), (half, half), (half, -half), (-half, -half)].map(|(x, z)| at + dvec3(x, 0.0, z))
    };
    scene.mesh.add(&Part::new("floor", &square(4.0, DVec3::ZERO), &faces).with_material(floor)).unwrap();
    let leaf = scene.add_texture(checker());
    let kinds = [
        Material::new("opaque", plain),
        Material::new("translucent", plain.with_opacity(0.4)),
        Material::new("masked", plain).with_opacity_map(leaf),
    ];
    let uvs = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
    for (i, kind) in kinds.into_iter().enumerate() {
        let material = scene.add_material(kind);
        let board = square(0.25, dvec3(f64::from(i as u32) * 0.8 - 0.8, 0.3 + 0.1 * i as f64, 0.0));
        scene.mesh.add(&Part::new("board", &board, &faces).with_uvs(&uvs).with_material(material)).unwrap();
    }
    scene.lights.push(LightSource::new("line", light));
    scene
}

fn checker() -> Texture {
    let opaque = |i: usize| if (i % 4 + i / 4).is_multiple_of(2) { 255 } else { 0 };
    Texture::new("leaf", [4, 4], Texels::from_opacities((0..16).map(opaque).collect()))
}

fn draw(scene: &Scene) -> Frame {
    render(scene, &DrawOptions::DEFAULT.with_layers(vec![LayerKind::Lit(0)]), &()).unwrap()
}

/// Root mean square and largest difference.
fn differences(a: &Frame, b: &Frame) -> (f32, f32) {
    let d: Vec<f32> = a.color.iter().zip(&b.color).map(|(a, b)| (a[0] - b[0]).abs()).collect();
    ((d.iter().map(|d| d * d).sum::<f32>() / d.len() as f32).sqrt(), d.iter().copied().fold(0.0, f32::max))
}

#[test]
fn a_line_is_the_limit_of_points_along_it() {
    let lambert = shade::Material::lambert(Vec3::splat(0.8));
    let shiny = lambert.with_specular(Model::NormalizedBlinnPhong, Vec3::splat(0.5), 60.0);
    for (surface, falloff) in [
        (lambert, Falloff::InverseSquare),
        (shiny, Falloff::InverseSquare),
        (shade::Material::ggx(Vec3::splat(0.4), Vec3::splat(0.3), 0.3), Falloff::InverseSquare),
        (lambert, Falloff::Polynomial([1.0, 0.5, 0.2])),
    ] {
        let whole = draw(&scene(surface, line(None, falloff)));
        let points = draw(&scene(surface, line(Some(256), falloff)));
        let (rms, most) = differences(&whole, &points);
        assert!(rms < 2e-3 && most < 0.03, "{surface:?} {falloff:?}: {rms:e} {most:e}");
    }
}

#[test]
fn without_shadows_only_the_lobe_is_approximated() {
    let lambert = shade::Material::lambert(Vec3::splat(0.8));
    for (surface, bound) in
        [(lambert, 2e-4), (lambert.with_specular(Model::NormalizedPhong, Vec3::splat(0.5), 200.0), 2e-3)]
    {
        for shading in [Interpolation::Flat, Interpolation::Phong] {
            let frame = |samples| {
                let mut scene = scene(surface, line(samples, Falloff::InverseSquare));
                scene.lights[0].shadow = false;
                scene.render.shading = shading;
                // In perspective, the middle of what a pixel sees of a surface is not what its middle sees. Points that are close are averaged over
                // it, and a line is asked at the middle: pixels are so small here that none is close.
                scene.camera.projection = Projection::Orthographic { height: 2.4 };
                draw(&scene)
            };
            let (rms, most) = differences(&frame(None), &frame(Some(1024)));
            assert!(rms < bound && most < 4e-3, "{surface:?}: {rms:e} {most:e}");
        }
    }
}

#[test]
fn the_layer_says_what_share_of_the_line_arrives() {
    let frame = |samples| draw(&scene(shade::Material::default(), line(samples, Falloff::InverseSquare)));
    let (whole, points) = (frame(None), frame(Some(256)));
    let planes = whole.layers[0].planes[0].iter().zip(&points.layers[0].planes[0]);
    let sum: f32 = planes.map(|(a, b)| (a - b).abs()).sum::<f32>() / 9216.0;
    assert!(sum < 5e-3, "{sum:e}");
}

#[test]
fn lines_that_are_none_are_refused_by_name() {
    let mut scene = scene(shade::Material::default(), line(None, Falloff::InverseSquare));
    let with = |scene: &mut Scene, new: DVec3| {
        let Light::Line { to, .. } = &mut scene.lights[0].light else { unreachable!("the light is a line") };
        *to = new;
    };
    with(&mut scene, ENDS[0]);
    let error = scene.check().unwrap_err();
    assert_eq!(error.to_string(), "light `line`: the light's line has no length");
    with(&mut scene, DVec3::splat(f64::NAN));
    assert!(matches!(scene.check(), Err(SceneError::NotFinite { .. })));
    with(&mut scene, ENDS[1]);
    let Light::Line { radiance, .. } = &mut scene.lights[0].light else {
        unreachable!("the light is a line")
    };
    radiance.x = -1.0;
    let error: RenderError = render(&scene, &DrawOptions::DEFAULT, &()).unwrap_err();
    assert!(matches!(error, RenderError::Scene(SceneError::NegativeLight { .. })), "{error}");
}
