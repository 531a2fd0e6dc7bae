//! `probe` and its commands.

use super::{Common, TextOutput, Tile, values};
use crate::input::is_standard;
use clap::{Subcommand, ValueEnum};
use pointillist_sh as sh;
use std::path::PathBuf;

/// What to do with light probes.
#[derive(Debug, Subcommand)]
pub enum ProbeCommand {
    /// Choose where probes go
    #[command(after_help = "Examples:\n  \
        pointillist probe place examples/house.toml --grid 12x6x6 -o grid.json\n  \
        pointillist probe place examples/house.toml --strategy cluster --count 40 -o probes.json\n  \
        pointillist probe place examples/house.toml --strategy random --count 200 --seed 3 -o -")]
    Place(PlaceOptions),
    /// Capture what probes see, as spherical harmonics
    ///
    /// Each probe looks around with six pictures of the scene. Probes of an output that is already there are kept where
    /// nothing that they see has changed.
    #[command(after_help = "Examples:\n  \
        pointillist probe place examples/house.toml --grid 6x3x4 -o probes.json\n  \
        pointillist probe bake examples/house.toml probes.json -o baked.json\n  \
        pointillist probe bake examples/house.toml probes.json --bounces 3 --resolution 64 -o baked.probes\n  \
        pointillist probe bake examples/house.toml probes.json --fit 200 --resolution 32 -o fitted.json\n  \
        pointillist probe bake examples/house.toml probes.json --indirect solve -o baked.json\n  \
        pointillist radiosity examples/house.toml -o light.json\n  \
        pointillist probe bake examples/house.toml probes.json --indirect light.json -o baked.json\n  \
        pointillist probe bake examples/house.toml probes.json --near 0.3 --far 20 -o baked.json\n  \
        pointillist probe bake examples/house.toml probes.json --bounces 0 --part 0/4 -o part0.json\n\n\
        Then draw with it:\n  \
        pointillist render examples/house.toml --set ambient.probes=baked.json -o lit.png")]
    Bake(BakeOptions),
    /// Turn panoramas that were taken at positions into probes
    ///
    /// LIST is JSON: `{"captures":[{"image":"hall.hdr","position":[0,1.6,0],"rotate":[0,90,0],"exposure":0}, …]}`. Images are named
    /// relative to the list: equirectangular (row 0 is the zenith, the centre looks along −Z) or a strip of a cube's faces. `rotate`
    /// turns a picture into the world, in degrees about x, then y, then z. `exposure` (default 0) is the stops by which a picture is
    /// to be brightened, as --exposure of `probe project`: of several of one position, the darkest has the highest. Those are
    /// brackets: they are merged, weighted by the light that each collected, without clipped pixels.
    #[command(after_help = "Examples:\n  \
        echo '{\"captures\":[{\"image\":\"examples/sky.png\",\"position\":[0,1.6,0],\"rotate\":[0,90,0]}]}' > list.json\n  \
        pointillist probe capture list.json -o photographed.json\n  \
        pointillist probe capture list.json --order 4 --response gamma=2.2 -o photographed.probes\n\n\
        Then draw with it:\n  \
        pointillist render examples/house.toml --set ambient.probes=photographed.json -o lit.png")]
    Capture(CaptureOptions),
    /// Turn an environment map into spherical harmonics
    #[command(after_help = "Examples:\n  \
        pointillist probe project examples/sky.png\n  \
        pointillist probe project examples/sky.png --order 4 -o sh.json")]
    Project(ProjectOptions),
    /// Divide space between points into Delaunay tetrahedra
    ///
    /// Prints `# tetrahedra N` and four indices a line, from 0; `# dimension 2` (1, 0) and triangles (segments, a point) where the
    /// points span no more; `# tetrahedra 0` for no points.
    #[command(after_help = "Examples:\n  \
        printf '0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n1 1 1\\n' | pointillist probe tetra -\n  \
        pointillist probe place examples/house.toml --grid 6x3x4 -o probes.json\n  \
        pointillist probe tetra probes.json -o cells.txt")]
    Tetra(TetraOptions),
    /// Irradiance at points with normals, from baked probes
    #[command(after_help = "Examples:\n  \
        pointillist probe place examples/house.toml --grid 6x3x4 -o probes.json\n  \
        pointillist probe bake examples/house.toml probes.json -o baked.json\n  \
        echo '-2 1 0  0 1 0' | pointillist probe query baked.json -\n  \
        echo '-2 1 0  0 1 0' | pointillist probe query baked.json - --sky")]
    Query(QueryOptions),
}

/// `probe place`.
#[derive(Debug, clap::Args)]
pub struct PlaceOptions {
    /// A scene (.toml, .json) or mesh (.obj, .ply)
    pub scene: PathBuf,
    /// How places are chosen
    #[arg(long, value_name = "STRATEGY", default_value = "grid")]
    pub strategy: Strategy,
    /// Probes to place; a grid has about as many
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = values::whole::<u32>(1..=1 << 24))]
    pub count: u32,
    /// Probes along each axis: for `grid` where they are, for `cluster` where they may be
    #[arg(long, value_name = "NXxNYxNZ", value_parser = values::grid)]
    pub grid: Option<[usize; 3]>,
    /// With `cluster`: stop when irradiance between probes is known up to this relative error
    #[arg(long, value_name = "E", default_value_t = 0.0, value_parser = values::not_negative)]
    pub error: f64,
    /// With `cluster`: pixels on a side of the pictures that candidates are judged by
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = values::whole::<u32>(4..=1024))]
    pub resolution: u32,
    /// Another seed gives other random places
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::whole::<u64>(0..=u64::MAX))]
    pub seed: u64,
    /// A corner of the box to fill (default: the scene's)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "high")]
    pub low: Option<values::Vector>,
    /// The opposite corner of the box to fill
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "low")]
    pub high: Option<values::Vector>,
    /// What to do with a probe inside a solid
    #[arg(long, value_name = "WHAT", default_value = "move")]
    pub inside: Inside,
    /// The probes: .json, .probes (binary), or `-` for standard output
    #[arg(short, long, value_name = "PATH", default_value = "probes.json")]
    pub output: PathBuf,
    /// Override a key of the scene
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// `--strategy`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Strategy {
    /// Evenly in a box
    Grid,
    /// Some of the scene's vertices, as far from one another as possible, lifted off their surface
    Vertices,
    /// Anywhere in a box
    Random,
    /// Where interpolation between them errs least, judged by what a grid of candidates sees
    Cluster,
}

/// `--inside`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Inside {
    /// Move it to the nearest place outside, a hundredth of the scene's diagonal off the surface
    Move,
    /// Leave it out
    Drop,
    /// End with an error
    Refuse,
    /// Leave it where it is
    Keep,
}

/// `probe bake`.
#[derive(Debug, clap::Args)]
pub struct BakeOptions {
    /// A scene (.toml, .json) or mesh (.obj, .ply)
    pub scene: PathBuf,
    /// Where the probes are: .json or .probes
    pub probes: PathBuf,
    /// Pixels on a side of each of the six pictures
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = values::whole::<u32>(1..=4096))]
    pub resolution: u32,
    /// Highest band of the harmonics
    #[arg(long, value_name = "L", default_value_t = 2, value_parser = values::whole::<u8>(0..=sh::MAX_ORDER as u8))]
    pub order: u8,
    /// Bounces of light between surfaces: in each, surfaces are lit by the probes of the bounce before [default: 1; 0 with --indirect]
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(0..=64))]
    pub bounces: Option<u32>,
    /// Light surfaces by a radiosity solution of the same scene in the place of bounces: a file that `radiosity` baked, or `solve`
    /// to have the scene solved on the way. Holds all bounces, and more exactly than probes light surfaces
    #[arg(long, value_name = "FILE|solve")]
    pub indirect: Option<Indirect>,
    /// Stop before the last bounce when one changes the light by less than this fraction
    #[arg(long, value_name = "E", default_value_t = 0.005, value_parser = values::not_negative)]
    pub until: f64,
    /// Look around from N more places between the probes, and let the probes hold what lights all places best, not what they see
    /// themselves: fewer probes for the same error
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::whole::<u32>(0..=1_000_000))]
    pub fit: u32,
    /// What probes hold
    #[arg(long, value_name = "WHAT", default_value = "indirect")]
    pub what: What,
    /// Texels on a side of each probe's map of distances, which keeps light from passing through walls; 0 for none
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = values::whole::<u32>(0..=256))]
    pub distances: u32,
    /// Damp the harmonics of a probe where irradiance would be negative
    #[arg(long)]
    pub dering: bool,
    /// Compute every shadow and texel within a pixel, and capture with all pixels throughout. Otherwise shadows and texels are
    /// computed as finely as the sum over a capture needs, bounced light is captured with half of the pixels on a side, and captures
    /// before the last bounce, and those of --fit, have at most 32
    #[arg(long)]
    pub thorough: bool,
    /// See only surfaces that are at least this far away: objects at the probe itself are left out, and what is behind them is seen.
    /// Distances are along the axes: what is left out is a cube around the probe. What is not seen still casts shadows
    #[arg(long, value_name = "D", default_value_t = 0.0, value_parser = values::not_negative)]
    pub near: f64,
    /// See only surfaces that are at most this far away, along the axes as with --near, and the background in the place of those beyond
    #[arg(long, value_name = "D", value_parser = values::positive)]
    pub far: Option<f64>,
    /// What to do with a probe inside a solid
    #[arg(long, value_name = "WHAT", default_value = "move")]
    pub inside: Inside,
    /// Bake a part of the probes, from 0; `merge` joins parts. Needs `--bounces 0` or `--indirect`
    #[arg(long, value_name = "I/N")]
    pub part: Option<Tile>,
    /// Bake every probe, whatever the output holds already
    #[arg(long)]
    pub overwrite: bool,
    /// Print what baking is expected to take (seconds, memory, what is heavy) and write nothing; --stats has it, too
    #[arg(long)]
    pub dry_run: bool,
    /// The baked probes: .json, .probes (binary), or `-` for standard output
    #[arg(short, long, value_name = "PATH", default_value = "baked.json")]
    pub output: PathBuf,
    /// Override a key of the scene
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

impl BakeOptions {
    /// Bounces between probes.
    #[must_use]
    pub fn bounces(&self) -> u32 {
        self.bounces.unwrap_or(u32::from(self.indirect.is_none()))
    }
}

/// `--indirect`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Indirect {
    /// Solve for it.
    Solve,
    /// Read it.
    File(PathBuf),
}

impl std::str::FromStr for Indirect {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(if text == "solve" { Self::Solve } else { Self::File(text.into()) })
    }
}

/// `--what`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum What {
    /// All light that arrives
    Total,
    /// Without what glowing surfaces send straight to the probe
    Indirect,
}

impl What {
    /// As in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Total => "total",
            Self::Indirect => "indirect",
        }
    }
}

/// `probe capture`.
#[derive(Debug, clap::Args)]
pub struct CaptureOptions {
    /// The list of panoramas (JSON), or `-` for standard input
    pub list: PathBuf,
    /// Highest band of the harmonics
    #[arg(long, value_name = "L", default_value_t = 2, value_parser = values::whole::<u8>(0..=sh::MAX_ORDER as u8))]
    pub order: u8,
    /// How much each texel counts
    #[arg(long, value_name = "RULE", default_value = "gregory")]
    pub weights: WeightRule,
    /// How a photograph's 8-bit values follow the light: srgb, linear, gamma=2.2, or a file with the radiance of each of the 256 levels
    #[arg(long, value_name = "CURVE", default_value = "srgb", value_parser = values::response)]
    pub response: values::ResponseCurve,
    /// Damp the harmonics so that irradiance is nowhere below 0
    #[arg(long)]
    pub dering: bool,
    /// The probes: .json, .probes (binary), or `-` for standard output
    #[arg(short, long, value_name = "PATH", default_value = "probes.json")]
    pub output: PathBuf,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// `probe project`.
#[derive(Debug, clap::Args)]
pub struct ProjectOptions {
    /// One picture of all directions (equirectangular, or a cube as a strip of 6:1 or 1:6), or six of a cube: +X −X +Y −Y +Z −Z
    #[arg(required = true, num_args = 1..=6, value_name = "IMAGE")]
    pub images: Vec<PathBuf>,
    /// Highest band of the harmonics
    #[arg(long, value_name = "L", default_value_t = 2, value_parser = values::whole::<u8>(0..=sh::MAX_ORDER as u8))]
    pub order: u8,
    /// How much each texel of a cube counts
    #[arg(long, value_name = "RULE", default_value = "gregory")]
    pub weights: WeightRule,
    /// Brighten by this many stops first
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true, value_parser = values::exposure)]
    pub exposure: f32,
    /// How a photograph's 8-bit values follow the light: srgb, linear, gamma=2.2, or a file with the radiance of each of the 256 levels
    #[arg(long, value_name = "CURVE", default_value = "srgb", value_parser = values::response)]
    pub response: values::ResponseCurve,
    /// Damp the harmonics so that irradiance is nowhere below 0
    #[arg(long)]
    pub dering: bool,
    /// Where results go.
    #[command(flatten)]
    pub output: TextOutput,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// `--weights`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WeightRule {
    /// Fourth order in the texel's size (from 16 pixels up)
    Gregory,
    /// The texel's exact solid angle
    Exact,
    /// The paper's dS·cosθ/r²
    Paper,
}

impl WeightRule {
    /// As the library has it.
    #[must_use]
    pub const fn weights(self) -> sh::Weights {
        match self {
            Self::Gregory => sh::Weights::Gregory,
            Self::Exact => sh::Weights::Exact,
            Self::Paper => sh::Weights::Paper,
        }
    }
}

/// `probe tetra`.
#[derive(Debug, clap::Args)]
pub struct TetraOptions {
    /// Text with `x y z` a line, raw doubles (.bin), or probes (.json, .probes)
    pub points: PathBuf,
    /// Points to find among the cells, to measure how long it takes
    #[arg(long, value_name = "QUERIES")]
    pub locate: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: TextOutput,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

impl TetraOptions {
    /// Where cells go; nowhere if location is measured, unless a file is named.
    pub fn result(&self) -> Option<&PathBuf> {
        Some(&self.output.path).filter(|path| self.locate.is_none() || !is_standard(path))
    }
}

/// `probe query`.
#[derive(Debug, clap::Args)]
pub struct QueryOptions {
    /// Baked probes
    pub probes: PathBuf,
    /// Text with `x y z nx ny nz` a line; `-` is standard input
    #[arg(default_value = "-")]
    pub points: PathBuf,
    /// After each irradiance, which probes it comes from: `number:share`, the largest share first
    #[arg(long)]
    pub shares: bool,
    /// After each irradiance, the share of an even sky's light that arrives: 1 in the open, 0 where no sky is seen (ambient occlusion)
    #[arg(long)]
    pub sky: bool,
    /// Where results go.
    #[command(flatten)]
    pub output: TextOutput,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}
