//! The commands.

mod check;
mod compare;
mod dice;
mod generate;
mod info;
mod job;
mod json_lines;
mod merge;
mod points;
mod polygon_lines;
mod probe;
mod radiosity;
mod render;
mod report;
mod sample;
mod scan;
mod surfel;

use crate::error::CliError;
use crate::options::{Cli, Command};
use report::Report;

/// Runs a command line.
///
/// # Errors
///
/// Whatever ends the command early; [`CliError::exit_code`] says with which code.
pub fn run(cli: &Cli) -> Result<(), CliError> {
    match &cli.command {
        Command::Render(options) => render::run(options),
        Command::Scan(options) => scan::run(options),
        Command::Surfel(options) => surfel::run(options),
        Command::Sample(options) => sample::run(options),
        Command::Probe { command } => probe::run(command),
        Command::Radiosity(options) => radiosity::run(options),
        Command::Dice(options) => dice::run(options),
        Command::Compare(options) => compare::run(options),
        Command::Info(options) => info::run(options),
        Command::Check(options) => check::run(options),
        Command::Job(options) => job::run(options),
        Command::Merge(options) => merge::run(options),
        Command::Completions { shell } => generate::completions(*shell),
        Command::Man { output } => generate::man(output.as_deref()),
    }
}
