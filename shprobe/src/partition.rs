//! How probes divide space: tetrahedra, or what is left of them where probes lie in a plane, on a line or in one place.

/// In the place of a neighbour: beyond this side there is no cell.
pub const OUTSIDE: u32 = u32::MAX;

/// Cells that fill the convex hull of the probes, by the dimension of that hull.
///
/// Corners are indices into the points given; of points that coincide only the first is used.
#[derive(Clone, Debug, PartialEq)]
pub enum Partition {
    /// All points are one.
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
    pub const fn dimension(&self) -> usize {
        match self {
            Self::Point(_) => 0,
            Self::Line(_) => 1,
            Self::Triangles(_) => 2,
            Self::Tetrahedra(_) => 3,
        }
    }
}
