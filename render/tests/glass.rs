//! Light through what is clear: its shadow has its colour.

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::shade::{self, Light};
use pointillist_render::{
    Camera, Details, DrawOptions, LayerKind, LightSource, Material, Part, Projection, Scene, Transmission,
    render,
};

const GLASS: Vec3 = Vec3::new(0.8, 0.5, 0.1);

fn square(half: f64, y: f64, middle: f64) -> [DVec3; 4] {
    [(-half, half), (half, half), (half, -half), (-half, -half)].map(|(x, z)| dvec3(x + middle, y, z))
}

/// The mean of what is sent on by a white floor that is seen from above, and the lit share of it; with these panes of glass
/// between it and the light, which the eye does not see.
fn floor(light: Light, panes: u32, glass: Vec3, closed: bool) -> (Vec3, f32) {
    let mut camera = Camera::perspective(dvec3(0.0, 5.0, 0.0), DVec3::ZERO, 1.0);
    (camera.up, camera.projection) = (DVec3::NEG_Z, Projection::Orthographic { height: 0.2 });
    let mut scene = Scene::new(camera, [3, 3]);
    let white = scene.add_material(Material::new("floor", shade::Material::lambert(Vec3::ONE)));
    let mut details = Details::default();
    details.transmission = Some(Transmission { color: glass, index: 1.0 });
    let clear = Material::new("glass", shade::Material::lambert(Vec3::ZERO)).with_details(details);
    let clear = scene.add_material(clear);
    let ground = square(0.5, 0.0, 0.0);
    let faces = [[0, 1, 2], [0, 2, 3]];
    scene.mesh.add(&Part::new("floor", &ground, &faces).with_material(white)).unwrap();
    for i in 0..panes {
        let pane = square(40.0, 1.0 + 0.1 * f64::from(i), 41.0);
        scene.mesh.add(&Part::new("pane", &pane, &faces).with_material(clear)).unwrap();
    }
    if closed {
        let corners: Vec<DVec3> = [2.0, 3.0].into_iter().flat_map(|y| square(40.0, y, 41.0)).collect();
        let sides = (0..4).flat_map(|i| {
            let j = (i + 1) % 4;
            [[i, j, j + 4], [i, j + 4, i + 4]]
        });
        let lids = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
        let all: Vec<[u32; 3]> = lids.into_iter().chain(sides).collect();
        scene.mesh.add(&Part::new("block", &corners, &all).with_material(clear)).unwrap();
    }
    scene.lights.push(LightSource::new("light", light));
    let options = DrawOptions::DEFAULT.with_layers(vec![LayerKind::Lit(0)]);
    let frame = render(&scene, &options, &()).unwrap();
    let sum: Vec3 = frame.color.iter().map(|c| Vec3::new(c[0], c[1], c[2])).sum();
    (sum / 9.0, frame.layers[0].planes[0].iter().sum::<f32>() / 9.0)
}

/// From the side, where nothing but glass lies between.
fn lights() -> [Light; 3] {
    let position = dvec3(40.0, 20.0, 0.0);
    [
        Light::Directional { direction: dvec3(-2.0, -1.0, 0.0), irradiance: Vec3::ONE },
        Light::Point { position, intensity: Vec3::splat(2000.0), falloff: shade::Falloff::InverseSquare },
        Light::Rect {
            corner: position,
            edge_u: dvec3(1.0, 0.0, 0.0),
            edge_v: dvec3(0.0, 0.0, 1.0),
            radiance: Vec3::splat(9000.0),
            samples: None,
            falloff: shade::Falloff::InverseSquare,
        },
    ]
}

#[test]
fn panes_tint_what_passes_them() {
    for light in lights() {
        let (open, lit) = floor(light, 0, GLASS, false);
        assert!(open.min_element() > 0.01 && (lit - 1.0).abs() < 1e-6, "{light:?}: {open} {lit}");
        for panes in 1..3 {
            let passes = GLASS.powf(panes as f32);
            let (seen, lit) = floor(light, panes, GLASS, false);
            assert!((seen / open - passes).abs().max_element() < 1e-5, "{light:?}: {}", seen / open);
            assert!((lit - passes.element_sum() / 3.0).abs() < 1e-5, "{light:?}: {lit}");
        }
    }
}

#[test]
fn a_block_is_passed_through_both_of_its_sides() {
    for light in lights() {
        let (open, _) = floor(light, 0, GLASS, false);
        for glass in [GLASS, Vec3::splat(0.25)] {
            let (seen, _) = floor(light, 0, glass, true);
            assert!((seen / open - glass * glass).abs().max_element() < 1e-5, "{light:?}: {}", seen / open);
        }
    }
}

#[test]
fn what_passes_all_light_casts_no_shadow() {
    for light in lights() {
        let (open, seen) = (floor(light, 0, GLASS, false).0, floor(light, 2, Vec3::ONE, true).0);
        assert!((seen - open).abs().max_element() < 1e-6 * open.max_element(), "{light:?}");
    }
}

/// A floor below a small pane of glass; with `screen`, below a clear sheet of opacity 0, too, which neither casts a shadow nor is seen.
fn half_tinted(light: Light, screen: bool) -> pointillist_render::Frame {
    let camera = Camera::perspective(dvec3(0.0, 6.0, 9.0), DVec3::ZERO, 0.8);
    let mut scene = Scene::new(camera, [70, 50]);
    let white = scene.add_material(Material::new("floor", shade::Material::lambert(Vec3::ONE)));
    let mut clear = |name: &str, opacity: f32| {
        let mut details = Details::default();
        details.transmission = Some(Transmission { color: GLASS, index: 1.0 });
        let mut surface = shade::Material::lambert(Vec3::ZERO);
        surface.opacity = opacity;
        scene.add_material(Material::new(name, surface).with_details(details))
    };
    let (glass, air) = (clear("glass", 0.8), clear("air", 0.0));
    let faces = [[0, 1, 2], [0, 2, 3]];
    scene.mesh.add(&Part::new("floor", &square(4.0, 0.0, 0.0), &faces).with_material(white)).unwrap();
    scene.mesh.add(&Part::new("pane", &square(0.7, 1.0, 0.9), &faces).with_material(glass)).unwrap();
    if screen {
        scene.mesh.add(&Part::new("air", &square(4.0, 0.5, 0.0), &faces).with_material(air)).unwrap();
    }
    scene.lights.push(LightSource::new("light", light));
    render(&scene, &DrawOptions::DEFAULT, &()).unwrap()
}

#[test]
fn asking_each_colour_only_where_glass_may_tint_it_changes_no_bit() {
    let mut lights = lights();
    if let Light::Point { position, .. } = &mut lights[1] {
        *position = dvec3(1.0, 5.0, 1.0);
    }
    if let Light::Rect { corner, edge_u, edge_v, .. } = &mut lights[2] {
        (*corner, *edge_u, *edge_v) = (dvec3(0.5, 4.0, 0.0), dvec3(1.0, 0.0, 0.0), dvec3(0.0, 0.0, 1.0));
    }
    for light in lights {
        let (some, all) = (half_tinted(light, false), half_tinted(light, true));
        let tinted = some.color.iter().filter(|c| (c[0] - c[2]).abs() > 1e-3).count();
        assert!(tinted > 20 && tinted < 2000, "{light:?}: {tinted} of 3500 pixels are coloured");
        assert!(some.color == all.color, "{light:?}");
    }
}
