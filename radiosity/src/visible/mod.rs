//! What of a polygon is seen past others: exactly, as convex pieces.

pub(crate) mod boxes;
pub(crate) mod cubature;
pub(crate) mod events;
pub(crate) mod parts;
pub(crate) mod shaft;
