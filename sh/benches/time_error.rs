//! How long for how much error: cube maps to nine coefficients, irradiance, rotation and blending. The error in each
//! name: of projection, of the worst coefficient relative to L00 for a sky that is quadratic in the direction; of the
//! others, relative to the largest value, against `f64` by the plain formula.
//!
//! `cargo bench -p pointillist-sh --bench time_error`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DQuat, DVec3, Vec3, dvec3};
use pointillist_sh::invariants::difference;
use pointillist_sh::{
    CubeMap, CubeProjector, Irradiance, IrradianceMatrix, Panorama, PanoramaProjector, Rotation, Sh,
    SphereQuadrature, Weights,
};

fn sky(d: DVec3) -> DVec3 {
    dvec3(1.0 + 0.5 * d.x + 0.3 * d.y * d.z, 2.0 + d.y, 1.5 + d.z * d.z)
}

fn exact(order: usize) -> Sh {
    SphereQuadrature::new(order + 2).project(order, sky).expect("the sky is finite")
}

fn id(name: impl Into<String>, error: f64) -> BenchmarkId {
    BenchmarkId::new(name, format!("{error:.1e}"))
}

fn projection(c: &mut Criterion) {
    let mut group = c.benchmark_group("project");
    for size in [16, 32, 64, 128, 256] {
        let map = CubeMap::from_fn(size, sky).expect("the size is allowed");
        for (order, weights) in [(2, Weights::Gregory), (2, Weights::Exact), (4, Weights::Gregory)] {
            let projector = CubeProjector::new(size, order, weights).expect("size and order are allowed");
            let error = difference(&exact(order), &projector.project(&map).expect("the sky is finite"));
            group.bench_function(id(format!("cube {size} order {order} {weights:?}"), error), |b| {
                b.iter(|| projector.project(black_box(&map)));
            });
        }
    }
    let map = Panorama::from_fn(256, 128, sky).expect("the sky is finite");
    let projector =
        PanoramaProjector::new(256, 128, 2, Weights::Gregory).expect("size and order are allowed");
    let error = difference(&exact(2), &projector.project(&map).expect("the sky is finite"));
    group.bench_function(id("panorama 256x128 order 2 Gregory", error), |b| {
        b.iter(|| projector.project(black_box(&map)));
    });
    group.finish();
}

/// A thousand and more directions, even.
fn directions() -> Vec<DVec3> {
    SphereQuadrature::new(45).points().iter().map(|point| point.0).collect()
}

fn evaluation(c: &mut Criterion) {
    let (sh, directions) = (exact(2), directions());
    let (matrix, single) = (IrradianceMatrix::new(&sh), Irradiance::new(&sh));
    let normals: Vec<Vec3> = directions.iter().map(|d| d.as_vec3()).collect();
    let error = |f: &dyn Fn(DVec3) -> DVec3| {
        let errors = directions.iter().map(|&n| (f(n) - sh.irradiance(n)).abs().max_element());
        errors.fold(0.0, f64::max) / sh.irradiance(DVec3::Y).max_element()
    };
    let mut group = c.benchmark_group(format!("irradiance of {} normals", normals.len()));
    group.bench_function(id("f64 matrix", error(&|n| matrix.at(n))), |b| {
        b.iter(|| directions.iter().map(|&n| matrix.at(n)).sum::<DVec3>());
    });
    group.bench_function(id("f32", error(&|n| single.at(n.as_vec3()).as_dvec3())), |b| {
        b.iter(|| normals.iter().map(|&n| single.at(n)).sum::<Vec3>());
    });
    group.bench_function(id("bands", 0.0), |b| {
        b.iter(|| directions.iter().map(|&n| sh.irradiance(n)).sum::<DVec3>());
    });
    group.finish();
}

fn coefficients(c: &mut Criterion) {
    let turn = DQuat::from_axis_angle(dvec3(0.48, 0.6, 0.64), 1.0);
    let mut group = c.benchmark_group("coefficients");
    for order in [2, 4, 8] {
        let sh = exact(order);
        let turned = sh.rotated(turn).expect("it is a rotation");
        let back = turned.rotated(turn.conjugate()).expect("it is a rotation");
        let matrix = glam::DMat3::from_quat(turn);
        let rotation = Rotation::new(order, matrix).expect("it is a rotation");
        group.bench_function(id(format!("rotate order {order}"), difference(&sh, &back)), |b| {
            b.iter(|| sh.rotated(black_box(turn)));
        });
        group.bench_function(id(format!("rotate order {order}, prepared"), difference(&sh, &back)), |b| {
            b.iter(|| rotation.of(black_box(&sh)));
        });
    }
    let sets = [1.0, 2.0, 3.0, 4.0].map(|factor| exact(2).scaled(factor));
    let weights = [0.1, 0.2, 0.3, 0.4];
    let mut blend = exact(2);
    blend.set_to_blend(sets.iter().zip(weights)).expect("all orders are 2");
    group.bench_function(id("blend four of order 2", difference(&exact(2).scaled(3.0), &blend)), |b| {
        b.iter(|| blend.set_to_blend(sets.iter().zip(black_box(weights))));
    });
    let fourth = exact(4);
    group.bench_function(id("split order 4 to 2", 0.0), |b| b.iter(|| black_box(&fourth).split(2)));
    group.finish();
}

criterion_group!(benches, projection, evaluation, coefficients);
criterion_main!(benches);
