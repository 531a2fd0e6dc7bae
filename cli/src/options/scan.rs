//! `scan`.

use super::values::{self, Vector};
use super::{CameraOptions, CloudLook, Common, PictureOptions, PointLayerRequest};
use crate::points::{ColorBy, PointOptions};
use clap::ValueEnum;
use pointillist_ibpr as ibpr;
use std::path::PathBuf;
use std::str::FromStr;

/// `scan`.
#[derive(Debug, clap::Args)]
pub struct ScanOptions {
    /// Scans (.ply, .ply.gz, .xyz, .las, .laz, .octree, with a feature .e57), lists of scans (.conf) and meshes (.obj, .ply with faces)
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// The picture: .png or .exr (default: the first FILE's name with .png)
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,
    /// How points become surfaces.
    #[command(flatten)]
    pub surface: SurfaceOptions,
    /// Which points are drawn, and in which colours.
    #[command(flatten)]
    pub look: CloudLook,
    /// How surfaces are lit.
    #[command(flatten)]
    pub shading: ShadingOptions,
    /// The view.
    #[command(flatten)]
    pub camera: CameraOptions,
    /// Draw from an octree beside each FILE (FILE.octree, made once) even if it fits into memory; clouds that do not fit are drawn so anyway, and COPC by its own
    #[arg(long)]
    pub octree: bool,
    /// Further layers in the EXR: `all`, or a list of N, P, count
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub layers: Vec<PointLayerRequest>,
    /// How the picture is written.
    #[command(flatten)]
    pub picture: PictureOptions,
    /// Leave out points that are NaN or infinite, instead of refusing the file
    #[arg(long)]
    pub drop_invalid: bool,
    /// Take the vertices of meshes, instead of points all over them
    #[arg(long)]
    pub vertices: bool,
    /// Draw the frame N times; --stats then has frame_ms and frame_cpu_ms
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = values::whole::<u32>(1..=u32::MAX))]
    pub repeat: u32,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// How points become surfaces.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Surface")]
pub struct SurfaceOptions {
    /// Distance of neighbouring points of a scan, world units (default: estimated)
    #[arg(long, value_name = "R", value_parser = values::positive)]
    pub spacing: Option<f64>,
    /// Size of a buffer pixel in picture pixels, at least 1, or `auto`
    #[arg(long, value_name = "S", default_value = "auto")]
    pub scale: ScaleValue,
    /// Thickness of a surface in spacings
    #[arg(long, value_name = "G", default_value_t = 2.0, value_parser = values::positive)]
    pub gamma: f64,
    /// Buffers per frame: 2 draws a finer one under the normal one, sharper where points are exact, grainy along outlines where they are not, in twice the time
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = values::whole::<u8>(1..=2))]
    pub passes: u8,
    /// With two passes, size of the finer buffer's pixels relative to the normal one's
    #[arg(long, value_name = "F", default_value_t = 0.83, value_parser = values::share_above_0)]
    pub finer: f64,
    /// Opacity of surfaces, 0 to 1, times that of their points (`alpha` in a PLY); without it, surfaces are translucent only if a point is
    #[arg(long, value_name = "A", value_parser = values::share)]
    pub alpha: Option<f32>,
    /// Draw all points as opaque, whatever opacity the file gives them
    #[arg(long)]
    pub ignore_alpha: bool,
    /// Where surfaces are translucent, how many a pixel keeps
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = values::whole::<u16>(1..=ibpr::Translucency::MOST_LAYERS as u16))]
    pub depth_layers: u16,
    /// Where surfaces are translucent, depth of a layer in spacings (the paper: 10)
    #[arg(long, value_name = "T", default_value_t = 5.0, value_parser = values::positive)]
    pub layer_threshold: f64,
    /// Draw scans and blocks that face away too
    #[arg(long, conflicts_with = "cull")]
    pub no_cull: bool,
    /// What is skipped because it faces away
    #[arg(long, value_name = "RULE", default_value = "blocks")]
    pub cull: CullValue,
    /// Where normals come from
    #[arg(long, value_name = "RULE", default_value = "plane")]
    pub normals: NormalsValue,
    /// How points of one pixel are averaged
    #[arg(long, value_name = "RULE", default_value = "even")]
    pub weights: WeightsValue,
    /// How far surfaces reach, in buffer pixels: 0.3 ends bodies where they end, more makes them larger; 0 as printed
    #[arg(long, value_name = "B", default_value_t = ibpr::Options::OUTLINE, value_parser = values::share)]
    pub outline: f32,
    /// Fill gaps of less than 2^L buffer pixels
    #[arg(long, value_name = "L", default_value_t = 2, value_parser = values::whole::<u32>(0..=ibpr::Options::MOST_FILL))]
    pub fill: u32,
}

/// How surfaces are lit.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Shading: colour × (A + (1 − A)·max(0, n·l))")]
pub struct ShadingOptions {
    /// Direction towards the light in the world (default: from the eye)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::direction)]
    pub light: Option<Vector>,
    /// Share of ambient light, which comes from all directions, 0 to 1
    #[arg(long, value_name = "A", default_value_t = 0.1, value_parser = values::share)]
    pub ambient: f32,
    /// Eye-dome lighting: darken what lies behind its surroundings; a strength of 1 is usual
    #[arg(long, value_name = "STRENGTH", num_args = 0..=1, default_missing_value = "1", value_parser = values::not_negative)]
    pub edl: Option<f64>,
}

/// `--scale`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaleValue(pub ibpr::Scale);

impl FromStr for ScaleValue {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self(ibpr::Scale::Auto(ibpr::Options::AUTO_FACTOR)));
        }
        match text.parse::<f32>() {
            Ok(s) if s >= 1.0 && s.is_finite() => Ok(Self(ibpr::Scale::Fixed(s))),
            _ => Err("must be a number of at least 1, or `auto`".to_owned()),
        }
    }
}

/// `--cull`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CullValue {
    /// Nothing
    None,
    /// Scans taken from behind, as in the paper: loses points that can be seen
    Printed,
    /// Scans taken from more than 165° away
    Scans,
    /// Blocks of points whose normals all face away
    Blocks,
}

/// `--normals`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum NormalsValue {
    /// Fitted over windows that grow with the noise
    Plane,
    /// From the paper's eight triangles
    Triangles,
}

/// `--weights`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WeightsValue {
    /// All points of the slab alike
    Even,
    /// About the slab's mean
    Symmetric,
    /// Falling from the nearest point
    Falling,
    /// As eq. 2 of the paper is printed: the nearest point counts least
    Printed,
}

impl ScanOptions {
    /// How clouds are read.
    #[must_use]
    pub fn reading(&self) -> PointOptions {
        PointOptions {
            drop_invalid: self.drop_invalid,
            ignore_alpha: self.surface.ignore_alpha,
            selection: self.look.selection(),
            scalar: self.look.color_by.scalar(),
        }
    }

    /// What the renderer is asked for, for points of which some are translucent, or none.
    pub fn frame_options(&self, has_translucent: bool) -> ibpr::Options {
        let surface = &self.surface;
        let mut options = ibpr::Options::default();
        options.scale = surface.scale.0;
        options.gamma = surface.gamma as f32;
        options.weighting = match surface.weights {
            WeightsValue::Even => ibpr::Weighting::Even,
            WeightsValue::Symmetric => ibpr::Weighting::Symmetric,
            WeightsValue::Falling => ibpr::Weighting::Falling,
            WeightsValue::Printed => ibpr::Weighting::Printed,
        };
        options.normals = match surface.normals {
            NormalsValue::Plane => ibpr::Normals::Plane,
            NormalsValue::Triangles => ibpr::Normals::Triangles,
        };
        options.culling = match surface.cull {
            _ if surface.no_cull => ibpr::Culling::None,
            CullValue::None => ibpr::Culling::None,
            CullValue::Printed => ibpr::Culling::Printed,
            CullValue::Scans => ibpr::Culling::Scans,
            CullValue::Blocks => ibpr::Culling::Blocks,
        };
        options.outline = surface.outline;
        options.fill = surface.fill;
        options.passes = match surface.passes {
            1 => ibpr::Passes::One,
            _ => ibpr::Passes::Two { finer: surface.finer as f32 },
        };
        options.translucency = surface.alpha.or(has_translucent.then_some(1.0)).map(|alpha| {
            ibpr::Translucency::new(alpha)
                .with_layers(surface.depth_layers.into())
                .with_threshold(surface.layer_threshold as f32)
        });
        if let Some(Vector(light)) = self.shading.light {
            options.light = ibpr::Light::Towards(light.into());
        }
        options.ambient = self.shading.ambient;
        options.eye_dome = self.shading.edl.map(|strength| ibpr::EyeDome::new(strength as f32, 2));
        options.surface_layers = !self.layers.is_empty() || self.look.color_by == ColorBy::Normal;
        options
    }
}
