//! Builds the triangulation of the dimension that points span.

use super::cell::Vertex;
use super::divide;
use super::hilbert;
use super::simplex::Simplex;
use super::sites::Sites;
use super::solid::Solid;
use crate::DelaunayError;
use glam::DVec3;

/// A triangulation, by the dimension that points span.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    /// All points coincide with this one.
    Point(u32),
    /// Points on a line, from one end to the other.
    Line(Vec<u32>),
    /// The points span space, or a plane.
    Solid(Box<Solid>),
}

/// The triangulation of the points with these indices, at least one. Writes for each the point that represents it.
pub(super) fn shape(
    points: &[DVec3],
    indices: &[u32],
    representative: &mut [u32],
) -> Result<Shape, DelaunayError> {
    indices.iter().for_each(|&i| representative[i as usize] = i);
    let order = hilbert::insertion_order(points, indices);
    let mut sites = Sites::new(order.iter().map(|&i| points[i as usize]));
    let vertices: Vec<Vertex> = (1..=order.len() as u32).map(Vertex).collect();
    let (first, apex) = match Simplex::new(&sites, &vertices) {
        Simplex::Point | Simplex::Line => return Ok(line(points, indices, representative)),
        Simplex::Plane(three) => {
            let apex = sites.push_apex(three);
            ([three[0], three[1], three[2], apex], Some(apex))
        }
        Simplex::Space(first) => (first, None),
    };
    // Halves of a plane would each need the apex.
    let depth = if apex.is_some() { 0 } else { divide::depth(vertices.len()) };
    let (mesh, same) =
        divide::mesh(&sites, &vertices, Some(first), depth)?.expect("the first four span space");
    let mut solid = Solid::new(sites, mesh, &order, apex, points.len());
    solid.merge(&same, representative);
    Ok(Shape::Solid(Box::new(solid)))
}

/// Points of a line, in lexicographic order, which is that along the line.
fn line(points: &[DVec3], indices: &[u32], representative: &mut [u32]) -> Shape {
    let of = |i: u32| points[i as usize].to_array();
    let compare = |&i: &u32, &j: &u32| of(i).partial_cmp(&of(j)).expect("positions are finite");
    let mut along = indices.to_vec();
    along.sort_unstable_by(|i, j| compare(i, j).then(i.cmp(j)));
    along.dedup_by(|next, first| {
        let is_same = compare(next, first).is_eq();
        if is_same {
            representative[*next as usize] = *first;
        }
        is_same
    });
    if along.len() == 1 { Shape::Point(along[0]) } else { Shape::Line(along) }
}
