//! `radiosity`: time against error of form factors and of solutions. Writes `radiosity.md`.

mod boxes;
pub(crate) mod buildings;
mod memory;
mod moved;
mod paths;
mod peer;
mod pictures;
mod probes;
mod study;

pub(crate) use study::{run, run_parts};
