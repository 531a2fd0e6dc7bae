//! Options of every command that computes.

use super::values;
use crate::job::ProgressMode;
use clap::ValueEnum;
use std::num::NonZero;
use std::path::PathBuf;

/// Options of every command that computes.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "General")]
pub struct Common {
    /// Threads to compute with, 1 to 1024 (default: one for each processor). No more are started than there are processors,
    /// or 16 if that is more, because more gain nothing. Results do not depend on it
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = values::whole::<usize>(1..=1024))]
    pub threads: Option<usize>,
    /// Memory that may be used, such as 8G (default: what is free, within the limits of the system and of the container)
    #[arg(long, value_name = "SIZE", env = "POINTILLIST_MEMORY", hide_env_values = true, value_parser = values::memory)]
    pub memory: Option<u64>,
    /// Print errors only
    #[arg(long, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Print details, such as the seconds of each stage
    #[arg(short, long)]
    pub verbose: bool,
    /// Write seconds, counts and peak memory as JSON
    #[arg(long, value_name = "PATH.json")]
    pub stats: Option<PathBuf>,
    /// How progress is shown (default: a bar if standard error is a terminal)
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
    /// Not at all
    None,
}

/// Where a command that prints text puts it.
#[derive(Clone, Debug, clap::Args)]
pub struct TextOutput {
    /// File for the result; `-` is standard output
    #[arg(id = "text_output", short = 'o', long = "output", value_name = "PATH", default_value = "-")]
    pub path: PathBuf,
}

/// Threads that may be started on any machine, so that the number of threads can be tried out on a small one.
const ALWAYS_ALLOWED: usize = 16;

impl Common {
    /// Threads to start.
    #[must_use]
    pub fn thread_count(&self) -> usize {
        let processors = std::thread::available_parallelism().map_or(1, NonZero::get);
        self.threads.map_or(processors, |threads| threads.min(processors.max(ALWAYS_ALLOWED)))
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_threads_are_started_than_are_of_use() {
        let processors = std::thread::available_parallelism().map_or(1, NonZero::get);
        let started = |threads| Common { threads, ..Common::default() }.thread_count();
        assert_eq!([started(None), started(Some(1)), started(Some(16))], [processors, 1, 16]);
        assert_eq!(started(Some(1024)), processors.clamp(ALWAYS_ALLOWED, 1024));
    }
}
