//! Light of probes on smooth surfaces.

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::sh::Sh;
use pointillist_render::shade::{self, Interpolation};
use pointillist_render::shprobe::Field;
use pointillist_render::{
    AmbientLight, BakedLight, BakedSide, Camera, DrawOptions, Lightmap, Material, Part, Projection, Scene,
    Unbaked, render,
};
use std::f32::consts::PI;
use std::f64::consts::TAU;

const SIZE: u32 = 48;

/// A white shape around the origin, amid probes of which each sees another light, so that it shows which of them count.
fn amid_probes(corners: &[DVec3], normals: &[Vec3], faces: &[[u32; 3]], shading: Interpolation) -> Scene {
    let mut camera = Camera::perspective(dvec3(0.0, 0.0, 8.0), DVec3::ZERO, 1.0);
    camera.projection = Projection::Orthographic { height: 1.8 };
    let mut scene = Scene::new(camera, [SIZE; 2]);
    scene.render.shading = shading;
    let white = scene.add_material(Material::new("white", shade::Material::lambert(Vec3::ONE)));
    scene.mesh.add(&Part::new("shape", corners, faces).with_normals(normals).with_material(white)).unwrap();
    let places =
        (0..8).map(|i| f64::from(i) + 0.3).map(|t| dvec3(3.0 * t.sin(), 0.3 * t.cos(), 3.0 * t.cos()));
    let light = (0..8).map(|i| Sh::constant(DVec3::splat(f64::from(1 + 3 * i % 7)), 2).unwrap());
    let field = Field::new(&places.collect::<Vec<_>>(), &light.collect::<Vec<_>>()).unwrap();
    scene.ambient = AmbientLight::Probes { field: Box::new(field), unbaked: Unbaked::NONE, fingerprint: 0 };
    scene
}

/// A column of a radius of 1 along Y with this many faces around, and normals that are those of a round one.
fn column(around: u32, shading: Interpolation) -> Scene {
    let ends = (0..around).flat_map(|i| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(around)).sin_cos();
        [-1.0, 1.0].map(|y| (dvec3(sin, y, cos), dvec3(sin, 0.0, cos).as_vec3()))
    });
    let (corners, normals): (Vec<DVec3>, Vec<Vec3>) = ends.unzip();
    let faces = (0..around).flat_map(|i| {
        let (a, b) = (2 * i, 2 * ((i + 1) % around));
        [[a, b, b + 1], [a, b + 1, a + 1]]
    });
    amid_probes(&corners, &normals, &faces.collect::<Vec<_>>(), shading)
}

/// Root of the mean squared difference of pixels, over the mean.
fn difference(a: &Scene, b: &Scene) -> f64 {
    let draw = |scene: &Scene| render(scene, &DrawOptions::DEFAULT, &()).unwrap().color;
    let (a, b) = (draw(a), draw(b));
    let squares: f64 = a.iter().zip(&b).map(|(a, b)| f64::from(a[0] - b[0]).powi(2)).sum();
    let sum: f64 = b.iter().map(|b| f64::from(b[0])).sum();
    (squares / a.len() as f64).sqrt() / (sum / b.len() as f64)
}

/// By the normals of faces probes came into sight at edges.
#[test]
fn faces_of_a_smooth_surface_do_not_show_in_the_light_of_probes() {
    let [phong, flat] = [Interpolation::Phong, Interpolation::Flat];
    let fine = column(768, phong);
    let smooth = difference(&column(24, phong), &fine);
    let faceted = difference(&column(24, flat), &fine);
    assert!(smooth < 0.2 * faceted, "{smooth} beside {faceted}");
}

/// Probes saw through what came later: it does not hide them from itself.
#[test]
fn unbaked_objects_are_lit_from_all_sides() {
    let as_newcomer = |shading| {
        let mut scene = column(24, shading);
        let AmbientLight::Probes { unbaked, .. } = &mut scene.ambient else { unreachable!() };
        *unbaked = Unbaked::all_but(&[], 48);
        scene
    };
    let difference = difference(&as_newcomer(Interpolation::Phong), &as_newcomer(Interpolation::Flat));
    assert!(difference < 1e-6, "{difference}");
}

/// A square that light was baked on, and one beside it that came later.
#[test]
fn what_no_light_was_baked_on_is_lit_between_probes() {
    let mut camera = Camera::perspective(dvec3(0.0, 0.0, 8.0), DVec3::ZERO, 1.0);
    camera.projection = Projection::Orthographic { height: 2.0 };
    let mut scene = Scene::new(camera, [2, 1]);
    let white = scene.add_material(Material::new("white", shade::Material::lambert(Vec3::ONE)));
    let corners =
        |x: f64| [[0.0, -1.0], [2.0, -1.0], [2.0, 1.0], [0.0, 1.0]].map(|[u, v]| dvec3(x + u, v, 0.0));
    for x in [-2.0, 0.0] {
        let corners = corners(x);
        let part = Part::new("square", &corners, &[[0, 1, 2], [0, 2, 3]]).with_material(white);
        scene.mesh.add(&part).unwrap();
    }
    let light = BakedLight {
        positions: &corners(-2.0).map(|p| p.to_array()),
        normals: &[[0.0, 0.0, 1.0]; 4],
        irradiance: &[[PI; 3]; 4],
        triangles: &[[0, 1, 2], [0, 2, 3]],
    };
    let side = BakedSide { faces: &[0, 1], back: false, count: 2 };
    let light = Box::new(Lightmap::new(&light, &[side], 4).unwrap());
    let field = Box::new(Field::new(&[DVec3::Z], &[Sh::constant(DVec3::splat(3.0), 2).unwrap()]).unwrap());
    scene.ambient = AmbientLight::RadiosityAndProbes { light, field, unbaked: Unbaked::NONE, fingerprint: 0 };
    let color = render(&scene, &DrawOptions::DEFAULT, &()).unwrap().color;
    assert!((color[0][0] - 1.0).abs() < 1e-6 && (color[1][0] - 3.0).abs() < 1e-5, "{color:?}");
    // Mirrors show what probes see, wherever they are.
    scene.materials[0].surface = shade::Material::ggx(Vec3::ZERO, Vec3::ONE, 0.0);
    let color = render(&scene, &DrawOptions::DEFAULT, &()).unwrap().color;
    assert!(color.iter().all(|pixel| (pixel[0] - 3.0).abs() < 1e-2), "{color:?}");
}

/// Averaged over the edges of what stands for no smooth surface, normals say nothing about what is in front of a face.
#[test]
fn a_column_of_four_faces_is_lit_by_what_is_in_front_of_them() {
    let difference = difference(&column(4, Interpolation::Phong), &column(4, Interpolation::Flat));
    assert!(difference < 1e-6, "{difference}");
}
