//! How much space belongs to each atom of a crystal: volumes of Voronoi cells, of which Delaunay cells' circumcentres
//! are the corners.
//!
//! Inside, every atom of a body-centred cubic lattice has half a unit cube; where an atom is missing, its neighbours
//! have more.
//!
//! `cargo run --release -p pointillist-delaunay --example voronoi`

use glam::{DVec3, dvec3};
use pointillist_delaunay::{Delaunay, DelaunayError, circumcentre};

/// Unit cubes along each axis.
const CUBES: u32 = 8;

/// Each way to walk from a corner along an edge and a face into a tetrahedron, and whether it turns left.
fn ways() -> impl Iterator<Item = ([usize; 3], f64)> {
    let all = (0..64).map(|i| [i % 4, i / 4 % 4, i / 16]);
    let distinct = all.filter(|[a, b, c]| a != b && b != c && c != a);
    distinct.map(|[a, b, c]| {
        let order = [a, b, c, 6 - a - b - c];
        let swaps =
            (0..4).flat_map(|i| (0..i).map(move |j| (i, j))).filter(|&(i, j)| order[j] > order[i]).count();
        ([a, b, c], if swaps % 2 == 0 { 1.0 } else { -1.0 })
    })
}

/// Volumes of the Voronoi cells of all points; of those on the hull only the part before its facets.
fn voronoi_volumes(delaunay: &Delaunay) -> Vec<f64> {
    let points = delaunay.points();
    let mut volumes = vec![0.0; points.len()];
    for cell in delaunay.partition().cells() {
        let Some(centre) = cell.circumcentre(points) else { continue };
        for (way, sense) in ways() {
            // A corner, the middles of an edge and a face, and of the cell span a part of the corner's Voronoi cell.
            let [a, b, c] = way.map(|k| points[cell.corners()[k] as usize]);
            let Some(face) = circumcentre(&[a, b, c]) else { continue };
            let part = (0.5 * (b - a)).cross(face - a).dot(centre - a);
            volumes[cell.corners()[way[0]] as usize] += sense * part / 6.0;
        }
    }
    volumes
}

fn main() -> Result<(), DelaunayError> {
    let corners = (0..CUBES.pow(3)).map(|i| [i % CUBES, i / CUBES % CUBES, i / CUBES / CUBES]);
    let corners = corners.map(|c| DVec3::from_array(c.map(f64::from)));
    let atoms: Vec<DVec3> = corners.flat_map(|p| [p, p + 0.5]).collect();
    let mut delaunay = Delaunay::new(&atoms)?;
    let at = |p: DVec3| atoms.iter().position(|&a| a == p).unwrap_or(0);
    let (vacancy, beside) = (at(dvec3(4.0, 4.0, 4.0)), at(dvec3(4.5, 4.5, 4.5)));
    println!("an atom inside: {:.6}", voronoi_volumes(&delaunay)[beside]);
    delaunay.remove(vacancy as u32)?;
    println!("the same beside a vacancy: {:.6}", voronoi_volumes(&delaunay)[beside]);
    println!("in the place of the vacancy: {:.6}", voronoi_volumes(&delaunay)[vacancy]);
    Ok(())
}
