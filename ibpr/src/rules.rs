//! What stays the same for all points of a frame.

use crate::buffer::DepthScale;
use crate::options::{Translucency, Weighting};

/// What stays the same for all points of a frame.
#[derive(Clone, Copy)]
pub(crate) struct Rules {
    pub(crate) gamma: f32,
    pub(crate) weighting: Weighting,
    pub(crate) scale: DepthScale,
    /// Several surfaces per pixel, or only the nearest.
    pub(crate) layers: Option<Translucency>,
}
