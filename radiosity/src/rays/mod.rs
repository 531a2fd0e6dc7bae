//! Rays: the nearest surface in a direction, and directions and points that cover what they shall evenly.

pub(crate) mod sequence;
pub(crate) mod tree;
