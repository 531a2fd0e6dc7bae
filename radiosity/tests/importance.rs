//! Links that are fine where a camera sees what they carry.

mod common;

use common::{faces, room};
use glam::{DQuat, DVec3, dvec3};
use pointillist_radiosity::{
    Lamp, RadiosityError, Rgb, Scene, SceneOptions, SolveOptions, Surface, Transport,
};

/// Two rooms with a doorway, a lamp in the first.
fn two_rooms(tolerance: f64) -> (Scene, Vec<Rgb>) {
    let mut surfaces = room(dvec3(8.0, 3.0, 4.0), DQuat::IDENTITY, 0.7, 0.0);
    for (low, high) in [
        (dvec3(3.9, 0.0, 0.0), dvec3(4.1, 3.0, 1.5)),
        (dvec3(3.9, 0.0, 2.5), dvec3(4.1, 3.0, 4.0)),
        (dvec3(3.9, 2.1, 1.5), dvec3(4.1, 3.0, 2.5)),
    ] {
        surfaces.extend(faces(low, high, DQuat::IDENTITY).iter().map(|f| Surface::new(f, [0.7; 3])));
    }
    let options =
        SceneOptions::DEFAULT.with_patch(0.25).with_smallest_patch(0.25).with_tolerance(Some(tolerance));
    let mut scene = Scene::new(&surfaces, &options).expect("surfaces");
    let position = dvec3(2.0, 1.8, 2.0);
    let irradiance = |p: DVec3, n: DVec3| {
        let way = position - p;
        [10.0 * way.dot(n).max(0.0) / way.length().powi(3); 3]
    };
    let direct =
        scene.direct(&[Lamp::Point { position, irradiance: &irradiance, shadow: true }]).expect("a lamp");
    (scene, direct)
}

/// Where the camera is: in a corner of the dark room.
const EYE: DVec3 = dvec3(7.7, 2.0, 0.3);

/// What is seen through a lens of 70 degrees, from the side of the doorway towards the far wall.
fn seen(scene: &Scene) -> Vec<f64> {
    let ahead = (dvec3(6.0, 1.0, 4.0) - EYE).normalize();
    let in_view = |p: DVec3| (p - EYE).normalize().dot(ahead) > 35.0_f64.to_radians().cos();
    scene.seen_from(EYE, &in_view).expect("finite")
}

fn for_the_camera(tolerance: f64) -> Transport {
    let (scene, direct) = two_rooms(tolerance);
    let importance = scene.importance(&direct, &seen(&scene)).expect("an importance");
    scene.transport_for(&direct, &importance, &|_| ()).expect("links")
}

#[test]
fn a_camera_sees_its_room_and_a_part_of_the_other() {
    let (scene, direct) = two_rooms(0.1);
    let seen = scene.seen_from(EYE, &|_| true).expect("finite");
    let transport = scene.transport(&direct).expect("links");
    let (mut near, mut far) = ([0.0; 2], [0.0; 2]);
    for (patch, share) in transport.patches().zip(&seen) {
        assert!((0.0..=1.0).contains(share), "{share}");
        let [sum, all] = if patch.centre.x > 4.1 { &mut near } else { &mut far };
        *sum += share * patch.area;
        *all += patch.area;
    }
    // All of its own room but what the wall's thickness hides; of the other what is behind the doorway.
    assert!(near[0] > 0.95 * near[1], "{near:?}");
    assert!(far[0] > 0.1 * far[1] && far[0] < 0.3 * far[1], "{far:?}");
}

#[test]
fn importance_spends_fewer_links_for_the_same_error() {
    let camera = {
        let (scene, _) = two_rooms(0.1);
        seen(&scene)
    };
    let solve = |transport: &Transport| {
        let solved = transport.gauss_seidel(&SolveOptions::DEFAULT).expect("it absorbs");
        solved.radiosity.iter().map(|r| r[0]).collect::<Vec<f64>>()
    };
    let plain = |tolerance: f64| {
        let (scene, direct) = two_rooms(tolerance);
        scene.transport(&direct).expect("links")
    };
    let exact = solve(&plain(0.001));
    // Of what the camera sees, all patches being of about one size.
    let error = |transport: &Transport| {
        let found = solve(transport);
        let mut sums = [0.0; 2];
        for ((found, exact), share) in found.iter().zip(&exact).zip(&camera) {
            sums[0] += share * (found - exact).powi(2);
            sums[1] += share * exact * exact;
        }
        (sums[0] / sums[1]).sqrt()
    };
    let (everywhere, important) = (plain(0.01), for_the_camera(0.01));
    let [links, fewer] = [&everywhere, &important].map(|t| t.counts().links);
    let [before, after] = [&everywhere, &important].map(error);
    println!("{links} links, error {before:.2e}; {fewer} links, error {after:.2e}");
    assert!(2 * fewer < links, "{fewer} links of {links}");
    assert!(after < 1.2 * before, "{after} by {fewer} links, {before} by {links}");
}

#[test]
fn where_all_is_important_nothing_changes() {
    let (scene, direct) = two_rooms(0.03);
    let ones = vec![1.0; scene.patch_count()];
    let weighted = scene.clone().transport_for(&direct, &ones, &|_| ()).expect("links");
    let plain = scene.transport(&direct).expect("links");
    let factors = |transport: &Transport| {
        let mut list = vec![];
        transport.factors(|from, to, factor| list.push((from, to, factor.to_bits())));
        list
    };
    assert_eq!(weighted.counts(), plain.counts());
    assert_eq!(factors(&weighted), factors(&plain));
}

#[test]
fn weights_that_are_none_are_refused() {
    let (scene, direct) = two_rooms(0.3);
    let mut importance = vec![0.5; scene.patch_count()];
    importance[3] = f64::NAN;
    let found = scene.clone().transport_for(&direct, &importance, &|_| ());
    assert!(matches!(found, Err(RadiosityError::Importance { patch: 3, .. })));
    assert!(matches!(
        scene.clone().transport_for(&direct, &[1.0], &|_| ()),
        Err(RadiosityError::CountMismatch { given: 1, .. })
    ));
    assert_eq!(scene.seen_from(DVec3::NAN, &|_| true), Err(RadiosityError::BadPoint));
}
