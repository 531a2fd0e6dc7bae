//! Facts that hold for every mesh, cloud, view and set of options, as functions `fn fact(…) -> Result<(), String>`:
//! `Err` says what was found instead.
//!
//! For property testers and fuzzers: the tests of this crate and its fuzz targets call them, and so can those of a
//! crate that builds on it, with the feature `invariants`. Each takes any input at all; what is refused satisfies every
//! fact.
//!
//! ```
//! use pointillist_surfel::invariants::{OwnedPoints, octrees_are_sound};
//!
//! let points = OwnedPoints::sphere(glam::DVec3::ZERO, 1.0, 500).jittered(glam::DVec3::X * 0.1, 1);
//! octrees_are_sound(&points)?;
//! # Ok::<(), String>(())
//! ```

mod drawing;
mod estimates;
mod frames;
mod octree;
mod owned_points;
mod parts;
mod sampling;
mod spheres;

pub use drawing::*;
pub use estimates::*;
pub use frames::*;
pub use octree::*;
pub use owned_points::{OwnedPoints, cloud};
pub use parts::*;
pub use sampling::*;
pub use spheres::*;

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}
