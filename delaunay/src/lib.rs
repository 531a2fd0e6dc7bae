//! Exact Delaunay tetrahedra of any points, in safe Rust.
#![forbid(unsafe_code)]

mod blend;
mod cells;
mod circumcentre;
mod error;
mod facets;
mod graph;
mod hull;
#[cfg(feature = "invariants")]
pub mod invariants;
mod locator;
mod nearest;
mod partition;
mod scale;
mod simplex;
mod triangulation;
mod verify;
mod wide;

use pointillist_parallel as parallel;

pub use blend::Blend;
pub use cells::Cell;
pub use circumcentre::circumcentre;
pub use error::DelaunayError;
pub use facets::Facet;
pub use graph::Graph;
pub use locator::{Hint, Locator};
pub use nearest::NearestVertex;
pub use partition::{OUTSIDE, Partition, Tetrahedra, Triangles};
pub use triangulation::Delaunay;
