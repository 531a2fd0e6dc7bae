//! Radiosity of a scene: its triangles as surfaces, its lights as lamps, and the baked file.

mod file;
mod lamps;
mod lightmap;
mod surfaces;

pub use file::{BakedFile, SurfaceEntry, read_baked};
pub use lamps::{Lamps, with_lamps};
pub use lightmap::Lightmap;
pub use surfaces::{SceneSurfaces, scene_surfaces};
