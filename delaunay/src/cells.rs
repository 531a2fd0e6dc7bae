//! Access to cells one by one, in the same way for all dimensions.

use crate::{OUTSIDE, Partition};

/// One cell of a [`Partition`]: a tetrahedron, triangle, segment or point.
#[derive(Clone, Copy, Debug)]
pub struct Cell<'a> {
    partition: &'a Partition,
    index: u32,
}

impl Partition {
    /// How many cells there are. A point is one.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        match self {
            Self::Point(_) => 1,
            Self::Line(line) => line.len().saturating_sub(1),
            Self::Triangles(t) => t.corners.len(),
            Self::Tetrahedra(t) => t.corners.len(),
        }
    }

    /// All cells, in order.
    ///
    /// ```
    /// use pointillist_delaunay::Delaunay;
    ///
    /// // A square and its middle, in a plane.
    /// let square = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 0.0], [1.0, 1.0, 0.0]];
    /// let partition = Delaunay::new(&square)?.partition();
    /// assert_eq!(partition.cells().len(), 4);
    /// // Every triangle has the middle for a corner, and two others beside it.
    /// assert!(partition.cells().all(|cell| cell.corners().contains(&4)));
    /// assert!(partition.cells().all(|cell| cell.neighbours().count() == 2));
    /// # Ok::<(), pointillist_delaunay::DelaunayError>(())
    /// ```
    pub fn cells(&self) -> impl ExactSizeIterator<Item = Cell<'_>> {
        (0..self.cell_count()).map(|index| Cell { partition: self, index: index as u32 })
    }

    /// The cell of this index, if there is one.
    #[must_use]
    pub fn cell(&self, index: u32) -> Option<Cell<'_>> {
        ((index as usize) < self.cell_count()).then_some(Cell { partition: self, index })
    }
}

impl<'a> Cell<'a> {
    /// Which cell it is, from 0.
    #[must_use]
    pub const fn index(self) -> u32 {
        self.index
    }

    /// Its corners, as indices of points: one more than the dimension.
    #[must_use]
    pub fn corners(self) -> &'a [u32] {
        let index = self.index as usize;
        match self.partition {
            Partition::Point(point) => std::slice::from_ref(point),
            Partition::Line(line) => &line[index..index + 2],
            Partition::Triangles(t) => &t.corners[index],
            Partition::Tetrahedra(t) => &t.corners[index],
        }
    }

    /// The cell beyond the side opposite corner `side`; `None` on the hull, and if there is no such corner.
    #[must_use]
    pub fn neighbour(self, side: usize) -> Option<Self> {
        let index = self.index as usize;
        let next = match self.partition {
            Partition::Point(_) => None,
            Partition::Line(_) => match side {
                0 => self.index.checked_add(1),
                1 => self.index.checked_sub(1),
                _ => None,
            },
            Partition::Triangles(t) => t.neighbours.get(index).and_then(|n| n.get(side)).copied(),
            Partition::Tetrahedra(t) => t.neighbours.get(index).and_then(|n| n.get(side)).copied(),
        };
        next.filter(|&n| n != OUTSIDE).and_then(|n| self.partition.cell(n))
    }

    /// The cells that share a side with it, by the corner opposite.
    pub fn neighbours(self) -> impl Iterator<Item = Self> {
        (0..self.corners().len()).filter_map(move |side| self.neighbour(side))
    }
}
