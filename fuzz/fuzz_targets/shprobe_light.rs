//! Probes anywhere, with any light, distances and planes: what is not refused has shares that sum to 1, keeps constant light
//! constant, comes back after changes, sees less farther away, and does not jump.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DVec3, Vec3, dvec3};
use libfuzzer_sys::fuzz_target;
use pointillist_shprobe::sh::Sh;
use pointillist_shprobe::{DistanceMap, Field, invariants as facts};

#[derive(Arbitrary, Debug)]
struct Probe {
    /// Sixteenths of it are lattice points: grids, planes, lines and repeats come often.
    position: [i8; 3],
    radiance: [i16; 3],
    /// Nearness and deviation of a map of one cell.
    nodes: [[f32; 2]; 4],
    /// Planes at its nodes, where there are any.
    planes: Option<[[f32; 3]; 4]>,
}

#[derive(Arbitrary, Debug)]
struct Input {
    probes: Vec<Probe>,
    /// Exponent of two that positions are multiplied by.
    power: i8,
    sees: bool,
    level: f32,
    queries: Vec<[f32; 3]>,
    taken_out: Vec<u8>,
}

/// What a probe sees; none if it is refused.
fn map_of(probe: &Probe) -> Option<DistanceMap> {
    let map = DistanceMap::new(1, &probe.nodes).ok()?;
    match &probe.planes {
        Some(planes) => map.with_planes(planes).ok(),
        None => Some(map),
    }
}

fuzz_target!(|input: Input| {
    let probes = &input.probes[..input.probes.len().min(24)];
    let scale = 2.0_f64.powi(input.power.into());
    let at = |p: &Probe| {
        let [x, y, z] = p.position.map(|c| f64::from(c / 16));
        dvec3(x, y, z) * scale
    };
    let positions: Vec<DVec3> = probes.iter().map(at).collect();
    // Halving a way ends at ulps only if it is not far longer than the probes are apart.
    let reach = DVec3::splat(16.0 * scale);
    let constant =
        |p: &Probe| Sh::constant(DVec3::from_array(p.radiance.map(f64::from)), 1).expect("order 1");
    let radiance: Vec<Sh> = probes.iter().map(constant).collect();
    let maps: Vec<DistanceMap> = match input.sees {
        true => probes.iter().filter_map(map_of).collect(),
        false => vec![],
    };
    let queries: Vec<DVec3> =
        input.queries.iter().take(8).map(|q| DVec3::from_array(q.map(f64::from))).collect();
    for map in &maps {
        facts::visibility_falls_with_distance(map, &queries).unwrap();
    }
    facts::spread_positions_are_far_apart(&positions, input.taken_out.len()).unwrap();
    let seen = (!maps.is_empty()).then_some(&maps[..]);
    facts::constant_light_stays_constant(&positions, seen, input.level.into(), &queries).unwrap();
    let gone: Vec<u32> = input.taken_out.iter().map(|&i| i.into()).collect();
    facts::changes_give_the_field_of_the_result(&positions, &radiance, &maps, &gone, &queries).unwrap();
    let Ok(field) = Field::new(&positions, &radiance) else { return };
    let field = match seen {
        Some(maps) => field.clone().with_distances(maps.to_vec()).unwrap_or(field),
        None => field,
    };
    facts::shares_sum_to_one(&field, &queries).unwrap();
    facts::at_most_so_many_probes_light_a_position(&field, &queries).unwrap();
    for way in queries.windows(2) {
        let [from, to] = [way[0], way[1]].map(|p| p.clamp(-reach, reach));
        facts::shares_do_not_jump(&field, (from, Vec3::ZERO), (to, Vec3::ZERO)).unwrap();
        facts::shares_do_not_jump(&field, (from, Vec3::Y), (to, Vec3::X)).unwrap();
    }
    let new = (queries.len()).min(radiance.len());
    let maps = &maps[..if field.distances().is_some() { new } else { 0 }];
    facts::insert_then_remove_restores(&field, &queries[..new], &radiance[..new], maps, &positions).unwrap();
});
