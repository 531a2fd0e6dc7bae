//! Points that span space or a plane: their mesh, and which point each vertex is.

use super::cavity::Cavity;
use super::cell::Vertex;
use super::insert::Inserted;
use super::mesh::Mesh;
use super::remove::Hole;
use super::sites::Sites;
use crate::{DelaunayError, OUTSIDE};
use glam::DVec3;

/// A mesh of tetrahedra, or of the triangles that are their bases.
///
/// Points of a plane get one vertex more, the apex, off the plane. A sphere through three of them and the apex meets
/// the plane in their circle, so the tetrahedra stand on the Delaunay triangles: exactly, however the plane is tilted.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    pub(super) sites: Sites,
    pub(super) mesh: Mesh,
    /// The point of each vertex; [`OUTSIDE`] for vertices without a point.
    pub(super) index: Vec<u32>,
    /// The vertex that a point is.
    vertex: Vec<Vertex>,
    /// The vertex off the plane and three in it that are not on a line, if the others all lie in it.
    pub(super) apex: Option<Vertex>,
    cavity: Cavity,
    hole: Hole,
}

/// The result of inserting a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Added {
    /// It is a vertex of the mesh.
    New,
    /// It lies where this one does.
    Same(u32),
    /// It does not fit: all has to be built anew.
    Unfit,
}

impl Solid {
    /// Of vertices 1… in this order of insertion, which are points with these indices, and perhaps an apex after them.
    pub(super) fn new(sites: Sites, mesh: Mesh, order: &[u32], apex: Option<Vertex>, points: usize) -> Self {
        let mut index = Vec::with_capacity(sites.len());
        index.push(OUTSIDE);
        index.extend_from_slice(order);
        index.extend(apex.map(|_| OUTSIDE));
        let mut vertex = vec![Vertex::INFINITE; points];
        for (v, &i) in (1..).zip(order) {
            vertex[i as usize] = Vertex(v);
        }
        let cavity = Cavity::new(sites.len());
        Self { sites, mesh, index, vertex, apex, cavity, hole: Hole::default() }
    }

    /// Of points that coincide, lets the first stand for all: `same` has a vertex and the one in the mesh that lies
    /// there. Writes the representative of each point.
    pub(super) fn merge(&mut self, same: &[(Vertex, Vertex)], representative: &mut [u32]) {
        for &(v, kept) in same {
            if self.index[v.slot()] < self.index[kept.slot()] {
                self.index.swap(v.slot(), kept.slot());
            }
        }
        for &(v, kept) in same {
            let first = self.index[kept.slot()];
            let other = std::mem::replace(&mut self.index[v.slot()], OUTSIDE);
            representative[other as usize] = first;
            self.vertex[first as usize] = kept;
            self.vertex[other as usize] = kept;
        }
    }

    /// Inserts a point of this index, one more than the last.
    pub(super) fn add(&mut self, p: DVec3, index: u32) -> Result<Added, DelaunayError> {
        let Some(v) = self.sites.push(p) else { return Ok(Added::Unfit) };
        if !self.spans(v) {
            self.sites.pop();
            return Ok(Added::Unfit);
        }
        self.cavity.grow(self.sites.len());
        let inserted = self.mesh.insert(&self.sites, &mut self.cavity, v);
        if inserted != Ok(Inserted::New) {
            self.sites.pop();
        }
        match inserted? {
            Inserted::New => {
                self.index.push(index);
                self.vertex.push(v);
                Ok(Added::New)
            }
            Inserted::Same(kept) => {
                self.vertex.push(kept);
                Ok(Added::Same(self.index[kept.slot()]))
            }
        }
    }

    /// Whether a vertex lies in the plane of all others, if they do.
    fn spans(&self, v: Vertex) -> bool {
        let Some(apex) = self.apex else { return true };
        let base = self.mesh.live().find_map(|(_, cell)| {
            let k = cell.corners.iter().position(|&c| c == apex)?;
            cell.is_finite().then(|| super::cell::replaced(cell.corners, k, v))
        });
        self.sites.orient(base.expect("a mesh has tetrahedra")) == 0.0
    }

    /// Removes the point of this index, the only one at its position. Returns false and changes nothing if the rest may
    /// span fewer dimensions.
    pub(super) fn remove(&mut self, index: u32) -> Result<bool, DelaunayError> {
        let v = self.vertex[index as usize];
        let removed = self.mesh.remove(&self.sites, &mut self.cavity, &mut self.hole, v)?;
        if removed {
            self.index[v.slot()] = OUTSIDE;
        }
        Ok(removed)
    }

    /// Lets the vertex of one point be another's in the same place.
    pub(super) fn rename(&mut self, from: u32, to: u32) {
        let v = self.vertex[from as usize];
        self.vertex[to as usize] = v;
        self.index[v.slot()] = to;
    }

    /// Whether a triangle of these points turns counterclockwise as seen along the first axis, of z, y and x, from
    /// which it is not seen edge on.
    pub(super) fn is_counterclockwise(&self, triangle: [u32; 3]) -> bool {
        self.sites
            .normal_signs(triangle.map(|i| self.vertex[i as usize]))
            .into_iter()
            .rev()
            .find(|&s| s != 0.0)
            > Some(0.0)
    }
}
