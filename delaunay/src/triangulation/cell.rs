//! What a mesh is made of: cells of four corners that know their neighbours, and the vertex at infinity.
//!
//! Beyond each face of the hull lies a *ghost*: a cell whose fourth corner is [`Vertex::INFINITE`]. With them every
//! cell has four neighbours, and a point outside the hull is inserted as one inside is.

/// A vertex, by its place in [`Sites`](super::sites::Sites).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Vertex(pub(crate) u32);

impl Vertex {
    /// The corner of all ghosts.
    pub(super) const INFINITE: Self = Self(0);

    /// As an index.
    #[inline]
    pub(super) const fn slot(self) -> usize {
        self.0 as usize
    }
}

/// A cell, by its place in the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct CellId(pub(super) u32);

impl CellId {
    /// As an index.
    #[inline]
    pub(super) const fn slot(self) -> usize {
        self.0 as usize
    }
}

/// A face of a cell, seen from the neighbour that it leads to: four times the cell, plus the face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Link(pub(super) u32);

impl Link {
    /// To face `face` of a cell.
    #[inline]
    pub(super) const fn new(cell: CellId, face: usize) -> Self {
        Self(cell.0 << 2 | face as u32)
    }

    /// The cell.
    #[inline]
    pub(super) const fn cell(self) -> CellId {
        CellId(self.0 >> 2)
    }

    /// Its face.
    #[inline]
    pub(super) const fn face(self) -> usize {
        (self.0 & 3) as usize
    }

    /// To the same face of a cell whose number is this much larger.
    #[inline]
    pub(super) const fn moved(self, offset: u32) -> Self {
        Self(self.0 + (offset << 2))
    }
}

/// Most cells: the number of different links.
pub(super) const MAX_CELLS: usize = 1 << 30;

/// The corners of each face, turned so that a positive cell lies on the side from which they run clockwise: `orient` of
/// these three and the corner opposite has one sign for all four.
pub(super) const FACE: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

/// A tetrahedron or a ghost.
///
/// Tetrahedra are positive. So is a ghost whose corner at infinity is replaced by a point beyond its face; that corner
/// is always the fourth. Half a cache line, and never parts of two.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub(super) struct Cell {
    pub(super) corners: [Vertex; 4],
    /// Entry k leads across the face opposite corner k.
    pub(super) links: [Link; 4],
}

impl Cell {
    /// Marks a freed cell. A live one never has its first corner at infinity.
    pub(super) const DEAD: Self = Self { corners: [Vertex::INFINITE; 4], links: [Link(0); 4] };

    /// Whether it lies beyond the hull.
    #[inline]
    pub(super) const fn is_ghost(&self) -> bool {
        self.corners[3].0 == Vertex::INFINITE.0
    }

    /// Whether it is live: a tetrahedron or a ghost.
    #[inline]
    pub(super) const fn is_live(&self) -> bool {
        self.corners[0].0 != Vertex::INFINITE.0
    }

    /// Whether it is a tetrahedron.
    #[inline]
    pub(super) const fn is_finite(&self) -> bool {
        !self.is_ghost()
    }
}

/// These corners with another in place k.
#[inline]
pub(super) fn replaced(mut corners: [Vertex; 4], k: usize, by: Vertex) -> [Vertex; 4] {
    corners[k] = by;
    corners
}
