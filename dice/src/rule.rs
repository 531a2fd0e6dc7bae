//! Fill rules, and the parts of edges that are boundary by them.

use glam::DVec2;

/// Which points are inside of an outline, by its winding number around them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FillRule {
    /// Odd winding numbers: a ring within a ring is a hole, whatever its direction. The default.
    #[default]
    EvenOdd,
    /// Any number of times but 0: a ring within a ring is a hole only if it goes the other way round.
    NonZero,
}

impl FillRule {
    pub(crate) fn is_inside(self, winding: i32) -> bool {
        match self {
            Self::EvenOdd => winding % 2 != 0,
            Self::NonZero => winding != 0,
        }
    }
}

/// The part of an edge between the heights `from` and `to` that is boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Boundary {
    /// The ends of the edge; `top` has the smaller y.
    pub(crate) top: DVec2,
    pub(crate) bottom: DVec2,
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Whether the inside is where x is larger.
    pub(crate) inside_right: bool,
}
