//! The parts of a frame that all tiles share.

use crate::camera::Camera;
use crate::cloud::Cloud;
use crate::shade::Shader;
use std::sync::atomic::AtomicBool;

/// What all tiles of a frame share.
pub(crate) struct Scene<'a> {
    pub(crate) cloud: &'a Cloud,
    pub(crate) camera: Camera,
    pub(crate) shader: Shader,
    pub(crate) culling: bool,
    /// Whether normals are asked for.
    pub(crate) normals: bool,
    /// Which of the selected nodes any tile has drawn.
    pub(crate) shown: &'a [AtomicBool],
}
