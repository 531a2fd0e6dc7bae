//! The `pointillist` command.

use pointillist_cli::job::interrupt;
use pointillist_cli::{CliError, options::Cli};
use std::io::Write as _;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// "Failed while running".
const FAILED: i32 = 1;

fn main() -> ExitCode {
    let cli = Cli::read();
    interrupt::watch();
    leave_instead_of_aborting();
    match pointillist_cli::run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Nobody to tell is no reason to leave with another code.
            let _ = match &error {
                CliError::BrokenPipe => Ok(()),
                CliError::Interrupted(_) => writeln!(std::io::stderr(), "{error}"),
                _ => writeln!(std::io::stderr(), "error: {error}"),
            };
            error.exit_code()
        }
    }
}

/// Has a failed allocation end the program with a code of ours.
///
/// Sizes from outside are checked before, but under a tight limit any allocation may fail. That cannot be caught: a line
/// "memory allocation of N bytes failed" is printed, and then the program aborts.
fn leave_instead_of_aborting() {
    // Without a handler it aborts.
    let _ = signal_hook::flag::register_conditional_shutdown(
        signal_hook::consts::SIGABRT,
        FAILED,
        Arc::new(AtomicBool::new(true)),
    );
}
