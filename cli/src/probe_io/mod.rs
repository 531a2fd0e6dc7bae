//! Files of probes: `probes.json`, and the same in binary.

mod captures;
mod entry;
mod file;
mod points;

pub use crate::baked_objects::BakedObject;
pub use captures::{CaptureEntry, CaptureList, read_captures};
pub use entry::{Distances, ProbeEntry};
pub use file::{ProbeFile, parse_probes, read_probes, write_probes};
pub use points::{format_cells, read_points, read_rows};
