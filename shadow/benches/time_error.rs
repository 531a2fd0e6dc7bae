//! How long for how much error: the shadow of a tilted edge on the ground, by both rules. The error in each name is the largest
//! over pixels against the analytic area.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, dvec2, dvec3};
use pointillist_dice::{Accumulator, Grid, accumulate};
use pointillist_micropoint::invariants::Soup;
use pointillist_micropoint::{MicropointOptions, Occlusion, PlainOpacity, Projection, Renderer, Tile, View};
use pointillist_shadow::invariants::{light_on, lit_picture_of};
use pointillist_shadow::{Emitter, Receivers, Resolution, ShadowLight, ShadowOptions, ShadowScratch, Viewer};

const PIXELS: u32 = 32;

fn time_error(c: &mut Criterion) {
    let half =
        [dvec3(-0.13, 1.0, 30.0), dvec3(30.0, 1.0, 30.0), dvec3(30.0, 1.0, -30.0), dvec3(0.37, 1.0, -30.0)];
    let mut soup = Soup::default();
    let (ground, plate) = (soup.surface(1.0), soup.surface(1.0));
    soup.polygon(
        &[dvec3(-9.0, 0.0, 9.0), dvec3(9.0, 0.0, 9.0), dvec3(9.0, 0.0, -9.0), dvec3(-9.0, 0.0, -9.0)],
        ground,
    );
    soup.polygon(&half, plate);
    let direction = dvec3(0.1, -1.0, 0.05);

    // The shadow in pixels of a picture 2 units high.
    let scale = f64::from(PIXELS) / 2.0;
    let shadow = half.map(|p| p + direction * p.y).map(|p| dvec2(p.x, p.z) * scale + 0.5 * f64::from(PIXELS));
    let mut dark = vec![0.0; (PIXELS * PIXELS) as usize];
    accumulate(&shadow, &Grid::UNIT, &mut Accumulator::new(), |run| {
        for (cell, _) in run.cells(&Grid::UNIT) {
            if cell.min_element() >= 0 && cell.max_element() < PIXELS as i32 {
                dark[(cell.y as u32 * PIXELS + cell.x as u32) as usize] = run.area;
            }
        }
    })
    .expect("the shadow is finite");

    let geometry = soup.geometry().expect("the scene is valid");
    let camera = Projection::Orthographic { height: 2.0 };
    let view = View::look_at(DVec3::Y * 0.5, DVec3::ZERO, DVec3::NEG_Z, camera, PIXELS, PIXELS)
        .expect("the view is valid");
    let renderer = Renderer::new(&geometry, &PlainOpacity, view, MicropointOptions::DEFAULT)
        .expect("the options are valid");
    let mut tile = Tile::default();
    renderer.render(renderer.picture(), &mut tile);
    let mut receivers = Receivers::default();
    receivers.push_tile(&tile);
    let paper = ShadowOptions::default().with_occlusion(Occlusion::Paper);
    let rules = [
        ("correlated".to_owned(), ShadowOptions::default()),
        ("paper".to_owned(), paper),
        ("paper 1024".to_owned(), paper.with_resolution(Resolution::Cells(1024))),
        ("paper 8192".to_owned(), paper.with_resolution(Resolution::Cells(8192))),
    ];
    for (name, options) in rules {
        let light = ShadowLight::new(&geometry, &PlainOpacity, Emitter::Directional { direction }, options)
            .expect("the light is valid");
        let lit = light_on(&lit_picture_of(&renderer, &light, [renderer.picture()]), ground);
        let error = lit.iter().zip(&dark).map(|(l, d)| (l - (1.0 - d)).abs()).fold(0.0, f64::max);
        let id = BenchmarkId::new(name, format!("error {error:.1e}"));
        let (mut scratch, mut fractions) = (ShadowScratch::default(), vec![]);
        c.benchmark_group("half-plane, 1024 receivers").bench_function(id, |b| {
            b.iter(|| {
                let viewer = Viewer { lens: tile.lens(), faces: tile.faces() };
                light.lit(viewer, black_box(&receivers), &mut scratch, &mut fractions);
            });
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
