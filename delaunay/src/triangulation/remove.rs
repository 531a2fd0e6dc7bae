//! Removes a vertex: the hole that it leaves is filled with cells of the triangulation of the vertices around it.
//!
//! What is Delaunay among all vertices but one, and fills its star, has corners only on the star's surface, so it is
//! Delaunay among those, and ties are broken alike (Devillers and Teillaud).

use super::cavity::Cavity;
use super::cell::{Cell, CellId, FACE, Link, MAX_CELLS, Vertex};
use super::mesh::Mesh;
use super::simplex::Simplex;
use super::sites::Sites;
use crate::DelaunayError;

/// A face of the hole.
#[derive(Clone, Copy, Debug)]
struct HoleFace {
    /// Its corners, as seen from inside.
    corners: [Vertex; 3],
    /// Across it, outside the hole.
    beyond: Link,
}

/// Working memory of removals.
#[derive(Clone, Debug, Default)]
pub(super) struct Hole {
    star: Vec<CellId>,
    faces: Vec<HoleFace>,
    /// Triangulation of the vertices around.
    patch: Mesh,
    /// Faces of the patch, by corners, sorted.
    patch_faces: Vec<([u32; 3], Link)>,
    /// Across the faces of each cell of the patch: out of the hole, where that is so.
    exits: Vec<[Option<Link>; 4]>,
    /// Cells of the patch that fill the hole, and which cell of the mesh each becomes.
    fill: Vec<CellId>,
    becomes: Vec<Option<CellId>>,
}

/// The same corners in the same sense, the least first.
fn rotated([a, b, c]: [Vertex; 3]) -> [u32; 3] {
    let [a, b, c] = [a.0, b.0, c.0];
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

fn face_of(cell: &Cell, k: usize) -> [Vertex; 3] {
    FACE[k].map(|j| cell.corners[j])
}

impl Mesh {
    /// Removes a vertex. Returns false and changes nothing if the vertices around it lie in one plane: the dimension
    /// may be lower without it.
    pub(super) fn remove(
        &mut self,
        sites: &Sites,
        cavity: &mut Cavity,
        hole: &mut Hole,
        v: Vertex,
    ) -> Result<bool, DelaunayError> {
        self.find_star(sites, hole, v);
        if !hole.triangulate(sites, cavity)? {
            return Ok(false);
        }
        hole.find_fill();
        if self.cells.len() + hole.fill.len() > MAX_CELLS {
            return Err(DelaunayError::TooManyCells { limit: MAX_CELLS });
        }
        self.fill_hole(hole);
        Ok(true)
    }

    /// The cells around v and the faces around them.
    fn find_star(&mut self, sites: &Sites, hole: &mut Hole, v: Vertex) {
        let start = self.locate(sites, v);
        let mark = self.next_mark();
        self.marks[start.slot()] = mark;
        hole.star.clear();
        hole.faces.clear();
        hole.star.push(start);
        let mut next = 0;
        while let Some(&id) = hole.star.get(next) {
            next += 1;
            let cell = *self.cell(id);
            for (k, &link) in cell.links.iter().enumerate() {
                if cell.corners[k] == v {
                    hole.faces.push(HoleFace { corners: face_of(&cell, k), beyond: link });
                } else if self.marks[link.cell().slot()] != mark {
                    self.marks[link.cell().slot()] = mark;
                    hole.star.push(link.cell());
                }
            }
        }
    }

    /// Replaces the star by what fills the hole.
    fn fill_hole(&mut self, hole: &mut Hole) {
        for &id in &hole.star {
            self.release(id);
        }
        hole.becomes.clear();
        hole.becomes.resize(hole.patch.cells.len(), None);
        for &id in &hole.fill {
            hole.becomes[id.slot()] = Some(self.allocate());
        }
        for &id in &hole.fill {
            let to = hole.becomes[id.slot()].expect("all cells that fill the hole have a place");
            let cell = *hole.patch.cell(id);
            self.cells[to.slot()].corners = cell.corners;
            for (k, exit) in hole.exits[id.slot()].iter().enumerate() {
                let inside = || {
                    let becomes =
                        hole.becomes[cell.links[k].cell().slot()].expect("only exits lead out of the hole");
                    Link::new(becomes, cell.links[k].face())
                };
                self.join(Link::new(to, k), exit.unwrap_or_else(inside));
            }
            self.last = to;
        }
    }
}

impl Hole {
    /// Triangulates the vertices around the hole; false if they lie in a plane.
    fn triangulate(&mut self, sites: &Sites, cavity: &mut Cavity) -> Result<bool, DelaunayError> {
        let mut around: Vec<Vertex> = self.faces.iter().flat_map(|f| f.corners).collect();
        // Lower numbers came first along the curve, or in earlier rounds.
        around.sort_unstable_by_key(|v| v.0);
        around.dedup();
        around.retain(|&v| v != Vertex::INFINITE);
        let Simplex::Space(first) = Simplex::new(sites, &around) else { return Ok(false) };
        self.patch.reset(sites, first);
        for &v in around.iter().filter(|v| !first.contains(v)) {
            self.patch.insert(sites, cavity, v)?;
        }
        Ok(true)
    }

    /// The cells of the patch that lie in the hole: all that are reached from its faces without leaving through one.
    fn find_fill(&mut self) {
        let faces = |(id, cell): (CellId, &Cell)| {
            std::array::from_fn::<_, 4, _>(|k| (rotated(face_of(cell, k)), Link::new(id, k)))
        };
        self.patch_faces.clear();
        self.patch_faces.extend(self.patch.live().flat_map(faces));
        self.patch_faces.sort_unstable_by_key(|(corners, _)| *corners);
        self.exits.clear();
        self.exits.resize(self.patch.cells.len(), [None; 4]);
        self.fill.clear();
        let mark = self.patch.next_mark();
        for i in 0..self.faces.len() {
            let face = self.faces[i];
            let corners = rotated(face.corners);
            let at = self.patch_faces.binary_search_by_key(&corners, |(c, _)| *c);
            let link = self.patch_faces[at.expect("faces around a star are Delaunay without its middle")].1;
            self.exits[link.cell().slot()][link.face()] = Some(face.beyond);
            self.reach(link.cell(), mark);
        }
        let mut next = 0;
        while let Some(&id) = self.fill.get(next) {
            next += 1;
            for k in 0..4 {
                if self.exits[id.slot()][k].is_none() {
                    self.reach(self.patch.cell(id).links[k].cell(), mark);
                }
            }
        }
    }

    fn reach(&mut self, id: CellId, mark: u32) {
        if self.patch.marks[id.slot()] != mark {
            self.patch.marks[id.slot()] = mark;
            self.fill.push(id);
        }
    }
}
