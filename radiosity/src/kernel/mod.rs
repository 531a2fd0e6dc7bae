//! Exchange between two polygons with nothing between them: the cheapest rule that is accurate enough.

pub(crate) mod edges;
pub(crate) mod gauss;
pub(crate) mod pair;
