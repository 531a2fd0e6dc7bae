//! Facts that hold for every pair of polygons and every scene, as functions: property tests and fuzz targets call the same ones.
//!
//! Each takes any input at all. What is refused satisfies every fact.

pub mod factors;
pub mod paths;
pub mod reference;
pub mod scenes;

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}
