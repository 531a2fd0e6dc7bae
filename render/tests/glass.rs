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

/// Two coloured panes, one of them partly opaque, over a floor that glows, all larger than the picture. Seen from above, with a light that only
/// the highlight of the upper pane shows.
fn stack(upper: Vec3, lower: Vec3, opacity: f32, shine: f32) -> Scene {
    let mut camera = Camera::perspective(dvec3(0.0, 5.0, 0.0), DVec3::ZERO, 1.0);
    (camera.up, camera.projection) = (DVec3::NEG_Z, Projection::Orthographic { height: 0.2 });
    let mut scene = Scene::new(camera, [3, 3]);
    let floor = shade::Material::lambert(Vec3::ZERO).with_emission(Vec3::new(4.0, 2.0, 1.0));
    let floor = scene.add_material(Material::new("floor", floor));
    let mut glass = |name: &str, color: Vec3, surface: shade::Material| {
        let mut details = Details::default();
        details.transmission = Some(Transmission { color, index: 1.0 });
        scene.add_material(Material::new(name, surface).with_details(details))
    };
    let matt = shade::Material::lambert(Vec3::ZERO);
    let shiny = matt.with_specular(shade::Model::NormalizedBlinnPhong, Vec3::splat(shine), 20.0);
    let panes = [
        (floor, 0.0),
        (glass("lower", lower, matt.with_opacity(opacity)), 1.0),
        (glass("upper", upper, shiny), 2.0),
    ];
    for (material, y) in panes {
        let corners = square(3.0, y, 0.0);
        let part = Part::new("square", &corners, &[[0, 1, 2], [0, 2, 3]]).with_material(material);
        scene.mesh.add(&part).unwrap();
    }
    let light = Light::Directional { direction: DVec3::NEG_Y, irradiance: Vec3::ONE };
    scene.lights.push(LightSource::new("light", light));
    scene
}

#[test]
fn what_is_behind_shows_through_in_the_colours_of_all_panes() {
    let glow = Vec3::new(4.0, 2.0, 1.0);
    for (upper, lower) in [
        (GLASS, Vec3::new(0.25, 0.5, 1.0)),
        (Vec3::splat(0.5), Vec3::new(0.0, 1.0, 0.5)),
        (Vec3::splat(0.5), Vec3::splat(0.25)),
        (Vec3::X, Vec3::Y),
        (Vec3::ONE, Vec3::ZERO),
    ] {
        for opacity in [1.0, 0.75] {
            let options = DrawOptions::DEFAULT.with_layers(vec![LayerKind::Lit(0)]);
            let frame = render(&stack(upper, lower, opacity, 0.0), &options, &()).unwrap();
            let through_lower = Vec3::ONE - opacity * (Vec3::ONE - lower);
            let passes = upper * through_lower;
            // The shares of upper pane, lower pane and floor, each times the light that arrives there.
            let lit = (Vec3::ONE - upper) + upper * upper * (Vec3::ONE - through_lower) + passes * passes;
            let found = frame.layers[0].planes[0][4];
            assert!((found - lit.element_sum() / 3.0).abs() < 1e-5, "{upper} {lower}: lit {found}, {lit}");
            for c in &frame.color {
                let seen = Vec3::new(c[0], c[1], c[2]);
                assert!((seen - glow * passes).abs().max_element() < 1e-5, "{upper} {lower}: {seen}");
                assert!((c[3] - 1.0).abs() < 1e-5, "{upper} {lower}: coverage {}", c[3]);
            }
        }
    }
}

#[test]
fn highlights_of_clear_surfaces_are_whole() {
    let seen = |upper, shine| {
        let options = DrawOptions::DEFAULT.with_layers(vec![LayerKind::Lit(0), LayerKind::Direct]);
        let frame = render(&stack(upper, Vec3::ZERO, 1.0, shine), &options, &()).unwrap();
        let direct = &frame.layers[1].planes;
        assert!((0..3).all(|c| (direct[c][4] - frame.color[4][c]).abs() < 1e-6), "nothing behind is seen");
        Vec3::new(frame.color[4][0], frame.color[4][1], frame.color[4][2])
    };
    let opaque = seen(Vec3::ZERO, 0.5);
    assert!(opaque.min_element() > 0.1);
    for clear in [GLASS, Vec3::splat(0.5), Vec3::ONE, Vec3::new(1.0, 0.5, 0.0)] {
        assert!(
            (seen(clear, 0.5) / opaque - 1.0).abs().max_element() < 1e-5,
            "{clear}: {}",
            seen(clear, 0.5)
        );
    }
}

#[test]
fn what_no_colour_passes_is_diffused() {
    let mut scene = stack(GLASS, Vec3::ZERO, 1.0, 0.0);
    scene.materials[2].surface.diffuse = Vec3::splat(0.8);
    let c = render(&scene, &DrawOptions::DEFAULT, &()).unwrap().color[4];
    let expected = Vec3::splat(0.8 * (1.0 - GLASS.max_element()) / std::f32::consts::PI);
    assert!((Vec3::new(c[0], c[1], c[2]) - expected).abs().max_element() < 1e-5, "{c:?}");
}

/// A pane over part of a floor: what is drawn does not depend on which tiles know of a colour.
#[test]
fn windows_onto_glass_agree_with_the_whole_picture() {
    let scene = {
        let camera = Camera::perspective(dvec3(0.0, 6.0, 9.0), DVec3::ZERO, 0.8);
        let mut scene = stack(GLASS, Vec3::new(0.25, 0.5, 1.0), 0.5, 0.5);
        (scene.camera, scene.image.width, scene.image.height) = (camera, 70, 50);
        scene
    };
    let layers = vec![LayerKind::Direct, LayerKind::Lit(0), LayerKind::Id];
    let whole = render(&scene, &DrawOptions::DEFAULT.with_layers(layers.clone()), &()).unwrap();
    let window = pointillist_render::PixelRect { x0: 11, y0: 7, x1: 60, y1: 43 };
    let part = render(&scene, &DrawOptions::DEFAULT.with_layers(layers).with_window(window), &()).unwrap();
    let (width, own) = (70, window.width() as usize);
    for (i, color) in part.color.iter().enumerate() {
        let at = (window.y0 as usize + i / own) * width + window.x0 as usize + i % own;
        assert_eq!(*color, whole.color[at]);
        for (a, b) in part.layers.iter().zip(&whole.layers) {
            assert!(a.planes.iter().zip(&b.planes).all(|(a, b)| a[i] == b[at]));
        }
    }
    let tinted = whole.color.iter().filter(|c| (c[0] - 4.0 * c[2]).abs() > 1e-3).count();
    assert!(tinted > 500, "{tinted}");
}
