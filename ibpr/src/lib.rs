//! Raw range scans, drawn directly.
#![forbid(unsafe_code)]

mod accumulate;
mod buffer;
mod cloud;
mod cone;
mod cull;
mod error;
mod eye_dome;
mod faces;
mod fill;
mod frame;
#[cfg(feature = "invariants")]
pub mod invariants;
mod layers;
mod normals;
mod options;
mod order;
mod parallel;
mod pixels;
mod project;
mod raster;
mod render;
mod scan;
mod shade;
mod spacing;
mod view;

pub use cloud::Cloud;
pub use error::IbprError;
pub use frame::{Frame, FrameCounts};
pub use options::{Culling, EyeDome, Light, Normals, Options, Passes, Scale, Translucency, Weighting};
pub use render::Renderer;
pub use scan::Scan;
pub use view::{Projection, View};
