//! Facts that hold for every set of points, as functions: property tests and fuzz targets call the same ones.
//!
//! Each takes any input at all. What is refused satisfies every fact.

mod exact;
pub mod queries;
pub mod triangulation;
pub mod weights;

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}
