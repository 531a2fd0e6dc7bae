//! The facts of `invariants`, for probes at hard positions, with and without distances.

use glam::{DVec3, Vec3, dvec3};
use pointillist_shprobe::sh::{Sh, coefficient_count};
use pointillist_shprobe::{DistanceMap, Field, invariants as facts};
use proptest::collection::vec;
use proptest::prelude::*;
use testkit::holds;
use testkit::points::{lattice_points, point, points, query};

/// A function of order 2.
fn radiance() -> impl Strategy<Value = Sh> {
    let color = [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from);
    vec(color, coefficient_count(2)).prop_map(|c| Sh::new(c).expect("nine coefficients"))
}

/// What a probe sees: from nothing but a wall in front of it to nothing at all, whose texels differ; in half of the cases with planes
/// at some of the nodes that have nothing to do with one another.
fn distances() -> impl Strategy<Value = DistanceMap> {
    let distance = prop_oneof![3 => 0.0..8.0_f32, 1 => Just(f32::INFINITY), 1 => Just(0.0)];
    let plane = prop_oneof![3 => [-4.0..4.0_f32, -4.0..4.0, -4.0..4.0], 1 => Just([0.0; 3])];
    (1..5_usize, vec(distance, 24), vec(plane, 25), any::<bool>()).prop_map(
        |(size, d, planes, has_planes)| {
            let map = DistanceMap::from_cube(size, 2, &d, 100.0).expect("six faces of four");
            let planes = &planes[..(size + 1) * (size + 1)];
            if has_planes { map.with_planes(planes).expect("finite planes") } else { map }
        },
    )
}

/// Probes at lattice points, each with its light and, in half of the cases, what it sees.
fn probes() -> impl Strategy<Value = (Vec<DVec3>, Vec<Sh>, Vec<DistanceMap>)> {
    (lattice_points(), any::<bool>()).prop_flat_map(|(at, sees)| {
        let maps = if sees { at.len() } else { 0 };
        (Just(at.clone()), vec(radiance(), at.len()), vec(distances(), maps))
    })
}

fn field((positions, radiance, maps): &(Vec<DVec3>, Vec<Sh>, Vec<DistanceMap>)) -> Field {
    let field = Field::new(positions, radiance).expect("finite probes");
    if maps.is_empty() { field } else { field.with_distances(maps.clone()).expect("a map for each") }
}

/// A place on a surface or in free space.
fn place() -> impl Strategy<Value = facts::Place> {
    let normal =
        prop_oneof![Just(Vec3::ZERO), Just(Vec3::Y), (-1.0..1.0_f32).prop_map(|x| Vec3::new(x, 0.5, -x))];
    (query(), normal.prop_map(Vec3::normalize_or_zero))
}

proptest! {
    #![proptest_config(testkit::config(128))]

    #[test]
    fn shares_sum_to_one(probes in probes(), queries in vec(query(), 1..12)) {
        holds!(facts::shares_sum_to_one(&field(&probes), &queries));
    }

    #[test]
    fn shares_sum_to_one_between_any_points(positions in points(24), queries in vec(point(), 1..8)) {
        let sh = Sh::constant(DVec3::ONE, 0).expect("a constant");
        if let Ok(field) = Field::new(&positions, &vec![sh; positions.len()]) {
            holds!(facts::shares_sum_to_one(&field, &queries));
            holds!(facts::shares_sum_to_one(&field, &positions));
        }
    }

    #[test]
    fn constant_light_stays_constant(probes in probes(), level in 0.0..9.0_f64, queries in vec(query(), 1..12)) {
        let maps = Some(&probes.2[..]).filter(|maps| !maps.is_empty());
        holds!(facts::constant_light_stays_constant(&probes.0, maps, level, &queries));
    }

    #[test]
    fn hints_do_not_matter(probes in probes(), queries in vec(query(), 1..24)) {
        holds!(facts::hints_do_not_matter(&field(&probes), &queries, 1e-5));
    }

    #[test]
    fn insert_then_remove_restores(probes in probes(), new in vec((query(), radiance(), distances()), 0..6)) {
        let (positions, (radiance, mut maps)): (Vec<_>, (Vec<_>, Vec<_>)) =
            new.into_iter().map(|(p, sh, map)| (p, (sh, map))).unzip();
        if probes.2.is_empty() {
            maps.clear();
        }
        let queries = probes.0.iter().map(|p| *p + dvec3(0.25, -0.5, 0.125)).collect::<Vec<_>>();
        holds!(facts::insert_then_remove_restores(&field(&probes), &positions, &radiance, &maps, &queries));
        let infinite = [DVec3::INFINITY];
        holds!(facts::insert_then_remove_restores(&field(&probes), &infinite, &probes.1[..1], &[], &queries));
    }

    #[test]
    fn changes_give_the_field_of_the_result(
        probes in probes(), gone in vec(0..30_u32, 0..6), queries in vec(query(), 1..12)
    ) {
        let (positions, radiance, maps) = &probes;
        holds!(facts::changes_give_the_field_of_the_result(positions, radiance, maps, &gone, &queries));
    }

    #[test]
    fn visibility_falls_with_distance(map in distances(), offsets in vec(point(), 1..24)) {
        holds!(facts::visibility_falls_with_distance(&map, &offsets));
    }

    #[test]
    fn spread_positions_are_far_apart(candidates in lattice_points(), count in 0..12_usize) {
        holds!(facts::spread_positions_are_far_apart(&candidates, count));
    }

    #[test]
    fn shares_do_not_jump(probes in probes(), from in place(), to in place()) {
        holds!(facts::shares_do_not_jump(&field(&probes), from, to));
    }

    #[test]
    fn at_most_so_many_probes_light_a_position(probes in probes(), queries in vec(query(), 1..12)) {
        holds!(facts::at_most_so_many_probes_light_a_position(&field(&probes), &queries));
    }
}
