//! `shprobe`: light probes: projection, tetrahedra, placement, pictures.

mod bounces;
mod canvas;
mod delaunay;
mod known;
mod layouts;
mod maps;
mod objects;
mod paper;
mod peer;
mod pictures;
mod projection;
mod rays;
mod seams;
mod site;
mod streets;
mod study;
pub(crate) mod together;
mod trilinear;
pub(crate) mod truth;
mod walk;
mod wall;

pub(crate) use study::{run, run_with};
