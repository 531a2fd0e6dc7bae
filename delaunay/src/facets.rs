//! The surface of the convex hull: sides of cells beyond which there is no cell.

use crate::{Cell, Partition};

/// A side of a cell: a triangle of a tetrahedron, an edge of a triangle, an end of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet {
    cell: u32,
    side: usize,
    corners: [u32; 3],
    count: usize,
}

/// The corners of a tetrahedron opposite each corner, counterclockwise as seen from outside.
const OUTWARD: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

impl Facet {
    /// The side of a cell that lies opposite one of its corners.
    pub(crate) fn of(cell: Cell<'_>, side: usize) -> Self {
        let of = cell.corners();
        let count = of.len() - 1;
        let mut corners = [0; 3];
        for (i, corner) in corners.iter_mut().take(count).enumerate() {
            let place = if of.len() == 4 { OUTWARD[side][i] } else { (side + 1 + i) % of.len() };
            *corner = of[place];
        }
        Self { cell: cell.index(), side, corners, count }
    }

    /// Its corners, as indices of points: as many as the dimension. Of a tetrahedron counterclockwise as seen from
    /// outside; of a triangle in the sense of that triangle.
    #[must_use]
    pub fn corners(&self) -> &[u32] {
        &self.corners[..self.count]
    }

    /// The cell that it is a side of.
    #[must_use]
    pub const fn cell(&self) -> u32 {
        self.cell
    }

    /// Which corner of the cell it lies opposite to.
    #[must_use]
    pub const fn side(&self) -> usize {
        self.side
    }

    /// Its corners in rising order, unused entries last: the same for both cells that share it.
    pub(crate) fn key(&self) -> [u32; 3] {
        let mut key = [u32::MAX; 3];
        key[..self.count].copy_from_slice(self.corners());
        key[..self.count].sort_unstable();
        key
    }
}

impl Partition {
    /// The facets of the convex hull: triangles around tetrahedra, edges around triangles, the two ends of a line. A
    /// point has none.
    ///
    /// Points that lie in a facet of the hull divide it, so that facets may lie in one plane.
    ///
    /// ```
    /// use pointillist_delaunay::Delaunay;
    ///
    /// let tetrahedron = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.1, 0.1, 0.1]];
    /// let hull = Delaunay::new(&tetrahedron)?.partition().hull();
    /// assert_eq!(hull.len(), 4);
    /// assert!(hull.iter().all(|facet| !facet.corners().contains(&4)));
    /// # Ok::<(), pointillist_delaunay::DelaunayError>(())
    /// ```
    #[must_use]
    pub fn hull(&self) -> Vec<Facet> {
        if self.dimension() == 0 {
            return vec![];
        }
        let open = |cell: Cell<'_>| {
            let facet = |side| cell.neighbour(side).is_none().then(|| Facet::of(cell, side));
            (0..cell.corners().len()).filter_map(facet).collect::<Vec<_>>()
        };
        self.cells().flat_map(open).collect()
    }
}
