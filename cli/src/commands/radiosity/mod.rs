//! `radiosity` and its command.

mod bake;
mod by_rays;
mod dry_run;
mod factor_lines;
mod factors;

use crate::error::CliError;
use crate::options::{RadiosityCommand, RadiosityOptions};

pub(super) fn run(options: &RadiosityOptions) -> Result<(), CliError> {
    match &options.command {
        Some(RadiosityCommand::Factors(options)) => factors::run(options),
        None => bake::run(&options.bake),
    }
}
