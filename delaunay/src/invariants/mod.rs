//! Facts that hold for every set of points, as functions `fn fact(…) -> Result<(), String>`: `Err` says what was found
//! instead.
//!
//! For property testers and fuzzers: the tests of this crate and its fuzz targets call them, and so can those of a
//! crate that builds on it, with the feature `invariants`. Each takes any input at all; what is refused satisfies every
//! fact.
//!
//! ```
//! use pointillist_delaunay::invariants::triangulation::partition_is_delaunay;
//! # use glam::dvec3;
//!
//! let points: Vec<_> = (0..50).map(|i| dvec3(f64::from(i % 3), f64::from(i / 3 % 5), f64::from(i / 15))).collect();
//! partition_is_delaunay(&points)?;
//! # Ok::<(), String>(())
//! ```

mod exact;
pub mod queries;
pub mod triangulation;
pub mod weights;

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}
