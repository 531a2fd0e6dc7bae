//! How long for how much error: a closed sphere in front of a plane, at three sizes, by both rules. The error in each name
//! is the root mean square over pixels of the plane's share, against the exact rule's own at 4 cells a pixel side.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, dvec3};
use pointillist_micropoint::invariants::{Soup, picture_of, shares};
use pointillist_micropoint::{
    Geometry, MicropointOptions, Occlusion, PlainOpacity, Projection, Renderer, Tile, View,
};

fn scene() -> Soup {
    let mut soup = Soup::default();
    let (ball, ground) = (soup.surface(1.0), soup.surface(1.0));
    soup.sphere(dvec3(0.1, 0.2, 0.0), 1.0, 24, 48, ball);
    soup.polygon(
        &[dvec3(-9.0, -1.0, 3.0), dvec3(9.0, -1.0, 3.0), dvec3(9.0, 2.0, -40.0), dvec3(-9.0, 2.0, -40.0)],
        ground,
    );
    soup
}

fn renderer(geometry: &Geometry, size: u32, options: MicropointOptions) -> Renderer<'_> {
    let camera = Projection::Perspective { fov_y_rad: 0.9 };
    let view = View::look_at(dvec3(0.3, 0.5, 4.0), DVec3::ZERO, DVec3::Y, camera, size, size)
        .expect("the view is valid");
    Renderer::new(geometry, &PlainOpacity, view, options).expect("the options are valid")
}

/// The plane's share of each pixel.
fn ground(geometry: &Geometry, size: u32, options: MicropointOptions) -> Vec<f64> {
    let renderer = renderer(geometry, size, options);
    let picture = picture_of(&renderer, renderer.picture().tiles(16));
    shares(&picture, 2).iter().map(|s| s[1]).collect()
}

fn time_error(c: &mut Criterion) {
    let soup = scene();
    let geometry = soup.geometry().expect("the scene is valid");
    for size in [32, 128] {
        let reference = ground(&geometry, size, MicropointOptions::DEFAULT.with_cells_per_pixel(4));
        for (name, occlusion) in [("correlated", Occlusion::Correlated), ("paper", Occlusion::Paper)] {
            for cells in [1, 2] {
                let options =
                    MicropointOptions::DEFAULT.with_occlusion(occlusion).with_cells_per_pixel(cells);
                let got = ground(&geometry, size, options);
                let squares: f64 = got.iter().zip(&reference).map(|(a, b)| (a - b) * (a - b)).sum();
                let error = (squares / got.len() as f64).sqrt();
                let id = BenchmarkId::new(
                    format!("{name} {cells}×{cells} cells"),
                    format!("{size} px, error {error:.1e}"),
                );
                let renderer = renderer(&geometry, size, options);
                let mut tile = Tile::default();
                c.benchmark_group("render").bench_function(id, |b| {
                    b.iter(|| {
                        for rect in black_box(&renderer).picture().tiles(16) {
                            renderer.render(rect, &mut tile);
                        }
                    });
                });
            }
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
