//! The cells, the list of freed ones, and marks on cells.

use super::cell::{Cell, CellId, Link, MAX_CELLS, Vertex, replaced};
use super::sites::Sites;
use crate::DelaunayError;

/// A Delaunay triangulation of some of the vertices of [`Sites`], ghosts included.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) cells: Vec<Cell>,
    /// What a search has found about a cell: valid if not less than [`Mesh::mark`].
    pub(super) marks: Vec<u32>,
    /// Marks of the latest search: this for cells in the cavity, one more for cells around it.
    pub(super) mark: u32,
    pub(super) free: Vec<CellId>,
    /// Where the next search starts; live.
    pub(super) last: CellId,
}

/// Cells per vertex of random points, ghosts included, with a margin.
const CELLS_PER_VERTEX: usize = 7;

impl Mesh {
    /// An empty mesh with memory reserved for random points; memory that is not needed is never touched.
    pub(super) fn with_capacity(vertices: usize) -> Self {
        let cells = CELLS_PER_VERTEX * vertices;
        Self { cells: Vec::with_capacity(cells), marks: Vec::with_capacity(cells), ..Self::default() }
    }

    /// One tetrahedron, its corners not in one plane, and the four ghosts around it.
    pub(super) fn reset(&mut self, sites: &Sites, mut corners: [Vertex; 4]) {
        if sites.orient(corners) < 0.0 {
            corners.swap(2, 3);
        }
        self.cells.clear();
        self.free.clear();
        self.cells.push(Cell { corners, links: std::array::from_fn(|k| Link::new(CellId(k as u32 + 1), 3)) });
        self.cells.extend((0..4).map(|k| Self::first_ghost(corners, k)));
        self.marks.clear();
        self.marks.resize(5, 0);
        (self.mark, self.last) = (0, CellId(0));
    }

    /// The ghost across face k of the first tetrahedron.
    fn first_ghost(of: [Vertex; 4], k: usize) -> Cell {
        let corners_of = |k: usize| {
            let mut corners = replaced(of, k, Vertex::INFINITE);
            // Seen from outside, the face is turned: two corners change places, and the fourth is the one at infinity.
            if k == 3 {
                corners.swap(0, 1)
            } else {
                corners.swap(k, 3)
            }
            corners
        };
        let corners = corners_of(k);
        let position =
            |corners: [Vertex; 4], v: Vertex| corners.iter().position(|&c| c == v).expect("v is a corner");
        let mut links = [Link::new(CellId(0), k); 4];
        for (j, &corner) in corners.iter().enumerate().take(3) {
            let across = position(of, corner);
            links[j] = Link::new(CellId(across as u32 + 1), position(corners_of(across), of[k]));
        }
        Cell { corners, links }
    }

    /// The cell of this number.
    #[inline]
    pub(super) fn cell(&self, id: CellId) -> &Cell {
        &self.cells[id.slot()]
    }

    /// Marks for a new search, which no cell has yet.
    pub(super) fn next_mark(&mut self) -> u32 {
        if self.mark > u32::MAX - 4 {
            self.marks.fill(0);
            self.mark = 0;
        }
        self.mark += 2;
        self.mark
    }

    /// A cell to write to: a free one or a new one.
    pub(super) fn allocate(&mut self) -> CellId {
        self.free.pop().unwrap_or_else(|| {
            let id = CellId(self.cells.len() as u32);
            self.cells.push(Cell::DEAD);
            self.marks.push(0);
            id
        })
    }

    /// Frees a cell.
    pub(super) fn release(&mut self, id: CellId) {
        self.cells[id.slot()] = Cell::DEAD;
        self.free.push(id);
    }

    /// Makes two faces each other's neighbours.
    #[inline]
    pub(super) fn join(&mut self, a: Link, b: Link) {
        self.cells[a.cell().slot()].links[a.face()] = b;
        self.cells[b.cell().slot()].links[b.face()] = a;
    }

    /// All live cells.
    pub(super) fn live(&self) -> impl Iterator<Item = (CellId, &Cell)> {
        let numbered = self.cells.iter().enumerate().map(|(i, cell)| (CellId(i as u32), cell));
        numbered.filter(|(_, cell)| cell.is_live())
    }

    /// Adds the cells of another mesh, and returns how much larger their numbers are now.
    pub(super) fn append(&mut self, other: Self) -> Result<u32, DelaunayError> {
        if self.cells.len() + other.cells.len() > MAX_CELLS {
            return Err(DelaunayError::TooManyCells { limit: MAX_CELLS });
        }
        let offset = self.cells.len() as u32;
        let moved = |cell: Cell| Cell { links: cell.links.map(|link| link.moved(offset)), ..cell };
        self.cells.extend(other.cells.into_iter().map(moved));
        self.free.extend(other.free.into_iter().map(|id| CellId(id.0 + offset)));
        self.marks.resize(self.cells.len(), 0);
        Ok(offset)
    }
}
