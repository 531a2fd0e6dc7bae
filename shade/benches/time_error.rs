//! How long for how much error: a rectangular light by its number of samples, and each BRDF.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, Vec3, dvec3, vec3};
use pointillist_shade::{Falloff, Light, Material, Model};
use std::hint::black_box;

/// Irradiance of the ground below the corner of a unit square one above it, in units of its radiance.
fn rect_irradiance(samples: u32) -> f64 {
    let rect = Light::Rect {
        corner: dvec3(0.0, 1.0, 0.0),
        edge_u: DVec3::X,
        edge_v: DVec3::Z,
        radiance: Vec3::ONE,
        samples,
        falloff: Falloff::InverseSquare,
    };
    let cosine_law = |i| {
        let incident = rect.illuminate(i, black_box(DVec3::ZERO));
        f64::from(incident.irradiance.x * incident.to_light.y)
    };
    (0..samples).map(cosine_law).sum()
}

fn rectangles(c: &mut Criterion) {
    // The form factor between a patch and a parallel rectangle above its corner, closed form.
    let s = 0.5f64.sqrt();
    let exact = s * s.atan();
    let mut group = c.benchmark_group("rect");
    for samples in [1, 4, 16, 64, 256] {
        let error = (rect_irradiance(samples) / exact - 1.0).abs();
        let id = BenchmarkId::new(samples.to_string(), format!("{error:.2e}"));
        group.bench_function(id, |b| b.iter(|| rect_irradiance(samples)));
    }
    group.finish();
}

fn brdfs(c: &mut Criterion) {
    let mut group = c.benchmark_group("brdf");
    let (l, v) = (vec3(0.6, 0.8, 0.0), vec3(0.0, 0.8, 0.6));
    for model in [Model::Lambert, Model::NormalizedPhong, Model::NormalizedBlinnPhong] {
        let material = Material::lambert(Vec3::splat(0.5)).with_specular(model, Vec3::splat(0.2), 50.0);
        group.bench_function(format!("{model:?}"), |b| {
            b.iter(|| black_box(&material).brdf(Vec3::Y, black_box(l), black_box(v)))
        });
    }
    group.finish();
}

criterion_group!(benches, rectangles, brdfs);
criterion_main!(benches);
