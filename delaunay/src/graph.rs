//! Edges, and the vertices around each vertex.

use crate::{DelaunayError, Partition};

/// The edges of a [`Partition`], by vertex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Graph {
    /// Neighbours of vertex v are `around[first[v]..first[v + 1]]`, rising.
    around: Vec<u32>,
    first: Vec<usize>,
    /// The vertex of a partition without edges.
    only: Option<u32>,
}

impl Partition {
    /// Which vertices share an edge with each vertex, of `count` points that the cells lie between.
    ///
    /// Linear in the number of cells; while it is built it takes 48 bytes a tetrahedron.
    ///
    /// # Errors
    /// [`DelaunayError::BadCell`] for cells with a corner that is not below `count`, and as [`Partition::check`].
    ///
    /// ```
    /// use pointillist_delaunay::Delaunay;
    ///
    /// let line = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    /// let graph = Delaunay::new(&line)?.partition().graph(line.len())?;
    /// assert_eq!(graph.around(2), [0, 1]);
    /// assert_eq!(graph.edges().collect::<Vec<_>>(), [[0, 2], [1, 2]]);
    /// # Ok::<(), pointillist_delaunay::DelaunayError>(())
    /// ```
    pub fn graph(&self, count: usize) -> Result<Graph, DelaunayError> {
        self.check(count)?;
        let mut first = vec![0; count + 1];
        for cell in self.cells() {
            cell.corners().iter().for_each(|&v| first[v as usize + 1] += cell.corners().len() - 1);
        }
        (0..count).for_each(|v| first[v + 1] += first[v]);
        let mut next = first.clone();
        let mut around = vec![0; first[count]];
        for cell in self.cells() {
            for &v in cell.corners() {
                for &w in cell.corners().iter().filter(|&&w| w != v) {
                    around[next[v as usize]] = w;
                    next[v as usize] += 1;
                }
            }
        }
        let only = if let Self::Point(point) = self { Some(*point) } else { None };
        Ok(Graph { around, first, only }.without_repeats(&next))
    }
}

impl Graph {
    /// Sorts the neighbours of each vertex, of which those before `ends` are set, and keeps one of each.
    fn without_repeats(mut self, ends: &[usize]) -> Self {
        let mut kept = 0;
        let count = self.point_count();
        for (v, &to) in ends.iter().enumerate().take(count) {
            let from = self.first[v];
            self.first[v] = kept;
            self.around[from..to].sort_unstable();
            for i in from..to {
                if i == from || self.around[i] != self.around[kept - 1] {
                    self.around[kept] = self.around[i];
                    kept += 1;
                }
            }
        }
        self.first[count] = kept;
        self.around.truncate(kept);
        self
    }

    /// How many points there are, vertices or not.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.first.len() - 1
    }

    /// The vertices that share an edge with this one, rising. Empty for a point that is no vertex: one that was
    /// removed, or one that coincides with a vertex.
    #[must_use]
    pub fn around(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        if v < self.point_count() { &self.around[self.first[v]..self.first[v + 1]] } else { &[] }
    }

    /// Every edge once, the lesser index first, in lexicographic order.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let of = |v: u32| self.around(v).iter().filter(move |&&w| v < w).map(move |&w| [v, w]);
        (0..self.point_count() as u32).flat_map(of)
    }

    /// Whether a point is a vertex: one with edges, or the only one.
    pub(crate) fn has(&self, vertex: u32) -> bool {
        self.only == Some(vertex) || !self.around(vertex).is_empty()
    }
}
