//! How long for how much error: clouds of a sphere made ready (octree alone; with radii; with normals too), and frames
//! of 97,000 and 362,000 points at 400×400, sharp and blurred, by each procedure. The error in each name is the root
//! mean square over color and opacity: of sharp frames against the sphere itself inside its outline, of blurred ones
//! against 97 views from the opening of the lens.
//!
//! `cargo bench -p pointillist-surfel --bench drawing`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use pointillist_surfel::invariants::{OwnedPoints, cloud, drawn, look_at, sphere_at};
use pointillist_surfel::{Cloud, Focus, Frame, Options, Procedure, Projection, Renderer, View};

const SIZE: u32 = 400;
const FOV: f64 = 0.55;
const EYE: f64 = 4.0;
const COUNTS: [u32; 2] = [97_000, 362_000];
/// Views from the opening of the lens: its middle, and 16 on each of so many rings.
const RINGS: u32 = 6;

/// The color at a place of the sphere.
fn paint(p: DVec3) -> [f32; 3] {
    p.to_array().map(|v| (0.5 + 0.4 * (9.0 * v).sin()) as f32)
}

fn sphere(count: u32) -> OwnedPoints {
    OwnedPoints::sphere(DVec3::ZERO, 1.0, count).painted(paint)
}

fn view_from(eye: DVec3, target: DVec3) -> View {
    look_at(eye, target, Projection::Perspective { fov_y_rad: FOV }, SIZE, SIZE).expect("the view is valid")
}

fn view() -> View {
    view_from(DVec3::Z * EYE, DVec3::ZERO)
}

/// In their own colors.
fn options(procedure: Procedure, focus: Focus) -> Options {
    let mut options = Options::default();
    (options.procedure, options.focus, options.ambient) = (procedure, focus, 1.0);
    options
}

/// A lens that blurs the middle of the sphere's front by so many pixels, focused behind it.
fn lens(blur_px: f64) -> (f64, f64) {
    let focal_px = 0.5 * f64::from(SIZE) / (0.5 * FOV).tan();
    let (focus, nearest) = (8.0, EYE - 1.0);
    (blur_px / (focal_px * (1.0 / nearest - 1.0 / focus)), focus)
}

fn rms(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, count) = pairs.fold((0.0, 0.0), |(sum, count), (a, b)| (sum + (a - b).powi(2), count + 1.0));
    f64::sqrt(sum / count)
}

/// Against the colors of the sphere, all but a rim of two pixels.
fn error_of_sharp(frame: &Frame) -> f64 {
    let pixel = |i: usize| sphere_at(&view(), i, DVec3::ZERO, 1.0, 2.0).map(|(_, place)| (i, paint(place)));
    let inside = (0..frame.color().len()).filter_map(pixel);
    rms(inside.flat_map(|(i, [r, g, b])| {
        let wanted = [r, g, b, 1.0].map(f64::from);
        frame.color()[i].map(f64::from).into_iter().zip(wanted)
    }))
}

/// The mean of sharp pictures from all over the lens, of which each has its own frustum onto the plane of the focus:
/// shifted by whole and part pixels, so that this plane stays where it is.
fn through_the_lens(cloud: &Cloud, blur_px: f64) -> Vec<[f64; 4]> {
    let (aperture, focus) = lens(blur_px);
    let focal_px = 0.5 * f64::from(SIZE) / (0.5 * FOV).tan();
    let mut sum = vec![[0.0; 4]; (SIZE * SIZE) as usize];
    let (mut all, sharp) = (0.0, options(Procedure::Blended, Focus::Everywhere));
    for ring in 0..=RINGS {
        let spokes = if ring == 0 { 1 } else { 16 };
        for spoke in 0..spokes {
            // Even over the area: rings at the middle of equal shares.
            let radius = if ring == 0 { 0.0 } else { ((f64::from(ring) - 0.5) / f64::from(RINGS)).sqrt() };
            let (sin, cos) = (std::f64::consts::TAU * f64::from(spoke) / f64::from(spokes)).sin_cos();
            let offset = DVec3::new(cos, sin, 0.0) * (radius * aperture);
            let eye = DVec3::Z * EYE + offset;
            let frame = drawn(cloud, &view_from(eye, eye - DVec3::Z), &sharp).expect("the options are valid");
            let shift = [offset.x, -offset.y].map(|v| v * focal_px / focus);
            add_shifted(&mut sum, &frame, shift);
            all += 1.0;
        }
    }
    sum.iter().map(|c| c.map(|v| v / all)).collect()
}

/// Adds a frame moved by so many pixels, with linear weights.
fn add_shifted(sum: &mut [[f64; 4]], frame: &Frame, [dx, dy]: [f64; 2]) {
    let size = SIZE as i32;
    let (left, top) = (dx.floor(), dy.floor());
    for y in 0..size {
        for x in 0..size {
            for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let share = |d: f64, k: i32| if k == 0 { 1.0 - d } else { d };
                let weight = share(dx - left, i) * share(dy - top, j);
                let (tx, ty) = (x + left as i32 + i, y + top as i32 + j);
                if (0..size).contains(&tx) && (0..size).contains(&ty) {
                    let from = frame.color()[(y * size + x) as usize];
                    let to = &mut sum[(ty * size + tx) as usize];
                    to.iter_mut().zip(from).for_each(|(t, f)| *t += weight * f64::from(f));
                }
            }
        }
    }
}

fn error_of_blurred(frame: &Frame, wanted: &[[f64; 4]]) -> f64 {
    let values = frame.color().iter().flatten().map(|v| f64::from(*v));
    rms(values.zip(wanted.iter().flatten().copied()))
}

fn prepare(c: &mut Criterion) {
    let mut group = c.benchmark_group("prepare");
    for count in COUNTS {
        let points = sphere(count);
        // The spacing of as many, and normals as they are.
        let radius = (2.0 * std::f64::consts::PI / f64::from(count)).sqrt() as f32 * 1.5;
        let given = OwnedPoints { radii: Some(vec![radius; count as usize]), ..points.clone() };
        let bare = OwnedPoints { normals: None, ..points.clone() };
        for (name, points) in [("octree and areas", given), ("and radii", points), ("and normals", bare)] {
            let made = cloud(&points).expect("the points are valid");
            let name = format!("{name}, {:.1} bytes per point", made.overhead_per_point());
            group.bench_function(BenchmarkId::new(name, count), |b| b.iter(|| cloud(black_box(&points))));
        }
    }
    group.finish();
}

fn draw(c: &mut Criterion) {
    for count in COUNTS {
        let cloud = cloud(&sphere(count)).expect("the points are valid");
        let mut group = c.benchmark_group(format!("draw, {count} points"));
        for blur_px in [0.0, 6.0, 16.0] {
            let (aperture, focus) = lens(blur_px);
            let focus = if blur_px == 0.0 { Focus::Everywhere } else { Focus::Lens { aperture, focus } };
            let wanted = if blur_px == 0.0 { vec![] } else { through_the_lens(&cloud, blur_px) };
            for procedure in [Procedure::Blended, Procedure::Paper] {
                let options = options(procedure, focus);
                let (mut renderer, mut frame) = (Renderer::new(), Frame::default());
                renderer.draw(&cloud, &view(), &options, &mut frame).expect("the options are valid");
                let error = if wanted.is_empty() {
                    error_of_sharp(&frame)
                } else {
                    error_of_blurred(&frame, &wanted)
                };
                let id =
                    BenchmarkId::new(format!("{procedure:?}, {blur_px} px"), format!("error {error:.2e}"));
                group.bench_function(id, |b| {
                    b.iter(|| renderer.draw(black_box(&cloud), &view(), &options, &mut frame));
                });
            }
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(800));
    targets = prepare, draw
}
criterion_main!(benches);
