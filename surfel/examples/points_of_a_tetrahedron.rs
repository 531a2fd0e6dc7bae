//! How even are a thousand points? The least distance of neighbours on a tetrahedron, against that of the best lattice.
//!
//! `cargo run -p pointillist-surfel --example points_of_a_tetrahedron`

use glam::dvec3;
use pointillist_surfel::{SampleOptions, SurfelError, sample};

fn main() -> Result<(), SurfelError> {
    let corners = [(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)];
    let corners = corners.map(|(x, y, z)| dvec3(x, y, z));
    let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    let points = sample(&corners, &faces, &SampleOptions::DEFAULT.with_count(1000))?;

    let mut least = f64::INFINITY;
    for (i, p) in points.iter().enumerate() {
        for q in &points[..i] {
            least = least.min(p.position.distance(q.position));
        }
    }
    // Edges are √8 long: an area of 4 · (√3/4) · 8.
    let area = 8.0 * 3f64.sqrt();
    let lattice = (area / (0.75f64.sqrt() * points.len() as f64)).sqrt();
    println!("{} points, the nearest two {:.2} of a lattice's spacing apart", points.len(), least / lattice);
    Ok(())
}
