//! The options of every command, as clap reads them.

mod cloud_look;
mod common;
mod job;
mod points;
mod probe;
mod radiosity;
mod render;
mod sample;
mod scan;
mod surfel;
mod tips;
mod values;

pub use cloud_look::{BoxValue, CloudLook, RangeValue};
pub use common::{Common, Progressive, TextOutput};
pub use job::JobOptions;
pub use points::{PointLayerRequest, layer_list};
pub use probe::{
    BakeOptions, CaptureOptions, Indirect, Inside, PlaceOptions, ProbeCommand, ProjectOptions, QueryOptions,
    Strategy, TetraOptions, WeightRule, What,
};
pub use radiosity::{
    FactorsOptions, FormFactorKind, LinkKind, RadiosityBakeOptions, RadiosityCommand, RadiosityOptions,
    SolveMethod,
};
pub use render::{CameraOptions, DisplayOptions, LayerRequest, PictureOptions, RenderOptions};
pub use sample::{SampleMethod, SampleOptions};
pub use scan::{ScanOptions, ShadingOptions, SurfaceOptions};
pub use surfel::{DiscOptions, FocusOptions, ProcedureValue, SurfelOptions, SurfelShading};
pub use values::{Colour, FrameRange, LAST_FRAME, ResponseCurve, Tile, Vector};

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use clap_complete::Shell;
use std::path::PathBuf;

/// Draws pictures of meshes with exact coverage: no samples, no noise, no shadow-map steps.
#[derive(Debug, Parser)]
#[command(
    name = "pointillist",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 done, 1 failed while running, 2 wrong usage, 3 bad input file,\n\
    4 pieces missing or not matching, 5 `compare` beyond its limit, 130 interrupted."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

impl Cli {
    /// Reads the command line. Ends the program after `--help`, and for options that cannot be used.
    #[must_use]
    pub fn read() -> Self {
        let matches = with_negative_numbers(Self::command()).try_get_matches();
        let read = matches.and_then(|matches| Self::from_arg_matches(&matches));
        read.unwrap_or_else(|error| tips::with_tip(error).exit())
    }
}

/// Reads a command line, its first word included; the error is the first line of the message.
///
/// # Errors
///
/// A line that [`Cli::read`] would end the program for.
pub fn parse(words: &[String]) -> Result<Command, String> {
    job::parse(words)
}

/// Makes the message about `--fov -3` one about the value of `--fov`, not about an unknown option `-3`.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let takes_values = |arg: &clap::Arg| !arg.is_positional() && arg.get_action().takes_values();
    let command =
        command.mut_args(|arg| if takes_values(&arg) { arg.allow_negative_numbers(true) } else { arg });
    command.mut_subcommands(with_negative_numbers)
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw a scene
    ///
    /// SCENE is a .toml or .json scene file, or an .obj, .ply, .gltf or .glb model, which is then framed and lit. Without SCENE the
    /// built-in scene is drawn to pointillist.png.
    #[command(after_help = "Examples:\n  \
        pointillist render\n  \
        pointillist render examples/house.toml -o house.exr --layers all\n  \
        pointillist render examples/rabbit.obj --eye 0.2,0.2,0.4 --target 0,0.08,0 --fov 30 -o rabbit.png\n  \
        pointillist render examples/rabbit.obj --bg white -o rabbit.jpg\n  \
        pointillist render examples/rabbit.obj --env examples/sky.png --bg 204060 --bits 16 -o sky.png\n  \
        pointillist render examples/house.toml --set render.shading=flat --size 1920x1080 -o flat.png\n  \
        pointillist render examples/house.toml --tile 0/4 -o part0.exr\n  \
        pointillist render examples/carousel.toml --frames 0-2 -o carousel.{frame:04}.png\n  \
        pointillist render examples/rabbit.obj --turntable 3 -o rabbit.{frame}.png\n  \
        pointillist render examples/house.toml --size 3840x2160 --dry-run\n  \
        pointillist render examples/house.toml --preview\n  \
        pointillist render examples/house.toml --time-budget 5 -o soon.png\n  \
        pointillist render examples/house.toml --error 0.002 -o right.exr\n\n\
        Until Ctrl-C, whenever the scene changes: pointillist render SCENE.toml --watch")]
    Render(RenderOptions),
    /// Draw range scans as they come: noisy, overlapping, without normals
    ///
    /// Scans are drawn as closed surfaces, without preparation. FILE is a scan, a Stanford .conf that places several, or a
    /// mesh, which gets points all over it.
    #[command(after_help = "Examples:\n  \
        pointillist sample examples/rabbit.obj --count 40000 -o rabbit.ply\n  \
        pointillist scan rabbit.ply -o rabbit.png\n  \
        pointillist scan rabbit.ply --edl --ambient 0.3 -o depth.png\n  \
        pointillist scan rabbit.ply --eye 0.3,0.15,0.4 --target 0,0.08,0 --fov 35 --passes 1 -o near.png\n  \
        pointillist scan rabbit.ply examples/ball.obj --alpha 0.4 -o inside.png\n  \
        pointillist scan rabbit.ply -o rabbit.exr --layers all --float\n  \
        pointillist scan rabbit.ply --color-by y --color-map turbo --legend --box -1,0.05,-1,1,1,1 -o height.png\n\n\
        Two scans, the second 0.2 to the right (tx ty tz qx qy qz qw):\n  \
        printf 'bmesh rabbit.ply 0 0 0 0 0 0 1\\nbmesh rabbit.ply 0.2 0 0 0 0 0 1\\n' > two.conf\n  \
        pointillist scan two.conf -o two.png")]
    Scan(ScanOptions),
    /// Turn a mesh into points with normals, colours and radii
    ///
    /// Each point stands for a disc; together the discs cover the surface. Normals are interpolated, colours come from materials
    /// and textures.
    #[command(after_help = "Examples:\n  \
        pointillist sample examples/rabbit.obj --count 40000 -o rabbit.ply\n  \
        pointillist sample examples/house.obj --spacing 0.05 --method ldi -o house.ply\n  \
        pointillist sample examples/house.toml --count 50000 --seed 7 --ascii -o house.ply")]
    Sample(SampleOptions),
    /// Draw a cloud of points with normals: discs, level of detail, depth of field
    ///
    /// CLOUD is what `sample` writes, or any cloud; normals and radii that it lacks are estimated.
    #[command(after_help = "Examples:\n  \
        pointillist sample examples/rabbit.obj --count 40000 -o rabbit.ply\n  \
        pointillist surfel rabbit.ply -o rabbit.png\n  \
        pointillist surfel rabbit.ply --eye 0.2,0.2,0.4 --target 0,0.08,0 --light 1,2,2 -o right.png\n  \
        pointillist surfel rabbit.ply --focus 0.3 --aperture 0.02 -o blurred.png\n  \
        pointillist surfel rabbit.ply --focus 0.35 --lens 50 --fstop 1.8 -o photograph.png\n  \
        pointillist surfel rabbit.ply -o rabbit.exr --layers all --float\n  \
        pointillist surfel rabbit.ply --octree -o large.png")]
    Surfel(SurfelOptions),
    /// Light probes: place, bake, project, tetrahedralise, query
    Probe {
        /// What to do.
        #[command(subcommand)]
        command: ProbeCommand,
    },
    /// Light between diffuse surfaces, baked for `render`
    ///
    /// Surfaces are divided into patches, what they exchange is computed with error bounds, and the light that arrives at every vertex
    /// from other surfaces is written. The scene's lights light the patches directly, with shadows; emissive materials are light, too.
    #[command(after_help = "Examples:\n  \
        pointillist radiosity examples/house.toml --patch 1 -o baked.json\n  \
        pointillist radiosity examples/house.toml --patch 1 --adaptive 0.5 -o fine.json\n  \
        pointillist radiosity examples/house.toml --patch 0.2 --dry-run\n\n\
        Then draw with it:\n  \
        pointillist render examples/house.toml --set ambient.radiosity=baked.json -o lit.png")]
    Radiosity(RadiosityOptions),
    /// Cut polygons by a grid: JSON lines in, JSON lines out
    #[command(
        long_about = "Cut polygons by a grid: JSON lines in, JSON lines out\n\n\
            Each line of the input is {\"polygon\":[[x,y],…],\"grid\":{\"origin\":[x0,y0],\"cell\":[dx,dy]}}, with unit \
            cells at the origin if there is no grid. \"size\":[nx,ny] in the grid limits the answer, and the time it \
            takes, to cells 0 ≤ i < nx, 0 ≤ j < ny; with a negative dy, j counts rows downward, as in a raster. Each line of the result is \
            {\"pieces\":[{\"cell\":[i,j],\"area\":a,\"vertices\":[[x,y],…]},…]}, or with --areas \
            {\"cells\":[{\"cell\":[i,j],\"area\":a,\"centroid\":[x,y]},…]}.",
        after_help = "Example:\n  \
            echo '{\"polygon\":[[0.5,0.5],[1.5,0.5],[1.5,1.5],[0.5,1.5]]}' | pointillist dice --areas"
    )]
    Dice(DiceOptions),
    /// Measure how far apart two pictures are
    ///
    /// Prints RMSE, MAE, bias, the largest difference and its pixel, PSNR (peak 1) and the mean of LDR-FLIP as JSON,
    /// all over linear red, green and blue.
    #[command(after_help = "Examples:\n  \
        pointillist render examples/house.toml -o a.exr\n  \
        pointillist render examples/house.toml --set render.subpixel=2 -o b.exr\n  \
        pointillist compare a.exr b.exr\n  \
        pointillist compare a.exr b.exr --diff difference.png --max-rmse 0.1\n  \
        pointillist compare a.exr b.exr --html compare.html")]
    Compare(CompareOptions),
    /// Print what a scene, mesh, cloud, picture or baked file holds, as JSON
    #[command(after_help = "Examples:\n  \
        pointillist info examples/house.toml\n  \
        pointillist info examples/rabbit.obj")]
    Info(InfoOptions),
    /// Read and validate a scene and everything it names; draw nothing
    #[command(after_help = "Examples:\n  \
        pointillist check examples/house.toml\n  \
        pointillist check examples/house.toml --set camera.fov=30")]
    Check(CheckOptions),
    /// Write a job for a render farm: an Open Job Description template
    ///
    /// The job has a task for each tile of each frame, and one for each frame that joins its tiles. Its parameters Scene, Output, Tiles, Frames and
    /// Program may be changed when it is submitted. With --probes it bakes probes in parts instead.
    #[command(after_help = "Examples:\n  \
        pointillist job examples/house.toml --tiles 8 -o house.yaml\n  \
        pointillist job examples/carousel.toml --tiles 2 --frames 0-47 -o carousel.json -- --size 1280x720 --layers all\n\n\
        Probes in the same way:\n  \
        pointillist probe place examples/house.toml --grid 6x3x4 -o probes.json\n  \
        pointillist job examples/house.toml --probes probes.json --tiles 4 -o bake.yaml")]
    Job(JobOptions),
    /// Join the parts that `render --tile` or `probe bake --part` wrote
    #[command(after_help = "Examples:\n  \
        pointillist render examples/house.toml --tile 0/2 -o part0.exr\n  \
        pointillist render examples/house.toml --tile 1/2 -o part1.exr\n  \
        pointillist merge part0.exr part1.exr -o house.exr\n\n\
        Many parts by the pattern of their names, counted from 1:\n  \
        pointillist render examples/house.toml --tile 1of2 -o tile1.exr\n  \
        pointillist render examples/house.toml --tile 2of2 -o tile2.exr\n  \
        pointillist merge tile{tile}.exr --tiles 2 -o house.exr\n\n\
        Probes in the same way:\n  \
        pointillist probe place examples/house.toml --grid 6x3x4 -o probes.json\n  \
        pointillist probe bake examples/house.toml probes.json --bounces 0 --part 0/2 -o part0.json\n  \
        pointillist probe bake examples/house.toml probes.json --bounces 0 --part 1/2 -o part1.json\n  \
        pointillist merge part0.json part1.json -o baked.json")]
    Merge(MergeOptions),
    /// Print a completion script for a shell
    #[command(after_help = "Example:\n  \
        mkdir -p ~/.local/share/bash-completion/completions\n  \
        pointillist completions bash > ~/.local/share/bash-completion/completions/pointillist")]
    Completions {
        /// Which shell.
        shell: Shell,
    },
    /// Print the manual page, or write one for every command into a folder
    #[command(after_help = "Examples:\n  \
        pointillist man | man -l -\n  \
        pointillist man -o ~/.local/share/man/man1")]
    Man {
        /// Folder to write pointillist.1, pointillist-render.1, … into.
        #[arg(short, long, value_name = "FOLDER")]
        output: Option<PathBuf>,
    },
}

/// `dice`.
#[derive(Debug, clap::Args)]
pub struct DiceOptions {
    /// File with a JSON object on each line; `-` is standard input.
    #[arg(value_name = "FILE", default_value = "-")]
    pub input: PathBuf,
    /// Print the area and centroid of each cell instead of pieces. Accepts concave polygons, polygons that cross themselves, and holes.
    #[arg(
        long,
        help = "Print the area and centroid of each cell instead of pieces. Accepts concave polygons, polygons that cross \
            themselves, and holes: \"rings\":[[[x,y],…],…] instead of \"polygon\", and \"rule\":\"evenodd\" (default) or \
            \"nonzero\" for what is inside"
    )]
    pub areas: bool,
    /// Where results go.
    #[command(flatten)]
    pub output: TextOutput,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// `compare`.
#[derive(Debug, clap::Args)]
pub struct CompareOptions {
    /// A picture: EXR, PNG, JPEG or HDR.
    pub a: PathBuf,
    /// The picture to compare it with.
    pub b: PathBuf,
    /// Write the absolute difference as a picture, brightened so that the largest is white.
    #[arg(long, value_name = "OUT.png")]
    pub diff: Option<PathBuf>,
    /// Write a page with both pictures under a slider, their difference, where it is largest, and the numbers
    ///
    /// All is in this one file: it opens from disk, and loads nothing.
    #[arg(long, value_name = "OUT.html")]
    pub html: Option<PathBuf>,
    /// For --html: brighten both pictures by this many stops. Numbers stay as they are
    #[arg(long, value_name = "EV", default_value_t = 0.0, requires = "html", allow_negative_numbers = true, value_parser = values::exposure)]
    pub exposure: f32,
    /// Exit with code 5 if the RMSE is larger.
    #[arg(long, value_name = "X", value_parser = values::not_negative)]
    pub max_rmse: Option<f64>,
    /// Where results go.
    #[command(flatten)]
    pub output: TextOutput,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// `info`.
#[derive(Debug, clap::Args)]
pub struct InfoOptions {
    /// Any file that a command reads or writes: scenes, meshes, materials, clouds, pictures and their parts, what was baked, lists of
    /// points, cells and form factors, statistics, jobs.
    pub file: PathBuf,
    /// Where results go.
    #[command(flatten)]
    pub output: TextOutput,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// `check`.
#[derive(Debug, clap::Args)]
pub struct CheckOptions {
    /// The scene; `-` is standard input.
    pub scene: PathBuf,
    /// Override a key of the scene.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// `merge`.
#[derive(Clone, Debug, clap::Args)]
pub struct MergeOptions {
    /// EXR files that `render --tile` wrote, or files that `probe bake --part` wrote, in any order; or their pattern, with {tile} for
    /// the numbers from 1 to --tiles.
    #[arg(required = true, value_name = "PART")]
    pub parts: Vec<PathBuf>,
    /// How many files each PART with {tile} in its name stands for, counted from 1.
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(1..=100_000))]
    pub tiles: Option<u32>,
    /// The number that stands in the place of {frame} in all names.
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(0..=LAST_FRAME))]
    pub frame: Option<u32>,
    /// The whole: .exr, .png or .jpg for a picture, .json, .probes or `-` (standard output) for probes.
    #[arg(short, long, value_name = "PATH")]
    pub output: PathBuf,
    /// How a PNG or JPEG is written.
    #[command(flatten)]
    pub display: DisplayOptions,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}
