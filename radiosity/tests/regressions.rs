//! Bugs that were fixed, each with the smallest input that showed it.

mod common;

use common::{cornell, quad, room};
use glam::{DQuat, DVec3, dvec3};
use pointillist_dice::lambert;
use pointillist_radiosity::{
    BakedVertex, FactorOptions, HemicubeKind, Lamp, RadiosityError, RayOptions, Scene, SceneOptions,
    SolveOptions, Surface, Transport, form_factor,
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

/// Both shine, and no patch sees the other; only from a vertex whose normal is the mean of theirs a few rays meet one. So the error asked for was the smallest number,
/// whose square is 0, and what was gathered was weighted by infinity over infinity.
#[test]
fn vertices_that_gather_what_no_patch_receives_are_finite() {
    let first = [[0.0, -3.0, 0.0], [0.0, 2.0, 2.0], [0.0, 1.0, 0.0], [0.0; 3]].map(DVec3::from_array);
    let second = [[0.0, -1.0, 0.0], [1.0, -3.0, 1.0], [0.0, -2.0, 3.0]].map(DVec3::from_array);
    for emission in [1.0, 1e-200, 1e30] {
        let surface = |ring: &[DVec3]| Surface::new(ring, [0.5; 3]).emitting([emission; 3]);
        let surfaces = [surface(&first), surface(&second)];
        let scene = Scene::new(&surfaces, &SceneOptions::DEFAULT.with_patch(4.0)).expect("both are sound");
        let rays = RayOptions::DEFAULT.with_links(16).with_most_rays(128);
        let transport = scene.transport_by_rays(&[], &rays, &|_| ()).expect("they fit");
        let solved = transport.solve(&SolveOptions::DEFAULT).expect("it converges");
        for vertex in solved.bake().vertices {
            assert!((0.0..0.01 * emission).contains(&vertex.irradiance[0]), "{emission:e}: {vertex:?}");
        }
    }
}

/// Rooms that shine a little or a lot: irradiance is in proportion.
#[test]
fn light_of_any_strength_is_gathered() {
    for emission in [1e-200, 1e-30, 1.0, 1e30, 1e100] {
        let surfaces = room(DVec3::ONE, DQuat::IDENTITY, 0.5, emission);
        let scene = Scene::new(&surfaces, &SceneOptions::DEFAULT.with_patch(0.5)).expect("a room");
        let rays = RayOptions::DEFAULT.with_links(64).with_most_rays(512);
        let transport = scene.transport_by_rays(&[], &rays, &|_| ()).expect("they fit");
        let solved = transport.solve(&SolveOptions::DEFAULT).expect("it converges");
        for vertex in solved.bake().vertices {
            // Every ray meets a wall of twice the emission.
            let share = vertex.irradiance[0] / (2.0 * emission);
            assert!((share - 1.0).abs() < 0.01, "{emission:e}: {share}");
        }
    }
}

/// Light passes between a ceiling and a lamp a thousandth of the room below it: of the ceiling, a strip of some thousandths sees the wall. Between samples nothing of
/// it was seen, and with 1e-9 asked for the result was wrong by 2.3 %.
#[test]
fn light_through_a_gap_of_a_thousandth_is_found() {
    let ceiling = quad(dvec3(0.5, 1.0, 0.375), DVec3::X * 0.125, DVec3::Z * 0.125);
    let wall = quad(dvec3(1.0, 0.875, 0.375), DVec3::Z * 0.125, DVec3::Y * 0.125);
    let (low, high) = (dvec3(0.4, 0.999, 0.4), dvec3(0.6, 0.999, 0.6));
    let lamp = quad(low, DVec3::X * 0.2, DVec3::Z * 0.2);
    // From a point of the wall the lamp hides a rectangle of the ceiling.
    const N: usize = 400;
    let mut exact = 0.0;
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let [y, z] = [i, j].map(|k| 0.125 * (k as f64 + 0.5) / N as f64);
        let p = dvec3(1.0, 0.875 + y, 0.375 + z);
        let hidden = if p.y < low.y {
            let [from, to] = [low, high].map(|v| p + (v - p) * ((1.0 - p.y) / (v.y - p.y)));
            let (from, to) = (from.max(ceiling.vertices()[0]), to.min(ceiling.vertices()[2]));
            let ring = [from, dvec3(to.x, 1.0, from.z), to, dvec3(from.x, 1.0, to.z)];
            if from.x < to.x && from.z < to.z { lambert::share(p, wall.normal(), &ring) } else { 0.0 }
        } else {
            0.0
        };
        exact += (lambert::share(p, wall.normal(), ceiling.vertices()) - hidden.abs()) / (N * N) as f64;
    }
    for (relative, allowed) in [(1e-3, 1e-6), (1e-5, 2e-8)] {
        let options = FactorOptions::DEFAULT.with_occluded(relative);
        let found = form_factor(&ceiling, &wall, std::slice::from_ref(&lamp), &options);
        assert!((found.value - exact).abs() <= allowed, "{found:?} for {exact}");
    }
}

/// An occluder that stands on a sliver hides a fortieth of it, between samples and near no corner. It counted as hiding nothing, with a bound of rounding.
#[test]
fn what_is_hidden_from_a_sliver_is_found() {
    let polygon = |ring: [[f64; 3]; 3]| {
        pointillist_radiosity::Polygon::new(&ring.map(DVec3::from_array)).expect("a triangle")
    };
    let sliver =
        polygon([[-0.24694, 0.25, -0.981577], [-0.49694, 0.25, -0.981577], [-0.49694, 0.25, -0.981587]]);
    let source = quad(dvec3(0.0, -1.0, 0.0), DVec3::Y * -0.25, DVec3::X * -0.25);
    let occluder = polygon([
        [0.167239, -1.0, -0.850558],
        [0.457532, -0.014315, -1.005588],
        [-0.458138, 0.485685, -1.005588],
    ]);
    let of = |occluders: &[_]| form_factor(&sliver, &source, occluders, &FactorOptions::DEFAULT).value;
    // By four million lines between random points 2.7 % is hidden.
    let hidden = 1.0 - of(&[occluder]) / of(&[]);
    assert!((hidden - 0.0271).abs() < 0.001, "{hidden}");
}

/// What a patch sends ahead was added to its radiosity, which then was half as high again.
#[test]
fn overshooting_does_not_brighten() {
    let options = SceneOptions::DEFAULT.with_patch(0.6);
    let scene = Scene::new(&room(DVec3::ONE, DQuat::IDENTITY, 0.5, 1.0), &options).expect("a room");
    let transport = scene.transport(&[]).expect("a room");
    let solved = transport.progressive(&[], &SolveOptions::DEFAULT).expect("solved");
    assert!((solved.radiosity[0][0] - 2.0).abs() <= solved.bound, "{solved:?}");
}

/// A patch that owed what it had sent ahead was shot again and again, because its debt was the largest: nothing else ever was.
#[test]
fn debts_are_not_shot_for_ever() {
    let options = SceneOptions::DEFAULT.with_patch(0.3);
    let surfaces = room(DVec3::ONE, DQuat::IDENTITY, 0.999, 1.0);
    let transport = Scene::new(&surfaces, &options).expect("a room").transport(&[]).expect("a room");
    let solved = transport.progressive(&[], &SolveOptions::DEFAULT).expect("solved");
    assert!(solved.converged, "{} steps for {} patches", solved.steps, transport.patch_count());
}

/// With importance, overshooting sent the same debt back and forth for ever.
#[test]
fn shooting_by_importance_ends() {
    let transport = Scene::new(&cornell(), &SceneOptions::DEFAULT.with_patch(0.6))
        .expect("a room")
        .transport(&[])
        .expect("a room");
    let mut importance = vec![0.0; transport.patch_count()];
    importance[0] = 1.0;
    let solved = transport.progressive(&importance, &SolveOptions::DEFAULT).expect("solved");
    assert!(solved.converged);
}

/// Of an edge between neighbours in f64 the middle is an end: looking for smaller neighbours along it never ended. Found by fuzzing.
#[test]
fn edges_without_a_middle_are_baked() {
    let surface = |ring: &[[f64; 3]]| {
        let ring: Vec<DVec3> = ring.iter().map(|&v| DVec3::from_array(v)).collect();
        Surface::new(&ring, [0.3; 3]).emitting([77.0; 3]).two_sided()
    };
    let surfaces = [
        surface(&[[2.0, -1.0, 0.0], [2.0, -1.0, 2.0], [0.0, 2.0, 0.0]]),
        surface(&[[2.0, -2.0, 2.0], [2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [2.0, 0.0, 0.0]]),
    ];
    let options = SceneOptions::DEFAULT.with_patch(4.0).with_tolerance(Some(0.2));
    pointillist_radiosity::invariants::scenes::is_refused_or_solved(&surfaces, &options).expect("solved");
}

/// The share of a near source seen from a needle was taken for a polynomial: an occluder made it brighter. Found by fuzzing.
#[test]
fn occluders_do_not_brighten() {
    let polygon = |ring: [[f64; 3]; 3]| {
        pointillist_radiosity::Polygon::new(&ring.map(DVec3::from_array)).expect("a triangle")
    };
    let from = polygon([[0.0, -1.0, 2.0], [1.0, 2.0, -3.0], [1.0, -2.0, 3.0]]);
    let to = polygon([[2.0, 2.0, 2.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]);
    let between = polygon([[2.0, -1.0, 2.0], [-1.0, -2.0, -1.0], [2.0, 3.0, -2.0]]);
    let exact = form_factor(&from, &to, std::slice::from_ref(&between), &FactorOptions::DEFAULT);
    let coarse = FactorOptions::DEFAULT.with_occluded(1e-3).with_absolute(1e-4).with_max_cells(400);
    let found = form_factor(&from, &to, &[between], &coarse);
    assert!((found.value - exact.value).abs() <= found.error + exact.error, "{found:?}, {exact:?}");
    assert!(found.value <= form_factor(&from, &to, &[], &FactorOptions::DEFAULT).value);
}

/// An outline that is a little off its plane, and 1e57 times as large as the other, sent less than nothing. Found by fuzzing.
#[test]
fn nothing_less_than_nothing_is_sent() {
    let ring = |ring: &[[f64; 3]]| {
        let ring: Vec<DVec3> = ring.iter().map(|&v| DVec3::from_array(v)).collect();
        pointillist_radiosity::Polygon::new(&ring).expect("a polygon")
    };
    let from = ring(&[[0.0, -2.0, -2.0], [-2.0, -2.0, 1.0], [-2.0, 0.0, 0.0]]);
    let far = -1.363_115_719_988_382e57;
    let to = ring(&[
        [far, -1.363_115_313_690_926_8e57, far],
        [far, far, far],
        [far, far, -1.363_115_284_460_894e57],
        [0.0, -1.363_115_717_718_532_2e57, far],
        [-1.363_115_719_981_308_8e57, 0.0, 0.0],
    ]);
    assert!(form_factor(&from, &to, &[], &FactorOptions::DEFAULT).value >= 0.0);
}

/// Rows of a hierarchy were scaled down to 1 where they were above it, which took 2 % of all light away.
#[test]
fn a_hierarchy_keeps_its_light() {
    let surfaces = room(DVec3::ONE, DQuat::IDENTITY, 0.9, 1.0);
    let options = SceneOptions::DEFAULT.with_patch(0.1).with_tolerance(Some(0.05));
    let transport = Scene::new(&surfaces, &options).expect("a room").transport(&[]).expect("a room");
    let solved = transport.gauss_seidel(&SolveOptions::DEFAULT).expect("solved");
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
    let transport = closed.transport(&[]).expect("a room");
    let refused = transport.gauss_seidel(&SolveOptions::DEFAULT);
    assert!(matches!(refused, Err(RadiosityError::NoEquilibrium { .. })), "{refused:?}");
    let open = room(DVec3::ONE, DQuat::IDENTITY, 1.0, 1.0);
    let transport = Scene::new(&open[..4], &options).expect("a room").transport(&[]).expect("a room");
    let solved = transport.gauss_seidel(&SolveOptions::DEFAULT).expect("light gets out");
    assert!(solved.converged && solved.contraction < 1.0, "{solved:?}");
}

/// A lamp that answered NaN or infinity was summed up, compared with the tolerance, and certified as `converged` with a bound of 0.
#[test]
fn lamps_that_give_no_light_are_refused_by_lamp_and_patch() {
    let dark = |_: DVec3, _: DVec3| [1.0, 0.0, 2.0];
    for bad in [f64::NAN, f64::INFINITY, -1e-9, 1e101] {
        let broken = move |p: DVec3, _: DVec3| if p.y < 0.2 { [0.0, bad, 0.0] } else { [1.0; 3] };
        let mut scene = Scene::new(&cornell(), &SceneOptions::DEFAULT.with_patch(0.6)).expect("a room");
        let position = dvec3(0.5, 0.5, 0.5);
        let lamps = [
            Lamp::Point { position, irradiance: &dark, shadow: false },
            Lamp::Point { position, irradiance: &broken, shadow: true },
        ];
        match scene.direct(&lamps) {
            Err(RadiosityError::LampIrradiance { lamp: 1, centre, value, .. }) => {
                assert!(!(0.0..=1e100).contains(&value) && centre[1] < 1.0, "{value} {centre:?}");
            }
            other => panic!("{other:?}"),
        }
    }
}

/// Negative direct light was taken for light, and NaN as a weight of patches shot 210,000 times.
#[test]
fn direct_light_and_importance_that_are_none_are_refused_by_patch() {
    let scene = || Scene::new(&cornell(), &SceneOptions::DEFAULT.with_patch(0.6)).expect("a room");
    let mut transport = scene().transport(&[]).expect("a room");
    let options = SolveOptions::DEFAULT;
    for bad in [f64::NAN, f64::INFINITY, -1.0, 1e200] {
        let mut light = vec![[1.0; 3]; transport.patch_count()];
        light[3][2] = bad;
        let named = |e: RadiosityError| matches!(e, RadiosityError::DirectIrradiance { patch: 3, .. });
        assert!(scene().transport(&light).is_err_and(named));
        assert!(scene().transport_by_hemicubes(HemicubeKind::Exact, 8, &light).is_err_and(named));
        assert!(transport.set_direct(&light).is_err_and(named));
        assert!(transport.direct().iter().all(|&light| light == [0.0; 3]), "a refused light was taken");
        let mut weights = vec![1.0; transport.patch_count()];
        weights[5] = bad;
        let named = |e: RadiosityError| matches!(e, RadiosityError::Importance { patch: 5, .. });
        assert!(transport.progressive(&weights, &options).is_err_and(named));
        assert!(transport.importance(&weights, &options).is_err_and(named));
    }
    let mut bright = cornell();
    bright[0].emission = [1e300; 3];
    assert!(matches!(
        Scene::new(&bright, &SceneOptions::DEFAULT),
        Err(RadiosityError::Emission { surface: 0, .. })
    ));
}

/// A solver took any list of direct light, and baking any solution: of another transport they gave wrong light or a panic.
#[test]
fn a_transport_owns_its_direct_light() {
    let options = SceneOptions::DEFAULT.with_patch(0.6);
    let scene = || Scene::new(&cornell(), &options).expect("a room");
    let lamp =
        Lamp::Point { position: dvec3(0.5, 0.5, 0.5), irradiance: &|_, _| [1.0, 2.0, 3.0], shadow: true };
    let mut lit = scene();
    let light = lit.direct(&[lamp]).expect("a lamp");
    let built = lit.clone().transport(&light).expect("a room");
    let mut relit = lit.transport(&[]).expect("a room");
    let dark = relit.gauss_seidel(&SolveOptions::DEFAULT).expect("solved").radiosity;
    relit.set_direct(&light).expect("one entry for each patch");
    assert_eq!(relit.direct(), built.direct());
    let [a, b] = [&relit, &built].map(|t| t.gauss_seidel(&SolveOptions::DEFAULT).expect("solved"));
    assert_eq!(a.radiosity, b.radiosity);
    assert_ne!(a.radiosity, dark);
    assert_eq!(a.bake(), b.bake());
    let patches = relit.patch_count();
    let short = relit.set_direct(&light[1..]);
    assert_eq!(short, Err(RadiosityError::CountMismatch { patches, given: patches - 1 }));
    assert_eq!(relit.direct(), light);
    relit.set_direct(&[]).expect("none");
    let again = relit.gauss_seidel(&SolveOptions::DEFAULT).expect("solved");
    assert_eq!(again.radiosity, dark);
}

/// Every edit of a room paid for all form factors.
#[test]
fn a_moved_object_pays_for_its_own_links() {
    let furnished = |x: f64| {
        let mut surfaces = room(dvec3(4.0, 2.5, 3.0), DQuat::IDENTITY, 0.7, 0.0);
        for (low, size) in
            [(dvec3(1.0, 0.9, 0.8), 0.3), (dvec3(2.9, 1.2, 1.9), 0.25), (dvec3(x, 0.5, 2.2), 0.3)]
        {
            let around = room(DVec3::splat(size), DQuat::IDENTITY, 0.5, 0.0);
            surfaces.extend(around.into_iter().map(|mut surface| {
                // Rooms look inward, boxes outward.
                surface.vertices.reverse();
                surface.vertices.iter_mut().for_each(|v| *v += low);
                surface
            }));
        }
        surfaces[1].emission = [1.0; 3];
        surfaces
    };
    let options = SceneOptions::DEFAULT.with_patch(0.51);
    let scene = |x: f64| Scene::new(&furnished(x), &options).expect("a room");
    let before = scene(0.5).transport(&[]).expect("a room");
    let fresh = scene(0.6).transport(&[]).expect("a room");
    let after = scene(0.6).transport_after(&before, &[], &|_| ()).expect("a room");
    let all = |transport: &Transport| {
        let mut list = vec![];
        transport.factors(|a, b, factor| list.push((a, b, factor.to_bits())));
        list
    };
    assert!(all(&fresh) == all(&after), "form factors are those of a fresh build");
    let [fresh, after] = [fresh.counts(), after.counts()];
    assert_eq!((fresh.links, fresh.partly_hidden, fresh.kept), (after.links, after.partly_hidden, 0));
    assert!(3 * after.kept > fresh.partly_hidden && after.cells < fresh.cells, "{fresh:?} {after:?}");
    let same = scene(0.5).transport_after(&before, &[], &|_| ()).expect("a room").counts();
    assert_eq!(same.kept, same.partly_hidden, "where nothing moves, all is kept");
    println!("{} of {} kept, {} of {} cells", after.kept, fresh.partly_hidden, after.cells, fresh.cells);
}

/// Linking was silent.
#[test]
fn progress_is_told_while_light_and_links_are_found() {
    let surfaces = room(DVec3::ONE, DQuat::IDENTITY, 0.5, 1.0);
    let options = SceneOptions::DEFAULT.with_patch(0.3).with_smallest_patch(0.1).with_tolerance(Some(0.01));
    let told = std::sync::Mutex::new(vec![]);
    let done = |share: f64| told.lock().expect("no panic").push(share);
    let irradiance = |_: DVec3, n: DVec3| [n.y.max(0.0); 3];
    let lamps = [Lamp::Point { position: dvec3(0.5, 0.9, 0.5), irradiance: &irradiance, shadow: true }];
    let mut scene = Scene::new(&surfaces, &options).expect("a room");
    let direct = scene.direct_with(&lamps, &done).expect("a lamp");
    let lit = told.lock().expect("no panic").len();
    assert!(lit >= scene.patch_count());
    scene.transport_with(&direct, &done).expect("a room");
    let told = told.into_inner().expect("no panic");
    assert!(told.len() > lit + 6 && told.iter().all(|share| (0.0..=1.0).contains(share)));
}

/// A sphere of latitudes and longitudes.
fn ball(centre: DVec3, radius: f64, rings: usize) -> Vec<Surface> {
    let at = |i: usize, j: usize| {
        let (sin, cos) = (std::f64::consts::PI * i as f64 / rings as f64).sin_cos();
        let (y, x) = (std::f64::consts::PI * j as f64 / rings as f64).sin_cos();
        centre + radius * dvec3(sin * x, sin * y, cos)
    };
    let mut surfaces = vec![];
    for (i, j) in (0..rings).flat_map(|i| (0..2 * rings).map(move |j| (i, j))) {
        let ring = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        let corners = match i {
            0 => vec![ring[0], ring[1], ring[2]],
            _ if i + 1 == rings => vec![ring[0], ring[1], ring[3]],
            _ => ring.to_vec(),
        };
        surfaces.push(Surface::new(&corners, [0.5; 3]));
    }
    surfaces
}

/// Every triangle of a ball between a patch and a lamp with an area was cut by all those before it: rooms with two balls took minutes, and
/// this 25 times as long. Rays must find what cutting found.
#[test]
fn light_of_a_lamp_past_a_ball_of_many_triangles_is_right() {
    let (centre, radius) = (dvec3(0.1, 0.0, 1.0), 0.4);
    let lamp = quad(dvec3(-0.4, -0.4, 2.4), dvec3(0.0, 0.8, 0.0), dvec3(0.8, 0.0, 0.0));
    let tiles: Vec<_> = (0..16 * 16)
        .map(|i| dvec3(-2.0 + 0.25 * f64::from(i % 16), -2.0 + 0.25 * f64::from(i / 16), 0.0))
        .map(|low| quad(low, DVec3::X * 0.25, DVec3::Y * 0.25))
        .collect();
    let mut surfaces = ball(centre, radius, 24);
    surfaces.extend(tiles.iter().map(|tile| Surface::new(tile.vertices(), [0.5; 3])));
    let mut scene = Scene::new(&surfaces, &SceneOptions::DEFAULT.with_squarer(false)).expect("a room");
    let lamps = [Lamp::Area { polygon: &lamp, exitance: [1.0; 3], shadow: true }];
    let light = scene.direct(&lamps).expect("lit");
    assert_eq!(light.len(), surfaces.len());
    let (mut largest, mut penumbra) = (0.0_f64, 0);
    for (tile, light) in tiles.iter().zip(&light[surfaces.len() - tiles.len()..]) {
        let (all, open) = past_sphere(tile.vertices(), lamp.vertices(), centre, radius);
        penumbra += i32::from(open > 0.02 * all && open < 0.98 * all);
        largest = largest.max((light[0] - open).abs() / all);
    }
    assert!(penumbra > 20 && largest < 0.025, "{penumbra} patches in half shadow, {largest}");
}

/// What a square patch gets of a square lamp, without and with a sphere between, by 24⁴ points.
fn past_sphere(patch: &[DVec3], lamp: &[DVec3], centre: DVec3, radius: f64) -> (f64, f64) {
    const N: usize = 24;
    let at = |ring: &[DVec3], i: usize, j: usize| {
        let [u, v] = [i, j].map(|k| (k as f64 + 0.5) / N as f64);
        ring[0] + (ring[1] - ring[0]) * u + (ring[3] - ring[0]) * v
    };
    let area = (lamp[1] - lamp[0]).cross(lamp[3] - lamp[0]).length();
    let (mut all, mut open) = (0.0, 0.0);
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        for (k, l) in (0..N).flat_map(|k| (0..N).map(move |l| (k, l))) {
            let from = at(patch, i, j);
            let way = at(lamp, k, l) - from;
            let share = way.z * way.z / way.length_squared().powi(2);
            all += share;
            let nearest = (centre - from).dot(way) / way.length_squared();
            open += if (from + way * nearest - centre).length() > radius { share } else { 0.0 };
        }
    }
    let scale = area / (std::f64::consts::PI * (N * N * N * N) as f64);
    (all * scale, open * scale)
}

/// A screen stands on a floor between two walls that shine. By rays the floor had one vertex on either side of the screen's foot, which saw both walls, and took
/// light of the one to the floor behind the screen.
#[test]
fn the_foot_of_a_screen_is_lit_on_its_own_side() {
    let quad = |o: DVec3, u: DVec3, v: DVec3| [o, o + u, o + u + v, o + v];
    let floor = Surface::new(&quad(dvec3(-2.0, -2.0, 0.0), DVec3::X * 4.0, DVec3::Y * 4.0), [0.0; 3]);
    let screen = Surface::new(&quad(DVec3::Y * -2.0, DVec3::Y * 4.0, DVec3::Z), [0.0; 3]).two_sided();
    let left = Surface::new(&quad(dvec3(-2.0, -2.0, 0.0), DVec3::Y * 4.0, DVec3::Z), [0.0; 3]);
    let right = Surface::new(&quad(dvec3(2.0, 2.0, 0.0), DVec3::Y * -4.0, DVec3::Z), [0.0; 3]);
    // Irradiance at the vertices of the foot's middle, and of the floor half a metre from it, by rising x.
    let light = |right: Surface| {
        let surfaces = [floor.clone(), screen.clone(), left.clone().emitting([1.0; 3]), right];
        let mut scene = Scene::new(&surfaces, &SceneOptions::for_rays(0.5)).unwrap();
        let direct = scene.direct(&[]).unwrap();
        let transport = scene.transport_by_rays(&direct, &RayOptions::DEFAULT, &|_| ()).unwrap();
        let baked = transport.solve(&SolveOptions::DEFAULT).unwrap().bake();
        let near = |p: DVec3| p.y.abs() < 1e-9 && p.x.abs() < 0.51;
        let is_asked = |v: &&BakedVertex| v.normal.z > 0.5 && near(v.position);
        let mut found: Vec<(f64, f64)> =
            baked.vertices.iter().filter(is_asked).map(|v| (v.position.x, v.irradiance[0])).collect();
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        found
    };
    // Of a strip as wide as the wall, seen from its distance: a half of 1 - cos(atan(1/2)) if it were infinitely long.
    let infinite = 0.5 * (1.0 - (0.5_f64).atan().cos());
    let one = light(right.clone());
    let foot: Vec<f64> = one.iter().filter(|v| v.0 == 0.0).map(|v| v.1).collect();
    assert!(foot.len() == 2 && foot[0] == 0.0, "{one:?}");
    assert!((0.6..1.0).contains(&(foot[1] / infinite)), "{one:?}");
    assert!(one.iter().all(|v| v.0 <= 0.0 || v.1 == 0.0), "{one:?}");
    let both = light(right.emitting([1.0; 3]));
    let foot: Vec<f64> = both.iter().filter(|v| v.0 == 0.0).map(|v| v.1).collect();
    assert!(foot.len() == 2 && foot.iter().all(|e| (0.6..1.0).contains(&(e / infinite))), "{both:?}");
}
