//! `radiosity` and its command.

use super::{Common, TextOutput, values};
use clap::{Subcommand, ValueEnum};
use std::path::PathBuf;

/// `radiosity`.
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct RadiosityOptions {
    /// Something else than to bake.
    #[command(subcommand)]
    pub command: Option<RadiosityCommand>,
    /// What to bake.
    #[command(flatten)]
    pub bake: RadiosityBakeOptions,
}

/// What else than to bake.
#[derive(Debug, Subcommand)]
pub enum RadiosityCommand {
    /// Form factors of pairs of polygons: JSON lines in, JSON lines out
    ///
    /// Each line holds `from`, `to` and `occluders`: planar convex polygons, counter-clockwise seen from the front. Each line of the
    /// result holds `F` and a bound on its `error`.
    #[command(after_help = "Example:\n  \
        echo '{\"from\":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]],\"to\":[[0,0,1],[0,1,1],[1,1,1],[1,0,1]]}' |\n    \
        pointillist radiosity factors")]
    Factors(FactorsOptions),
}

/// Bakes the light of a scene.
#[derive(Clone, Debug, clap::Args)]
pub struct RadiosityBakeOptions {
    /// A scene (.toml, .json) or mesh (.obj, .ply)
    #[arg(required = true)]
    pub scene: Option<PathBuf>,
    /// How the light is solved for
    #[arg(long, value_name = "METHOD", default_value = "gauss-seidel")]
    pub method: SolveMethod,
    /// How form factors are computed: hemicubes are per patch, and need --links full
    #[arg(long, value_name = "KIND", default_value = "analytic")]
    pub form_factor: FormFactorKind,
    /// Pixels across a hemicube
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = values::whole::<u32>(4..=1024))]
    pub resolution: u32,
    /// Longest edge of a patch, in the scene's unit (default: a 32nd of the scene's longest side)
    #[arg(long, value_name = "SIZE", value_parser = values::positive)]
    pub patch: Option<f64>,
    /// Divide patches down to this where light changes fast: at shadow edges and in corners (default with rays: an eighth of a patch)
    #[arg(long, value_name = "SIZE", value_parser = values::positive)]
    pub adaptive: Option<f64>,
    /// Which patches exchange light directly: all pairs, groups of patches where --tolerance allows, or those that rays meet (auto: groups above 1000
    /// patches and with --importance, rays above 128 surfaces)
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub links: LinkKind,
    /// Largest error of one link between groups, as a fraction of the scene's mean radiosity (default 0.01); with rays, standard error of the light
    /// at a vertex, as a fraction of it (default 0.01, or 0.02 above 2000 surfaces)
    #[arg(long, value_name = "T", value_parser = values::positive)]
    pub tolerance: Option<f64>,
    /// Link groups at --tolerance only where the scene's camera sees what they carry, and coarsely elsewhere: in half the time, with up to 2.6 times
    /// the error in its picture (a quarter fewer links for the same error). For cameras that see a part of few, large surfaces
    #[arg(long)]
    pub importance: bool,
    /// Leave out form factors below this; what was left out is reported
    #[arg(long, value_name = "F", default_value_t = 0.0, value_parser = values::not_negative)]
    pub least_factor: f64,
    /// Largest number of patches; a --patch that needs more is refused
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = values::whole::<usize>(1..=usize::MAX))]
    pub max_patches: usize,
    /// The light: .json for `[ambient] radiosity`, .ply for looking at, or `-` for JSON on standard output
    #[arg(short, long, value_name = "PATH", default_value = "radiosity.json")]
    pub output: PathBuf,
    /// Write all form factors as lines of `i,j,F`
    #[arg(long, value_name = "F.csv")]
    pub factors: Option<PathBuf>,
    /// Print what baking is expected to take (seconds, memory, what is heavy) and write nothing; --stats has it, too
    #[arg(long)]
    pub dry_run: bool,
    /// Override a key of the scene
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// `--method`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SolveMethod {
    /// Row by row; fastest to the end
    GaussSeidel,
    /// Shooting, the brightest first
    Progressive,
}

/// `--form-factor`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormFactorKind {
    /// Polygon to polygon, with error bounds
    Analytic,
    /// Hemicubes whose cells hold exact coverage
    Hemicube,
    /// Hemicubes with one sample a cell
    HemicubeClassic,
}

/// `--links`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LinkKind {
    /// By the number of patches
    Auto,
    /// Each patch with each other
    Full,
    /// Groups of patches
    Hierarchical,
    /// By rays: for buildings of many thousand surfaces
    Rays,
}

/// `radiosity factors`.
#[derive(Debug, clap::Args)]
pub struct FactorsOptions {
    /// File with a JSON object on each line; `-` is standard input
    #[arg(value_name = "FILE", default_value = "-")]
    pub input: PathBuf,
    /// Relative error to aim at where something is between
    #[arg(long, value_name = "E", default_value_t = 1e-5, value_parser = values::positive)]
    pub tolerance: f64,
    /// Where results go.
    #[command(flatten)]
    pub output: TextOutput,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}
