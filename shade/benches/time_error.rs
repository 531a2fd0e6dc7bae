//! How long for how much error: a rectangular light by its number of samples, each BRDF, mirrored surroundings, and albedos.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, Vec3, dvec3, vec3};
use pointillist_shade::{
    CubeMap, Environment, Falloff, Light, Material, MerlTable, Model, coat_albedo, directional_albedo,
};
use std::hint::black_box;
use std::num::NonZeroU32;

/// Irradiance of the ground below the corner of a unit square one above it, in units of its radiance.
fn rect_irradiance(samples: u32) -> f64 {
    let rect = Light::Rect {
        corner: dvec3(0.0, 1.0, 0.0),
        edge_u: DVec3::X,
        edge_v: DVec3::Z,
        radiance: Vec3::ONE,
        samples: NonZeroU32::new(samples),
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
    for model in [Model::Lambert, Model::NormalizedPhong, Model::NormalizedBlinnPhong, Model::Ggx] {
        let material = Material::lambert(Vec3::splat(0.5)).with_specular(model, Vec3::splat(0.2), 50.0);
        group.bench_function(format!("{model:?}"), |b| {
            b.iter(|| black_box(&material).brdf(Vec3::Y, black_box(l), black_box(v)))
        });
    }
    let table = MerlTable::tabulate(|l, v| Material::default().brdf(Vec3::Z, l, v));
    let error = (table.brdf(Vec3::Y, l, v) - Material::default().brdf(Vec3::Y, l, v)).abs().max_element();
    group.bench_function(BenchmarkId::new("Merl", format!("{error:.2e}")), |b| {
        b.iter(|| table.brdf(Vec3::Y, black_box(l), black_box(v)))
    });
    group.finish();
}

/// Half a sky, mirrored at its rim: half of it should be seen, whatever the roughness.
fn environments(c: &mut Criterion) {
    let sky = |d: DVec3| if d.x > 0.0 { Vec3::ONE } else { Vec3::ZERO };
    let map = Environment::sharp(CubeMap::from_function(256, sky)).with_rough_levels();
    let mut group = c.benchmark_group("environment");
    for roughness in [0.0, 0.15, 0.5, 1.0] {
        let error = (map.radiance(Vec3::Z, roughness).x - 0.5).abs();
        let id = BenchmarkId::new(format!("roughness {roughness}"), format!("{error:.2e}"));
        group.bench_function(id, |b| b.iter(|| map.radiance(black_box(Vec3::Z), roughness)));
    }
    group.finish();
}

/// The share of light that a GGX coat returns, by quadrature; the error is that against many steps.
fn albedos(c: &mut Criterion) {
    let coat = Material::lambert(Vec3::ZERO).with_roughness(0.3);
    let coat = coat.with_specular(Model::Ggx, Vec3::splat(0.5), 0.0);
    let albedo = |steps| directional_albedo(vec3(0.6, 0.0, 0.8), steps, |l, v| coat.brdf(Vec3::Z, l, v)).x;
    let exact = albedo(1000);
    let mut group = c.benchmark_group("albedo");
    for steps in [16, 64, 256] {
        let id = BenchmarkId::new(format!("{steps} steps"), format!("{:.2e}", (albedo(steps) - exact).abs()));
        group.bench_function(id, |b| b.iter(|| albedo(black_box(steps))));
    }
    let error = (coat_albedo(coat.specular, 0.3, 0.8).x - exact).abs();
    group.bench_function(BenchmarkId::new("table", format!("{error:.2e}")), |b| {
        b.iter(|| coat_albedo(coat.specular, black_box(0.3), black_box(0.8)))
    });
    group.finish();
}

criterion_group!(benches, rectangles, brdfs, environments, albedos);
criterion_main!(benches);
