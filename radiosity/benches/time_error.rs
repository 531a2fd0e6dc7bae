//! How long for how much error: form factors of unit squares in the open, apart, touching, and behind an occluder; a point's
//! by hemicubes. The error in each name is relative to the closed form, or to the finest setting.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, dvec3};
use pointillist_radiosity::{FactorOptions, Hemicube, HemicubeKind, Polygon, form_factor};

fn quad(o: DVec3, u: DVec3, v: DVec3) -> Polygon {
    Polygon::new(&[o, o + u, o + u + v, o + v]).expect("a parallelogram")
}

fn pairs(c: &mut Criterion) {
    let floor = quad(DVec3::ZERO, DVec3::X, DVec3::Y);
    let slanted = dvec3(0.3, 0.2, 0.9);
    let pairs = [
        ("parallel", quad(DVec3::Z, DVec3::Y, DVec3::X)),
        ("shared edge", quad(DVec3::ZERO, DVec3::Y, slanted)),
        ("far", quad(DVec3::Z * 20.0, DVec3::Y, dvec3(0.9, 0.1, 0.2))),
    ];
    let finest = FactorOptions::DEFAULT.with_unoccluded(1e-15);
    for (name, other) in &pairs {
        let exact = form_factor(&floor, other, &[], &finest).value;
        for tolerance in [1e-4, 1e-8, 1e-12] {
            let options = FactorOptions::DEFAULT.with_unoccluded(tolerance);
            let error = (form_factor(&floor, other, &[], &options).value / exact - 1.0).abs();
            let id = BenchmarkId::new(format!("{name}, {tolerance:e} asked"), format!("error {error:.1e}"));
            c.benchmark_group("open")
                .bench_function(id, |b| b.iter(|| form_factor(black_box(&floor), other, &[], &options)));
        }
    }
}

fn behind(c: &mut Criterion) {
    let floor = quad(DVec3::ZERO, DVec3::X, DVec3::Y);
    let ceiling = quad(DVec3::Z, DVec3::Y, DVec3::X);
    let between = [quad(dvec3(0.3, 0.3, 0.5), dvec3(0.4, 0.1, 0.0), dvec3(-0.1, 0.4, 0.0))];
    let exact = form_factor(&floor, &ceiling, &between, &FactorOptions::DEFAULT.with_occluded(1e-7)).value;
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
        let options = FactorOptions::DEFAULT.with_occluded(tolerance);
        let error = (form_factor(&floor, &ceiling, &between, &options).value / exact - 1.0).abs();
        let id = BenchmarkId::new(format!("{tolerance:e} asked"), format!("error {error:.1e}"));
        c.benchmark_group("behind")
            .bench_function(id, |b| b.iter(|| form_factor(black_box(&floor), &ceiling, &between, &options)));
    }
}

fn hemicubes(c: &mut Criterion) {
    let square = [quad(dvec3(-0.37, -0.41, 1.0), DVec3::Y * 0.9, DVec3::X * 0.8)];
    let of = |kind, size| Hemicube::new(kind, size).factors(DVec3::ZERO, DVec3::Z, &square)[0];
    let exact = of(HemicubeKind::Exact, 2048);
    for size in [16, 64, 256] {
        for kind in [HemicubeKind::Exact, HemicubeKind::Classic] {
            let error = (of(kind, size) / exact - 1.0).abs();
            let mut hemicube = Hemicube::new(kind, size);
            let id = BenchmarkId::new(format!("{kind:?} {size}"), format!("error {error:.1e}"));
            c.benchmark_group("hemicube").bench_function(id, |b| {
                b.iter(|| hemicube.factors(DVec3::ZERO, DVec3::Z, black_box(&square)));
            });
        }
    }
}

criterion_group!(benches, pairs, behind, hemicubes);
criterion_main!(benches);
