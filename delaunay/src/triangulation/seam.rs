//! Cuts the border out of the two halves and inserts the new cells between them.

use super::cell::{Cell, CellId, Link, MAX_CELLS, Vertex};
use super::mesh::Mesh;
use crate::DelaunayError;
use std::collections::{HashMap, HashSet};

/// Corners in a fixed order.
fn sorted<const N: usize>(corners: [Vertex; N]) -> [u32; N] {
    let mut sorted = corners.map(|v| v.0);
    sorted.sort_unstable();
    sorted
}

/// Corners of a cell in an order that depends on the cell alone. Those of a ghost keep the orientation of its face:
/// with the rest of one half missing, a patch can have the same face on its hull with the opposite orientation.
fn cell_key(cell: &Cell) -> [u32; 4] {
    if cell.is_finite() {
        return sorted(cell.corners);
    }
    let [a, b, c, infinite] = cell.corners.map(|v| v.0);
    let least = a.min(b).min(c);
    let [a, b, c] =
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().find(|t| t[0] == least).expect("one of three is least");
    [infinite, a, b, c]
}

fn face_key(cell: &Cell, k: usize) -> [u32; 3] {
    sorted([1, 2, 3].map(|j| cell.corners[(k + j) % 4]))
}

/// The cells that were cut out, and what they leave open.
pub(super) struct Seam {
    /// Faces of cells left that are open now, by corners.
    open: HashMap<[u32; 3], Link>,
    /// Cells cut out, by corners.
    cut: HashSet<[u32; 4]>,
}

impl Seam {
    /// Takes these cells out of a mesh.
    pub(super) fn cut(mesh: &mut Mesh, cells: &[CellId]) -> Self {
        let mut is_cut = vec![false; mesh.cells.len()];
        cells.iter().for_each(|id| is_cut[id.slot()] = true);
        let mut open = HashMap::new();
        for cell in cells.iter().map(|&id| mesh.cell(id)) {
            let faces = cell.links.into_iter().enumerate().filter(|(_, link)| !is_cut[link.cell().slot()]);
            open.extend(faces.map(|(k, link)| (face_key(cell, k), link)));
        }
        let cut = cells.iter().map(|&id| cell_key(mesh.cell(id))).collect();
        cells.iter().for_each(|&id| mesh.release(id));
        Self { open, cut }
    }

    /// Puts in those cells of a patch that have corners on both sides, 1 and 2, or were there before.
    pub(super) fn sew(&self, mesh: &mut Mesh, patch: &Mesh, sides: &[u8]) -> Result<(), DelaunayError> {
        let belongs = |cell: &Cell| {
            let sides = cell.corners.iter().fold(0, |all, v| all | sides[v.slot()]);
            sides == 3 || self.cut.contains(&cell_key(cell))
        };
        let mut becomes = vec![None; patch.cells.len()];
        for (id, _) in patch.live().filter(|(_, cell)| belongs(cell)) {
            becomes[id.slot()] = Some(mesh.allocate());
        }
        if mesh.cells.len() > MAX_CELLS {
            return Err(DelaunayError::TooManyCells { limit: MAX_CELLS });
        }
        let mut sewn = 0;
        for (id, cell) in patch.live() {
            let Some(to) = becomes[id.slot()] else { continue };
            mesh.cells[to.slot()].corners = cell.corners;
            mesh.last = to;
            for (k, link) in cell.links.into_iter().enumerate() {
                let inner = becomes[link.cell().slot()].map(|id| Link::new(id, link.face()));
                sewn += usize::from(inner.is_none());
                let outer = || self.open.get(&face_key(cell, k)).copied();
                mesh.join(
                    Link::new(to, k),
                    inner.or_else(outer).expect("the patch ends where the halves are open"),
                );
            }
        }
        assert!(sewn == self.open.len(), "the patch fills all that was cut out");
        Ok(())
    }
}
