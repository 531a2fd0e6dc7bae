//! Reads points as little-endian `f64`s, divides space with the crate `delaunay`, and prints what that took.
//!
//! `studies/peers/build` builds it; then `cargo run --release -p studies -- shprobe` runs it.

use std::time::Instant;

use cpu_time::ProcessTime;
use delaunay::prelude::construction::{DelaunayTriangulation, vertex};
use delaunay::prelude::geometry::AdaptiveKernel;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("which file of points?")?;
    let bytes = std::fs::read(path)?;
    let numbers: Vec<f64> = bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
    let vertices: Vec<_> = numbers.as_chunks::<3>().0.iter().map(|p| vertex!(*p)).collect();
    let (start, cpu) = (Instant::now(), ProcessTime::now());
    let cells: DelaunayTriangulation<AdaptiveKernel<f64>, (), (), 3> = DelaunayTriangulation::new(&vertices)?;
    let (wall, cpu) = (start.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    println!("build_s {wall:.6} cpu_s {cpu:.6} cells {}", cells.number_of_simplices());
    Ok(())
}
