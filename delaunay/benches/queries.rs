//! How long questions take among 10 000 random points: weights at positions, the nearest vertex, edges, circumcentres,
//! validity. The error in each name: of interpolating a linear function inside the hull; of distances from centres to
//! corners, over the radius.
//!
//! `cargo bench -p pointillist-delaunay --bench queries`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, dvec3};
use pointillist_delaunay::{Delaunay, Hint, Locator, NearestVertex, Partition};

/// Pseudorandom points in a unit cube.
fn random(count: usize, seed: u64) -> Vec<DVec3> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count).map(|_| dvec3(next(), next(), next())).collect()
}

fn find(c: &mut Criterion) {
    let points = random(10_000, 1);
    let partition = Delaunay::new(&points).expect("points are finite").partition();
    let locator = Locator::new(&points, &partition).expect("cells between these points");
    let nearest = NearestVertex::new(&points, &partition).expect("cells between these points");
    let queries: Vec<DVec3> = random(10_000, 2).iter().map(|q| q * 0.8 + 0.1).collect();
    let error = |q: &DVec3| {
        let blend = locator.locate_anywhere(*q).expect("queries are finite");
        (blend.parts().map(|(p, w)| points[p as usize].x * w).sum::<f64>() - q.x).abs()
    };
    let error = queries.iter().map(error).fold(0.0, f64::max);
    let mut group = c.benchmark_group("find 10000");
    group.bench_function(BenchmarkId::new("weights anywhere", format!("{error:.1e}")), |b| {
        b.iter(|| queries.iter().map(|&q| locator.locate_anywhere(q).map_or(0, |b| b.points[0])).max());
    });
    group.bench_function(BenchmarkId::new("weights along a path", format!("{error:.1e}")), |b| {
        let along = |i: usize| DVec3::splat(0.1).lerp(dvec3(0.9, 0.8, 0.7), i as f64 / 10_000.0);
        b.iter(|| {
            let mut hint = Hint::START;
            (0..10_000).map(|i| locator.locate(along(i), &mut hint).map_or(0, |b| b.points[0])).max()
        });
    });
    group.bench_function("nearest vertex", |b| {
        b.iter(|| queries.iter().map(|&q| nearest.find(q).unwrap_or(0)).max());
    });
    group.finish();
}

/// The largest difference of distances from a centre, over the radius.
fn error_of_centres(points: &[DVec3], partition: &Partition) -> f64 {
    let of = |cell: pointillist_delaunay::Cell<'_>| {
        let centre = cell.circumcentre(points).unwrap_or(DVec3::ZERO);
        let distances = cell.corners().iter().map(|&c| points[c as usize].distance(centre));
        let (least, most) = distances.fold((f64::INFINITY, 0.0_f64), |(l, m), d| (l.min(d), m.max(d)));
        (most - least) / most
    };
    partition.cells().map(of).fold(0.0, f64::max)
}

fn all_cells(c: &mut Criterion) {
    let points = random(10_000, 1);
    let partition = Delaunay::new(&points).expect("points are finite").partition();
    let mut group = c.benchmark_group(format!("{} cells", partition.cell_count()));
    group.sample_size(20);
    let error = format!("{:.1e}", error_of_centres(&points, &partition));
    group.bench_function(BenchmarkId::new("circumcentres", error), |b| {
        b.iter(|| partition.cells().filter_map(|cell| cell.circumcentre(black_box(&points))).sum::<DVec3>());
    });
    group.bench_function("graph", |b| b.iter(|| black_box(&partition).graph(points.len())));
    group.bench_function("hull", |b| b.iter(|| black_box(&partition).hull()));
    group.bench_function("verify", |b| b.iter(|| black_box(&partition).verify(&points)));
    group.finish();
}

criterion_group!(benches, find, all_cells);
criterion_main!(benches);
