//! How fast an OBJ is read, in bytes: positions alone in triangles; quads with all kinds of index and seven materials;
//! the same quads with a comment on every line, which all have to be taken apart. The number in each name is the
//! largest difference between a position and the one that was written, relative to it: 0, as numbers are read exactly.
//!
//! `cargo bench -p pointillist --bench obj`

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pointillist_cli::mesh_io::read_obj;
use std::fmt::Write;
use std::hint::black_box;

/// Vertices on a side of the grid.
const SIDE: usize = 128;

/// The vertices of a grid over the plane, row by row.
fn places() -> impl Iterator<Item = [f64; 3]> {
    let place = |i: usize, j: usize| {
        let (x, y) = (0.37 * i as f64, 0.41 * j as f64);
        [x, y, (0.03 * x).sin() * (0.02 * y).cos()]
    };
    (0..SIDE * SIDE).map(move |at| place(at % SIDE, at / SIDE))
}

/// The corners of the grid's cells, row by row, counted from 1.
fn cells() -> impl Iterator<Item = [usize; 4]> {
    let corners = |first: usize| [first, first + 1, first + SIDE + 1, first + SIDE];
    (0..SIDE - 1).flat_map(move |j| (0..SIDE - 1).map(move |i| corners(j * SIDE + i + 1)))
}

fn triangles() -> String {
    let mut text = String::new();
    for [x, y, z] in places() {
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for [a, b, c, d] in cells() {
        writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
    }
    text
}

fn quads() -> String {
    let mut text = "mtllib grid.mtl\n".to_owned();
    for [x, y, z] in places() {
        writeln!(text, "v {x} {y} {z}\nvt {:.6} {:.6}\nvn {z:.6} 0.5 1.0", x / 50.0, y / 50.0).unwrap();
    }
    for (at, corners) in cells().enumerate() {
        if at % SIDE == 0 {
            writeln!(text, "usemtl m{}\ns 1", at / SIDE % 7).unwrap();
        }
        let [a, b, c, d] = corners.map(|n| format!("{n}/{n}/{n}"));
        writeln!(text, "f {a} {b} {c} {d}").unwrap();
    }
    text
}

/// The largest relative difference between the grid and what a file of it has.
fn error(text: &str) -> f64 {
    let mesh = read_obj("grid.obj", text.as_bytes()).expect("the file is sound");
    // Positions come in the order in which faces use them.
    let mut read: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    let mut written: Vec<[f64; 3]> = places().collect();
    let by_place = |a: &[f64; 3], b: &[f64; 3]| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0]));
    read.sort_by(by_place);
    read.dedup();
    written.sort_by(by_place);
    assert_eq!(read.len(), written.len());
    let difference = |(a, b): (&f64, &f64)| if a == b { 0.0 } else { ((a - b) / b).abs() };
    read.as_flattened().iter().zip(written.as_flattened()).map(difference).fold(0.0, f64::max)
}

fn obj(c: &mut Criterion) {
    let quads = quads();
    let commented = quads.replace('\n', " #\n");
    let mut group = c.benchmark_group("read_obj");
    for (name, text) in [("triangles", triangles()), ("quads", quads), ("comments", commented)] {
        group.throughput(Throughput::Bytes(text.len() as u64));
        let id = BenchmarkId::new(name, format!("{:.2e}", error(&text)));
        group.bench_function(id, |b| b.iter(|| read_obj("grid.obj", black_box(text.as_bytes()))));
    }
    group.finish();
}

criterion_group!(benches, obj);
criterion_main!(benches);
