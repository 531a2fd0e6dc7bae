//! Exact Delaunay tetrahedra of any points, in safe Rust.
#![forbid(unsafe_code)]

mod blend;
mod error;
mod hull;
#[cfg(feature = "invariants")]
pub mod invariants;
mod locator;
mod partition;
mod scale;
mod simplex;
mod triangulation;

use pointillist_parallel as parallel;

pub use blend::Blend;
pub use error::DelaunayError;
pub use locator::{Hint, Locator};
pub use partition::{OUTSIDE, Partition, Tetrahedra, Triangles};
pub use triangulation::Delaunay;
