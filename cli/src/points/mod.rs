//! Pictures of points: what `scan` and `surfel` share.

mod cloud;
mod colouring;
mod layers;
mod legend;
mod palette;
mod reading;
mod selection;
mod tree;

pub use cloud::PointSet;
pub use colouring::{ColorBy, Colouring, Entry, Key, Legend, Part};
pub use layers::{Drawn, PointLayer, window_of};
pub use legend::draw_legend;
pub use palette::{ColorMap, MapTable, class_name};
pub use reading::{PointOptions, PointSink, read_points};
pub use selection::{Selection, Selector, WorldBox};
pub use tree::{Density, Trees, are_drawn_by_nodes, has_faces, has_nodes, write_octree};
