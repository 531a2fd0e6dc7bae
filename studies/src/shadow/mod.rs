//! `shadow`: run time against error of shadows, beside a shadow map; lights with an area beside samples.

pub(crate) mod area;
mod shadow_map;
mod study;

use std::path::Path;

use crate::common::report::Outcome;

/// Measures and writes `shadow.*` and `shadow-area.*`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    Ok(study::run(out_dir)? && area::run(out_dir)?)
}
