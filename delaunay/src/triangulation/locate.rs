//! The cell that holds a point, found by walking.

use super::cell::{CellId, Vertex, replaced};
use super::mesh::Mesh;
use super::sites::Sites;

impl Mesh {
    /// The tetrahedron that holds a vertex, on its surface or inside, or a ghost from whose face it is strictly seen.
    ///
    /// Walks from the last cell through faces that separate the cell from the vertex. The walk terminates: the power of
    /// the vertex with respect to the cells' spheres decreases along it in every Delaunay triangulation, also with ties
    /// broken by lifting (Edelsbrunner 1990).
    #[inline(never)]
    pub(super) fn locate(&self, sites: &Sites, v: Vertex) -> CellId {
        let mut at = self.last;
        if self.cell(at).is_ghost() {
            at = self.cell(at).links[3].cell();
        }
        let mut from = usize::MAX;
        loop {
            let cell = self.cell(at);
            if cell.is_ghost() {
                return at;
            }
            let separates = |k: &usize| *k != from && sites.orient(replaced(cell.corners, *k, v)) < 0.0;
            let Some(k) = (0..4).find(separates) else { return at };
            (at, from) = (cell.links[k].cell(), cell.links[k].face());
        }
    }

    /// The corner of a cell that coincides with v.
    pub(super) fn corner_at(&self, sites: &Sites, id: CellId, v: Vertex) -> Option<Vertex> {
        let cell = self.cell(id);
        let corners = &cell.corners[..if cell.is_ghost() { 3 } else { 4 }];
        corners.iter().copied().find(|&c| sites.compare(c, v).is_eq())
    }
}
