//! The `pointillist` command.

use clap::Parser as _;
use pointillist_cli::{CliError, image_io, options::Cli};
use std::io::Write as _;
use std::process::ExitCode;

/// What a shell reports for a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

fn main() -> ExitCode {
    let cli = Cli::parse();
    // Without a handler Ctrl-C still ends the program; only a temporary file would stay.
    let _ = ctrlc::set_handler(|| {
        image_io::remove_temporaries();
        std::process::exit(INTERRUPTED);
    });
    match pointillist_cli::run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if !matches!(error, CliError::BrokenPipe) {
                let _ = writeln!(std::io::stderr(), "error: {error}");
            }
            error.exit_code()
        }
    }
}
