//! A mesh built vertex after vertex.

use super::cavity::Cavity;
use super::cell::Vertex;
use super::insert::Inserted;
use super::mesh::Mesh;
use super::sites::Sites;
use crate::DelaunayError;

/// Vertices that coincide: one that is not in the mesh, and the one that is.
pub(super) type Same = Vec<(Vertex, Vertex)>;

/// The mesh of these vertices, built from the first, and those that are not in it, each with the one in its place that
/// is.
pub(super) fn mesh(
    sites: &Sites,
    vertices: &[Vertex],
    first: [Vertex; 4],
) -> Result<(Mesh, Same), DelaunayError> {
    let (mut mesh, mut same) = (Mesh::with_capacity(vertices.len()), vec![]);
    let mut cavity = Cavity::new(sites.len());
    mesh.reset(sites, first);
    for &v in vertices.iter().filter(|v| !first.contains(v)) {
        if let Inserted::Same(kept) = mesh.insert(sites, &mut cavity, v)? {
            same.push((v, kept));
        }
    }
    Ok((mesh, same))
}
