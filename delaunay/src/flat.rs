//! Points that would lie in a plane or on a line, had their coordinates not been rounded.

use crate::vertices::rounding_of;
use crate::{Delaunay, DelaunayError, Partition};
use glam::{DVec3, dvec3};

/// Roundings whose squares, and those of coordinates, keep their digits.
const USABLE: std::ops::Range<f64> = 1e-115..1e85;

impl Partition {
    /// The cells of [`Delaunay::new`], but triangles where points lie in a plane as nearly as the rounding of their coordinates, and segments
    /// where they lie so on a line.
    ///
    /// Exactly, rounded points of a tilted plane span space, and have tetrahedra between them that are as flat as the rounding: right, and
    /// useless for interpolation. Give the points as they are to [`Locator::new`](crate::Locator::new); a position off the plane or line counts
    /// as its projection. [`Partition::verify`] is exact, and does not accept such cells.
    ///
    /// # Errors
    /// As [`Delaunay::new`].
    ///
    /// ```
    /// use glam::DVec3;
    /// use pointillist_delaunay::{Delaunay, Locator, Partition};
    ///
    /// let points: Vec<DVec3> = (0..9).map(|i| DVec3::new(0.1, 0.3, 0.7) * f64::from(i)).collect();
    /// assert_eq!(Delaunay::new(&points)?.dimension(), 3);
    ///
    /// let partition = Partition::up_to_rounding(&points)?;
    /// assert_eq!(partition.dimension(), 1);
    /// let blend = Locator::new(&points, &partition)?.locate_anywhere(points[4].midpoint(points[5]))?;
    /// assert!(blend.parts().all(|(point, weight)| (4..=5).contains(&point) && (weight - 0.5).abs() < 1e-9));
    /// # Ok::<(), pointillist_delaunay::DelaunayError>(())
    /// ```
    pub fn up_to_rounding(points: &[DVec3]) -> Result<Self, DelaunayError> {
        let exact = Delaunay::new(points)?;
        match flattened(points, exact.dimension()) {
            Some(flat) => Ok(Delaunay::new(&flat)?.partition()),
            None => Ok(exact.partition()),
        }
    }
}

/// The coordinates of points along their plane, `(x, y, 0)`, or line, `(x, 0, 0)`, if they are as near to one as rounding and span more than
/// that exactly.
fn flattened(points: &[DVec3], dimension: usize) -> Option<Vec<DVec3>> {
    let rounding = rounding_of(points);
    if dimension < 2 || !USABLE.contains(&rounding) {
        return None;
    }
    // The same of points in any order.
    let in_order =
        |a: &DVec3, b: &DVec3| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z));
    let first = points.iter().copied().min_by(in_order)?;
    let longest = |offset: &dyn Fn(DVec3) -> DVec3| {
        let by_length =
            |a: &DVec3, b: &DVec3| a.length_squared().total_cmp(&b.length_squared()).then(in_order(a, b));
        points.iter().map(|&p| offset(p)).max_by(by_length)
    };
    let reach = longest(&|p| p - first)?;
    let along = reach.try_normalize().filter(|_| reach.length() > rounding)?;
    let beside = longest(&|p| (p - first) - along * along.dot(p - first))?;
    if beside.length() <= rounding {
        return Some(points.iter().map(|&p| dvec3(along.dot(p - first), 0.0, 0.0)).collect());
    }
    let across = (beside - along * along.dot(beside)).try_normalize().filter(|_| dimension == 3)?;
    let normal = along.cross(across);
    let is_flat = points.iter().all(|&p| normal.dot(p - first).abs() <= rounding);
    is_flat.then(|| points.iter().map(|&p| dvec3(along.dot(p - first), across.dot(p - first), 0.0)).collect())
}
