//! Run time against evenness: a sphere sampled by both methods. The error in each name is the standard deviation of the
//! distance to the nearest neighbour, relative to its mean.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, dvec3};
use pointillist_surfel::{Method, SampleOptions, SurfacePoint, sample};
use std::f64::consts::{PI, TAU};
use std::hint::black_box;

const BANDS: u32 = 64;

fn sphere() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let columns = 2 * BANDS;
    let vertex = |r: u32, c: u32| {
        let (s, z) = (PI * f64::from(r) / f64::from(BANDS)).sin_cos();
        let (y, x) = (TAU * f64::from(c) / f64::from(columns)).sin_cos();
        dvec3(s * x, s * y, z)
    };
    let positions = (0..=BANDS).flat_map(|r| (0..columns).map(move |c| vertex(r, c))).collect();
    let at = |r: u32, c: u32| r * columns + c % columns;
    let quads = (0..BANDS).flat_map(|r| (0..columns).map(move |c| (r, c)));
    let of = |(r, c): (u32, u32)| {
        [[at(r, c), at(r + 1, c), at(r + 1, c + 1)], [at(r, c), at(r + 1, c + 1), at(r, c + 1)]]
    };
    (positions, quads.flat_map(of).collect())
}

/// Every tenth point against all is enough for a deviation.
fn unevenness(points: &[SurfacePoint]) -> f64 {
    let nearest = |p: &SurfacePoint| {
        let others = points.iter().filter(|q| q.position != p.position);
        others.map(|q| q.position.distance_squared(p.position)).fold(f64::INFINITY, f64::min).sqrt()
    };
    let distances: Vec<f64> = points.iter().step_by(10).map(nearest).collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    let variance = distances.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / distances.len() as f64;
    variance.sqrt() / mean
}

fn time_error(c: &mut Criterion) {
    let (positions, triangles) = sphere();
    for count in [1_000, 10_000] {
        for method in [Method::Ldi, Method::Poisson] {
            let options = SampleOptions::DEFAULT.with_method(method).with_count(count);
            let points = sample(&positions, &triangles, &options).expect("the mesh is valid");
            let id = BenchmarkId::new(format!("{method:?}"), format!("error {:.2}", unevenness(&points)));
            c.benchmark_group(format!("sphere, {count} points")).bench_function(id, |b| {
                b.iter(|| sample(black_box(&positions), &triangles, &options));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(800));
    targets = time_error
}
criterion_main!(benches);
