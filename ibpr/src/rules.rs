//! Parameters of a frame that all points share.

use crate::buffer::DepthScale;
use crate::options::{Translucency, Weighting};

/// Parameters of a frame that all points share.
#[derive(Clone, Copy)]
pub(crate) struct Rules {
    pub(crate) gamma: f32,
    pub(crate) weighting: Weighting,
    pub(crate) scale: DepthScale,
    /// Several surfaces per pixel, or only the nearest.
    pub(crate) layers: Option<Translucency>,
}
