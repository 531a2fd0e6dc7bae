//! Light probes against closed forms.

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::sh::Irradiance;
use pointillist_render::shade;
use pointillist_render::{BakeOptions, Camera, Material, Part, Prepared, Scene, Solids, bake_probes};
use std::f32::consts::PI;

/// The corners of a box and its triangles, seen from outside, or from inside.
fn cuboid(low: DVec3, high: DVec3, from_inside: bool) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corner = |i: u32| {
        let pick = |axis: usize| if i >> axis & 1 == 1 { high[axis] } else { low[axis] };
        dvec3(pick(0), pick(1), pick(2))
    };
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let turned = |[a, b, c]: [u32; 3]| if from_inside { [a, c, b] } else { [a, b, c] };
    let triangles = faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).map(turned);
    ((0..8).map(corner).collect(), triangles.collect())
}

/// Walls that glow with radiance 1 and reflect half of what arrives.
fn glowing_room() -> Scene {
    let mut scene = Scene::new(Camera::perspective(DVec3::ONE, DVec3::ZERO, 1.0), [8, 8]);
    let mut surface = shade::Material::lambert(Vec3::splat(0.5));
    surface.emission = Vec3::ONE;
    scene.add_material(Material::new("wall", surface));
    let (positions, triangles) = cuboid(DVec3::splat(-2.0), DVec3::splat(2.0), true);
    scene.mesh.add(&Part::new("room", &positions, &triangles)).unwrap();
    scene
}

fn options(bounces: u32) -> BakeOptions {
    let mut options = BakeOptions::DEFAULT;
    (options.resolution, options.bounces, options.until, options.emission) = (16, bounces, 0.0, true);
    options
}

#[test]
fn light_in_a_closed_room_is_a_geometric_series() {
    let scene = glowing_room();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let places = [DVec3::ZERO, dvec3(1.0, 0.5, -1.2), dvec3(-1.0, 1.0, 1.0), dvec3(0.3, -1.3, 0.9)];
    for bounces in [0, 1, 2, 5] {
        let bake = bake_probes(&prepared, &Solids::new(&prepared), &places, &options(bounces), &()).unwrap();
        assert_eq!((bake.probes.len(), bake.changes.len()), (4, bounces as usize));
        let radiance: f32 = (0..=bounces).map(|k| 0.5_f32.powi(k as i32)).sum();
        for probe in &bake.probes {
            let light = Irradiance::new(&probe.seen.radiance);
            for normal in [Vec3::X, Vec3::NEG_Y, Vec3::Z] {
                let error = light.at(normal) / (PI * radiance) - Vec3::ONE;
                assert!(error.abs().max_element() < 2e-3, "{bounces} bounces: {error}");
            }
            assert!(!probe.buried && probe.seen.back_share == 0.0);
        }
        // Each bounce adds half of what the last one added.
        for (k, change) in (1..).zip(&bake.changes) {
            let wanted = f64::from(0.5_f32.powi(k) / (2.0 - 0.5_f32.powi(k)));
            assert!((change - wanted).abs() < 1e-3, "bounce {k}: {change}, not {wanted}");
        }
    }
}

#[test]
fn what_glows_bounces_even_if_probes_are_not_to_hold_it() {
    let scene = glowing_room();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let mut options = options(1);
    options.emission = false;
    let places = [DVec3::ZERO, DVec3::X];
    let bake = bake_probes(&prepared, &Solids::new(&prepared), &places, &options, &()).unwrap();
    let light = Irradiance::new(&bake.probes[0].seen.radiance).at(Vec3::Y);
    assert!((light / PI - Vec3::splat(0.5)).abs().max_element() < 2e-3, "{light}");
}

#[test]
fn matter_is_told_from_rooms_and_has_a_way_out() {
    let mut scene = glowing_room();
    let (positions, triangles) = cuboid(DVec3::splat(-0.5), DVec3::splat(0.5), false);
    scene.mesh.add(&Part::new("block", &positions, &triangles)).unwrap();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let solids = Solids::new(&prepared);
    // The camera is in the room, so the room is none.
    assert!(solids.is_free(DVec3::ONE) && !solids.is_free(DVec3::ZERO) && !solids.is_free(DVec3::splat(0.4)));
    let out = solids.nearest_free(dvec3(0.4, 0.0, 0.0)).unwrap();
    assert!(solids.is_free(out) && out.x > 0.5 && out.abs().max_element() < 2.0, "{out}");
    assert!(solids.nearest_free(DVec3::ZERO).is_some());
}

#[test]
fn which_probes_are_buried_is_asked_of_all_at_once() {
    use pointillist_render::buried;
    assert_eq!(buried(&[0.9, 0.1, 0.4]), [true, false, false]);
    // Most would be: then the surfaces are turned the wrong way.
    assert_eq!(buried(&[0.9, 0.8, 0.4]), [false; 3]);
    assert!(buried(&[]).is_empty());
}

/// A room with a block in its middle, and a lamp.
fn room_with_a_block() -> Scene {
    let mut scene = glowing_room();
    let (positions, triangles) = cuboid(DVec3::splat(-1.5), DVec3::splat(-0.5), false);
    scene.mesh.add(&Part::new("block", &positions, &triangles)).unwrap();
    scene
}

#[test]
fn probes_that_are_all_buried_end_the_bounces_instead_of_the_bake() {
    let scene = room_with_a_block();
    let prepared = Prepared::new(&scene, &()).unwrap();
    // The box of these two, in which places for the fit are sought, reaches out of the block; both see nothing but its inside.
    let places = [DVec3::splat(-1.4), DVec3::splat(-0.501)];
    let options = options(2).with_fit(60);
    let bake = bake_probes(&prepared, &Solids::new(&prepared), &places, &options, &()).unwrap();
    assert_eq!(bake.probes.len(), 2);
    let few = bake_probes(&prepared, &Solids::new(&prepared), &places[..1], &options, &()).unwrap();
    assert_eq!(few.probes.len(), 1);
}

#[test]
fn progress_of_a_bake_ends_at_its_total_however_early_light_settles() {
    use pointillist_render::Watch;
    use std::sync::atomic::{AtomicU64, Ordering};
    let scene = room_with_a_block();
    let prepared = Prepared::new(&scene, &()).unwrap();
    for (until, emission) in [(0.0, true), (0.9, true), (0.9, false)] {
        let (most, last) = (AtomicU64::new(0), AtomicU64::new(0));
        let report = |done, total| {
            most.store(total, Ordering::Relaxed);
            last.fetch_max(done, Ordering::Relaxed);
        };
        let watch = Watch::new().with_progress(&report);
        let options = options(4).with_until(until).with_emission(emission).with_resolution(40);
        bake_probes(&prepared, &Solids::new(&prepared), &[DVec3::ONE, DVec3::X], &options, &watch).unwrap();
        assert_eq!(last.into_inner(), most.into_inner(), "until {until}, emission {emission}");
    }
}

#[test]
fn an_empty_scene_is_looked_at() {
    let mut scene = Scene::new(Camera::perspective(DVec3::Z, DVec3::ZERO, 1.0), [8, 8]);
    scene.image.background = Vec3::splat(0.25);
    let prepared = Prepared::new(&scene, &()).unwrap();
    let bake =
        bake_probes(&prepared, &Solids::new(&prepared), &[DVec3::ZERO, DVec3::X], &options(0), &()).unwrap();
    for probe in &bake.probes {
        let light = Irradiance::new(&probe.seen.radiance).at(Vec3::Y);
        assert!((light / PI - Vec3::splat(0.25)).abs().max_element() < 2e-3, "{light}");
    }
}

#[test]
fn places_are_chosen_outside_of_walls() {
    use pointillist_render::{ChooseOptions, choose_places};
    let scene = room_with_a_block();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let candidates: Vec<DVec3> = (0..64)
        .map(|i| dvec3(f64::from(i % 4), f64::from(i / 4 % 4), f64::from(i / 16)) - DVec3::splat(1.3))
        .collect();
    let options = ChooseOptions::DEFAULT.with_resolution(8).with_max_count(12);
    let chosen = choose_places(&prepared, &candidates, &options, &()).unwrap();
    assert_eq!((chosen.positions.len(), chosen.buried), (12, 1));
    // Candidates, and places about the block that were tried, too.
    let most = candidates.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    assert!(
        chosen
            .positions
            .iter()
            .all(|p| Solids::new(&prepared).is_free(*p) && p.abs().max_element() <= 2.0 * most)
    );
    assert!(
        chosen.positions.iter().any(|p| candidates.contains(p)) && chosen.candidates >= candidates.len() - 1
    );
    assert!(chosen.error > 0.0 && chosen.error < 0.5, "{}", chosen.error);
    assert!(choose_places(&prepared, &[], &options, &()).is_err());
}

#[test]
fn cancelled_looks_end_before_the_first_position() {
    use pointillist_render::{LookOptions, RenderError, Watch, fingerprints, look_all};
    use std::sync::atomic::AtomicBool;
    let scene = glowing_room();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let (stop, places) = (AtomicBool::new(true), [DVec3::ZERO]);
    let watch = Watch::new().with_cancel(&stop);
    let ambient = prepared.ambient();
    let look = look_all(&prepared, &places, LookOptions::DEFAULT, ambient, &watch);
    assert!(matches!(look, Err(RenderError::Cancelled)));
    let marks = fingerprints(&prepared, &places, true, ambient, &watch);
    assert!(matches!(marks, Err(RenderError::Cancelled)));
    assert!(matches!(Prepared::new(&scene, &watch), Err(RenderError::Cancelled)));
}

#[test]
fn captures_refuse_what_cannot_be_seen_from_even_where_nothing_is() {
    use pointillist_render::CaptureOptions;
    let scene = Scene::new(Camera::perspective(DVec3::Z, DVec3::ZERO, 1.0), [8, 8]);
    let prepared = Prepared::new(&scene, &()).unwrap();
    let capture = |position, resolution| {
        let options = CaptureOptions { resolution, ..CaptureOptions::DEFAULT };
        prepared.capture(position, options, prepared.ambient(), &())
    };
    assert!(capture(DVec3::ZERO, 4).is_ok());
    assert!(capture(DVec3::NAN, 4).is_err() && capture(DVec3::INFINITY, 4).is_err());
    assert!(capture(DVec3::ZERO, 0).is_err() && capture(DVec3::ZERO, u32::MAX).is_err());
}
