//! The triangulation itself: exact, incremental, of any finite points. References are those of the crate's
//! documentation.
//!
//! 1. Coordinates are multiplied by a power of two and, where all are multiples of one, counted from the least
//!    (`scale.rs`): without rounding, unless their magnitudes span more than `f64` holds.
//! 2. Points are ordered in random rounds, each along a Hilbert curve (\[4\], `hilbert.rs`), and inserted one by one
//!    (\[1\], \[2\]).
//! 3. A point is found by a walk from the one before (`locate.rs`). The cells whose spheres hold it are removed, and it
//!    is joined to the faces of the hole (`insert.rs`, `cavity.rs`). Cells beyond the hull, *ghosts* that share a
//!    vertex at infinity (`cell.rs`), make the outside like the inside; there is no enclosing tetrahedron.
//! 4. Whether a point lies on a side of a plane or in a sphere is decided in `sites.rs`: by a determinant in `f64`
//!    where it exceeds its error, and exactly elsewhere (`exact.rs`, `limbs.rs`, `wide.rs`). Ties are broken by a
//!    symbolic perturbation (\[3\]).
//! 5. With several threads, parts divided by planes are built at once and joined (\[6\], `divide.rs`, `border.rs`,
//!    `seam.rs`).
//! 6. A point is removed by triangulating the vertices around it alone (\[3\], `remove.rs`).
//! 7. Cells are reported in an order that depends on the points alone (`canonical.rs`).
//!
//! Points in a plane get one vertex more, off the plane: the bases of the tetrahedra are their Delaunay triangles, also
//! where the plane is tilted (`solid.rs`). Points on a line are ordered along it (`build.rs`).

mod border;
mod build;
mod canonical;
mod cavity;
mod cell;
mod divide;
mod exact;
mod hilbert;
mod incremental;
mod insert;
mod limbs;
mod locate;
mod mesh;
mod remove;
mod scale;
mod seam;
mod simplex;
mod sites;
mod solid;

use crate::partition::check_count;
use crate::{DelaunayError, OUTSIDE, Partition};
pub(crate) use cell::Vertex;
pub(crate) use sites::Sites;

use build::Shape;
use glam::DVec3;
use solid::Added;

/// A Delaunay triangulation that grows and shrinks: of space, or of the plane or line in which all points lie.
#[derive(Clone, Debug)]
pub struct Delaunay {
    /// All points that were ever given.
    points: Vec<DVec3>,
    /// [`OUTSIDE`] for those removed.
    representative: Vec<u32>,
    live: usize,
    /// Points that another one, which coincides with them, represents.
    duplicates: usize,
    shape: Shape,
}

impl Delaunay {
    /// Of these points: `DVec3`, `[f64; 3]` or `(f64, f64, f64)`. Points that lie in one plane, such as z = 0, give its
    /// triangles.
    ///
    /// # Errors
    /// [`DelaunayError::NoPoints`], [`DelaunayError::TooManyPoints`], [`DelaunayError::TooManyCells`], and
    /// [`DelaunayError::PointNotFinite`] for the first that is not.
    ///
    /// ```
    /// use pointillist_delaunay::Delaunay;
    ///
    /// let delaunay = Delaunay::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])?;
    /// assert_eq!((delaunay.dimension(), delaunay.partition().cell_count()), (3, 1));
    /// # Ok::<(), pointillist_delaunay::DelaunayError>(())
    /// ```
    pub fn new<P: Copy + Into<DVec3>>(points: &[P]) -> Result<Self, DelaunayError> {
        Self::of_points(points.iter().map(|&p| p.into()).collect())
    }

    fn of_points(points: Vec<DVec3>) -> Result<Self, DelaunayError> {
        if points.is_empty() {
            return Err(DelaunayError::NoPoints);
        }
        check_count(points.len())?;
        (0..).zip(&points).try_for_each(|(i, p)| check_finite(i, *p))?;
        let count = points.len();
        Self::of(points, vec![0; count])
    }

    /// Of those points whose representative is not [`OUTSIDE`].
    fn of(points: Vec<DVec3>, mut representative: Vec<u32>) -> Result<Self, DelaunayError> {
        let indices: Vec<u32> =
            (0..points.len() as u32).filter(|&i| representative[i as usize] != OUTSIDE).collect();
        let shape = build::shape(&points, &indices, &mut representative)?;
        let duplicates = indices.iter().filter(|&&i| representative[i as usize] != i).count();
        Ok(Self { points, representative, live: indices.len(), duplicates, shape })
    }

    /// 3 if the points span space, 2 if they lie in a plane, 1 on a line, 0 if they coincide.
    #[must_use]
    pub fn dimension(&self) -> usize {
        match &self.shape {
            Shape::Point(_) => 0,
            Shape::Line(_) => 1,
            Shape::Solid(solid) => 3 - usize::from(solid.apex.is_some()),
        }
    }

    /// For each point given, the first that coincides with it, mostly itself; [`OUTSIDE`] if it was removed.
    #[must_use]
    pub fn representative(&self) -> &[u32] {
        &self.representative
    }

    /// The points given, those removed too.
    #[must_use]
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// The cells. For the same points it is the same value, however they came to be there.
    #[must_use]
    pub fn partition(&self) -> Partition {
        match &self.shape {
            Shape::Point(index) => Partition::Point(*index),
            Shape::Line(along) => Partition::Line(along.clone()),
            Shape::Solid(solid) => canonical::partition(solid),
        }
    }

    /// How many points there are, without those removed.
    #[must_use]
    pub const fn live_count(&self) -> usize {
        self.live
    }

    /// Adds a point and returns its index: one more than the largest so far, those removed included. Indices are not
    /// used again; [`Delaunay::compact`] gives back their memory.
    ///
    /// # Errors
    /// The point is not finite, or one too many. Then nothing has changed.
    pub fn insert(&mut self, point: impl Into<DVec3>) -> Result<u32, DelaunayError> {
        self.insert_point(point.into())
    }

    fn insert_point(&mut self, point: DVec3) -> Result<u32, DelaunayError> {
        let index = self.points.len();
        check_finite(index, point)?;
        check_count(index + 1)?;
        let index = index as u32;
        let added = match &mut self.shape {
            Shape::Solid(solid) => solid.add(point, index)?,
            _ => Added::Unfit,
        };
        let representative = match added {
            Added::Unfit => {
                return self.rebuild(|points, r| [points.push(point), r.push(index)]).map(|()| index);
            }
            Added::New => index,
            Added::Same(first) => first,
        };
        self.points.push(point);
        self.representative.push(representative);
        self.live += 1;
        self.duplicates += usize::from(representative != index);
        Ok(index)
    }

    /// Removes a point. Indices of the others stay.
    ///
    /// # Errors
    /// There is no such point, or no other one. Then nothing has changed.
    pub fn remove(&mut self, index: u32) -> Result<(), DelaunayError> {
        let first = self.representative.get(index as usize).copied().filter(|&r| r != OUTSIDE);
        let first = first.ok_or(DelaunayError::NoSuchPoint { index })?;
        if self.live == 1 {
            return Err(DelaunayError::NoPoints);
        }
        if first != index {
            self.duplicates -= 1;
        } else if let Some(next) = self.next_duplicate(index) {
            self.hand_over(index, next);
        } else {
            let removed = match &mut self.shape {
                Shape::Solid(solid) => solid.remove(index)?,
                _ => false,
            };
            if !removed {
                return self.rebuild(|_, r| r[index as usize] = OUTSIDE);
            }
        }
        self.representative[index as usize] = OUTSIDE;
        self.live -= 1;
        Ok(())
    }

    /// Forgets the points that were removed and numbers the rest anew, in the same order. Returns the new index of each
    /// old one, and [`OUTSIDE`] for those removed.
    ///
    /// Call it now and then if you insert and remove for long, for example when `points().len()` is twice
    /// [`Delaunay::live_count`]: it costs what building costs, so it adds a constant amount to each insertion.
    ///
    /// # Errors
    /// [`DelaunayError::TooManyCells`], as of building. Then nothing has changed.
    ///
    /// ```
    /// use pointillist_delaunay::{Delaunay, OUTSIDE};
    ///
    /// let mut delaunay = Delaunay::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])?;
    /// delaunay.remove(1)?;
    /// assert_eq!(delaunay.compact()?, [0, OUTSIDE, 1]);
    /// assert_eq!(delaunay.points().len(), 2);
    /// # Ok::<(), pointillist_delaunay::DelaunayError>(())
    /// ```
    pub fn compact(&mut self) -> Result<Vec<u32>, DelaunayError> {
        let is_live = |i: usize| self.representative[i] != OUTSIDE;
        let mut next = 0;
        let number = |i: usize| {
            let number = if is_live(i) { next } else { OUTSIDE };
            next += u32::from(is_live(i));
            number
        };
        let renumbered = (0..self.points.len()).map(number).collect();
        let kept: Vec<DVec3> =
            (0..self.points.len()).filter(|&i| is_live(i)).map(|i| self.points[i]).collect();
        *self = Self::of_points(kept)?;
        Ok(renumbered)
    }

    /// The next point that coincides with this one.
    fn next_duplicate(&self, index: u32) -> Option<u32> {
        let after = index as usize + 1;
        let at = self.representative[after..].iter().position(|&r| r == index);
        at.filter(|_| self.duplicates > 0).map(|at| (after + at) as u32)
    }

    /// Makes another coincident point the representative of all points that this one represents.
    fn hand_over(&mut self, from: u32, to: u32) {
        self.representative.iter_mut().filter(|r| **r == from).for_each(|r| *r = to);
        self.duplicates -= 1;
        match &mut self.shape {
            Shape::Point(index) => *index = to,
            Shape::Line(along) => along.iter_mut().filter(|i| **i == from).for_each(|i| *i = to),
            Shape::Solid(solid) => solid.rename(from, to),
        }
    }

    /// Builds all anew, after a change to points and representatives that is undone if that fails.
    fn rebuild<T>(
        &mut self,
        change: impl FnOnce(&mut Vec<DVec3>, &mut Vec<u32>) -> T,
    ) -> Result<(), DelaunayError> {
        let (mut points, mut representative) = (self.points.clone(), self.representative.clone());
        change(&mut points, &mut representative);
        *self = Self::of(points, representative)?;
        Ok(())
    }
}

fn check_finite(index: usize, p: DVec3) -> Result<(), DelaunayError> {
    if p.is_finite() { Ok(()) } else { Err(DelaunayError::PointNotFinite { index }) }
}
