//! Meshes that light others directly, against lights of the same shape and closed forms.

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::shade::{self, Falloff, Light};
use pointillist_render::{
    Ambient, Camera, CaptureOptions, Details, DrawOptions, Frame, Lamps, LayerKind, LightSource, Map,
    Material, Part, Prepared, Projection, RenderError, Scene, SceneError, Texture, render, scene_surfaces,
    with_lamps,
};
use std::f64::consts::PI;

const RADIANCE: Vec3 = Vec3::new(4.0, 2.0, 1.0);

fn square(half: f64, y: f64) -> [DVec3; 4] {
    [(-half, half), (half, half), (half, -half), (-half, -half)].map(|(x, z)| dvec3(x, y, z))
}

/// Looks down on a white floor from below the lamps; a small square hangs between them and the floor, out of view.
fn scene() -> Scene {
    let mut camera = Camera::perspective(dvec3(0.0, 0.2, 0.0), DVec3::ZERO, 1.0);
    (camera.up, camera.projection) = (DVec3::NEG_Z, Projection::Orthographic { height: 3.0 });
    let mut scene = Scene::new(camera, [24, 24]);
    let white = scene.add_material(Material::new("floor", shade::Material::lambert(Vec3::ONE)));
    let faces = [[0, 1, 2], [0, 2, 3]];
    scene.mesh.add(&Part::new("floor", &square(4.0, 0.0), &faces).with_material(white)).unwrap();
    let caster = square(0.3, 0.5).map(|p| p + DVec3::X * 0.4);
    scene.mesh.add(&Part::new("caster", &caster, &faces).with_material(white)).unwrap();
    scene
}

fn lamp_material(scene: &mut Scene, change: impl FnOnce(&mut Details)) -> u32 {
    let mut details = Details::default();
    details.emits = true;
    change(&mut details);
    let surface = shade::Material::lambert(Vec3::ZERO).with_emission(RADIANCE);
    scene.add_material(Material::new("lamp", surface).with_details(details))
}

fn draw(scene: &Scene) -> Frame {
    render(scene, &DrawOptions::DEFAULT.with_layers(vec![LayerKind::Direct]), &()).unwrap()
}

fn largest_difference(a: &Frame, b: &Frame) -> f32 {
    a.color.iter().flatten().zip(b.color.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

fn polygon_light(corners: &[DVec3], two_sided: bool) -> LightSource {
    let outline = shade::LightOutline::new(corners).unwrap();
    let light = Light::Polygon {
        outline,
        radiance: RADIANCE,
        two_sided,
        samples: None,
        falloff: Falloff::InverseSquare,
    };
    LightSource::new("lamp", light)
}

/// A quad that faces down.
fn panel() -> [DVec3; 4] {
    let [a, b, c, d] = square(0.5, 1.5);
    [d, c, b, a]
}

#[test]
fn a_quad_lights_the_floor_as_a_light_of_its_shape_does() {
    let mut lit = scene();
    lit.lights.push(polygon_light(&panel(), false));
    let expected = draw(&lit);
    // As two triangles, turned over with its back drawn, and as a grid of triangles.
    let [a, b, c, d] = panel();
    let at = |i: u32, j: u32| a + (b - a) * f64::from(i) / 3.0 + (d - a) * f64::from(j) / 3.0;
    let grid: Vec<DVec3> = (0..16).map(|k| at(k % 4, k / 4)).collect();
    let cells = (0..9u32).flat_map(|k| {
        let v = k % 3 + k / 3 * 4;
        [[v, v + 1, v + 5], [v, v + 5, v + 4]]
    });
    let cells: Vec<[u32; 3]> = cells.collect();
    let faces = [[0, 1, 2], [0, 2, 3]];
    type Way<'a> = (&'a [DVec3], &'a [[u32; 3]], bool);
    let ways: [Way<'_>; 3] =
        [(&[a, b, c, d], &faces, false), (&[d, c, b, a], &faces, true), (&grid, &cells, false)];
    for (corners, triangles, two_sided) in ways {
        let mut own = scene();
        let material = lamp_material(&mut own, |_| ());
        let part = Part::new("lamp", corners, triangles).with_material(material).with_two_sided(two_sided);
        own.mesh.add(&part).unwrap();
        let got = draw(&own);
        let difference = largest_difference(&expected, &got);
        // The grid's outline begins with another corner. Where receivers are halved is decided in the light's axes, which follow from it.
        let bound = if triangles.len() == 2 { 2e-6 } else { 1e-3 };
        assert!(difference < bound, "{} triangles: {difference:e}", triangles.len());
    }
    // The shadow is there.
    let value = |x: usize| expected.color[12 * 24 + x][0];
    assert!(value(16) < 0.2 * value(6), "{} {}", value(16), value(6));
}

#[test]
fn a_back_that_is_not_drawn_lights_nothing() {
    for one_sided in [false, true] {
        let mut scene = scene();
        let material = lamp_material(&mut scene, |details| details.one_sided = one_sided);
        let up = square(0.5, 1.5);
        scene.mesh.add(&Part::new("lamp", &up, &[[0, 1, 2], [0, 2, 3]]).with_material(material)).unwrap();
        let sum: f32 = draw(&scene).layers[0].planes.iter().flatten().sum();
        assert_eq!(sum == 0.0, one_sided, "{sum}");
    }
}

/// A sphere with `rows` rows of quadrangles, its corners on a radius that gives it the projected area of a sphere of radius `r`.
fn sphere(centre: DVec3, r: f64, rows: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let columns = 2 * rows;
    // The mean projected area of a convex body is a quarter of its surface.
    let build = |r: f64| -> Vec<DVec3> {
        let at = |i: u32, j: u32| {
            let (polar, around) =
                (PI * f64::from(i) / f64::from(rows), 2.0 * PI * f64::from(j % columns) / f64::from(columns));
            centre + r * dvec3(polar.sin() * around.sin(), polar.cos(), polar.sin() * around.cos())
        };
        (0..=rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect()
    };
    let faces: Vec<[u32; 3]> = (0..rows)
        .flat_map(|i| (0..columns).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let v = |i: u32, j: u32| i * columns + j % columns;
            [[v(i, j), v(i + 1, j), v(i + 1, j + 1)], [v(i, j), v(i + 1, j + 1), v(i, j + 1)]]
        })
        .collect();
    let area = |p: &[DVec3]| -> f64 {
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| p[v as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        faces.iter().map(of).sum()
    };
    let scale = (4.0 * PI * r * r / area(&build(r))).sqrt();
    (build(r * scale), faces)
}

#[test]
fn a_tessellated_sphere_lights_as_a_sphere_does() {
    let (centre, r) = (dvec3(0.0, 1.5, 0.0), 0.4);
    let mut scene = scene();
    // Without the caster.
    scene.mesh = Default::default();
    scene.mesh.add(&Part::new("floor", &square(4.0, 0.0), &[[0, 1, 2], [0, 2, 3]])).unwrap();
    let material = lamp_material(&mut scene, |_| ());
    let (corners, faces) = sphere(centre, r, 20);
    scene.mesh.add(&Part::new("bulb", &corners, &faces).with_material(material)).unwrap();
    let frame = draw(&scene);
    for (i, color) in frame.color.iter().enumerate() {
        let place = |k: usize| (k as f64 + 0.5) / 24.0 * 3.0 - 1.5;
        let point = dvec3(place(i % 24), 0.0, place(i / 24));
        let towards = centre - point;
        // E = π L (r / d)² cos θ for a sphere above the horizon; a white floor sends on E / π.
        let expected =
            f64::from(RADIANCE.x) * r * r / towards.length_squared() * towards.y / towards.length();
        let relative = (f64::from(color[0]) / expected - 1.0).abs();
        // What a pixel's middle has in place of its mean, and the facets.
        assert!(relative < 2e-3, "{point}: {} is not {expected}", color[0]);
    }
}

#[test]
fn a_concave_lamp_shadows_itself_and_not_its_own_plane() {
    // Two quads that face down side by side in one plane, and a board from between them down to the floor.
    let mut lit = scene();
    let mut own = scene();
    let material = lamp_material(&mut own, |_| ());
    let board = [dvec3(0.0, 0.0, -2.0), dvec3(0.0, 0.0, 2.0), dvec3(0.0, 1.5, 2.0), dvec3(0.0, 1.5, -2.0)];
    let faces = [[0, 1, 2], [0, 2, 3]];
    for scene in [&mut lit, &mut own] {
        scene.mesh.add(&Part::new("board", &board, &faces)).unwrap();
    }
    for shift in [-0.6, 0.6] {
        let quad = panel().map(|p| p + DVec3::X * shift);
        lit.lights.push(polygon_light(&quad, false));
        let part = Part::new("lamp", &quad, &faces).with_material(material).with_two_sided(false);
        own.mesh.add(&part).unwrap();
    }
    let difference = largest_difference(&draw(&lit), &draw(&own));
    assert!(difference < 2e-6, "{difference:e}");
}

#[test]
fn what_lights_directly_is_a_lamp_of_radiosity_and_no_glow_of_probes() {
    let mut own = scene();
    let material = lamp_material(&mut own, |_| ());
    own.mesh.add(&Part::new("lamp", &panel(), &[[0, 1, 2], [0, 2, 3]]).with_material(material)).unwrap();
    let surfaces = scene_surfaces(&own).unwrap().surfaces;
    assert!(surfaces.iter().all(|s| s.emission == [0.0; 3]));
    assert_eq!(with_lamps(&Lamps::new(&own), |lamps| lamps.len()), 2);
    // From between lamp and floor, towards the lamp.
    let look = |scene: &Scene, lights: bool| {
        let options = CaptureOptions { emission: true, lights, ..CaptureOptions::DEFAULT };
        let prepared = Prepared::new(scene, &()).unwrap();
        let seen = prepared.capture(DVec3::Y, options, Ambient::Color(Vec3::ZERO), &()).unwrap();
        seen.radiance[0].iter().fold(0.0, |most: f32, &v| most.max(v))
    };
    assert_eq!(look(&own, false), 0.0);
    assert!((0.1..0.9 * RADIANCE.x).contains(&look(&own, true)));
    own.materials[material as usize].details.emits = false;
    assert!((look(&own, true) - RADIANCE.x).abs() < 1e-5);
}

#[test]
fn the_order_of_triangles_does_not_matter() {
    let (corners, mut faces) = sphere(dvec3(0.0, 1.5, 0.0), 0.4, 5);
    let mut picture = |reversed: bool| {
        if reversed {
            faces.reverse();
        }
        let mut scene = scene();
        let material = lamp_material(&mut scene, |_| ());
        scene.mesh.add(&Part::new("bulb", &corners, &faces).with_material(material)).unwrap();
        draw(&scene)
    };
    assert_eq!(picture(false), picture(true));
}

#[test]
fn a_map_counts_by_its_mean_over_a_polygon() {
    let mut lit = scene();
    lit.lights.push(polygon_light(&panel(), false));
    let mut own = scene();
    let texture = own.add_texture(Texture::from_srgb("map", [4, 4], |x, _| [if x < 2 { 255 } else { 0 }; 3]));
    let material = lamp_material(&mut own, |details| {
        details.emission_map = Some(Map::new(texture));
    });
    let uvs = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(u, v)| glam::dvec2(u, v));
    let quad = panel();
    let part = Part::new("lamp", &quad, &[[0, 1, 2], [0, 2, 3]]).with_uvs(&uvs).with_material(material);
    own.mesh.add(&part.with_two_sided(false)).unwrap();
    let (expected, got) = (draw(&lit), draw(&own));
    for (e, g) in expected.color.iter().zip(&got.color) {
        assert!((0.5 * e[0] - g[0]).abs() < 2e-6, "{e:?} {g:?}");
    }
}

#[test]
fn a_lamp_without_light_is_refused_by_its_name() {
    for (emission, expected) in [
        (Vec3::ZERO, SceneError::NoEmission { material: "lamp".to_owned() }),
        (Vec3::new(1.0, -1.0, 0.0), SceneError::NegativeEmission { material: "lamp".to_owned() }),
    ] {
        let mut scene = scene();
        let material = lamp_material(&mut scene, |_| ()) as usize;
        scene.materials[material].surface.emission = emission;
        let error = render(&scene, &DrawOptions::DEFAULT, &()).unwrap_err();
        assert!(matches!(&error, RenderError::Scene(e) if *e == expected), "{error}");
    }
}
