//! Where to put probes.
//!
//! * [`grid`], [`random`], [`spread`]: without knowing the light.
//! * [`adaptive`]: from candidates whose light is known, those between which the others are interpolated best.

mod adaptive;
mod regular;
mod thin;
mod trial;

pub use adaptive::{Adaptive, AdaptiveOptions, adaptive};
pub use regular::{grid, random, spread};
pub use trial::Candidates;
