//! Pictures of points: what `scan` and `surfel` share.

mod cloud;
mod layers;

pub use cloud::{PointOptions, PointSet};
pub use layers::{Drawn, PointLayer, window_of};
