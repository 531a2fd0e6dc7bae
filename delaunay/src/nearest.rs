//! The vertex nearest to a position.
//!
//! From a vertex that is not the nearest an edge leads to one that is nearer: the way to the position leaves the
//! vertex's Voronoi cell through a facet, beyond which such a vertex lies. So walking downhill ends at the nearest, in
//! exact arithmetic, and comparisons are exact.

use crate::wide;
use crate::{DelaunayError, Graph, Partition};
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BTreeSet;

/// Finds the vertex of a triangulation that is nearest to a position.
///
/// ```
/// use glam::dvec3;
/// use pointillist_delaunay::{Delaunay, NearestVertex};
///
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let delaunay = Delaunay::new(&corners)?;
/// let nearest = NearestVertex::new(delaunay.points(), &delaunay.partition())?;
/// assert_eq!(nearest.find(dvec3(0.9, 0.2, -5.0))?, 1);
/// # Ok::<(), pointillist_delaunay::DelaunayError>(())
/// ```
#[derive(Clone, Debug)]
pub struct NearestVertex {
    points: Vec<DVec3>,
    graph: Graph,
    /// Vertices, about the cube root of their number; a walk starts from the nearest of these.
    starts: Vec<u32>,
}

/// Bounds the rounding of a difference of squared distances, over the sum of the absolute values of its terms: each
/// term is a product of a difference and a sum of two differences (4 roundings of half an ulp), and two sums follow;
/// doubled.
const ROUNDING: f64 = 6.0 * f64::EPSILON;

/// Products that underflow add less error than this.
const LEAST_BOUND: f64 = 1e-300;

impl NearestVertex {
    /// For points and the cells between them, as [`Delaunay::partition`](crate::Delaunay::partition) gives them.
    ///
    /// Answers are right if the cells are Delaunay; if they are not, they may be another vertex.
    ///
    /// # Errors
    /// [`DelaunayError::PointNotFinite`], and [`DelaunayError::BadCell`] for cells that are not between these points.
    pub fn new(points: &[DVec3], partition: &Partition) -> Result<Self, DelaunayError> {
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(DelaunayError::PointNotFinite { index });
        }
        let graph = partition.graph(points.len())?;
        let vertices: Vec<u32> = (0..points.len() as u32).filter(|&v| graph.has(v)).collect();
        let step = (vertices.len() as f64).powf(2.0 / 3.0).ceil().max(1.0) as usize;
        let starts = vertices.into_iter().step_by(step).collect();
        Ok(Self { points: points.to_vec(), graph, starts })
    }

    /// The edges between the vertices.
    #[must_use]
    pub const fn graph(&self) -> &Graph {
        &self.graph
    }

    /// The nearest vertex; of several that are equally near the one of least index. Exact for all finite coordinates.
    ///
    /// Takes about n^⅓ steps; [`NearestVertex::find_from`] takes as many as there are vertices on the way.
    ///
    /// # Errors
    /// [`DelaunayError::QueryNotFinite`].
    pub fn find(&self, query: DVec3) -> Result<u32, DelaunayError> {
        let near = |a: &&u32, b: &&u32| {
            self.points[**a as usize]
                .distance_squared(query)
                .total_cmp(&self.points[**b as usize].distance_squared(query))
        };
        let start = self.starts.iter().min_by(near).expect("a partition has a vertex");
        self.find_from(query, *start)
    }

    /// As [`NearestVertex::find`], from a vertex that is near already, such as the answer to the query before.
    ///
    /// # Errors
    /// [`DelaunayError::QueryNotFinite`], and [`DelaunayError::NoSuchPoint`] if `start` is no vertex.
    pub fn find_from(&self, query: DVec3, start: u32) -> Result<u32, DelaunayError> {
        if !query.is_finite() {
            return Err(DelaunayError::QueryNotFinite { index: 0 });
        }
        if !self.graph.has(start) {
            return Err(DelaunayError::NoSuchPoint { index: start });
        }
        let mut at = start;
        loop {
            let mut best = at;
            for &v in self.graph.around(at) {
                if self.compare(query, v, best).is_lt() {
                    best = v;
                }
            }
            if best == at {
                return Ok(self.least_of_ties(query, at));
            }
            at = best;
        }
    }

    /// The least index among vertices as near as the nearest: edges connect them, since they are corners of one Voronoi
    /// vertex's cells.
    fn least_of_ties(&self, query: DVec3, nearest: u32) -> u32 {
        let mut ties = BTreeSet::from([nearest]);
        let mut open = vec![nearest];
        while let Some(at) = open.pop() {
            for &v in self.graph.around(at) {
                if self.compare(query, v, nearest).is_eq() && ties.insert(v) {
                    open.push(v);
                }
            }
        }
        ties.first().copied().unwrap_or(nearest)
    }

    /// Exact order of the distances of two vertices from p.
    fn compare(&self, p: DVec3, v: u32, w: u32) -> Ordering {
        let (a, b) = (self.points[v as usize], self.points[w as usize]);
        // |a−p|² − |b−p|² = (a−b)·((a−p) + (b−p)).
        let (to_a, to_b, step) = (a - p, b - p, a - b);
        let difference = step.dot(to_a + to_b);
        let bound = ROUNDING * step.abs().dot(to_a.abs() + to_b.abs()) + LEAST_BOUND;
        if difference.abs() > bound {
            return difference.total_cmp(&0.0);
        }
        let (to_a, to_b) = (wide::difference(a, p), wide::difference(b, p));
        wide::dot(&to_a, &to_a).cmp(&wide::dot(&to_b, &to_b))
    }
}
