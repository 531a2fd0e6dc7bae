//! How points divide space: into tetrahedra, or triangles, segments or a point where they span fewer dimensions.

use crate::DelaunayError;

/// Most points of a triangulation. Random points have about seven cells each, and the number of cells must fit its
/// links.
const MAX_POINTS: usize = 1 << 27;

/// Stands for a neighbour where there is none: the side lies on the hull.
pub const OUTSIDE: u32 = u32::MAX;

/// Cells that fill the convex hull of the points, by the dimension of that hull: plain lists, to be matched on, or
/// walked alike in all dimensions by [`Partition::cells`], [`Partition::graph`] and [`Partition::hull`].
///
/// Corners are indices into the points given; of points that coincide only the first is used.
#[derive(Clone, Debug, PartialEq)]
pub enum Partition {
    /// All points coincide.
    Point(u32),
    /// The points on a line, from one end to the other.
    Line(Vec<u32>),
    /// Points in a plane.
    Triangles(Triangles),
    /// Points in space.
    Tetrahedra(Tetrahedra),
}

/// Delaunay triangles of points in a plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// Three points each, all in the same sense of rotation.
    pub corners: Vec<[u32; 3]>,
    /// Entry k is the triangle beyond the side opposite corner k, or [`OUTSIDE`].
    pub neighbours: Vec<[u32; 3]>,
}

/// Delaunay tetrahedra.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tetrahedra {
    /// Four points each, a, b, c, d with `(b−a)×(c−a)·(d−a) > 0`, exactly.
    pub corners: Vec<[u32; 4]>,
    /// Entry k is the tetrahedron beyond the face opposite corner k, or [`OUTSIDE`].
    pub neighbours: Vec<[u32; 4]>,
}

impl Partition {
    /// 3 for tetrahedra, 2 for triangles, 1 for a line, 0 for a point.
    #[must_use]
    pub const fn dimension(&self) -> usize {
        match self {
            Self::Point(_) => 0,
            Self::Line(_) => 1,
            Self::Triangles(_) => 2,
            Self::Tetrahedra(_) => 3,
        }
    }

    /// Checks that every corner is one of `count` points, that no cell has a corner twice, and that neighbours are
    /// mutual: what a walk from cell to cell relies on.
    ///
    /// # Errors
    /// [`DelaunayError::BadCell`] for the first cell that is not so; [`DelaunayError::TooManyPoints`].
    pub fn check(&self, count: usize) -> Result<(), DelaunayError> {
        // Lists by point are allocated next; a wrong count must not allocate all memory.
        check_count(count)?;
        let missing =
            |cell| DelaunayError::BadCell { cell, problem: "has a corner that is none of the points" };
        match self {
            Self::Point(only) if *only as usize >= count => Err(missing(0)),
            Self::Point(_) => Ok(()),
            Self::Line(line) => match line.iter().position(|&p| p as usize >= count) {
                Some(place) => Err(missing(place)),
                None if line.len() < 2 => {
                    Err(DelaunayError::BadCell { cell: 0, problem: "is a line of fewer than two points" })
                }
                None => match line.windows(2).position(|ends| ends[0] == ends[1]) {
                    Some(cell) => Err(DelaunayError::BadCell { cell, problem: REPEATED }),
                    None => Ok(()),
                },
            },
            Self::Triangles(t) => check_cells(&t.corners, &t.neighbours, count),
            Self::Tetrahedra(t) => check_cells(&t.corners, &t.neighbours, count),
        }
    }
}

/// Refuses more points than [`MAX_POINTS`].
pub(crate) fn check_count(count: usize) -> Result<(), DelaunayError> {
    let limit = MAX_POINTS;
    if count <= limit { Ok(()) } else { Err(DelaunayError::TooManyPoints { count, limit }) }
}

/// What is wrong with a cell that has no inside.
const REPEATED: &str = "has a corner twice";

fn check_cells<const N: usize>(
    corners: &[[u32; N]],
    neighbours: &[[u32; N]],
    count: usize,
) -> Result<(), DelaunayError> {
    let bad = |cell, problem| Err(DelaunayError::BadCell { cell, problem });
    if corners.len() != neighbours.len() {
        return bad(corners.len().min(neighbours.len()), "has corners or neighbours, but not both");
    }
    if corners.is_empty() {
        return bad(0, "is missing: a plane or a space has at least one");
    }
    for (cell, (points, next)) in corners.iter().zip(neighbours).enumerate() {
        if points.iter().any(|&p| p as usize >= count) {
            return bad(cell, "has a corner that is none of the points");
        }
        if (1..N).any(|k| points[..k].contains(&points[k])) {
            return bad(cell, REPEATED);
        }
        for &n in next.iter().filter(|&&n| n != OUTSIDE) {
            let back = neighbours.get(n as usize).is_some_and(|list| list.contains(&(cell as u32)));
            if !back {
                return bad(cell, "has a neighbour that does not have it for a neighbour");
            }
        }
    }
    Ok(())
}
