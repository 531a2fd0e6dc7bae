//! How long light between probes takes: moving objects and surfaces among 432 and 10 000 random probes of order 2, with
//! and without walls. The error in each name: of a light that is linear in the position, at positions inside the hull,
//! over its largest value.
//!
//! `cargo bench -p pointillist-shprobe --bench field`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use pointillist_shprobe::sh::Sh;
use pointillist_shprobe::{DistanceMap, Field, LitObject, place};

const OBJECTS: usize = 10_000;

/// Radiance 1 + x, the same in all directions.
fn linear_field(probes: usize) -> Field {
    let positions = place::random(DVec3::ZERO, DVec3::ONE, probes, 1);
    let radiance = |p: &DVec3| Sh::constant(DVec3::splat(1.0 + p.x), 2).expect("the order is allowed");
    let radiance: Vec<Sh> = positions.iter().map(radiance).collect();
    Field::new(&positions, &radiance).expect("positions are finite and orders are alike")
}

/// The largest error of the light on these objects, over the largest light.
fn error(objects: &[LitObject]) -> f64 {
    let wrong = |o: &LitObject| {
        let truth = std::f64::consts::PI * (1.0 + o.position.x);
        (f64::from(o.light.at(Vec3::Y).x) - truth).abs()
    };
    objects.iter().map(wrong).fold(0.0, f64::max) / (2.0 * std::f64::consts::PI)
}

fn light(c: &mut Criterion) {
    let mut group = c.benchmark_group("field");
    group.sample_size(20);
    for probes in [432, 10_000] {
        let blind = linear_field(probes);
        // Every probe sees as far as the box is wide.
        let open = DistanceMap::new(16, &[[0.5, 0.0]; 289]).expect("nearness is finite");
        let seeing = blind.clone().with_distances(vec![open; probes]).expect("one map for each probe");
        // The same with a plane at every node that faces it: interpolation takes the largest of three.
        let wall = [[0.3; 3]; 289];
        let walled = DistanceMap::new(16, &[[0.5, 0.0]; 289]).and_then(|map| map.with_planes(&wall));
        let walled = vec![walled.expect("planes are finite"); probes];
        let walled = blind.clone().with_distances(walled).expect("one map for each probe");
        let kinds = [
            ("objects", &blind),
            ("objects and distances", &seeing),
            ("objects, distances and planes", &walled),
        ];
        for (name, field) in kinds {
            let inner = place::random(DVec3::splat(0.2), DVec3::splat(0.8), OBJECTS, 2);
            let mut objects: Vec<LitObject> = inner.iter().map(|&p| LitObject::at(p)).collect();
            field.light_objects(&mut objects).expect("positions are finite");
            let id = BenchmarkId::new(format!("{name}, {probes} probes"), format!("{:.1e}", error(&objects)));
            group.bench_function(id, |b| b.iter(|| field.light_objects(black_box(&mut objects))));
        }
        let queries: Vec<(DVec3, Vec3)> =
            place::random(DVec3::ZERO, DVec3::ONE, OBJECTS, 3).into_iter().map(|p| (p, Vec3::Y)).collect();
        group.bench_function(BenchmarkId::new("surfaces", probes), |b| {
            b.iter(|| blind.irradiance_all(black_box(&queries)));
        });
    }
    group.finish();
}

criterion_group!(benches, light);
criterion_main!(benches);
