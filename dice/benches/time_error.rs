//! How long for how much error: `split`, `accumulate` and `cut` on triangles of 1.5, 12 and 200 cells, near the origin and 10⁷
//! cells away. The error in each name is that of the total area, relative to it.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec2, dvec2};
use pointillist_dice::{Accumulator, CellWindow, Cut, Grid, accumulate, cut, split};

/// A triangle of about `size` cells across with its corners off the lines.
fn triangle(size: f64, offset: f64) -> [DVec2; 3] {
    [dvec2(0.11, 0.23), dvec2(0.97, 0.31), dvec2(0.41, 1.03)].map(|v| v * size + DVec2::splat(offset))
}

/// Sum of areas against the triangle's own, relative to it.
fn error(total: f64, t: &[DVec2; 3]) -> f64 {
    let area = 0.5 * (t[1] - t[0]).perp_dot(t[2] - t[0]).abs();
    (total - area).abs() / area
}

fn time_error(c: &mut Criterion) {
    for offset in [0.0, 1e7] {
        for size in [1.5, 12.0, 200.0] {
            let t = triangle(size, offset);
            let name = format!("{size} cells at {offset:e}");
            let split_area = |t: &[DVec2; 3]| {
                let mut total = 0.0;
                split(t, &Grid::UNIT, |p| total += p.area).expect("the triangle is finite");
                total
            };
            let mut scratch = Accumulator::new();
            let mut accumulated_area = |t: &[DVec2; 3]| {
                let mut total = 0.0;
                accumulate(t, &Grid::UNIT, &mut scratch, |run| total += run.area * run.columns.len() as f64)
                    .expect("the triangle is finite");
                total
            };
            let cut_area = |t: &[DVec2; 3]| {
                let mut total = 0.0;
                cut(t, CellWindow::ALL, |part| match part {
                    Cut::Span { first, end, .. } => total += f64::from(end - first),
                    Cut::Piece { polygon, .. } => total += polygon.area(),
                });
                total
            };
            let label = format!("error {:.1e}", error(cut_area(&t), &t));
            c.benchmark_group("cut")
                .bench_function(BenchmarkId::new(&name, label), |b| b.iter(|| cut_area(black_box(&t))));
            let label = format!("error {:.1e}", error(split_area(&t), &t));
            c.benchmark_group("split")
                .bench_function(BenchmarkId::new(&name, label), |b| b.iter(|| split_area(black_box(&t))));
            let label = format!("error {:.1e}", error(accumulated_area(&t), &t));
            c.benchmark_group("accumulate").bench_function(BenchmarkId::new(&name, label), |b| {
                b.iter(|| accumulated_area(black_box(&t)))
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(1));
    targets = time_error
}
criterion_main!(benches);
