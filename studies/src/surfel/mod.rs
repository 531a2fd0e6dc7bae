//! `surfel`: time against error of point clouds, against rays cast at the surface through a thin lens.

mod coloured_cloud;
mod layer_error;
mod lens_camera;
mod lens_reference;
mod lens_samples;
mod lens_scenes;
mod measured;
mod open3d;
mod same;
mod sheets;
mod specks;
mod stage;
mod study;
mod tables;
mod views;

pub(crate) use study::{run, run_quick};
