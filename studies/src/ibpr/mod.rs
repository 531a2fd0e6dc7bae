//! `ibpr`: time against error of raw range scans, against the surface that they measured.

mod floor;
mod scans;
mod settings;
mod study;
mod tables;

pub(crate) use study::{run, run_floor, run_relief};
