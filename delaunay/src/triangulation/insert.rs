//! Inserts a vertex: cells whose spheres hold it are removed, and it is joined to the faces of the hole (Bowyer;
//! Watson).

use super::cavity::Cavity;
use super::cell::{Cell, CellId, Link, MAX_CELLS, Vertex};
use super::mesh::Mesh;
use super::sites::Sites;
use crate::DelaunayError;

/// The result of an insertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Inserted {
    /// It is in the mesh now.
    New,
    /// This one, already there, lies in the same place.
    Same(Vertex),
}

impl Mesh {
    /// Inserts a vertex.
    pub(super) fn insert(
        &mut self,
        sites: &Sites,
        cavity: &mut Cavity,
        v: Vertex,
    ) -> Result<Inserted, DelaunayError> {
        let start = self.locate(sites, v);
        if let Some(same) = self.corner_at(sites, start, v) {
            return Ok(Inserted::Same(same));
        }
        self.dig(sites, cavity, start, v);
        if self.cells.len() + cavity.rim().len() > MAX_CELLS {
            return Err(DelaunayError::TooManyCells { limit: MAX_CELLS });
        }
        self.fill(cavity, v);
        Ok(Inserted::New)
    }

    /// Finds the cells whose spheres hold v, from one of them, and the faces around them.
    ///
    /// Branch prediction cannot foresee whether a cell's sphere holds v. So every candidate is written, and only the
    /// count depends on the test: this saves a fifth of the time of the whole construction.
    #[inline(never)]
    fn dig(&mut self, sites: &Sites, cavity: &mut Cavity, start: CellId, v: Vertex) {
        let inside = self.next_mark();
        cavity.start(start);
        self.marks[start.slot()] = inside;
        let mut next = 0;
        while let Some(id) = cavity.dug_cell(next) {
            next += 1;
            let links = self.cell(id).links;
            for (k, link) in links.into_iter().enumerate() {
                let beyond = link.cell();
                let mut mark = self.marks[beyond.slot()];
                if mark < inside {
                    let holds = self.conflicts(sites, beyond, v);
                    mark = inside + u32::from(!holds);
                    self.marks[beyond.slot()] = mark;
                    cavity.add_dug(beyond, holds);
                }
                cavity.add_rim(Link::new(id, k), link, mark != inside);
            }
        }
    }

    /// Whether the sphere of a cell holds v.
    ///
    /// The sphere of a ghost is the half space beyond its face; in the plane of the face it is the disc that the sphere
    /// of the tetrahedron behind it cuts out.
    #[inline]
    fn conflicts(&self, sites: &Sites, id: CellId, v: Vertex) -> bool {
        let Cell { corners, links } = *self.cell(id);
        if corners[3] != Vertex::INFINITE {
            return sites.in_sphere(corners, v);
        }
        let [a, b, c, _] = corners;
        let side = sites.orient([a, b, c, v]);
        if side != 0.0 { side > 0.0 } else { sites.in_sphere(self.cell(links[3].cell()).corners, v) }
    }

    /// Replaces the cells of the cavity by new ones around the vertex.
    #[inline(never)]
    fn fill(&mut self, cavity: &mut Cavity, v: Vertex) {
        while cavity.missing() > 0 {
            let id = self.allocate();
            cavity.add_cell(id);
        }
        cavity.pair_edges(&self.cells, v);
        // Written last, because edges are read from the old cells.
        for id in cavity.spare() {
            self.release(id);
        }
        for (face, id) in cavity.faces() {
            self.cells[id.slot()] = Cell { corners: face.corners, links: cavity.links_of(face) };
            self.cells[face.beyond.cell().slot()].links[face.beyond.face()] = Link::new(id, face.slot());
            self.last = id;
        }
    }
}
