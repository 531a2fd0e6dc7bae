//! The parts of the `pointillist` command, as a library: for its own tests and fuzz targets.
//!
//! The crates below this one are the library to build on; this one may change with every version.
#![forbid(unsafe_code)]

mod baked_file;
mod baked_objects;
pub mod cloud_io;
mod commands;
pub mod compare;
pub mod coordinate;
mod error;
pub mod image_io;
pub mod input;
mod input_error;
pub mod job;
mod json_kind;
pub mod json_lines;
mod json_words;
pub mod memory;
pub mod mesh_io;
mod name_pattern;
mod number_lines;
pub mod options;
pub mod points;
pub mod probe_io;
pub mod scan;
pub mod scene;

pub use commands::run;
pub use error::CliError;
pub use input_error::{InputError, Place};
