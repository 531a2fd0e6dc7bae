//! Where to put probes.
//!
//! * [`grid`], [`random`], [`spread`]: without knowing the light.
//! * [`adaptive`]: from candidates whose light is known, those between which the others are interpolated best.
//! * [`openings`], [`near_openings`]: where what is seen changes, and more candidates are needed.
//! * [`fit`]: what those should hold so that all candidates are lit right.

mod adaptive;
mod fit;
mod openings;
mod regular;
mod sighted;
mod thin;
mod trial;

pub use adaptive::{Adaptive, AdaptiveOptions, adaptive};
pub use fit::{FitOptions, fit};
pub use openings::{near_openings, openings};
pub use regular::{grid, random, spread};
pub use trial::{BALANCE, Candidates};
