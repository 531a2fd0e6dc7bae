//! How long for how much error: a sphere scanned from ten sides with noise of a quarter spacing, prepared
//! and drawn at 512×512 by each kind of frame. The errors in each name are the mean angle of normals and
//! the root mean square of depth in spacings, against the sphere itself.
//!
//! `cargo bench -p pointillist-ibpr --bench time_error`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, Vec3, dvec3};
use pointillist_ibpr::invariants::{OwnedScan, cloud};
use pointillist_ibpr::{
    Cloud, Frame, Normals, Options, Passes, Projection, Renderer, Scale, Translucency, View, Weighting,
};

const SIZE: u32 = 512;
const SPACING: f64 = 0.012;
const NOISE: f64 = 0.25;
const EYE: f64 = 4.0;

fn scans() -> Vec<OwnedScan> {
    let around = (0..8).map(|k| DVec3::from_array(direction(k)));
    let scan = |(k, d): (usize, DVec3)| {
        // Uniform noise of this deviation.
        let amount = d * (NOISE * SPACING * 3f64.sqrt());
        OwnedScan::sphere(DVec3::ZERO, 1.0, SPACING, d).jittered(amount, k as u64)
    };
    around
        .chain([dvec3(0.1, 1.0, 0.2).normalize(), dvec3(0.2, -1.0, 0.1).normalize()])
        .enumerate()
        .map(scan)
        .collect()
}

fn direction(k: u32) -> [f64; 3] {
    let (s, c) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
    [s, 0.0, c]
}

fn view() -> View {
    let camera = Projection::Perspective { fov_y_rad: 0.55 };
    View::look_at(DVec3::Z * EYE, DVec3::ZERO, DVec3::Y, camera, SIZE, SIZE).expect("the view is valid")
}

/// Mean angle of normals in degrees and RMS of depth in spacings, over the inner nine tenths of the disc.
fn error(cloud: &Cloud, options: &Options) -> (f64, f64) {
    let mut frame = Frame::default();
    let mut options = *options;
    options.surface_layers = true;
    Renderer::new().draw(cloud, &view(), &options, &mut frame).expect("the options are valid");
    let half = 0.5 * f64::from(SIZE);
    let slope = (0.5f64 * 0.55).tan() / half;
    let (mut angles, mut squares, mut count) = (0.0, 0.0, 0.0);
    for i in 0..frame.depth().len() {
        let (x, y) = ((i % frame.width()) as f64 + 0.5 - half, half - 0.5 - (i / frame.width()) as f64);
        let ray = dvec3(x * slope, y * slope, -1.0);
        // |EYE·Z + t·ray| = 1
        let (a, b, c) = (ray.length_squared(), -EYE, EYE * EYE - 1.0);
        let root = b * b - a * c;
        let nearest = (-b - root.max(0.0).sqrt()) / a;
        let n = DVec3::Z * EYE + ray * nearest;
        if root > 0.0 && n.truncate().length() < 0.9 && frame.depth()[i] < f32::INFINITY {
            let got = Vec3::from_array(frame.normal()[i]).as_dvec3();
            angles += got.dot(n).clamp(-1.0, 1.0).acos().to_degrees();
            squares += (f64::from(frame.depth()[i]) - nearest).powi(2);
            count += 1.0;
        }
    }
    (angles / count, (squares / count).sqrt() / SPACING)
}

fn settings() -> Vec<(&'static str, Options)> {
    let with = |name, change: fn(&mut Options)| {
        let mut options = Options::default();
        change(&mut options);
        (name, options)
    };
    vec![
        with("one pass", |_| {}),
        with("one pass, factor 2", |o| o.scale = Scale::Auto(2.0)),
        with("one pass, with layers", |o| o.surface_layers = true),
        with("one pass, symmetric weights", |o| o.weighting = Weighting::Symmetric),
        with("one pass, eight triangles", |o| o.normals = Normals::Triangles),
        with("two passes", |o| o.passes = Passes::Two { finer: 0.75 }),
        with("translucent", |o| o.translucency = Some(Translucency::new(0.5))),
        with("translucent, factor 1.6", |o| {
            (o.translucency, o.scale) = (Some(Translucency::new(0.5)), Scale::Auto(1.6));
        }),
        with("translucent, factor 2", |o| {
            (o.translucency, o.scale) = (Some(Translucency::new(0.5)), Scale::Auto(2.0));
        }),
    ]
}

fn time_error(c: &mut Criterion) {
    let scans = scans();
    let cloud = cloud(&scans).expect("the scans are valid");
    let points = cloud.len();
    c.benchmark_group("prepare").bench_function(
        BenchmarkId::from_parameter(format!("{points} points")),
        |b| {
            b.iter(|| pointillist_ibpr::invariants::cloud(black_box(&scans)));
        },
    );
    for (name, options) in settings() {
        let (angle, depth) = error(&cloud, &options);
        let id =
            BenchmarkId::new(name, format!("{points} points, {SIZE} px, {angle:.2}°, {depth:.3} spacings"));
        let (mut renderer, mut frame) = (Renderer::new(), Frame::default());
        c.benchmark_group("draw").bench_function(id, |b| {
            b.iter(|| renderer.draw(black_box(&cloud), &view(), &options, &mut frame));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(800));
    targets = time_error
}
criterion_main!(benches);
