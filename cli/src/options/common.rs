//! Options of every command that computes.

use crate::job::ProgressMode;
use clap::ValueEnum;
use std::path::PathBuf;

/// Options of every command that computes.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "General")]
pub struct Common {
    /// Threads to compute with (default: all)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Say nothing but errors
    #[arg(long, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say more
    #[arg(short, long)]
    pub verbose: bool,
    /// Write seconds, counts and peak memory as JSON
    #[arg(long, value_name = "PATH.json")]
    pub stats: Option<PathBuf>,
    /// Who is told about progress (default: a bar if standard error is a terminal)
    #[arg(long, value_name = "KIND")]
    pub progress: Option<Progressive>,
}

/// `--progress`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Progressive {
    /// A bar if standard error is a terminal
    Auto,
    /// `openjd_progress: N` lines on standard output, or on standard error if standard output is the result (`-o -`)
    Openjd,
    /// Nobody
    None,
}

/// Where a command that prints text puts it.
#[derive(Clone, Debug, clap::Args)]
pub struct TextOutput {
    /// File for the result; `-` is standard output
    #[arg(id = "text_output", short = 'o', long = "output", value_name = "PATH", default_value = "-")]
    pub path: PathBuf,
}

impl Common {
    /// The progress to show, `beside_result` if standard output is taken by a result.
    pub fn progress_mode(&self, beside_result: bool) -> ProgressMode {
        match self.progress {
            Some(Progressive::Openjd) if beside_result => ProgressMode::OpenJdOnStderr,
            Some(Progressive::Openjd) => ProgressMode::OpenJd,
            Some(Progressive::None) => ProgressMode::Off,
            None | Some(Progressive::Auto) if self.quiet => ProgressMode::Off,
            None | Some(Progressive::Auto) => ProgressMode::Auto,
        }
    }
}
