//! Against closed forms.

mod common;

use common::{cornell, faces, quad, room};
use glam::{DQuat, DVec3, EulerRot, dvec3};
use pointillist_radiosity::{
    FactorOptions, Hemicube, HemicubeKind, Lamp, Polygon, Scene, SceneOptions, SolveOptions, Surface,
    form_factor,
};
use std::f64::consts::PI;

const EXACT: FactorOptions = FactorOptions::DEFAULT.with_unoccluded(1e-13);

#[test]
fn unit_squares_have_their_known_form_factors() {
    let floor = quad(DVec3::ZERO, DVec3::X, DVec3::Y);
    let ceiling = quad(DVec3::Z, DVec3::Y, DVec3::X);
    let wall = quad(DVec3::ZERO, DVec3::Y, DVec3::Z);
    for (other, known) in [(ceiling, 0.199_824_895_698_387), (wall, 0.200_043_776_075_403)] {
        let found = form_factor(&floor, &other, &[], &EXACT);
        assert!((found.value / known - 1.0).abs() < 5e-15, "{found:?} for {known}");
        assert!(found.error < 1e-13 && (found.value - known).abs() <= found.error + 1e-15, "{found:?}");
    }
}

/// Howell's catalogue, C-41: parallel coaxial discs. Polygons of n sides approach them as 1/n².
#[test]
fn polygons_of_many_sides_approach_discs() {
    let disc = |n: usize, radius: f64, z: f64| {
        let at = |i: usize| {
            let (sine, cosine) = (2.0 * PI * i as f64 / n as f64).sin_cos();
            dvec3(radius * cosine, radius * sine, z)
        };
        let polygon = Polygon::new(&(0..n).map(at).collect::<Vec<_>>()).expect("a disc");
        if z > 0.0 { polygon.flipped() } else { polygon }
    };
    for (r1, r2) in [(1.0_f64, 1.0_f64), (0.5, 2.0)] {
        let x = 1.0 + (1.0 + r2 * r2) / (r1 * r1);
        let exact = 0.5 * (x - (x * x - 4.0 * (r2 / r1) * (r2 / r1)).sqrt());
        let errors = [8, 16, 32, 64]
            .map(|n| form_factor(&disc(n, r1, 0.0), &disc(n, r2, 1.0), &[], &EXACT).value / exact - 1.0);
        for pair in errors.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((3.5..4.5).contains(&ratio), "errors fall as {errors:?}");
        }
    }
}

/// A small polygon behind a hole sees through it exactly what the hole shows.
#[test]
fn a_window_and_its_shutter_add_up() {
    let (floor, ceiling) = (quad(DVec3::ZERO, DVec3::X, DVec3::Y), quad(DVec3::Z, DVec3::Y, DVec3::X));
    let at = |x: f64, y: f64, w: f64, h: f64| quad(dvec3(x, y, 0.5), DVec3::X * w, DVec3::Y * h);
    let frame =
        [at(-2.0, -2.0, 5.0, 2.3), at(-2.0, 0.7, 5.0, 2.3), at(-2.0, 0.3, 2.3, 0.4), at(0.7, 0.3, 2.3, 0.4)];
    let shutter = [at(0.3, 0.3, 0.4, 0.4)];
    let open = form_factor(&floor, &ceiling, &[], &EXACT).value;
    let parts = [&frame[..], &shutter[..]].map(|list| form_factor(&floor, &ceiling, list, &EXACT));
    let sum = parts[0].value + parts[1].value;
    assert!((sum / open - 1.0).abs() < 1e-5, "{parts:?} of {open}");
    // By an integration of its own, to 1e-9: the shutter halves no cell evenly.
    assert!((parts[0].value - 0.069_909_073_5).abs() < 1e-6, "{parts:?}");
}

#[test]
fn a_wall_between_hides_all_and_one_beside_nothing() {
    let (floor, ceiling) = (quad(DVec3::ZERO, DVec3::X, DVec3::Y), quad(DVec3::Z, DVec3::Y, DVec3::X));
    let open = form_factor(&floor, &ceiling, &[], &EXACT);
    let between = quad(dvec3(-1.0, -1.0, 0.5), DVec3::X * 3.0, DVec3::Y * 3.0);
    assert_eq!(form_factor(&floor, &ceiling, &[between], &EXACT).value, 0.0);
    let beside = faces(dvec3(1.0, 0.0, 0.0), dvec3(2.0, 1.0, 1.0), DQuat::IDENTITY);
    let beside: Vec<Polygon> = beside.iter().map(|f| Polygon::new(f).expect("a face")).collect();
    assert_eq!(form_factor(&floor, &ceiling, &beside, &EXACT), open);
    assert_eq!(form_factor(&floor, &ceiling, &[floor.clone(), ceiling.clone()], &EXACT), open);
}

/// A ribbon close to the floor, edge by edge between the first samples: each of its places is off by no more than was asked for.
#[test]
fn narrow_occluders_do_not_slip_through_between_samples() {
    let floor = quad(DVec3::ZERO, DVec3::X, DVec3::Y);
    let lamp = quad(dvec3(0.0, 0.0, 8.0), DVec3::Y * 1.1, DVec3::X * 1.1);
    for place in [0.2, 0.3, 0.7, 0.8] {
        let ribbon = quad(dvec3(place, -1.0, 0.02), DVec3::X * 0.01, DVec3::Y * 3.0);
        let exact = form_factor(&floor, &lamp, std::slice::from_ref(&ribbon), &FactorOptions::DEFAULT).value;
        let surfaces = [&floor, &lamp, &ribbon].map(|p| Surface::new(p.vertices(), [0.5; 3]));
        let scene = Scene::new(&surfaces, &SceneOptions::DEFAULT.with_patch(2.0)).expect("a scene");
        let transport = scene.transport(&[]).expect("links");
        let surface: Vec<usize> = transport.patches().map(|p| p.surface).collect();
        let mut found = 0.0;
        transport.factors(|from, to, factor| {
            if (surface[from], surface[to]) == (0, 1) {
                found += factor;
            }
        });
        assert!((found - exact).abs() < 1e-5, "{place}: {found} for {exact}");
    }
}

#[test]
fn rows_of_a_closed_box_of_384_patches_add_up_to_1() {
    for turn in [DQuat::IDENTITY, DQuat::from_euler(EulerRot::XYZ, 0.3, 0.7, 1.1)] {
        let options = SceneOptions::DEFAULT.with_patch(0.126).with_factors(EXACT);
        let scene = Scene::new(&room(DVec3::ONE, turn, 0.5, 1.0), &options).expect("a room");
        assert_eq!(scene.patch_count(), 384);
        let transport = scene.transport(&[]).expect("a room");
        let worst = transport.row_sums().iter().fold(0.0, |m: f64, s| m.max((s - 1.0).abs()));
        assert!(worst < 1e-12, "a row is off by {worst:e}");
        // Uniform: B = E/(1 − ρ), here 2.
        let solved = transport.gauss_seidel(&SolveOptions::DEFAULT).expect("a solution");
        assert!(solved.radiosity.iter().flatten().all(|b| (b - 2.0).abs() <= solved.bound), "{solved:?}");
        let most = transport.factor_error();
        assert!(most < 1e-9, "bounds of up to {most:e}");
    }
}

#[test]
fn bright_and_thin_closed_boxes_are_solved_within_their_bound() {
    for (size, patch) in [(DVec3::ONE, 0.26), (dvec3(4.0, 0.1, 3.0), 0.51)] {
        let options = SceneOptions::DEFAULT.with_patch(patch);
        let scene = Scene::new(&room(size, DQuat::IDENTITY, 0.999, 1.0), &options).expect("a room");
        let transport = scene.transport(&[]).expect("a room");
        let solved = transport.gauss_seidel(&SolveOptions::DEFAULT).expect("a solution");
        assert!(solved.converged && solved.bound < 2e-3, "{solved:?}");
        // The exact solution for these rows is 1000 up to how far rows are from 1, times 1000.
        let rows = transport.row_sums().iter().fold(0.0, |m: f64, s| m.max((s - 1.0).abs()));
        let slack = solved.bound + 1e6 * rows;
        assert!(solved.radiosity.iter().flatten().all(|b| (b - 1000.0).abs() <= slack), "{slack:e}");
        assert!(slack < 0.01, "{slack:e}");
    }
}

#[test]
fn the_residual_falls_with_every_sweep_by_the_contraction_or_more() {
    let options = SceneOptions::DEFAULT.with_patch(0.26);
    let scene = Scene::new(&cornell(), &options).expect("a room");
    let transport = scene.transport(&[]).expect("a room");
    for balance in [false, true] {
        let options = SolveOptions::DEFAULT.with_balance(balance);
        let solved = transport.gauss_seidel(&options).expect("a solution");
        assert!(solved.history.len() > 3);
        for pair in solved.history.windows(2) {
            assert!(pair[1] <= pair[0] * solved.contraction + 1e-12, "{:?}", solved.history);
        }
    }
}

#[test]
fn energy_is_balanced_and_solvers_agree() {
    let scene = Scene::new(&cornell(), &SceneOptions::DEFAULT.with_patch(0.26)).expect("a room");
    let transport = scene.transport(&[]).expect("a room");
    let solved = transport.gauss_seidel(&SolveOptions::DEFAULT.with_tolerance(1e-10)).expect("solved");
    for overshoot in [false, true] {
        let options = SolveOptions::DEFAULT.with_overshoot(overshoot);
        let shot = transport.progressive(&[], &options).expect("solved");
        assert!(shot.converged);
        for (a, b) in solved.radiosity.iter().flatten().zip(shot.radiosity.iter().flatten()) {
            assert!((a - b).abs() <= solved.bound + shot.bound, "{a} {b}");
        }
    }
    // What is sent out is absorbed or lost where rows do not add up to 1.
    let rows = transport.row_sums();
    let (mut sent, mut gone) = (0.0, 0.0);
    for ((patch, b), row) in transport.patches().zip(&solved.radiosity).zip(&rows) {
        let arriving = solved.gathered_by(patch.index);
        sent += patch.area * patch.emission[0];
        gone += patch.area * ((1.0 - patch.reflectance[0]) * arriving[0] + b[0] * (1.0 - row));
    }
    assert!((sent / gone - 1.0).abs() < 1e-9, "{sent} sent out, {gone} absorbed");
}

/// A point light in the middle of a cube lights each wall with a sixth of its power, whatever the patches.
#[test]
fn a_point_light_gives_what_its_solid_angle_says() {
    let mut scene =
        Scene::new(&room(DVec3::ONE, DQuat::IDENTITY, 0.5, 0.0), &SceneOptions::DEFAULT.with_patch(0.26))
            .expect("a room");
    let at = DVec3::splat(0.5);
    let light = |p: DVec3, n: DVec3| {
        let to = at - p;
        [3.0 * n.dot(to).max(0.0) / to.length().powi(3); 3]
    };
    let lamp = Lamp::Point { position: at, irradiance: &light, shadow: true };
    let direct = scene.direct(&[lamp]).expect("a lamp");
    let transport = scene.transport(&direct).expect("a room");
    let power: f64 = transport.patches().zip(transport.direct()).map(|(p, e)| p.area * e[0]).sum();
    assert!((power / (4.0 * PI * 3.0) - 1.0).abs() < 1e-8, "{power}");
}

/// Half of a floor under a wall's shadow: the shadow's edge is where it must be.
#[test]
fn a_shadow_takes_exactly_what_the_occluder_hides() {
    let floor = Surface::new(&[DVec3::ZERO, DVec3::X, dvec3(1.0, 1.0, 0.0), DVec3::Y], [0.5; 3]);
    let roof = [dvec3(-1.0, -1.0, 0.5), dvec3(0.25, -1.0, 0.5), dvec3(0.25, 2.0, 0.5), dvec3(-1.0, 2.0, 0.5)];
    let surfaces = [floor, Surface::new(&roof, [0.0; 3])];
    let mut scene = Scene::new(&surfaces, &SceneOptions::DEFAULT).expect("a floor");
    let light = |_: DVec3, n: DVec3| [n.z; 3];
    let down = Lamp::Directional { direction: DVec3::NEG_Z, irradiance: &light, shadow: true };
    let direct = scene.direct(&[down]).expect("a lamp");
    assert!((direct[0][0] - 0.75).abs() < 1e-14, "{direct:?}");
}

#[test]
fn irradiance_in_a_uniform_room_is_that_of_its_walls() {
    let scene =
        Scene::new(&room(DVec3::ONE, DQuat::IDENTITY, 0.5, 1.0), &SceneOptions::DEFAULT.with_patch(0.26))
            .expect("a room");
    let transport = scene.transport(&[]).expect("a room");
    let solved = transport.gauss_seidel(&SolveOptions::DEFAULT).expect("solved");
    for (p, n) in [(DVec3::splat(0.3), DVec3::X), (dvec3(0.5, 0.2, 0.9), dvec3(1.0, 2.0, -3.0))] {
        for visibility in [false, true] {
            let light = solved.irradiance(p, n, visibility).expect("a point");
            assert!((light[0] - 2.0).abs() < 1e-6, "{light:?}");
        }
    }
    assert!(solved.irradiance(DVec3::NAN, DVec3::X, true).is_err());
    for vertex in solved.bake().vertices {
        // Gathered beside the room's edges, not on them.
        assert!((vertex.irradiance[0] - 2.0).abs() < 1e-6, "{vertex:?}");
        assert!((vertex.radiosity[0] - 2.0).abs() < 1e-6, "{vertex:?}");
    }
}

/// A point's share of a square overhead: the exact hemicube converges at least with the square of its cells, the classic one does not.
#[test]
fn covered_cells_have_no_aliasing() {
    let square = quad(dvec3(-0.37, -0.41, 1.0), DVec3::Y * 0.9, DVec3::X * 0.8);
    let exact: f64 = {
        // Four rectangles above their corner: 1/2π (x/√(1+x²) atan(y/√(1+x²)) + …).
        let corner = |x: f64, y: f64| {
            let part = |a: f64, b: f64| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
            (part(x, y) + part(y, x)) / (2.0 * PI)
        };
        let (x0, x1, y0, y1) = (-0.37, 0.43, -0.41, 0.49);
        corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)
    };
    let error = |kind, size| {
        let found = Hemicube::new(kind, size).factors(DVec3::ZERO, DVec3::Z, std::slice::from_ref(&square));
        (found[0] / exact - 1.0).abs()
    };
    let (mut covered, mut sampled) = (0.0_f64, 0.0_f64);
    for size in [16, 32, 64] {
        covered = covered.max(error(HemicubeKind::Exact, size) * (size * size) as f64);
        sampled = sampled.max(error(HemicubeKind::Classic, size) * size as f64);
    }
    assert!(covered < 3.0, "{covered}");
    assert!(error(HemicubeKind::Exact, 64) * 10.0 < error(HemicubeKind::Classic, 64), "{sampled}");
}

/// A room is a room: the hierarchy agrees with the full matrix.
#[test]
fn groups_of_patches_say_what_single_patches_say() {
    let solve = |tolerance| {
        let options = SceneOptions::DEFAULT.with_patch(0.13).with_tolerance(tolerance);
        let transport = Scene::new(&cornell(), &options).expect("a room").transport(&[]).expect("a room");
        let solved = transport.gauss_seidel(&SolveOptions::DEFAULT).expect("solved");
        let power: f64 = transport.patches().zip(&solved.radiosity).map(|(p, b)| p.area * b[1]).sum();
        (power, transport.counts().links)
    };
    let (full, links) = solve(None);
    let (coarse, few) = solve(Some(0.01));
    assert!((coarse / full - 1.0).abs() < 0.01, "{coarse} in groups, {full} in all");
    assert!(few * 3 < links, "{few} links of {links}");
}

#[test]
fn patches_are_divided_at_shadow_edges_only() {
    let mut surfaces = room(DVec3::ONE, DQuat::IDENTITY, 0.5, 0.0);
    surfaces.push(Surface::new(
        &[dvec3(0.3, 0.4, 0.3), dvec3(0.3, 0.4, 0.7), dvec3(0.7, 0.4, 0.7), dvec3(0.7, 0.4, 0.3)],
        [0.5; 3],
    ));
    let options = SceneOptions::DEFAULT.with_patch(0.26).with_smallest_patch(0.04).with_tolerance(Some(0.05));
    let mut scene = Scene::new(&surfaces, &options).expect("a room");
    let before = scene.patch_count();
    let at = dvec3(0.5, 0.9, 0.5);
    let light = |p: DVec3, n: DVec3| [n.dot(at - p).max(0.0) / (at - p).length().powi(3); 3];
    let lamp = Lamp::Point { position: at, irradiance: &light, shadow: true };
    let direct = scene.direct(&[lamp]).expect("a lamp");
    assert_eq!(direct.len(), scene.patch_count());
    let after = scene.patch_count();
    assert!(after > before && after < 16 * before, "{before} patches became {after}");
}

#[test]
fn importance_is_the_adjoint_of_light() {
    let scene = Scene::new(&cornell(), &SceneOptions::DEFAULT.with_patch(0.3)).expect("a room");
    let transport = scene.transport(&[]).expect("a room");
    let options = SolveOptions::DEFAULT.with_tolerance(1e-10);
    let solved = transport.gauss_seidel(&options).expect("solved");
    // Seen: the second box, evenly; grey, so that all bands agree.
    let seen: Vec<f64> = transport.patches().map(|p| f64::from(u8::from(p.surface > 12))).collect();
    let importance = transport.importance(&seen, &options).expect("an importance");
    let (mut by_light, mut by_importance) = (0.0, 0.0);
    for (i, patch) in transport.patches().enumerate() {
        let mean = |v: [f64; 3]| v.iter().sum::<f64>() / 3.0;
        by_light += patch.area * seen[i] * mean(solved.radiosity[i]);
        by_importance += patch.area * importance[i] * mean(patch.emission);
    }
    assert!((by_light / by_importance - 1.0).abs() < 1e-6, "{by_light} and {by_importance}");
    let shot = transport.progressive(&importance, &SolveOptions::DEFAULT).expect("solved");
    assert!(shot.converged);
}

#[test]
#[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
fn any_number_of_threads_gives_the_same_bytes() {
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let options = SceneOptions::DEFAULT.with_patch(0.26).with_tolerance(Some(0.02));
            let transport = Scene::new(&cornell(), &options).expect("a room").transport(&[]).expect("a room");
            let solved = transport.gauss_seidel(&SolveOptions::DEFAULT).expect("solved");
            solved.bake()
        })
    };
    assert_eq!(of(1), of(3));
}
