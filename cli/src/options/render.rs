//! `render`.

use super::Common;
use super::values::{self, Colour, FrameRange, Surroundings, Tile, Vector};
use crate::error::CliError;
use crate::image_io::{Bits, PixelRect};
use crate::scene::Overrides;
use crate::scene::description::view_fault;
use glam::DVec3;
use pointillist_render::Matte;
use std::path::PathBuf;
use std::str::FromStr;

/// `render`.
#[derive(Debug, clap::Args)]
pub struct RenderOptions {
    /// Scene file or mesh; `-` is either on standard input.
    pub scene: Option<PathBuf>,
    /// The picture: .png, .jpg or .exr (default: pointillist.png for the built-in scene, else SCENE with .png)
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,
    /// Override any key of the scene; the value is TOML, and a path is relative to the folder you are in
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// The view.
    #[command(flatten)]
    pub camera: CameraOptions,
    /// Draw these frames of a scene that moves; the output's name has their number in the place of {frame}, or {frame:04} for four digits.
    /// Without it, frame 0 is drawn
    #[arg(long, value_name = "A-B")]
    pub frames: Option<FrameRange>,
    /// Draw N views around a plain model, frames 0 to N − 1
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(1..=100_000))]
    pub turntable: Option<u32>,
    /// For models: a map of their surroundings (.hdr, .exr, .png, .jpg; equirectangular, +Y up), which lights them, is mirrored, and is
    /// seen behind them, in a PNG and EXR under alpha 0 (with --bg the colour is). Or a cube: one picture of six faces in a strip,
    /// or six with commas between them, +X,-X,+Y,-Y,+Z,-Z
    #[arg(long, value_name = "MAP")]
    pub env: Option<Surroundings>,
    /// Further layers in the EXR: `all`, or a list of N, P, albedo, direct, indirect, lit, lit.NAME, id, and cryptomatte, which `all` leaves
    /// out (objects and materials by name with their coverage; cryptomatte.object and cryptomatte.material are one of the two)
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub layers: Vec<LayerRequest>,
    /// Choose the cells per pixel so that an RMSE of at most E is expected (linear colours), and tell what is believed to be reached
    #[arg(long, value_name = "E", value_parser = values::positive, conflicts_with = "time_budget")]
    pub error: Option<f64>,
    /// Stop after so many seconds: the picture is drawn coarsely first and refined until then, and is always complete
    #[arg(long, value_name = "SECONDS", value_parser = values::positive, conflicts_with_all = ["frames", "turntable", "tile", "dry_run"])]
    pub time_budget: Option<f64>,
    /// Show the picture in the terminal; without -o no file is written
    #[arg(long, conflicts_with = "dry_run")]
    pub preview: bool,
    /// Draw again whenever the scene or a file that it reads changes, until Ctrl-C
    #[arg(long, conflicts_with = "dry_run")]
    pub watch: bool,
    /// Print what the picture is expected to take (seconds, memory, what is heavy) and write nothing; --stats has it, too
    #[arg(long)]
    pub dry_run: bool,
    /// How the picture is written.
    #[command(flatten)]
    pub picture: PictureOptions,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

impl RenderOptions {
    /// What these options change in a scene; they win over `--set`. `gain` is what the picture's colours are multiplied by when it is
    /// written.
    pub fn overrides(&self, gain: f32) -> Overrides {
        let mut overrides = self.camera.overrides(&self.set);
        let mut add = |option: &str, assignment: String| {
            overrides.assignments.push((option.to_owned(), assignment));
        };
        if let Some(map) = &self.env {
            add("--env", map.assignment());
            if !self.set.iter().any(|assignment| assignment.trim_start().starts_with("ambient.")) {
                add("--env", "ambient.environment=true".to_owned());
            }
        }
        if let Some(Colour(color)) = self.picture.bg {
            let [r, g, b] = color.map(|channel| channel / gain);
            add("--bg", format!("image.background=[{r:?}, {g:?}, {b:?}]"));
            add("--bg", "image.backdrop=\"background\"".to_owned());
        }
        overrides
    }
}

/// How linear light becomes the numbers of a PNG or JPEG.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct DisplayOptions {
    /// For PNG and JPEG: brighten by this many stops
    #[arg(long, value_name = "EV", default_value_t = 0.0, value_parser = values::exposure, allow_negative_numbers = true)]
    pub exposure: f32,
    /// For PNG: 8 (default) or 16 bits a channel
    #[arg(long, value_name = "N", value_parser = values::bits)]
    pub bits: Option<Bits>,
    /// For JPEG: 1 (smallest file) to 100 (least loss); default 92
    #[arg(long, value_name = "Q", value_parser = values::whole::<u8>(1..=100))]
    pub quality: Option<u8>,
}

/// How a picture is written.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct PictureOptions {
    /// For EXR: 32-bit colours instead of 16-bit
    #[arg(long)]
    pub float: bool,
    /// How a PNG or JPEG is written.
    #[command(flatten)]
    pub display: DisplayOptions,
    /// An opaque picture in front of this colour: rrggbb or rgb as on the web, or linear R,G,B, or white or black. --exposure
    /// does not change it
    #[arg(long, value_name = "COLOR")]
    pub bg: Option<Colour>,
    /// Draw even if the EXR is already there with the same fingerprint
    #[arg(long)]
    pub overwrite: bool,
}

/// Options that override the scene's camera and picture.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "View")]
pub struct CameraOptions {
    /// Where the camera is
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub eye: Option<Vector>,
    /// What it looks at
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub target: Option<Vector>,
    /// Up in the picture
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::direction)]
    pub up: Option<Vector>,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEG", value_parser = values::degrees)]
    pub fov: Option<f64>,
    /// Width and height of the picture
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<[u32; 2]>,
    /// Draw only these pixels: from X0,Y0 to before X1,Y1
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = values::window)]
    pub crop: Option<PixelRect>,
    /// Draw only one of N bands of rows, or several, counted from 0 (or IofN, counted from 1)
    #[arg(long, value_name = "I/N")]
    pub tile: Option<Tile>,
}

impl CameraOptions {
    /// What the whole job covers (`--crop`, or all) and what of it this run draws (`--tile`).
    ///
    /// # Errors
    ///
    /// [`CliError::Usage`] if the crop is not inside the picture, or has fewer rows than tiles.
    pub fn windows(&self, width: u32, height: u32) -> Result<(PixelRect, PixelRect), CliError> {
        let region = self.crop.unwrap_or(PixelRect::of_picture(width, height));
        if region.x1 > width || region.y1 > height {
            let message = format!("--crop {region} is not inside the picture of {width}×{height} pixels");
            return Err(CliError::Usage(message));
        }
        let Some(tile) = self.tile else { return Ok((region, region)) };
        let window = tile.window(region).ok_or_else(|| {
            CliError::Usage(format!("--tile {tile}: {} rows cannot be cut into more tiles", region.height()))
        })?;
        Ok((region, window))
    }

    /// Refuses a view that has no direction, whatever is looked at.
    ///
    /// # Errors
    ///
    /// [`CliError::Usage`] with the options at fault.
    pub fn check_view(&self) -> Result<(), CliError> {
        let (Some(Vector(eye)), Some(Vector(target))) = (self.eye, self.target) else { return Ok(()) };
        let (eye, target) = (DVec3::from(eye), DVec3::from(target));
        // Without `--up` the scene may have one; any that is not parallel will do here.
        let up = self.up.map_or((target - eye).any_orthogonal_vector(), |Vector(up)| DVec3::from(up));
        match view_fault(eye, target, up) {
            None => Ok(()),
            Some(fault) if eye == target => Err(CliError::Usage(format!("--eye and --target: {fault}"))),
            Some(fault) => Err(CliError::Usage(format!("--up: {fault}"))),
        }
    }

    /// What these options and `--set` change in a scene; the options win.
    pub fn overrides(&self, set: &[String]) -> Overrides {
        let mut assignments: Vec<(String, String)> =
            set.iter().map(|assignment| ("--set".to_owned(), assignment.clone())).collect();
        let mut add = |option: &str, assignment: String| assignments.push((option.to_owned(), assignment));
        for (key, value) in [("eye", self.eye), ("target", self.target), ("up", self.up)] {
            if let Some(Vector([x, y, z])) = value {
                // `{:?}` writes every finite number so that it reads back the same, and is TOML.
                add(&format!("--{key}"), format!("camera.{key}=[{x:?}, {y:?}, {z:?}]"));
            }
        }
        if let Some(fov) = self.fov {
            add("--fov", format!("camera.fov={fov:?}"));
        }
        if let Some([width, height]) = self.size {
            add("--size", format!("image.size=[{width}, {height}]"));
        }
        Overrides { assignments }
    }
}

/// One entry of `--layers`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LayerRequest {
    /// Everything there is.
    All,
    /// `N`.
    Normal,
    /// `P`.
    Position,
    /// `albedo`.
    Albedo,
    /// `direct`.
    Direct,
    /// `indirect`.
    Indirect,
    /// `lit`: all lights; `lit.NAME`: one.
    Lit(Option<String>),
    /// `id`.
    Id,
    /// `cryptomatte`: objects and materials; `cryptomatte.object`, `cryptomatte.material`: one of the two.
    Cryptomatte(Option<Matte>),
}

impl FromStr for LayerRequest {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Ok(match text {
            "all" => Self::All,
            "N" => Self::Normal,
            "P" => Self::Position,
            "albedo" => Self::Albedo,
            "direct" => Self::Direct,
            "indirect" => Self::Indirect,
            "lit" => Self::Lit(None),
            "id" => Self::Id,
            "cryptomatte" => Self::Cryptomatte(None),
            "cryptomatte.object" => Self::Cryptomatte(Some(Matte::Object)),
            "cryptomatte.material" => Self::Cryptomatte(Some(Matte::Material)),
            _ => match text.strip_prefix("lit.") {
                Some(light) => Self::Lit(Some(light.to_owned())),
                None => {
                    return Err(
                        "layers are all, N, P, albedo, direct, indirect, lit, lit.NAME, id, cryptomatte, cryptomatte.object and cryptomatte.material".to_owned()
                    );
                }
            },
        })
    }
}
