//! Light probes against closed forms.

use glam::{DVec3, Vec3, dvec3};
use pointillist_render::sh::Irradiance;
use pointillist_render::shade;
use pointillist_render::{
    Ambient, BakeOptions, Camera, CaptureOptions, DepthRange, IndirectOptions, Lamps, LightSource, Material,
    Part, Prepared, Scene, Solids, bake_probes, bake_probes_in, radiosity, scene_surfaces, solve_indirect,
    with_lamps,
};
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

/// A block of side 1 in the middle of the room.
fn room_with_block() -> Scene {
    let mut scene = glowing_room();
    let (positions, triangles) = cuboid(DVec3::splat(-0.5), DVec3::splat(0.5), false);
    scene.mesh.add(&Part::new("block", &positions, &triangles)).unwrap();
    scene
}

#[test]
fn matter_is_told_from_rooms_and_has_a_way_out() {
    let scene = room_with_block();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let solids = Solids::new(&prepared);
    // The camera is in the room, so the room is none.
    assert!(solids.is_free(DVec3::ONE) && !solids.is_free(DVec3::ZERO) && !solids.is_free(DVec3::splat(0.4)));
    let out = solids.nearest_free(dvec3(0.4, 0.0, 0.0)).unwrap();
    assert!(solids.is_free(out) && out.x > 0.5 && out.abs().max_element() < 2.0, "{out}");
    assert!(solids.nearest_free(DVec3::ZERO).is_some());
}

/// Probes that were just inside of a solid were moved into its surface, which then showed what lights that one place as a dark square.
#[test]
fn what_is_moved_out_of_matter_keeps_off_its_surface() {
    let scene = room_with_block();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let bounds = prepared.geometry().bounds();
    let margin = Solids::MARGIN * (bounds.high - bounds.low).length();
    let solids = Solids::new(&prepared);
    for depth in [1e-6, 1e-3, 0.01, 0.1, 0.4] {
        for at in
            [dvec3(0.5 - depth, 0.1, -0.2), dvec3(0.5 - depth, 0.5 - depth, 0.0), DVec3::splat(0.5 - depth)]
        {
            let out = solids.nearest_free(at).unwrap();
            let off = (out.abs() - 0.5).max_element();
            // Within a step of the least there must be.
            assert!(off > 0.9 * margin && (out - at).length() < 3.0 * (depth + margin), "{at} to {out}");
        }
    }
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
    let marks = fingerprints(&prepared, &places, LookOptions::DEFAULT.capture, ambient, &watch);
    assert!(matches!(marks, Err(RenderError::Cancelled)));
    assert!(matches!(Prepared::new(&scene, &watch), Err(RenderError::Cancelled)));
}

#[test]
fn captures_refuse_what_cannot_be_seen_from_even_where_nothing_is() {
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

/// A grey room of 4 × 3 × 4 with a lamp, of which one wall is red.
fn lamp_room(light: shade::Light) -> Scene {
    let mut scene = Scene::new(Camera::perspective(DVec3::ONE, DVec3::ZERO, 1.0), [8, 8]);
    let grey = scene.add_material(Material::new("grey", shade::Material::lambert(Vec3::splat(0.7))));
    let red = scene.add_material(Material::new("red", shade::Material::lambert(Vec3::new(0.8, 0.2, 0.1))));
    let (positions, triangles) = cuboid(dvec3(-2.0, -1.5, -2.0), dvec3(2.0, 1.5, 2.0), true);
    scene.mesh.add(&Part::new("wall", &positions, &triangles[..2]).with_material(red)).unwrap();
    scene.mesh.add(&Part::new("room", &positions, &triangles[2..]).with_material(grey)).unwrap();
    let (positions, triangles) = cuboid(dvec3(-1.0, -1.5, -1.0), dvec3(-0.4, 0.1, 0.2), false);
    scene.mesh.add(&Part::new("block", &positions, &triangles).with_material(grey)).unwrap();
    scene.lights.push(LightSource::new("lamp", light));
    scene
}

fn bulb() -> shade::Light {
    let (position, intensity) = (dvec3(0.8, 0.9, -0.3), Vec3::splat(10.0));
    shade::Light::Point { position, intensity, falloff: shade::Falloff::InverseSquare }
}

/// Irradiance for some normals.
fn irradiance(radiance: &pointillist_render::sh::Sh) -> Vec<Vec3> {
    let normals = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    normals.iter().map(|&n| Irradiance::new(radiance).at(n)).collect()
}

/// Root mean square of differences over that of what is wanted.
fn off(found: &[Vec3], wanted: &[Vec3]) -> f32 {
    let squares: f32 = found.iter().zip(wanted).map(|(a, b)| (*a - *b).length_squared()).sum();
    (squares / wanted.iter().map(|b| b.length_squared()).sum::<f32>()).sqrt()
}

#[test]
fn probes_in_the_light_of_a_radiosity_solution_hold_all_bounces() {
    let scene = lamp_room(bulb());
    let surfaces = scene_surfaces(&scene).unwrap();
    let settings = radiosity::SceneOptions::DEFAULT.with_patch(0.2).with_tolerance(Some(0.003));
    let mut patches = radiosity::Scene::new(&surfaces.surfaces, &settings).unwrap();
    let direct = with_lamps(&Lamps::new(&scene), |lamps| patches.direct(lamps)).unwrap();
    let transport = patches.transport(&direct).unwrap();
    let solution = transport.gauss_seidel(&radiosity::SolveOptions::DEFAULT).unwrap();
    let places = [dvec3(1.2, 0.3, 1.1), dvec3(-1.5, -0.9, 0.9), dvec3(0.1, 0.2, -1.6)];
    let prepared = Prepared::new(&scene, &()).unwrap();
    let light = solve_indirect(&scene, &IndirectOptions::DEFAULT, &()).unwrap();
    let solids = Solids::new(&prepared);
    let options = options(0).with_resolution(32);
    let ambient = Ambient::Radiosity(&light);
    let known = bake_probes_in(&prepared, &solids, &places, ambient, &options, &()).unwrap();
    let bounced = bake_probes(&prepared, &solids, &places, &options.with_bounces(8), &()).unwrap();
    let (mut found, mut by_probes, mut wanted) = (vec![], vec![], vec![]);
    for (i, place) in places.iter().enumerate() {
        for n in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
            let e = solution.irradiance(*place, n, true).unwrap();
            wanted.push(Vec3::from_array(e.map(|v| v as f32)));
        }
        found.extend(irradiance(&known.probes[i].seen.radiance));
        by_probes.extend(irradiance(&bounced.probes[i].seen.radiance));
    }
    let (error, error_by_probes) = (off(&found, &wanted), off(&by_probes, &wanted));
    assert!(error < 0.02, "{error}");
    assert!(error_by_probes > 2.0 * error, "bounces by three probes are off by {error_by_probes}");
}

/// Buildings were linked pair by pair, which took for ever, and nothing was said meanwhile.
#[test]
fn light_solved_by_rays_is_that_by_pairs_and_tells_how_far_it_is() {
    #[derive(Default)]
    struct Told([std::sync::atomic::AtomicU64; 2]);
    impl pointillist_render::Monitor for Told {
        fn begin(&self, units: u64) {
            self.0[0].fetch_add(units, std::sync::atomic::Ordering::Relaxed);
        }
        fn advance(&self, units: u64) {
            self.0[1].fetch_add(units, std::sync::atomic::Ordering::Relaxed);
        }
    }
    let scene = lamp_room(bulb());
    let triangles = scene.mesh.triangles.clone();
    let lights = [IndirectOptions::DEFAULT, IndirectOptions::DEFAULT.with_most_paired(0)].map(|options| {
        let told = Told::default();
        let light = solve_indirect(&scene, &options, &told).unwrap();
        let [all, done] = told.0.map(std::sync::atomic::AtomicU64::into_inner);
        assert!(all > 0 && done <= all && done > all / 2, "{done} of {all}");
        light
    });
    let lit = |light: &pointillist_render::Lightmap| -> Vec<Vec3> {
        let middle = |t: &[u32; 3]| t.iter().map(|&v| scene.mesh.positions[v as usize]).sum::<DVec3>() / 3.0;
        triangles.iter().zip(0..).map(|(t, number)| light.irradiance(number, true, middle(t))).collect()
    };
    let [pairs, rays] = [&lights[0], &lights[1]].map(lit);
    assert!(pairs.iter().any(|e| e.x > 0.0));
    assert!(off(&rays, &pairs) < 0.05, "{}", off(&rays, &pairs));
}

#[test]
fn economy_asks_for_no_more_shadows_than_thorough_pictures_and_errs_little() {
    let area = shade::Light::Rect {
        corner: dvec3(0.4, 1.4, -0.6),
        edge_u: dvec3(0.8, 0.0, 0.0),
        edge_v: dvec3(0.0, 0.0, 0.8),
        radiance: Vec3::splat(10.0),
        samples: None,
        falloff: shade::Falloff::InverseSquare,
    };
    for light in [bulb(), area] {
        let scene = lamp_room(light);
        let prepared = Prepared::new(&scene, &()).unwrap();
        let look = |thorough: bool| {
            let counts = Counts::default();
            let options = options(0).with_resolution(48).with_thorough(thorough);
            let places = [dvec3(1.2, 0.3, 1.1)];
            let bake = bake_probes(&prepared, &Solids::new(&prepared), &places, &options, &counts).unwrap();
            (irradiance(&bake.probes[0].seen.radiance), counts.0.into_inner())
        };
        let ((quick, asked), (all, asked_by_all)) = (look(false), look(true));
        assert!(asked > 0 && asked <= asked_by_all, "{asked} {asked_by_all}");
        assert!(off(&quick, &all) < 2e-4, "{}", off(&quick, &all));
    }
}

/// Shadows that were asked for.
#[derive(Default)]
struct Counts(std::sync::atomic::AtomicU64);

impl pointillist_render::Monitor for Counts {
    fn count(&self, what: &'static str, n: u64) {
        if ["shadow_receivers", "area_light_points"].contains(&what) {
            self.0.fetch_add(n, std::sync::atomic::Ordering::Relaxed);
        }
    }
}

#[test]
fn a_range_of_distances_tells_the_sky_the_room_and_what_is_in_it_apart() {
    // A glowing cube of 4 around a dark one of 1 about the probe, under a sky of 3.
    let mut scene = glowing_room();
    scene.image.background = Vec3::splat(3.0);
    let dark = scene.add_material(Material::new("dark", shade::Material::lambert(Vec3::ZERO)));
    let (positions, triangles) = cuboid(DVec3::splat(-0.5), DVec3::splat(0.5), true);
    scene.mesh.add(&Part::new("shell", &positions, &triangles).with_material(dark)).unwrap();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let solids = Solids::new(&prepared);
    let mean = |near: f64, far: f64| {
        let options = options(0).with_depths(DepthRange { near, far }).with_keep_buried(true);
        let bake = bake_probes(&prepared, &solids, &[DVec3::ZERO], &options, &()).unwrap();
        let seen = &bake.probes[0].seen;
        (seen.radiance.mean().x, seen.sky.mean())
    };
    let close = |(a, b): (f64, f64), (c, d): (f64, f64)| (a - c).abs() < 1e-4 && (b - d).abs() < 1e-4;
    let all = mean(0.0, f64::INFINITY);
    assert!(close(all, (0.0, 0.0)), "the shell hides all: {all:?}");
    let room = mean(0.6, f64::INFINITY);
    assert!(close(room, (1.0, 0.0)), "without the shell the room glows: {room:?}");
    let sky = mean(2.1, f64::INFINITY);
    assert!(close(sky, (3.0, 1.0)), "without the room there is the sky: {sky:?}");
    assert!(close(mean(0.0, 0.4), (3.0, 1.0)), "nothing is as near as that");
    assert!(close(mean(0.0, 1.0), (0.0, 0.0)) && close(mean(0.6, 2.1), (1.0, 0.0)));
    for (near, far) in [(1.0, 1.0), (2.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (0.0, f64::NAN)] {
        let options = options(0).with_depths(DepthRange { near, far });
        assert!(bake_probes(&prepared, &solids, &[DVec3::ZERO], &options, &()).is_err(), "{near} {far}");
    }
}

#[test]
fn a_wall_that_the_range_cuts_is_seen_as_far_as_it_is_within() {
    // A glowing plane at z = −1 that reaches far: of the face towards it all is nearer than 2; of each neighbouring face, depths from 2 on are
    // left: a half space from slope 1/2 on.
    let mut scene = Scene::new(Camera::perspective(DVec3::Z, DVec3::ZERO, 1.0), [8, 8]);
    let mut surface = shade::Material::lambert(Vec3::ZERO);
    surface.emission = Vec3::ONE;
    scene.add_material(Material::new("wall", surface));
    let corners = [(-1e4, -1e4), (1e4, -1e4), (1e4, 1e4), (-1e4, 1e4)].map(|(x, y)| dvec3(x, y, -1.0));
    scene.mesh.add(&Part::new("wall", &corners, &[[0, 1, 2], [0, 2, 3]])).unwrap();
    let prepared = Prepared::new(&scene, &()).unwrap();
    let open = |near: f64, far: f64| {
        let options =
            CaptureOptions { resolution: 64, depths: DepthRange { near, far }, ..CaptureOptions::DEFAULT };
        let capture = prepared.capture(DVec3::ZERO, options, prepared.ambient(), &()).unwrap();
        let face = |f: usize| capture.sky[f * 64 * 64..][..64 * 64].iter().sum::<f32>() / (64.0 * 64.0);
        (face(5), face(0))
    };
    let (towards, beside) = open(0.0, f64::INFINITY);
    assert!(towards < 1e-5 && (beside - 0.5).abs() < 1e-4, "{towards} {beside}");
    let (towards, beside) = open(2.0, f64::INFINITY);
    assert!((towards - 1.0).abs() < 1e-5 && (beside - 0.75).abs() < 1e-4, "{towards} {beside}");
    let (towards, beside) = open(0.0, 2.0);
    assert!(towards < 1e-5 && (beside - 0.75).abs() < 1e-4, "{towards} {beside}");
}
