//! What is compared of a frame of points.

use pointillist_ibpr::Frame;

/// What is compared of a frame.
pub(crate) struct Layers {
    pub(crate) color: Vec<[f32; 4]>,
    pub(crate) depth: Vec<f32>,
    pub(crate) normal: Vec<[f32; 3]>,
}

impl Layers {
    pub(crate) fn of(frame: &Frame) -> Self {
        Self { color: frame.color().to_vec(), depth: frame.depth().to_vec(), normal: frame.normal().to_vec() }
    }
}
