//! `job`.

use super::values::{self, FrameRange};
use super::{Cli, Command, Common};
use clap::{CommandFactory as _, FromArgMatches as _};
use std::path::PathBuf;

/// `job`.
#[derive(Debug, clap::Args)]
pub struct JobOptions {
    /// The scene or model that is drawn, or whose probes are baked
    pub scene: PathBuf,
    /// Tiles of each picture, or parts of the probes: what the job's parameter is unless the submitter says otherwise
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = values::whole::<u32>(1..=100_000))]
    pub tiles: u32,
    /// Frames to draw (default: frame 0 alone, or all of --turntable)
    #[arg(long, value_name = "A-B", conflicts_with = "probes")]
    pub frames: Option<FrameRange>,
    /// Bake these probes of the scene in the place of drawing it
    #[arg(long, value_name = "PROBES")]
    pub probes: Option<PathBuf>,
    /// Where the job puts its result: .exr or .png, with {frame} if there are several frames; .json or .probes with --probes
    /// (default: SCENE with .exr, or baked.json)
    #[arg(long, value_name = "PATH")]
    pub result: Option<PathBuf>,
    /// The template: .json, .yaml, or `-` for YAML on standard output
    #[arg(short, long, value_name = "PATH", default_value = "-")]
    pub output: PathBuf,
    /// Options for `render`, or for `probe bake` with --probes. Files that they name are looked for in the folder of the task: name them in full
    #[arg(last = true, value_name = "OPTION")]
    pub more: Vec<String>,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// Reads a command line as [`Cli::read`] does, but gives the message in the place of ending the program.
pub(super) fn parse(words: &[String]) -> Result<Command, String> {
    let matches = super::with_negative_numbers(Cli::command()).try_get_matches_from(words);
    let cli = matches.and_then(|matches| Cli::from_arg_matches(&matches));
    cli.map(|cli| cli.command).map_err(|error| {
        let text = error.to_string();
        let first = text.lines().next().unwrap_or_default();
        first.trim_start_matches("error: ").to_owned()
    })
}
