//! Facts that hold for every mesh, cloud, view and set of options, as functions: property tests and fuzz targets call the
//! same ones.
//!
//! Each takes any input at all. What is refused satisfies every fact.

mod drawing;
mod estimates;
mod frames;
mod octree;
mod owned_points;
mod sampling;
mod spheres;

pub use drawing::*;
pub use estimates::*;
pub use frames::*;
pub use octree::*;
pub use owned_points::{OwnedPoints, cloud};
pub use sampling::*;
pub use spheres::*;

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}
