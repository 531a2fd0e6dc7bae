//! From a scene to a frame: micropoints, shadows and shading, tile by tile.
//!
//! No algorithm lives here. Each tile goes through three stages on one thread: its visible micropoints
//! are found, for each light the lit fractions of those that can use its light, then each is
//! shaded once. Memory is that of a tile per thread, plus the frame.

mod ambient;
mod background;
mod canvas;
mod capture;
mod detail;
mod detail_maps;
mod direct;
mod gather;
mod lights;
mod look;
mod mirrors;
mod prepared;
mod reflections;
mod shading;
mod surfaces;

pub use ambient::Ambient;
pub use capture::{Capture, CaptureOptions};
pub use look::{LookOptions, Seen, buried, fingerprints, look_again, look_all};
pub use prepared::Prepared;

use crate::image_io::Frame;
use crate::job::{Progress, RenderJob, Stats};
use crate::scene::Scene;
use pointillist_micropoint::MicropointError;
use pointillist_sh::ShError;
use pointillist_shadow::ShadowError;
use pointillist_shprobe::ProbeError;
use pointillist_view::ViewError;

/// What can go wrong while a valid scene is drawn.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    /// The geometry was refused.
    #[error(transparent)]
    Micropoint(#[from] MicropointError),
    /// The camera or the size of the picture was refused.
    #[error(transparent)]
    View(#[from] ViewError),
    /// What probes saw was refused.
    #[error(transparent)]
    Probe(#[from] ProbeError),
    /// An image of a probe cannot be projected.
    #[error(transparent)]
    Harmonics(#[from] ShError),
    /// A light was refused.
    #[error("light `{name}`: {source}")]
    Shadow {
        /// The light's name.
        name: String,
        /// Why.
        source: ShadowError,
    },
}

/// Pixels on a side of a tile: about a thousand cells, whose state stays in the second-level cache.
const TILE_SIZE: u32 = 16;

/// Draws the job's window of a scene.
///
/// The frame has the layers that the job asks for, in its order. A pixel's value depends on the scene
/// only: not on the window, on tiles or on the number of threads.
///
/// # Errors
/// [`PipelineError`] if the scene cannot be drawn.
pub fn render(
    scene: &Scene,
    job: &RenderJob,
    progress: &Progress,
    stats: &Stats,
) -> Result<Frame, PipelineError> {
    let prepared = Prepared::new(scene, stats)?;
    progress.begin("render", job.window.tiles(TILE_SIZE).count() as u64);
    let start = std::time::Instant::now();
    let view = scene.camera.view([scene.image.width, scene.image.height])?;
    let frame = prepared.draw(view, &prepared.plain_style(), job, progress, stats)?;
    stats.add_wall("tiles", start.elapsed());
    progress.finish();
    Ok(frame)
}
