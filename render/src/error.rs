//! What can go wrong while a scene is drawn.

use crate::scene::SceneError;
use pointillist_micropoint::MicropointError;
use pointillist_sh::ShError;
use pointillist_shadow::ShadowError;
use pointillist_shprobe::ProbeError;
use pointillist_view::ViewError;

/// What can go wrong while a scene is drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// [`crate::Scene::check`] found an element that is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The geometry, a texture or an option was refused.
    #[error(transparent)]
    Micropoint(#[from] MicropointError),
    /// The camera or the size of the picture was refused.
    #[error(transparent)]
    View(#[from] ViewError),
    /// What probes saw was refused.
    #[error(transparent)]
    Probe(#[from] ProbeError),
    /// What a probe saw cannot be projected on spherical harmonics.
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
    /// The layer `lit` of a light that does not exist was asked for.
    #[error("a layer of light {index} is asked for, but there are {count}")]
    Layer {
        /// The light's index.
        index: usize,
        /// Lights there are.
        count: usize,
    },
    /// [`crate::Monitor::is_cancelled`] said so.
    #[error("cancelled")]
    Cancelled,
}
