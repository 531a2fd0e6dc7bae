//! What is measured of a frame.

use crate::common::timing::{Ratio, Timing};
use crate::surfel::layer_error::LayerError;

/// A frame of one setting in one scene.
pub(crate) struct Measured {
    pub(crate) scene: String,
    /// The procedure, or what is compared with it.
    pub(crate) series: &'static str,
    pub(crate) setting: String,
    /// Points drawn, links included.
    pub(crate) points: usize,
    /// Processor seconds on one thread, and seconds on all.
    pub(crate) cpu: Timing,
    pub(crate) wall: Timing,
    /// Processor time over that of what the section names, if it names one.
    pub(crate) ratio: Option<Ratio>,
    pub(crate) error: LayerError,
    /// Of the cloud, world units.
    pub(crate) spacing: f64,
}
