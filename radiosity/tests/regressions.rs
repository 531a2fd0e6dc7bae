//! Bugs that were fixed, each with the smallest input that showed it.

mod common;

use common::{cornell, quad, room};
use glam::{DQuat, DVec3, dvec3};
use pointillist_radiosity::{
    FactorOptions, RadiosityError, Scene, SceneOptions, SolveOptions, Surface, form_factor,
};

/// Height and Jacobian alone need a point each: with the kernel's own order, far triangles were off by a thousandth.
#[test]
fn far_triangles_get_enough_points() {
    let triangle = |z: f64, flip: bool| {
        let polygon = pointillist_radiosity::Polygon::new(&[
            dvec3(0.0, 0.0, z),
            dvec3(1.0, 0.0, z),
            dvec3(0.0, 1.0, z),
        ])
        .expect("a triangle");
        if flip { polygon.flipped() } else { polygon }
    };
    let coarse = FactorOptions::DEFAULT.with_unoccluded(1e-4);
    let (a, b) = (triangle(0.0, false), triangle(300.0, true));
    let found = form_factor(&a, &b, &[], &coarse).value;
    // Area over π d², and the second order is (1/300)².
    assert!((found * std::f64::consts::PI * 9e4 / 0.5 - 1.0).abs() < 1e-4, "{found}");
}

/// What a patch sends ahead was added to its radiosity, which then was half as high again.
#[test]
fn overshooting_does_not_brighten() {
    let options = SceneOptions::DEFAULT.with_patch(0.6);
    let scene = Scene::new(&room(DVec3::ONE, DQuat::IDENTITY, 0.5, 1.0), &options).expect("a room");
    let (transport, direct) = scene.transport(&[]).expect("a room");
    let solved = transport.progressive(&direct, &[], &SolveOptions::DEFAULT).expect("solved");
    assert!((solved.radiosity[0][0] - 2.0).abs() <= solved.bound, "{solved:?}");
}

/// With importance, overshooting sent the same debt back and forth for ever.
#[test]
fn shooting_by_importance_ends() {
    let (transport, direct) = Scene::new(&cornell(), &SceneOptions::DEFAULT.with_patch(0.6))
        .expect("a room")
        .transport(&[])
        .expect("a room");
    let mut importance = vec![0.0; transport.patch_count()];
    importance[0] = 1.0;
    let solved = transport.progressive(&direct, &importance, &SolveOptions::DEFAULT).expect("solved");
    assert!(solved.converged);
}

/// Rows of a hierarchy were scaled down to 1 where they were above it, which took 2 % of all light away.
#[test]
fn a_hierarchy_keeps_its_light() {
    let surfaces = room(DVec3::ONE, DQuat::IDENTITY, 0.9, 1.0);
    let options = SceneOptions::DEFAULT.with_patch(0.1).with_tolerance(Some(0.05));
    let (transport, direct) =
        Scene::new(&surfaces, &options).expect("a room").transport(&[]).expect("a room");
    let solved = transport.gauss_seidel(&direct, &SolveOptions::DEFAULT).expect("solved");
    let patches = transport.patches().zip(&solved.radiosity);
    let (power, area) =
        patches.fold((0.0, 0.0), |(p, a), (patch, b)| (p + patch.area * b[0], a + patch.area));
    assert!((power / area - 10.0).abs() < 0.1, "{}", power / area);
}

#[test]
fn impossible_scenes_are_refused_by_name() {
    let options = SceneOptions::DEFAULT;
    let square = |reflectance: f64| {
        let q = quad(DVec3::ZERO, DVec3::X, DVec3::Y);
        Surface::new(q.vertices(), [0.5, reflectance, 0.5])
    };
    let error = |surfaces: &[Surface]| Scene::new(surfaces, &options).map(|_| ()).expect_err("a fault");
    assert_eq!(
        error(&[square(0.5), square(1.5)]),
        RadiosityError::ReflectanceAboveOne { surface: 1, value: 1.5 }
    );
    assert!(matches!(error(&[square(f64::NAN)]), RadiosityError::Reflectance { surface: 0, .. }));
    assert!(matches!(error(&[square(-0.1)]), RadiosityError::Reflectance { surface: 0, .. }));
    assert!(matches!(
        error(&[square(0.5).emitting([f64::NAN; 3])]),
        RadiosityError::Emission { surface: 0, .. }
    ));
    let line = Surface::new(&[DVec3::ZERO, DVec3::X, DVec3::X * 2.0], [0.5; 3]);
    assert_eq!(error(&[line.clone().emitting([1.0; 3])]), RadiosityError::EmitterWithoutArea { surface: 0 });
    assert_eq!(error(std::slice::from_ref(&line)), RadiosityError::NoSurface);
    let scene = Scene::new(&[line, square(0.5)], &options).expect("a square");
    assert_eq!(scene.dropped(), 1);
    // A mirror-white closed room keeps all light for ever; an open one lets it out.
    let closed = Scene::new(&room(DVec3::ONE, DQuat::IDENTITY, 1.0, 1.0), &options).expect("a room");
    let (transport, _) = closed.transport(&[]).expect("a room");
    let refused = transport.gauss_seidel(&[], &SolveOptions::DEFAULT);
    assert!(matches!(refused, Err(RadiosityError::NoEquilibrium { .. })), "{refused:?}");
    let open = room(DVec3::ONE, DQuat::IDENTITY, 1.0, 1.0);
    let (transport, _) = Scene::new(&open[..4], &options).expect("a room").transport(&[]).expect("a room");
    let solved = transport.gauss_seidel(&[], &SolveOptions::DEFAULT).expect("light gets out");
    assert!(solved.converged && solved.contraction < 1.0, "{solved:?}");
}
