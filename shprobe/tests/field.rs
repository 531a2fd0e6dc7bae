//! What must hold between probes: light, distances, placement.

use glam::{DVec3, Vec3, dvec3};
use pointillist_shprobe::delaunay::{Delaunay, Partition};
use pointillist_shprobe::invariants::{
    at_most_so_many_probes_light_a_position, fields_are_equal, shares_do_not_jump,
};
use pointillist_shprobe::sh::{CubePoint, Sh, cube_direction};
use pointillist_shprobe::{DistanceMap, Field, Hint, LitObject, ProbeError, place};

/// Probes that see the same radiance from everywhere.
fn constant(values: &[f64]) -> Vec<Sh> {
    values.iter().map(|&v| Sh::constant(DVec3::splat(v), 2).unwrap()).collect()
}

#[test]
fn fewer_dimensions_fall_back_to_triangles_segments_and_a_constant() {
    let kinds = [
        (vec![DVec3::ONE; 3], 0),
        (vec![DVec3::ZERO, DVec3::X * 2.0, DVec3::X], 1),
        (vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y], 2),
        (vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], 3),
    ];
    for (points, dimension) in kinds {
        let partition = Delaunay::new(&points).unwrap().partition();
        assert_eq!(partition.dimension(), dimension);
        let values: Vec<f64> = points.iter().map(|p| p.x).collect();
        let field = Field::new(&points, &constant(&values)).unwrap();
        let light = field.light(dvec3(0.5, 0.25, 7.0), &mut Hint::default()).unwrap().at(Vec3::Y);
        let wanted = if dimension == 0 { 1.0 } else { 0.5 } * std::f32::consts::PI;
        // Above a tetrahedron the nearest point is not below.
        assert!(dimension == 3 || (light.x - wanted).abs() < 1e-6, "{dimension}: {light}");
    }
}

#[test]
fn bad_input_is_refused_with_what_is_wrong() {
    let nan = dvec3(0.0, f64::NAN, 0.0);
    assert_eq!(Field::new(&[], &[]).err(), Some(ProbeError::NoProbes));
    assert_eq!(
        Field::new(&[DVec3::ZERO, nan], &constant(&[1.0, 1.0])).err(),
        Some(ProbeError::PositionNotFinite { index: 1 })
    );
    assert_eq!(
        Field::new(&[DVec3::ZERO], &constant(&[1.0, 1.0])).err(),
        Some(ProbeError::CountMismatch { probes: 1, given: 2 })
    );
    let mixed = [Sh::constant(DVec3::ONE, 1).unwrap(), Sh::constant(DVec3::ONE, 2).unwrap()];
    assert_eq!(
        Field::new(&[DVec3::ZERO, DVec3::X], &mixed).err(),
        Some(ProbeError::MixedOrders { index: 1, order: 2, expected: 1 })
    );
    let field = Field::new(&[DVec3::ZERO, DVec3::X], &constant(&[1.0, 1.0])).unwrap();
    assert_eq!(
        field.irradiance_all(&[(DVec3::ZERO, Vec3::Y), (nan, Vec3::Y)]).err(),
        Some(ProbeError::QueryNotFinite { index: 1 })
    );
    let mut objects = [LitObject::at(DVec3::ZERO), LitObject::at(nan)];
    assert_eq!(field.light_objects(&mut objects).err(), Some(ProbeError::QueryNotFinite { index: 1 }));
    assert_eq!(DistanceMap::new(1, &[[1.0, 1.0]; 3]).err(), Some(ProbeError::BadDistances { index: 3 }));
    let negative = DistanceMap::from_cube(4, 1, &[1.0, 1.0, -1.0, 1.0, 1.0, 1.0], 9.0);
    assert_eq!(negative.err(), Some(ProbeError::BadDistances { index: 2 }));
}

/// Distances from the middle of a cube-shaped room of half-width `reach`, as six faces of `size`² texels.
fn room(size: usize, reach: f32) -> Vec<f32> {
    let unit = |i: usize| (2 * i + 1) as f32 / size as f32 - 1.0;
    let face =
        (0..size * size).map(|i| reach * (1.0 + unit(i % size).powi(2) + unit(i / size).powi(2)).sqrt());
    let face: Vec<f32> = face.collect();
    face.iter().copied().cycle().take(6 * size * size).collect()
}

#[test]
fn what_is_in_the_room_is_seen_and_what_is_behind_its_walls_is_not() {
    let map = DistanceMap::from_cube(16, 64, &room(64, 1.0), 100.0).unwrap();
    for i in 0..1000 {
        let a = f64::from(i);
        let d = dvec3((a * 0.7).sin(), (a * 1.3).cos(), (a * 2.1).sin());
        let to_wall = d / d.abs().max_element();
        // Near edges of the room what is seen is a little less certain.
        assert!(map.visibility(to_wall * 0.8) > 0.9, "{d}: {}", map.visibility(to_wall * 0.8));
        assert!(map.visibility(to_wall * 1.6) < 0.05, "{d}: {}", map.visibility(to_wall * 1.6));
    }
    assert_eq!(map.visibility(DVec3::ZERO), 1.0);
}

#[test]
fn light_does_not_pass_through_a_wall() {
    // A bright probe at −1 and a dark one at 1; each sees half a unit far, to the wall at 0 that is a unit thick.
    let positions = [dvec3(-1.0, 0.0, 0.0), dvec3(1.0, 0.0, 0.0)];
    let field = Field::new(&positions, &constant(&[1.0, 0.0])).unwrap();
    let dark = dvec3(0.6, 0.0, 0.0);
    let through = field.light(dark, &mut Hint::default()).unwrap().at(Vec3::Y).x;
    assert!((through - 0.2 * std::f32::consts::PI).abs() < 1e-5, "{through}");
    let map = DistanceMap::from_cube(16, 32, &room(32, 0.5), 100.0).unwrap();
    let field = field.with_distances(vec![map.clone(), map]).unwrap();
    let behind = field.light(dark, &mut Hint::default()).unwrap().at(Vec3::Y).x;
    assert!(behind < 0.01 * through, "{behind}");
}

#[test]
fn moving_objects_are_lit_as_still_ones() {
    let positions = place::grid(DVec3::ZERO, DVec3::ONE, [4, 4, 4]);
    let values: Vec<f64> = positions.iter().map(|p| p.x + 2.0 * p.y).collect();
    let field = Field::new(&positions, &constant(&values)).unwrap();
    let mut objects: Vec<LitObject> =
        place::random(DVec3::splat(-0.2), DVec3::splat(1.2), 500, 5).into_iter().map(LitObject::at).collect();
    for _ in 0..2 {
        field.light_objects(&mut objects).unwrap();
        for object in &objects {
            let still = field.irradiance(object.position, Vec3::ZERO, Vec3::Z, &mut Hint::default()).unwrap();
            assert!((object.light.at(Vec3::Z) - still).abs().max_element() < 1e-5);
        }
        objects.iter_mut().for_each(|o| o.position += dvec3(0.01, 0.02, -0.01));
    }
}

#[test]
fn grids_fill_their_box() {
    let grid = place::grid(DVec3::ZERO, dvec3(12.0, 6.0, 6.0), [12, 6, 1]);
    assert_eq!(grid.len(), 72);
    assert!(
        grid.iter().all(|p| p.cmpgt(DVec3::ZERO).all() && p.cmplt(dvec3(12.0, 6.0, 6.0)).all() && p.z == 3.0)
    );
    assert_eq!(place::random(DVec3::ZERO, DVec3::ONE, 5, 1), place::random(DVec3::ZERO, DVec3::ONE, 5, 1));
}

/// Candidates on a grid in light that changes quickly about one place only.
fn spotted() -> (Vec<DVec3>, Vec<Sh>) {
    let positions = place::grid(DVec3::ZERO, dvec3(4.0, 2.0, 2.0), [16, 6, 6]);
    let values: Vec<f64> =
        positions.iter().map(|p| 1.0 + 5.0 * (-4.0 * p.distance_squared(DVec3::ONE)).exp()).collect();
    (positions, constant(&values))
}

#[test]
fn adaptive_probes_gather_where_light_changes_and_beat_a_grid() {
    let (positions, radiance) = spotted();
    let candidates = place::Candidates::new(&positions, &radiance);
    let options = place::AdaptiveOptions::DEFAULT.with_max_count(60).with_balance(0.0);
    let chosen = place::adaptive(candidates, &options).unwrap();
    assert_eq!(chosen.chosen.len(), 60);
    let near = chosen.chosen.iter().filter(|&&i| positions[i as usize].distance(DVec3::ONE) < 1.2).count();
    assert!(near > 30, "{near} of 60 are near the spot");

    // A grid of the same candidates, every other one along each axis: 72 probes.
    let on_grid: Vec<usize> =
        (0..positions.len()).filter(|i| i % 2 == 0 && i / 16 % 3 == 0 && i / 96 % 2 == 0).collect();
    let pick = |list: &[usize]| -> (Vec<DVec3>, Vec<Sh>) {
        list.iter().map(|&i| (positions[i], radiance[i].clone())).unzip()
    };
    let rms = |list: &[usize]| {
        let (at, light) = pick(list);
        let field = Field::new(&at, &light).unwrap();
        let one = |i: usize| {
            let mixed = field.light(positions[i], &mut Hint::default()).unwrap().at(Vec3::Y).x;
            f64::from(mixed - radiance[i].irradiance(DVec3::Y).x as f32).powi(2)
        };
        ((0..positions.len()).map(one).sum::<f64>() / positions.len() as f64).sqrt()
    };
    let ours: Vec<usize> = chosen.chosen.iter().map(|&i| i as usize).collect();
    assert!(rms(&ours) < 0.5 * rms(&on_grid), "{} against {}", rms(&ours), rms(&on_grid));
}

#[test]
fn adaptive_placement_stops_at_the_error_asked_for_and_says_what_it_reached() {
    let (positions, radiance) = spotted();
    let candidates = place::Candidates::new(&positions, &radiance);
    let options = place::AdaptiveOptions::DEFAULT.with_max_count(positions.len()).with_max_error(0.05);
    let chosen = place::adaptive(candidates, &options).unwrap();
    assert!(
        chosen.error <= 0.05 && chosen.chosen.len() < 300,
        "{} probes, {}",
        chosen.chosen.len(),
        chosen.error
    );
    assert!(chosen.errors[0].0 == positions.len() && chosen.errors[0].1 < 1e-15);
    let one = place::adaptive(candidates, &place::AdaptiveOptions::DEFAULT.with_max_count(1)).unwrap();
    assert_eq!(one.chosen.len(), 1);
    assert!(matches!(Delaunay::new(&positions[..1]).unwrap().partition(), Partition::Point(0)));
}

/// The mean squared difference between what candidates saw and what probes with this light give them.
fn squared_error(positions: &[DVec3], radiance: &[Sh], chosen: &[u32], held: &[Sh]) -> f64 {
    let at: Vec<DVec3> = chosen.iter().map(|&i| positions[i as usize]).collect();
    let field = Field::new(&at, held).unwrap();
    let one = |(p, saw): (&DVec3, &Sh)| {
        let mut sum = Sh::constant(DVec3::ZERO, saw.order()).unwrap();
        for (probe, share) in field.shares(*p, &mut Hint::default()).unwrap() {
            sum = sum.plus(&held[probe as usize].scaled(share)).unwrap();
        }
        let rest = sum.plus(&saw.scaled(-1.0)).unwrap();
        rest.coefficients().iter().map(|c| c.length_squared()).sum::<f64>()
    };
    positions.iter().zip(radiance).map(one).sum::<f64>() / positions.len() as f64
}

#[test]
fn fitted_probes_are_a_minimum_of_the_error() {
    let (positions, radiance) = spotted();
    let candidates = place::Candidates::new(&positions, &radiance);
    // Every other place along each axis: none on top of the spot.
    let chosen: Vec<u32> =
        (0..positions.len() as u32).filter(|i| i % 2 == 0 && i / 16 % 3 == 0 && i / 96 % 2 == 0).collect();
    let options = place::FitOptions::DEFAULT.with_balance(0.0).with_hold(0.0);
    let fitted = place::fit(candidates, &chosen, &options).unwrap();
    let saw: Vec<Sh> = chosen.iter().map(|&i| radiance[i as usize].clone()).collect();
    let error = |held: &[Sh]| squared_error(&positions, &radiance, &chosen, held);
    let best = error(&fitted);
    assert!(best < 0.8 * error(&saw), "{best} against {}", error(&saw));
    for probe in [0, 7, 39] {
        for change in [1e-3, -1e-3] {
            let mut other = fitted.clone();
            other[probe] = other[probe].plus(&Sh::constant(DVec3::splat(change), 2).unwrap()).unwrap();
            assert!(error(&other) > best, "probe {probe} by {change}");
        }
    }
    let held = place::fit(candidates, &chosen, &options.with_hold(1e9)).unwrap();
    let moved = held.iter().zip(&saw).map(|(a, b)| (a.coefficients()[0] - b.coefficients()[0]).length());
    assert!(moved.fold(0.0, f64::max) < 1e-6);
    assert_eq!(
        place::fit(candidates, &[3, 700], &options).unwrap_err(),
        ProbeError::NoSuchProbe { index: 700 }
    );
}

/// Places close behind walls took the light of the room from the probes in it: by their maps these seem to see them.
#[test]
fn places_behind_thin_walls_do_not_darken_the_room() {
    let inside = place::grid(DVec3::splat(-0.6), DVec3::splat(0.6), [3, 3, 3]);
    // From just outside of a wall, half of all directions meet it, and the others nothing.
    let behind: Vec<DVec3> =
        [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|way| [way * 1.01, -way * 1.01]).collect();
    let map = |p: &DVec3| {
        let distance = |(face, x, y): (usize, usize, usize)| {
            let [s, t] = [x, y].map(|i| f64::from(2 * i as u32 + 1) / 32.0 - 1.0);
            let way = cube_direction(CubePoint { face, s, t });
            let to_wall = |axis: usize| {
                let walls = [-1.0, 1.0].map(|wall| (wall - p[axis]) / way[axis]);
                let is_on = |t: &f64| *t > 0.0 && (*p + way * *t).abs().max_element() < 1.0 + 1e-9;
                walls.into_iter().filter(is_on).fold(f64::INFINITY, f64::min)
            };
            (0..3).map(to_wall).fold(f64::INFINITY, f64::min) as f32
        };
        let texels = (0..6).flat_map(|face| (0..32 * 32).map(move |i| (face, i % 32, i / 32)));
        DistanceMap::from_cube(16, 32, &texels.map(distance).collect::<Vec<_>>(), 100.0).unwrap()
    };
    let positions: Vec<DVec3> = inside.iter().chain(&behind).copied().collect();
    let values: Vec<f64> = positions.iter().map(|p| f64::from(p.abs().max_element() < 1.0)).collect();
    let (radiance, maps) = (constant(&values), positions.iter().map(map).collect::<Vec<_>>());
    let mut candidates = place::Candidates::new(&positions, &radiance);
    candidates.distances = Some(&maps);
    let chosen: Vec<u32> = (0..27).collect();
    let fitted = place::fit(candidates, &chosen, &place::FitOptions::DEFAULT).unwrap();
    for (probe, sh) in fitted.iter().enumerate() {
        let light = sh.coefficients()[0] / radiance[0].coefficients()[0];
        assert!((light - 1.0).abs().max_element() < 0.02, "probe {probe}: {light}");
    }
}

#[test]
fn fitting_keeps_what_is_right_already() {
    let positions = place::grid(DVec3::ZERO, DVec3::ONE, [5, 5, 5]);
    let values: Vec<f64> = positions.iter().map(|p| 1.0 + p.x + 2.0 * p.y - 0.5 * p.z).collect();
    let radiance = constant(&values);
    let candidates = place::Candidates::new(&positions, &radiance);
    // The corners of the grid: light is linear between them.
    let corners: Vec<u32> = (0..8).map(|i| 4 * (i & 1) + 20 * (i >> 1 & 1) + 100 * (i >> 2)).collect();
    let fitted = place::fit(candidates, &corners, &place::FitOptions::DEFAULT).unwrap();
    for (&i, sh) in corners.iter().zip(&fitted) {
        let change = sh.coefficients()[0] - radiance[i as usize].coefficients()[0];
        assert!(change.length() < 1e-12, "probe {i}: {change}");
    }
}

/// Bit for bit, at places in and about the probes.
fn assert_same_light(a: &Field, b: &Field) {
    let at = |i: u32| {
        let t = f64::from(i);
        dvec3((t * 0.7).sin(), (t * 1.3).cos(), (t * 2.1).sin()) * 1.2
    };
    fields_are_equal(a, b, &(0..200).map(at).collect::<Vec<_>>()).unwrap();
}

/// Probes of a small room, with distances.
fn probes() -> (Vec<DVec3>, Vec<Sh>, Vec<DistanceMap>) {
    let positions = place::random(DVec3::splat(-1.0), DVec3::ONE, 24, 5);
    let values: Vec<f64> = positions.iter().map(|p| 2.0 + p.x).collect();
    let map = |i: usize| DistanceMap::from_cube(8, 16, &room(16, 0.5 + 0.1 * i as f32), 100.0).unwrap();
    (positions, constant(&values), (0..24).map(map).collect())
}

#[test]
fn a_field_that_is_changed_is_the_one_made_of_the_result() {
    let (positions, radiance, maps) = probes();
    let whole = Field::new(&positions, &radiance).unwrap().with_distances(maps.clone()).unwrap();
    let first = Field::new(&positions[..20], &radiance[..20]).unwrap();
    let mut grown = first.with_distances(maps[..20].to_vec()).unwrap();
    assert_eq!(grown.insert(&positions[20..], &radiance[20..], maps[20..].to_vec()), Ok(20..24));
    assert_same_light(&grown, &whole);

    let left = grown.remove(&[3, 7, 7]).unwrap();
    assert_eq!(left, (0..24).filter(|i| ![3, 7].contains(i)).collect::<Vec<u32>>());
    let pick = |i: &u32| *i as usize;
    let rest = Field::new(
        &left.iter().map(|i| positions[pick(i)]).collect::<Vec<_>>(),
        &left.iter().map(|i| radiance[pick(i)].clone()).collect::<Vec<_>>(),
    );
    let rest = rest.unwrap().with_distances(left.iter().map(|i| maps[pick(i)].clone()).collect()).unwrap();
    assert_same_light(&grown, &rest);

    let mut other = Field::new(&positions, &radiance.iter().rev().cloned().collect::<Vec<_>>()).unwrap();
    let swapped: Vec<DistanceMap> = maps.iter().rev().cloned().collect();
    other = other.with_distances(swapped).unwrap();
    for (i, (sh, map)) in radiance.iter().zip(&maps).enumerate() {
        other.set_radiance(i as u32, sh).unwrap();
        other.set_distances(i as u32, map.clone()).unwrap();
    }
    assert_same_light(&other, &whole);
    let known = Field::from_parts(&positions, whole.partition().clone(), &radiance).unwrap();
    assert_same_light(&known.with_distances(maps).unwrap(), &whole);
}

#[test]
fn changes_that_do_not_fit_are_refused_and_change_nothing() {
    let (positions, radiance, maps) = probes();
    let plain = Field::new(&positions, &radiance).unwrap();
    let mut field = plain.clone();
    assert_eq!(field.set_radiance(24, &radiance[0]), Err(ProbeError::NoSuchProbe { index: 24 }));
    let coarse = Sh::constant(DVec3::ONE, 1).unwrap();
    let mixed = |index| Err(ProbeError::MixedOrders { index, order: 1, expected: 2 });
    assert_eq!(field.set_radiance(3, &coarse), mixed(3));
    assert_eq!(field.set_distances(0, maps[0].clone()), Err(ProbeError::NoDistances));
    let at = [DVec3::ONE];
    assert_eq!(field.insert(&at, &[coarse], vec![]), mixed(24).map(|()| 0..0));
    let counts = Err(ProbeError::CountMismatch { probes: 0, given: 1 });
    assert_eq!(field.insert(&at, &radiance[..1], maps[..1].to_vec()), counts);
    let infinite = [DVec3::INFINITY];
    let refused = field.insert(&infinite, &radiance[..1], vec![]);
    assert_eq!(refused, Err(ProbeError::PositionNotFinite { index: 24 }));
    assert_eq!(field.remove(&[1, 99]), Err(ProbeError::NoSuchProbe { index: 99 }));
    assert_eq!(field.remove(&(0..24).collect::<Vec<_>>()), Err(ProbeError::NoProbes));
    assert_same_light(&field, &plain);

    let beyond = Partition::Point(24);
    assert!(matches!(Field::from_parts(&positions, beyond, &radiance), Err(ProbeError::Cells(_))));
}

/// Light beyond single precision was infinite, and distances between far probes were NaN.
#[test]
fn what_no_light_can_be_computed_of_is_refused() {
    let positions = [DVec3::ZERO, DVec3::X];
    for bad in [1e31, -1e31, 1e300] {
        let refused = Field::new(&positions, &constant(&[1.0, bad])).err();
        assert_eq!(refused, Some(ProbeError::BadRadiance { index: 1 }), "{bad:e}");
    }
    let nan = constant(&[1.0])[0].scaled(f64::NAN);
    let mut field = Field::new(&positions, &constant(&[1.0, 2.0])).unwrap();
    assert_eq!(field.set_radiance(1, &nan), Err(ProbeError::BadRadiance { index: 1 }));
    assert_eq!(field.insert(&[DVec3::Y], &[nan], vec![]), Err(ProbeError::BadRadiance { index: 2 }));
    let far = [DVec3::ZERO, dvec3(0.0, -1e151, 0.0)];
    assert_eq!(Field::new(&far, &constant(&[1.0, 1.0])).err(), Some(ProbeError::PositionTooFar { index: 1 }));
    assert_eq!(
        field.insert(&far, &constant(&[1.0, 1.0]), vec![]),
        Err(ProbeError::PositionTooFar { index: 3 })
    );
    assert_eq!(field.probe_count(), 2);
    let mut hint = Hint::default();
    let normal = field.irradiance(DVec3::ZERO, Vec3::Y, Vec3::NAN, &mut hint);
    assert_eq!(normal, Err(ProbeError::QueryNotFinite { index: 0 }));
    assert!(matches!(field.clone().with_bias(f64::NAN), Err(ProbeError::BadOption { name: "bias", .. })));
    assert_eq!(field.with_bias(0.5).unwrap().bias(), 0.5);
}

/// Sizes overflowed, and a `far` that is NaN or negative made maps without any walls.
#[test]
fn maps_that_cannot_be_are_refused() {
    let limit = DistanceMap::MAX_SIZE;
    for size in [0, limit + 1, usize::MAX] {
        let wrong = Some(ProbeError::MapSize { size, limit });
        assert_eq!(DistanceMap::new(size, &[]).err(), wrong);
        assert_eq!(DistanceMap::from_cube(size, 1, &[1.0; 6], 9.0).err(), wrong);
        assert_eq!(DistanceMap::from_cube(4, size, &[1.0; 6], 9.0).err(), wrong);
    }
    for far in [f32::NAN, 0.0, -4.0, f32::INFINITY, 1e20] {
        let refused = DistanceMap::from_cube(2, 1, &[f32::INFINITY; 6], far).err();
        assert!(matches!(refused, Some(ProbeError::BadOption { name: "far", .. })), "{far}");
    }
    let farthest = DistanceMap::from_cube(2, 1, &[f32::INFINITY; 6], DistanceMap::FARTHEST).unwrap();
    assert!(farthest.nodes().iter().flatten().all(|n| n.is_finite()));
}

/// With weights and options that were NaN one probe was chosen, with an error of 0.
#[test]
fn placement_refuses_weights_and_options_that_are_no_numbers() {
    let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let radiance = constant(&[1.0, 2.0, 3.0, 4.0]);
    let known = place::Candidates::new(&positions, &radiance);
    let options = place::AdaptiveOptions::DEFAULT;
    for (weights, index) in [
        ([1.0, f64::NAN, 1.0, 1.0], 1),
        ([1.0, 1.0, -1.0, 1.0], 2),
        ([1.0, 1.0, 1.0, f64::INFINITY], 3),
        ([0.0; 4], 0),
    ] {
        let refused = place::adaptive(known.with_weights(&weights), &options).err();
        assert!(matches!(refused, Some(ProbeError::BadWeight { index: i, .. }) if i == index), "{refused:?}");
    }
    for bad in [f64::NAN, -1.0, f64::INFINITY] {
        for refused in [
            place::adaptive(known, &options.with_balance(bad)).map(|_| ()),
            place::adaptive(known, &options.with_max_error(bad)).map(|_| ()),
            place::fit(known, &[0, 1], &place::FitOptions::DEFAULT.with_hold(bad)).map(|_| ()),
        ] {
            assert!(matches!(refused, Err(ProbeError::BadOption { .. })), "{bad}: {refused:?}");
        }
    }
}

/// The first candidate was taken again and again, because its distance to the others was NaN.
#[test]
fn candidates_that_are_not_finite_are_never_taken() {
    let candidates = [DVec3::NAN, DVec3::ONE, DVec3::INFINITY, DVec3::ZERO];
    let mut chosen = place::spread(&candidates, 4);
    chosen.sort_unstable();
    assert_eq!(chosen, [1, 3]);
    assert!(place::spread(&candidates[..1], 4).is_empty());
}

/// The first 64 probes of a box lit a position in the order in which they were given: light jumped where another box
/// began, and where the sum of what a cell saw fell below a quarter.
#[test]
fn light_does_not_jump_among_a_thousand_probes_in_a_small_box() {
    let positions = place::random(DVec3::ZERO, DVec3::splat(0.1), 1000, 9);
    let values: Vec<f64> = (0..1000).map(|i| f64::from(i % 7)).collect();
    let map = |i: usize| DistanceMap::from_cube(8, 16, &room(16, 0.01 + 1e-4 * i as f32), 100.0).unwrap();
    let field = Field::new(&positions, &constant(&values)).unwrap();
    let field = field.with_distances((0..1000).map(map).collect()).unwrap();
    let ends = place::random(DVec3::splat(-0.05), DVec3::splat(0.15), 60, 4);
    at_most_so_many_probes_light_a_position(&field, &ends).unwrap();
    for (i, way) in ends.windows(2).enumerate() {
        let normals = if i % 2 == 0 { [Vec3::ZERO; 2] } else { [Vec3::X, Vec3::Y] };
        shares_do_not_jump(&field, (way[0], normals[0]), (way[1], normals[1])).unwrap();
    }
}

/// Found by fuzzing: a probe in a plane by which it is hidden on one side sees nothing within a millimetre and all on the other side, however far it is off.
#[test]
fn steep_is_no_jump_however_far_probes_are_apart() {
    let far = 2.0_f64.powi(118);
    let positions = [DVec3::NEG_X, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * far);
    let map = |plane| DistanceMap::new(1, &[[1e-30, 0.0]; 4]).unwrap().with_planes(&[plane; 4]).unwrap();
    let field = Field::new(&positions, &constant(&[1.0, 2.0, 3.0, 4.0])).unwrap();
    let below = [0.0, -1e10, -1e-10];
    let field = field.with_distances([below, [0.0; 3], [0.0; 3], [0.0; 3]].map(map).to_vec()).unwrap();
    for normals in [[Vec3::Y, Vec3::X], [Vec3::ZERO; 2]] {
        // The second way begins where one double is farther from the next than the change is wide.
        for x in [6.5e17, 0.5 * far] {
            let [from, to] = [-0.003, far].map(|y| dvec3(x, y, 0.0));
            shares_do_not_jump(&field, (from, normals[0]), (to, normals[1])).unwrap();
            shares_do_not_jump(&field, (from - far * 0.1, normals[0]), (to, normals[1])).unwrap();
        }
    }
}

/// Through the middles of faces of cells, with and without distances.
#[test]
fn light_does_not_jump_at_faces_of_cells() {
    let positions = place::grid(DVec3::ZERO, dvec3(4.0, 2.0, 2.0), [6, 4, 4]);
    let values: Vec<f64> = positions.iter().map(|p| if p.x > 2.0 { 0.0 } else { 5.0 }).collect();
    let blind = Field::new(&positions, &constant(&values)).unwrap();
    let map = DistanceMap::from_cube(16, 32, &room(32, 0.5), 100.0).unwrap();
    let seeing = blind.clone().with_distances(vec![map; positions.len()]).unwrap();
    let Partition::Tetrahedra(cells) = blind.partition() else { panic!("a grid has tetrahedra") };
    for corners in cells.corners.iter().step_by(5) {
        let [a, b, c, d] = corners.map(|i| positions[i as usize]);
        let (middle, away) = ((a + b + c) / 3.0, d - (a + b + c) / 3.0);
        for field in [&blind, &seeing] {
            for normal in [Vec3::ZERO, Vec3::Z] {
                shares_do_not_jump(field, (middle - away * 1e-3, normal), (middle + away * 1e-3, normal))
                    .unwrap();
                let light = |p: DVec3| field.irradiance(p, normal, Vec3::Y, &mut Hint::default()).unwrap().x;
                let jump = (light(middle + away * 1e-7) - light(middle - away * 1e-7)).abs();
                assert!(jump < 1e-4, "{jump} at {middle}");
            }
        }
    }
}

/// A wall between a bright and a dark room lit its dark face from both.
#[test]
fn probes_behind_a_surface_do_not_light_it() {
    // Probes at both sides of a thin wall at x = 0, which their maps are too coarse to show.
    let side = |x: f64| place::grid(dvec3(x - 0.4, -1.0, -1.0), dvec3(x + 0.4, 1.0, 1.0), [2, 4, 4]);
    let positions = [side(-0.6), side(0.6)].concat();
    let values: Vec<f64> = positions.iter().map(|p| if p.x < 0.0 { 100.0 } else { 1.0 }).collect();
    let blind = Field::new(&positions, &constant(&values)).unwrap();
    let far = DistanceMap::open(9.0).unwrap();
    let seeing = blind.clone().with_distances(vec![far; positions.len()]).unwrap();
    for p in place::random(dvec3(0.0, -0.9, -0.9), dvec3(0.0, 0.9, 0.9), 50, 2) {
        for field in [&blind, &seeing] {
            let dark = field.irradiance(p, Vec3::X, Vec3::X, &mut Hint::default()).unwrap().x;
            let bright = field.irradiance(p, Vec3::NEG_X, Vec3::NEG_X, &mut Hint::default()).unwrap().x;
            let pi = std::f32::consts::PI;
            assert!((dark / pi - 1.0).abs() < 0.02, "{dark} at {p}");
            assert!((bright / pi - 100.0).abs() < 2.0, "{bright} at {p}");
        }
    }
}

/// A probe close to a wall lit a disc of it: by the cosine of its way to the wall it faded out a few times its distance from the wall away, and probes farther off took over
/// within that, as scallops.
#[test]
fn a_probe_close_to_a_wall_is_in_front_of_all_of_it() {
    let far = place::grid(dvec3(-1.0, 1.0, -1.0), dvec3(1.0, 2.0, 1.0), [3, 2, 3]);
    let positions = [vec![dvec3(0.0, 0.05, 0.0)], far].concat();
    let field = Field::new(&positions, &constant(&vec![1.0; positions.len()])).unwrap();
    let field = field.with_distances(vec![DistanceMap::open(9.0).unwrap(); positions.len()]).unwrap();
    for x in [0.0, 0.1, 0.3, 0.6, 1.0, 1.5] {
        let at = dvec3(x, 0.0, 0.2);
        let on_the_wall = field.surface_shares(at, Vec3::Y, &mut Hint::default()).unwrap();
        assert_eq!(on_the_wall, field.shares(at, &mut Hint::default()).unwrap(), "at {x}");
        assert!(on_the_wall.iter().any(|s| s.0 == 0), "at {x}");
    }
    // Behind it and in its plane it gives nothing.
    for height in [0.05, 0.2] {
        let shares = field.surface_shares(dvec3(0.3, height, 0.2), Vec3::Y, &mut Hint::default()).unwrap();
        assert!(shares.iter().all(|s| s.0 != 0 || s.1 < 1e-4), "{height}: {shares:?}");
    }
}

/// On a surface all whose probes are behind it, the nearest give light: it is never black.
#[test]
fn a_surface_without_probes_in_front_is_lit_by_the_nearest() {
    let positions = place::grid(DVec3::ZERO, DVec3::ONE, [3, 3, 3]);
    let field = Field::new(&positions, &constant(&[2.0; 27])).unwrap();
    let map = DistanceMap::from_cube(8, 16, &room(16, 5.0), 100.0).unwrap();
    for field in [field.clone(), field.with_distances(vec![map; 27]).unwrap()] {
        let above = field.irradiance(dvec3(0.5, 3.0, 0.5), Vec3::Y, Vec3::Y, &mut Hint::default()).unwrap().x;
        assert!((above - 2.0 * std::f32::consts::PI).abs() < 1e-4, "{above}");
    }
}

/// The lift off a surface passed a board that hangs 15 cm above a floor, for probes at a distance of 1.
#[test]
fn the_bias_does_not_jump_over_a_near_surface() {
    // Everything below −0.85 is hidden from the bright probe; the floor is at −1, and a dark probe lies under the board.
    let below = |y: f32| if y < 0.0 { 0.85 / -y } else { f32::INFINITY };
    let unit = |i: usize| (2 * i + 1) as f32 / 32.0 - 1.0;
    let mut cube = vec![];
    for face in 0..6 {
        for texel in 0..32 * 32 {
            let point = pointillist_shprobe::sh::CubePoint {
                face,
                s: unit(texel % 32).into(),
                t: unit(texel / 32).into(),
            };
            cube.push(below(pointillist_shprobe::sh::cube_direction(point).normalize().y as f32));
        }
    }
    let map = DistanceMap::from_cube(16, 32, &cube, 100.0).unwrap();
    let under = DistanceMap::from_cube(16, 32, &room(32, 5.0), 100.0).unwrap();
    let positions = [DVec3::ZERO, dvec3(0.6, -0.98, 0.0)];
    let field =
        Field::new(&positions, &constant(&[50.0, 1.0])).unwrap().with_distances(vec![map, under]).unwrap();
    let field = field.with_bias(0.2).unwrap();
    let floor = field.irradiance(dvec3(0.0, -1.0, 0.0), Vec3::Y, Vec3::Y, &mut Hint::default()).unwrap().x;
    assert!(floor < 10.0 * std::f32::consts::PI, "{floor}");
    assert!(matches!(field.with_bias(-0.1), Err(ProbeError::BadOption { name: "bias", .. })));
}

/// Fitting to surfaces lowers their error, and places on surfaces are never probes.
#[test]
fn places_on_surfaces_are_fitted_and_never_chosen() {
    let (mut positions, mut radiance) = spotted();
    let free = positions.len();
    // A floor in other light than there is just above it: from the side, as if by an edge.
    let floor = place::grid(dvec3(0.0, 0.0, 0.0), dvec3(4.0, 0.0, 2.0), [12, 1, 6]);
    let dim = Sh::new((0..9).map(|k| DVec3::splat(if k == 0 { 2.0 } else { 0.1 })).collect()).unwrap();
    radiance.extend(floor.iter().map(|_| dim.clone()));
    positions.extend(&floor);
    let normals: Vec<DVec3> =
        (0..positions.len()).map(|i| if i < free { DVec3::ZERO } else { DVec3::Y }).collect();
    let map = DistanceMap::from_cube(8, 16, &room(16, 9.0), 100.0).unwrap();
    let maps = vec![map; positions.len()];
    let counts: Vec<f64> = normals.iter().map(|n| if *n == DVec3::ZERO { 1.0 } else { 50.0 }).collect();
    let options = place::AdaptiveOptions::DEFAULT.with_max_count(40);
    let fit = place::FitOptions::DEFAULT;
    for known in [
        place::Candidates::new(&positions, &radiance).with_normals(&normals).with_weights(&counts),
        place::Candidates::new(&positions, &radiance)
            .with_normals(&normals)
            .with_weights(&counts)
            .with_distances(&maps),
    ] {
        let chosen = place::adaptive(known, &options).unwrap().chosen;
        assert!(chosen.len() == 40 && chosen.iter().all(|&i| (i as usize) < free));
        let at: Vec<DVec3> = chosen.iter().map(|&i| positions[i as usize]).collect();
        let error = |held: &[Sh]| {
            let mut field = Field::new(&at, held).unwrap();
            if known.distances.is_some() {
                field = field.with_distances(maps[..40].to_vec()).unwrap();
            }
            let truth = dim.irradiance(DVec3::Y).x;
            let one = |p: &DVec3| {
                let light = field.irradiance(*p, Vec3::Y, Vec3::Y, &mut Hint::default()).unwrap().x;
                (f64::from(light) - truth).powi(2)
            };
            floor.iter().map(one).sum::<f64>()
        };
        let saw: Vec<Sh> = chosen.iter().map(|&i| radiance[i as usize].clone()).collect();
        let fitted = place::fit(known, &chosen, &fit).unwrap();
        assert!(error(&fitted) < 0.5 * error(&saw), "{} against {}", error(&fitted), error(&saw));
    }
    let wrong = place::Candidates::new(&positions, &radiance).with_normals(&normals[1..]);
    assert!(matches!(place::adaptive(wrong, &options), Err(ProbeError::CountMismatch { .. })));
    let nowhere = vec![DVec3::Y; positions.len()];
    let none = place::Candidates::new(&positions, &radiance).with_normals(&nowhere);
    assert_eq!(place::adaptive(none, &options).err(), Some(ProbeError::NoProbes));
}

/// What is seen from `p` in two rooms, with a wall at x = 0 and a doorway about z = 0 in it.
fn two_rooms_from(p: DVec3) -> DistanceMap {
    let size = 32;
    let unit = |i: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    let mut cube = vec![];
    for (face, texel) in (0..6).flat_map(|face| (0..size * size).map(move |t| (face, t))) {
        let point = pointillist_shprobe::sh::CubePoint { face, s: unit(texel % size), t: unit(texel / size) };
        let d = pointillist_shprobe::sh::cube_direction(point).normalize();
        let to_side = [0, 1, 2].map(|k| ([4.0, 1.0, 2.0][k] * d[k].signum() - p[k]) / d[k]);
        let mut far = to_side.into_iter().fold(f64::INFINITY, f64::min);
        let to_wall = -p.x / d.x;
        if to_wall > 0.0 && (p.z + d.z * to_wall).abs() > 0.5 {
            far = far.min(to_wall);
        }
        cube.push(far as f32);
    }
    DistanceMap::from_cube(16, size, &cube, 100.0).unwrap()
}

#[test]
fn openings_are_found_in_the_doorway_and_nowhere_else() {
    let positions = place::grid(dvec3(-4.0, -1.0, -2.0), dvec3(4.0, 1.0, 2.0), [16, 4, 9]);
    let maps: Vec<DistanceMap> = positions.iter().map(|&p| two_rooms_from(p)).collect();
    let scores = place::openings(&positions, &maps).unwrap();
    let about = |p: DVec3| p.x.abs() < 1.6 && p.z.abs() < 1.6;
    let most = |is_near: bool| {
        let of = positions.iter().zip(&scores).filter(|(p, _)| about(**p) == is_near);
        of.map(|(_, s)| *s).fold(0.0, f64::max)
    };
    assert!(most(true) > 0.01 && most(false) < 0.01 * most(true), "{} and {}", most(true), most(false));
    let more = place::near_openings(&positions, &maps, 100, 1).unwrap();
    assert!(more.len() == 100 && more.iter().filter(|p| about(**p)).count() > 80);
    assert!(place::near_openings(&positions, &maps[1..], 9, 1).is_err());
    let open = vec![DistanceMap::open(9.0).unwrap(); positions.len()];
    assert!(place::near_openings(&positions, &open, 100, 1).unwrap().is_empty());
}

/// Distances along a wall change by orders of magnitude within a texel: what was just behind the wall was seen.
#[test]
fn a_probe_close_to_a_wall_does_not_see_through_it_along_the_wall() {
    let height = 0.05;
    let unit = |i: usize| (2 * i + 1) as f64 / 32.0 - 1.0;
    let mut cube = vec![];
    for (face, texel) in (0..6).flat_map(|face| (0..32 * 32).map(move |texel| (face, texel))) {
        let point = pointillist_shprobe::sh::CubePoint { face, s: unit(texel % 32), t: unit(texel / 32) };
        let down = -pointillist_shprobe::sh::cube_direction(point).normalize().y;
        cube.push(if down > 0.0 { (height / down) as f32 } else { f32::INFINITY });
    }
    let map = DistanceMap::from_cube(16, 32, &cube, 100.0).unwrap();
    for i in 0..100 {
        let (sin, cos) = (f64::from(i) * 0.1).sin_cos();
        // Under the wall by twice the probe's height, along it by up to eight times that.
        let reach = 0.1 + 0.003 * f64::from(i);
        let [above, below] = [-0.5 * height, -3.0 * height].map(|y| dvec3(reach * cos, y, reach * sin));
        assert!(map.visibility(above) > 10.0 * map.visibility(below), "{below}: {}", map.visibility(below));
        assert!(map.visibility(below) < 0.1, "{below}: {}", map.visibility(below));
    }
}

/// Distances from `p` in two rooms that are open to the front, with a wall 0.1 thick between them that ends at the front, and a doorway
/// at the back: those of the guide. Returns how far is seen in a direction.
fn open_rooms(p: DVec3, d: DVec3) -> f64 {
    let walls: [(usize, f64, [f64; 4]); 9] = [
        // Axis, where, and low and high of the other two in order.
        (0, -3.0, [0.0, 2.4, -2.0, 2.0]),
        (0, 3.0, [0.0, 2.4, -2.0, 2.0]),
        (1, 0.0, [-3.0, 3.0, -2.0, 2.0]),
        (1, 2.4, [-3.0, 3.0, -2.0, 2.0]),
        (2, -2.0, [-3.0, 3.0, 0.0, 2.4]),
        (0, -0.05, [0.0, 2.4, -1.0, 2.0]),
        (0, 0.05, [0.0, 2.4, -1.0, 2.0]),
        (2, 2.0, [-0.05, 0.05, 0.0, 2.4]),
        (2, -1.0, [-0.05, 0.05, 0.0, 2.4]),
    ];
    let met = |&(axis, at, [a, b, c, e]): &(usize, f64, [f64; 4])| {
        let t = (at - p[axis]) / d[axis];
        let [u, v] = [[1, 2], [0, 2], [0, 1]][axis].map(|k| p[k] + d[k] * t);
        (t > 1e-9 && (a..=b).contains(&u) && (c..=e).contains(&v)).then_some(t)
    };
    walls.iter().filter_map(met).fold(f64::INFINITY, f64::min)
}

/// Triangles of a map with corners on two walls hid what lies along the edge between these: dark specks. What was tolerated for their sake
/// let light past the end of the wall.
#[test]
fn the_edges_of_a_room_are_seen_and_what_is_behind_a_wall_is_not() {
    let size = 32;
    let unit = |i: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    let (mut hidden, mut leaks, mut asked) = (0, 0, 0);
    for p in place::grid(dvec3(-2.7, 0.3, -1.7), dvec3(2.7, 2.1, 1.7), [8, 3, 5]) {
        let texels = (0..6).flat_map(|face| (0..size * size).map(move |texel| (face, texel)));
        let far = texels.map(|(face, texel)| {
            let point =
                pointillist_shprobe::sh::CubePoint { face, s: unit(texel % size), t: unit(texel / size) };
            open_rooms(p, pointillist_shprobe::sh::cube_direction(point).normalize()) as f32
        });
        let map = DistanceMap::from_cube(16, size, &far.collect::<Vec<_>>(), 30.0).unwrap();
        for i in 0..400 {
            // Just in front of the edge between ceiling and back wall, and under the ceiling next to the wall between the rooms.
            let x = -2.95 + 5.9 * f64::from(i) / 399.0;
            let near_wall =
                dvec3(-0.07 - 0.0005 * f64::from(i), 2.399, -0.9 + 2.85 * f64::from(i * 37 % 400) / 400.0);
            for at in [dvec3(x, 2.398, -1.998), near_wall] {
                let offset = at - p;
                if offset.length() > 2.0 {
                    continue;
                }
                let is_free = open_rooms(p, offset.normalize()) > offset.length();
                asked += 1;
                let seen = map.visibility(offset);
                hidden += i32::from(is_free && seen < 0.2);
                leaks += i32::from(!is_free && seen > 0.2);
            }
        }
    }
    // They were 4.7 % and 4.6 %. What is left is next to outlines in the same cell.
    assert!(asked > 15_000 && hidden * 25 < asked && leaks * 100 < asked, "{hidden}, {leaks} of {asked}");
}

/// What lies outside of a room that is open on one side is dark, and no probe is in front of it: probes by the opening, which lit it for want of
/// others, were fitted to it and held no light from there.
#[test]
fn probes_are_not_fitted_to_surfaces_that_none_is_in_front_of() {
    let mut positions = place::grid(DVec3::ZERO, DVec3::ONE, [3, 3, 3]);
    let free = positions.len();
    let light = Sh::constant(DVec3::ONE, 2).unwrap();
    let mut radiance = vec![light.clone(); free];
    // The outer face of a wall, in front of which no probe lies.
    let face = place::grid(dvec3(0.0, 0.0, 1.0), dvec3(1.0, 1.0, 1.0), [6, 6, 1]);
    radiance.extend(face.iter().map(|_| Sh::constant(DVec3::ZERO, 2).unwrap()));
    positions.extend(&face);
    let normals: Vec<DVec3> =
        (0..positions.len()).map(|i| if i < free { DVec3::ZERO } else { DVec3::Z }).collect();
    let map = DistanceMap::open(100.0).unwrap();
    let maps = vec![map; positions.len()];
    let chosen: Vec<u32> = (0..free as u32).collect();
    let plain = place::Candidates::new(&positions, &radiance).with_normals(&normals);
    for known in [plain, plain.with_distances(&maps)] {
        for held in place::fit(known, &chosen, &place::FitOptions::DEFAULT).unwrap() {
            let off = held.irradiance(DVec3::Z) / light.irradiance(DVec3::Z) - 1.0;
            assert!(off.abs().max_element() < 1e-6, "{off}");
        }
    }
}
