//! How long tetrahedra take: random points and grids of 432, 10 k and 100 k, inserting one more point and taking one
//! out. There is no error to name: results are exact.
//!
//! `cargo bench -p pointillist-delaunay --bench build`

use std::hint::black_box;

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, dvec3};
use pointillist_delaunay::Delaunay;

/// Pseudorandom points in a unit cube.
fn random(count: usize) -> Vec<DVec3> {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count).map(|_| dvec3(next(), next(), next())).collect()
}

/// Points of a grid.
fn grid([nx, ny, nz]: [u32; 3]) -> Vec<DVec3> {
    let all = (0..nx).flat_map(|x| (0..ny).flat_map(move |y| (0..nz).map(move |z| [x, y, z])));
    all.map(|c| DVec3::from_array(c.map(f64::from))).collect()
}

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("delaunay/build");
    group.sample_size(10);
    let grids = [[12, 6, 6], [22, 22, 22], [46, 46, 46]].map(|counts| ("grid", grid(counts)));
    let randoms = [432, 10_000, 100_000].map(|count| ("random", random(count)));
    for (name, points) in randoms.iter().chain(&grids) {
        group.bench_with_input(BenchmarkId::new(*name, points.len()), points, |b, points| {
            b.iter(|| Delaunay::new(black_box(points)).expect("points are finite"));
        });
    }
    group.finish();
}

fn change(c: &mut Criterion) {
    let mut group = c.benchmark_group("delaunay/change");
    for count in [432, 10_000] {
        let built = Delaunay::new(&random(count)).expect("points are finite");
        group.bench_function(BenchmarkId::new("insert", count), |b| {
            let insert = |mut d: Delaunay| {
                d.insert(black_box(dvec3(0.51, 0.52, 0.53))).expect("the point is finite");
                d
            };
            b.iter_batched(|| built.clone(), insert, BatchSize::LargeInput);
        });
        group.bench_function(BenchmarkId::new("remove", count), |b| {
            let remove = |mut d: Delaunay| {
                d.remove(black_box(count as u32 / 2)).expect("the point is there");
                d
            };
            b.iter_batched(|| built.clone(), remove, BatchSize::LargeInput);
        });
    }
    group.finish();
}

criterion_group!(benches, build, change);
criterion_main!(benches);
