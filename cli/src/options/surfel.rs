//! `surfel`.

use super::values::{self, Vector};
use super::{CameraOptions, CloudLook, Common, PictureOptions, PointLayerRequest};
use crate::points::{ColorBy, PointOptions};
use clap::ValueEnum;
use pointillist_surfel as surfel;
use std::path::PathBuf;

/// `surfel`.
#[derive(Debug, clap::Args)]
pub struct SurfelOptions {
    /// Clouds, drawn together: .ply with x y z and, where it has them, nx ny nz, face_nx face_ny face_nz beside these, red green blue, alpha, radius; .ply.gz, .xyz, .las, .laz, .octree, with a feature .e57
    #[arg(required = true, value_name = "CLOUD")]
    pub clouds: Vec<PathBuf>,
    /// The picture: .png or .exr (default: the first CLOUD's name with .png)
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,
    /// What is sharp.
    #[command(flatten)]
    pub focus: FocusOptions,
    /// How discs become a picture.
    #[command(flatten)]
    pub discs: DiscOptions,
    /// Which points are drawn, and in which colours.
    #[command(flatten)]
    pub look: CloudLook,
    /// How surfaces are lit.
    #[command(flatten)]
    pub shading: SurfelShading,
    /// The view.
    #[command(flatten)]
    pub camera: CameraOptions,
    /// Draw from an octree beside each CLOUD (CLOUD.octree, made once) even if it fits into memory; clouds that do not fit are drawn so anyway, and COPC by its own
    #[arg(long)]
    pub octree: bool,
    /// Draw a picture for each line of a file, EYE and TARGET in six numbers or nine with UP; -o then has a place for the number: flight_{frame:04}.png
    #[arg(long, value_name = "FILE", conflicts_with_all = ["eye", "target"])]
    pub views: Option<PathBuf>,
    /// Further layers in the EXR: `all`, or a list of N, P
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub layers: Vec<PointLayerRequest>,
    /// How the picture is written.
    #[command(flatten)]
    pub picture: PictureOptions,
    /// Leave out points that are NaN or infinite, instead of refusing the file
    #[arg(long)]
    pub drop_invalid: bool,
    /// Draw the frame N times; --stats then has frame_ms and frame_cpu_ms
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = values::whole::<u32>(1..=u32::MAX))]
    pub repeat: u32,
    /// What every command has.
    #[command(flatten)]
    pub common: Common,
}

/// Depth of field.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Depth of field (with --focus and one of --depth, --aperture, --lens)")]
pub struct FocusOptions {
    /// Distance along the view axis at which everything is sharp, world units; -v tells where things are
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = values::positive)]
    pub focus: Option<f64>,
    /// Radius of the blur per unit of distance from the focus (the paper's d); 0 is sharp everywhere
    #[arg(long, value_name = "D", allow_negative_numbers = true, value_parser = values::not_negative, requires = "focus", conflicts_with_all = ["aperture", "lens"])]
    pub depth: Option<f64>,
    /// Radius of a thin lens, world units; 0 is a pinhole
    #[arg(long, value_name = "RADIUS", allow_negative_numbers = true, value_parser = values::not_negative, requires = "focus", conflicts_with = "lens")]
    pub aperture: Option<f64>,
    /// Focal length of a lens in millimetres, for a world in metres; without --fov the view is that of the lens
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = values::positive, requires_all = ["focus", "fstop"])]
    pub lens: Option<f64>,
    /// f-number of the lens: its focal length over the diameter of its opening
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = values::positive, requires = "lens")]
    pub fstop: Option<f64>,
    /// Height of the lens's sensor in millimetres (default: 24)
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = values::positive, requires = "lens", conflicts_with = "fov")]
    pub sensor: Option<f64>,
    /// No depth of field: everything is sharp, whatever the options above say
    #[arg(long)]
    pub no_dof: bool,
}

/// How discs become a picture.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Discs")]
pub struct DiscOptions {
    /// Level of detail: take the coarsest level whose points are at most this many pixels apart; 0 takes all points
    #[arg(long, value_name = "PX", allow_negative_numbers = true, default_value_t = 1.27, value_parser = values::not_negative)]
    pub level: f64,
    /// How discs become a picture
    #[arg(long, value_name = "NAME", default_value = "blended")]
    pub procedure: ProcedureValue,
    /// Do not skip what faces away or is hidden; the picture is the same
    #[arg(long)]
    pub no_cull: bool,
    /// Estimate normals from neighbouring points, even where the file has some
    #[arg(long)]
    pub estimate_normals: bool,
    /// Draw all points as opaque, whatever opacity the file gives them (`alpha` in a PLY)
    #[arg(long)]
    pub ignore_alpha: bool,
}

/// How surfaces are lit.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Shading: colour × (A + (1 − A)·max(0, n·l))")]
pub struct SurfelShading {
    /// Direction towards the light in the world (default: from the eye)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::direction)]
    pub light: Option<Vector>,
    /// Share of ambient light, which comes from all directions, 0 to 1
    #[arg(long, value_name = "A", allow_negative_numbers = true, default_value_t = 0.1, value_parser = values::share)]
    pub ambient: f32,
}

/// `--procedure`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProcedureValue {
    /// Layers of depth, in each the weighted mean of all discs
    Blended,
    /// The paper's: z-buffer, links, a Gaussian filter over holes
    Paper,
}

/// Height of a 35 mm frame.
const DEFAULT_SENSOR_MM: f64 = 24.0;

impl SurfelOptions {
    /// How clouds are read.
    #[must_use]
    pub fn reading(&self) -> PointOptions {
        PointOptions {
            drop_invalid: self.drop_invalid,
            ignore_alpha: self.discs.ignore_alpha,
            selection: self.look.selection(),
            scalar: self.look.color_by.scalar(),
        }
    }

    /// The field of view of the lens in degrees, where nothing else says what is seen.
    ///
    /// # Errors
    ///
    /// A focus nearer than the focal length.
    pub fn lens_fov_deg(&self) -> Result<Option<f64>, String> {
        let focus = &self.focus;
        let (Some(lens), Some(distance), None) = (focus.lens, focus.focus, self.camera.fov) else {
            return Ok(None);
        };
        let sensor = focus.sensor.unwrap_or(DEFAULT_SENSOR_MM);
        match surfel::field_of_view_rad(lens, sensor, 1000.0 * distance) {
            Some(fov) => Ok(Some(fov.to_degrees())),
            None => Err(format!(
                "--focus {distance} is nearer than the focal length of --lens {lens} mm (the world is in metres)"
            )),
        }
    }

    /// What the renderer is asked for.
    ///
    /// # Errors
    ///
    /// A focus without anything that blurs.
    pub fn frame_options(&self) -> Result<surfel::Options, String> {
        let mut options = surfel::Options::default();
        options.focus = self.focus.chosen()?;
        options.procedure = match self.discs.procedure {
            ProcedureValue::Blended => surfel::Procedure::Blended,
            ProcedureValue::Paper => surfel::Procedure::Paper,
        };
        options.level = self.discs.level as f32;
        options.culling = !self.discs.no_cull;
        if let Some(Vector(light)) = self.shading.light {
            options.light = surfel::Light::Towards(light.into());
        }
        options.ambient = self.shading.ambient;
        options.surface_layers = !self.layers.is_empty() || self.look.color_by == ColorBy::Normal;
        Ok(options)
    }
}

impl FocusOptions {
    fn chosen(&self) -> Result<surfel::Focus, String> {
        let Some(focus) = self.focus.filter(|_| !self.no_dof) else { return Ok(surfel::Focus::Everywhere) };
        if let Some(depth) = self.depth {
            Ok(surfel::Focus::Depth { depth, focus })
        } else if let Some(aperture) = self.aperture {
            Ok(surfel::Focus::Lens { aperture, focus })
        } else if let (Some(lens), Some(fstop)) = (self.lens, self.fstop) {
            Ok(surfel::Focus::photographic(0.001 * lens, fstop, focus))
        } else {
            Err("--focus blurs nothing by itself; add --depth, --aperture or --lens with --fstop".to_owned())
        }
    }
}
