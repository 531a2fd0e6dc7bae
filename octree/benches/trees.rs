//! How fast trees of half a million points are built and read, by the memory that they are built in, and how fast the nodes of a view are
//! chosen.
//!
//! `cargo bench -p pointillist-octree --bench trees`

use std::hint::black_box;
use std::io::Cursor;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, dvec3};
use pointillist_octree::{Builder, Cube, CutOptions, TreeHeader, TreeReader, TreeWriter, cut};
use pointillist_view::{Projection, View};

const COUNT: u32 = 500_000;

/// On a sphere in a spiral, about evenly.
fn points() -> Vec<DVec3> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let point = |i: u32| {
        let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(COUNT);
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        let r = (1.0 - y * y).sqrt();
        dvec3(r * cos, y, r * sin)
    };
    (0..COUNT).map(point).collect()
}

fn built(points: &[DVec3], memory: u64) -> Vec<u8> {
    let cube = Cube::around(-DVec3::ONE, DVec3::ONE).expect("a cube of usual size");
    let mut builder = Builder::new(cube, 0, memory, Cursor::new(vec![]));
    for point in points {
        builder.push(*point, &[]).expect("memory takes all");
    }
    let header = TreeHeader { fingerprint: 1, cube, payload: 0, layout: 0 };
    let mut writer = TreeWriter::new(vec![], &header).expect("memory takes all");
    builder.finish(&mut |key, records| writer.node(key, records), &mut |_| ()).expect("memory takes all");
    writer.finish().expect("memory takes all")
}

fn trees(c: &mut Criterion) {
    let points = points();
    let mut group = c.benchmark_group("octree");
    group.sample_size(10).throughput(Throughput::Elements(u64::from(COUNT)));
    for megabytes in [4, 64] {
        let id = BenchmarkId::new("build", format!("{megabytes} MiB"));
        group.bench_function(id, |b| b.iter(|| built(black_box(&points), megabytes << 20)));
    }
    let file = built(&points, 64 << 20);
    group.bench_function("read all nodes", |b| {
        b.iter(|| {
            let mut reader = TreeReader::new(Cursor::new(&file)).expect("the file is whole");
            let nodes = reader.tree().nodes().len() as u32;
            (0..nodes).map(|node| reader.read(node).expect("the file is whole").len()).sum::<usize>()
        });
    });
    let reader = TreeReader::new(Cursor::new(&file)).expect("the file is whole");
    let lens = Projection::Perspective { fov_y_rad: 0.6 };
    let view = View::look_at(4.0 * DVec3::Z, DVec3::ZERO, DVec3::Y, lens, 1024, 1024).expect("a usual view");
    group.bench_function("choose nodes", |b| b.iter(|| cut(&[reader.tree()], &view, &CutOptions::default())));
    group.finish();
}

criterion_group!(benches, trees);
criterion_main!(benches);
