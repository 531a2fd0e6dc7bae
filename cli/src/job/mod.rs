//! What one run of `render` is asked to do, and how it tells what it does.

mod expected;
pub mod interrupt;
mod progress;
mod stats;
mod watch;

pub use expected::Expected;
pub use progress::{Progress, ProgressMode};
pub use stats::{IS_DEBUG_BUILD, Stats, ThreadClock};
pub use watch::{Piece, Watch};

use crate::image_io::{LayerKind, PixelRect};

/// What of a scene to draw, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderJob {
    /// The part of the picture that the whole job is about: all of it, or `--crop`.
    pub region: PixelRect,
    /// The part that this run draws: `region`, or its share of it with `--tile`.
    pub window: PixelRect,
    /// What to deliver beside colour and depth, in this order.
    pub layers: Vec<LayerKind>,
}
