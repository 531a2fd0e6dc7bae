//! How long a camera takes to be made and asked: `look_at`, `project`, `unproject` and `ray`, for both projections. The
//! last three are timed over 1024 points or pixel positions; the number in each name is the largest error of
//! `unproject` after `project`, in ulps of the largest coordinate.
//!
//! `cargo bench -p pointillist-view --bench camera`

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, dvec3};
use pointillist_view::{Projected, Projection, View};
use std::hint::black_box;

const EYE: DVec3 = dvec3(3.0, 2.0, 8.0);

const POINTS: usize = 1024;

fn look(projection: Projection) -> View {
    View::look_at(black_box(EYE), DVec3::ZERO, DVec3::Y, projection, 1920, 1080).expect("the view is valid")
}

/// Points of a lattice around the origin, all before the eye.
fn points() -> Vec<DVec3> {
    let coordinate = |i: usize| (i % 16) as f64 / 8.0 - 1.0;
    (0..POINTS).map(|i| dvec3(coordinate(i), coordinate(i / 16), coordinate(i / 64))).collect()
}

/// Largest distance between a point and what `unproject` makes of its place in the picture, ulps of the eye's largest
/// coordinate.
fn error_ulps(view: &View, points: &[DVec3], seen: &[Projected]) -> f64 {
    let error = |(p, s): (&DVec3, &Projected)| (view.unproject(s.pixel, s.depth) - *p).abs().max_element();
    points.iter().zip(seen).map(error).fold(0.0, f64::max) / (f64::EPSILON * EYE.max_element())
}

fn camera(c: &mut Criterion) {
    let kinds = [
        ("perspective", Projection::Perspective { fov_y_rad: 0.7 }),
        ("orthographic", Projection::Orthographic { height: 4.0 }),
    ];
    for (kind, projection) in kinds {
        let (view, points) = (look(projection), points());
        let seen: Vec<Projected> = points.iter().filter_map(|p| view.project(*p)).collect();
        assert_eq!(seen.len(), POINTS, "all points lie before the eye");
        let mut group = c.benchmark_group(kind);
        group.bench_function("look_at", |b| b.iter(|| look(black_box(projection))));
        group.throughput(Throughput::Elements(POINTS as u64));
        group.bench_function("project", |b| {
            b.iter(|| {
                points.iter().for_each(|p| {
                    black_box(view.project(black_box(*p)));
                });
            });
        });
        let error = format!("{:.1} ulps", error_ulps(&view, &points, &seen));
        group.bench_function(BenchmarkId::new("unproject", error), |b| {
            b.iter(|| {
                seen.iter().for_each(|s| {
                    black_box(view.unproject(black_box(s.pixel), s.depth));
                });
            });
        });
        group.bench_function("ray", |b| {
            b.iter(|| {
                seen.iter().for_each(|s| {
                    black_box(view.ray(black_box(s.pixel)));
                });
            });
        });
        group.finish();
    }
}

criterion_group!(benches, camera);
criterion_main!(benches);
