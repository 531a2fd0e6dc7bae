//! Errors of commands, with their exit codes.

use crate::input_error::InputError;
use crate::json_lines::JsonLinesError;
use std::io;
use std::process::ExitCode;

/// What a shell reports for a program that Ctrl-C ended.
pub(crate) const INTERRUPTED: u8 = 130;

/// What ends a command before it is done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// Options that do not fit together or the input. Exit code 2.
    #[error("{0}")]
    Usage(String),
    /// A file that cannot be used. Exit code 3.
    #[error("{0}")]
    Input(#[from] InputError),
    /// Lines could not be answered. Exit code 3 for the input, 1 otherwise.
    #[error("{0}")]
    Lines(JsonLinesError),
    /// Parts that are missing or do not belong together. Exit code 4.
    #[error("{0}")]
    Parts(String),
    /// `compare` found more difference than allowed. Exit code 5.
    #[error("{0}")]
    Beyond(String),
    /// Ctrl-C or SIGTERM, and what was kept. Exit code 130.
    #[error("interrupted: {0}")]
    Interrupted(String),
    /// Whoever read our output has had enough. Exit code 0.
    #[error("the reader of the output went away")]
    BrokenPipe,
    /// Anything that goes wrong while running. Exit code 1.
    #[error("{0}")]
    Failed(String),
}

impl CliError {
    /// The exit code of the program.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::BrokenPipe => 0,
            Self::Failed(_) => 1,
            Self::Usage(_) => 2,
            Self::Input(error) if error.mismatched => 4,
            Self::Input(_) | Self::Lines(JsonLinesError::Input { .. }) => 3,
            Self::Parts(_) => 4,
            Self::Beyond(_) => 5,
            Self::Lines(_) => 1,
            Self::Interrupted(_) => INTERRUPTED,
        })
    }

    /// An error of writing to `what`.
    pub fn writing(what: &str, error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::BrokenPipe
        } else {
            Self::Failed(format!("{what} cannot be written: {error}"))
        }
    }
}

impl From<JsonLinesError> for CliError {
    fn from(error: JsonLinesError) -> Self {
        match error {
            JsonLinesError::Write(error) => Self::writing("the result", &error),
            other => Self::Lines(other),
        }
    }
}
