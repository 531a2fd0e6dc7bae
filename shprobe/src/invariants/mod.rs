//! Facts that hold for every field of probes, as functions `fn fact(…) -> Result<(), String>`: `Err` says what was
//! found instead.
//!
//! For property testers and fuzzers: the tests of this crate and its fuzz target call them, and so can those of a crate
//! that builds on it, with the feature `invariants`. Each takes any input at all; what is refused satisfies every fact.
//! Facts about cells and about harmonics are in the modules of that name in [`crate::delaunay`] and [`crate::sh`].
//!
//! ```
//! use pointillist_shprobe::{invariants::constant_light_stays_constant, place};
//! use glam::DVec3;
//!
//! let positions = place::random(DVec3::ZERO, DVec3::ONE, 20, 7);
//! constant_light_stays_constant(&positions, None, 3.0, &[DVec3::ONE * 0.5, DVec3::ONE * 4.0])?;
//! # Ok::<(), String>(())
//! ```

mod changes;
mod continuous;
mod light;
mod sight;

pub use changes::{changes_give_the_field_of_the_result, fields_are_equal, insert_then_remove_restores};
pub use continuous::{Place, shares_do_not_jump};
pub use light::{CONSTANT_ERROR, constant_light_stays_constant, hints_do_not_matter, shares_sum_to_one};
pub use sight::{
    at_most_so_many_probes_light_a_position, spread_positions_are_far_apart, visibility_falls_with_distance,
};

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}
