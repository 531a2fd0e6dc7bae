//! Light from far away: maps of all directions, sharp, and blurred as rough surfaces mirror them.

mod cube;
mod equirectangular;
mod prefilter;

pub use cube::{CubeMap, cube_direction, cube_place};
pub use equirectangular::{Equirectangular, equirectangular_direction, equirectangular_uv};
pub use prefilter::Environment;
