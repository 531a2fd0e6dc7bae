//! Builds an octree of a million points of a hilly field in a temporary file, in 8 MiB of memory, and says what views from far to near read
//! of it.
//!
//! `cargo run --release -p pointillist-octree --example near_and_far`

use glam::{DVec3, dvec3};
use pointillist_octree::{Builder, Cube, CutOptions, TreeHeader, TreeReader, TreeWriter, cut};
use pointillist_view::{Projection, View};
use std::fs::File;
use std::io::{BufReader, BufWriter};

const SIDE: u32 = 1000;
/// Bytes of a point: its position in the node, and a byte of our own.
const PAYLOAD: usize = 1;

/// A field 1 km wide, a point every metre.
fn point(i: u32) -> DVec3 {
    let (x, y) = (f64::from(i % SIDE), f64::from(i / SIDE));
    dvec3(x, y, 20.0 * (x / 130.0).sin() * (y / 90.0).cos())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::temp_dir();
    let (buckets, name) = (folder.join("near_and_far.buckets"), folder.join("near_and_far.octree"));
    let cube = Cube::around(dvec3(0.0, 0.0, -20.0), dvec3(f64::from(SIDE), f64::from(SIDE), 20.0))?;
    let temporary = File::options().read(true).write(true).create(true).truncate(true).open(&buckets)?;
    let mut builder = Builder::new(cube, PAYLOAD, 8 << 20, temporary);
    for i in 0..SIDE * SIDE {
        builder.push(point(i), &[(i % 7) as u8])?;
    }
    let header = TreeHeader { fingerprint: 1, cube, payload: PAYLOAD as u32, layout: 0 };
    let mut writer = TreeWriter::new(BufWriter::new(File::create(&name)?), &header)?;
    builder.finish(&mut |key, records| writer.node(key, records), &mut |_| ())?;
    writer.finish()?;

    let mut reader = TreeReader::new(BufReader::new(File::open(&name)?))?;
    let (points, nodes) = (reader.tree().points(), reader.tree().nodes().len());
    println!("{points} points in {nodes} nodes, {} bytes", std::fs::metadata(&name)?.len());
    let lens = Projection::Perspective { fov_y_rad: 0.8 };
    for distance in [5000.0, 1000.0, 200.0, 40.0] {
        let target = dvec3(400.0, 500.0, 0.0);
        let eye = target + distance * dvec3(0.0, -0.8, 0.6);
        let view = View::look_at(eye, target, DVec3::Z, lens, 640, 480)?;
        let seen = cut(&[reader.tree()], &view, &CutOptions::default());
        let mut bytes = 0;
        for (_, node) in &seen.nodes {
            bytes += reader.read(*node)?.len();
        }
        println!("from {distance} m: {} of {nodes} nodes, {bytes} bytes", seen.nodes.len());
    }
    std::fs::remove_file(buckets)?;
    std::fs::remove_file(name)?;
    Ok(())
}
