//! `probe` and its commands.

mod bake;
mod capture;
mod dry_run;
mod indirect;
mod inside;
mod merge;
mod photographs;
mod place;
mod project;
mod query;
mod tetra;

pub(super) use merge::merge_probes;

use super::report::write_text;
use crate::error::CliError;
use crate::image_io::write_atomically;
use crate::input::is_standard;
use crate::options::ProbeCommand;
use crate::probe_io::{ProbeFile, write_probes};
use crate::scene::Overrides;
use pointillist_render::RenderError;
use std::path::Path;

pub(super) fn run(command: &ProbeCommand) -> Result<(), CliError> {
    match command {
        ProbeCommand::Place(options) => place::run(options),
        ProbeCommand::Bake(options) => bake::run(options),
        ProbeCommand::Capture(options) => capture::run(options),
        ProbeCommand::Project(options) => project::run(options),
        ProbeCommand::Tetra(options) => tetra::run(options),
        ProbeCommand::Query(options) => query::run(options),
    }
}

fn overrides(set: &[String]) -> Overrides {
    Overrides { assignments: set.iter().map(|assignment| ("--set".to_owned(), assignment.clone())).collect() }
}

fn failed(error: RenderError) -> CliError {
    CliError::Failed(error.to_string())
}

/// Whether a file of this name holds probes.
pub(super) fn is_probe_file(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json") || e.eq_ignore_ascii_case("probes"))
}

/// Refuses names that say nothing about how probes are written.
fn check_output(path: &Path) -> Result<(), CliError> {
    if is_standard(path) || is_probe_file(path) {
        return Ok(());
    }
    Err(CliError::Usage(format!("`{}`: a file of probes ends in .json or .probes", path.display())))
}

fn write(path: &Path, file: &ProbeFile) -> Result<(), CliError> {
    if is_standard(path) {
        return write_text(path, |output| write_probes(output, file, false));
    }
    let binary = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("probes"));
    write_atomically(path, |output| {
        let mut output = std::io::BufWriter::new(output);
        write_probes(&mut output, file, binary)?;
        std::io::Write::flush(&mut output)
    })
    .map_err(|error| CliError::writing(&path.display().to_string(), &error))
}
