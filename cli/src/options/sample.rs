//! `sample`.

use super::{Common, values};
use clap::ValueEnum;
use pointillist_surfel as surfel;
use std::path::PathBuf;

/// `sample`.
#[derive(Debug, clap::Args)]
pub struct SampleOptions {
    /// A mesh (.obj, .ply) or a scene (.toml, .json) with all its objects; `-` reads either from standard input
    pub model: PathBuf,
    /// The cloud: .ply, or `-` for PLY on standard output (default: the model's name with .points.ply)
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,
    /// Points to make (default: 100000); with `--method ldi` about as many
    #[arg(long, value_name = "N", conflicts_with = "spacing", value_parser = values::whole::<u64>(1..=surfel::MAX_COUNT as u64))]
    pub count: Option<u64>,
    /// Distance of neighbouring points, world units, instead of a count
    #[arg(long, value_name = "D", value_parser = values::positive)]
    pub spacing: Option<f64>,
    /// How points are chosen
    #[arg(long, value_name = "METHOD", default_value = "poisson")]
    pub method: SampleMethod,
    /// Another seed gives other points; for `--method poisson`
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::whole::<u64>(0..=u64::MAX))]
    pub seed: u64,
    /// Write numbers as text
    #[arg(long)]
    pub ascii: bool,
    /// Override a key of the scene
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// `--method`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SampleMethod {
    /// On three grids of rays along the axes: regular, fast
    Ldi,
    /// Blue noise: even, without pattern, exactly as many as asked for
    Poisson,
}

impl SampleOptions {
    /// What the sampler is asked to do.
    #[must_use]
    pub fn sampler(&self) -> surfel::SampleOptions {
        let method = match self.method {
            SampleMethod::Ldi => surfel::Method::Ldi,
            SampleMethod::Poisson => surfel::Method::Poisson,
        };
        let options = surfel::SampleOptions::DEFAULT.with_method(method).with_seed(self.seed);
        match (self.spacing, self.count) {
            (Some(spacing), _) => options.with_spacing(spacing),
            (None, Some(count)) => options.with_count(count as usize),
            (None, None) => options,
        }
    }
}
