//! What `scan` and `surfel` share: where the picture goes, the camera, drawing again and again, writing.

use super::Report;
use super::render::{OutputFormat, is_there, write_picture};
use super::report::check_output;
use crate::cloud_io::Pose;
use crate::error::CliError;
use crate::image_io::{Frame, PixelRect, Stamp};
use crate::input::{self, is_standard};
use crate::input_error::InputError;
use crate::memory;
use crate::name_pattern;
use crate::options::{CameraOptions, CloudLook, PictureOptions, Vector};
use crate::points::{Colouring, Legend, Trees, draw_legend};
use crate::scene::description::{CameraDescription, DEFAULT_FOV_DEG};
use crate::scene::{Camera, FRAME_MARGIN as MARGIN, Projection, frame_around};
use cpu_time::ProcessTime;
use glam::DVec3;
use pointillist_ibpr as ibpr;
use pointillist_octree::Cut;
use pointillist_surfel as surfel;
use std::hash::Hasher as _;
use std::path::{Path, PathBuf};
use std::time::Instant;
use twox_hash::XxHash3_64;

/// Width and height of a picture without `--size`.
const DEFAULT_SIZE: [u32; 2] = [1024, 1024];

/// Bytes that a pixel takes at least while points are drawn: buffers, the frame and its layers.
const PIXEL_BYTES: u128 = 48;

pub(super) fn size(options: &CameraOptions) -> [u32; 2] {
    options.size.unwrap_or(DEFAULT_SIZE)
}

/// Looks at the view and the size of the picture before anything is loaded; gives what the job covers and what this run draws.
pub(super) fn check_view(options: &CameraOptions) -> Result<(PixelRect, PixelRect), CliError> {
    options.check_view()?;
    let [width, height] = size(options);
    let most = ibpr::Renderer::LARGEST_SIDE.min(surfel::Renderer::LARGEST_SIDE);
    if width.max(height) > most {
        let message = format!("--size {width}x{height}: points are drawn with up to {most} pixels a side");
        return Err(CliError::Usage(message));
    }
    let needed = u128::from(width) * u128::from(height) * PIXEL_BYTES;
    memory::check(needed, || format!("{width}×{height} pixels (--size) take"))
        .map_err(|error| CliError::Usage(error.with_help()))?;
    options.windows(width, height)
}

/// Whether a run draws all of a picture.
pub(super) fn is_whole(window: PixelRect, [width, height]: [u32; 2]) -> bool {
    window == PixelRect::of_picture(width, height)
}

/// `-o`, or the name of the first file: `bun.ply.gz` gives `bun.png`, and standard input `pointillist.png`.
pub(super) fn output_path(given: Option<&Path>, first: &Path) -> PathBuf {
    let own = || {
        let name = PathBuf::from(first.file_name().unwrap_or_default());
        let name = if name.extension().is_some_and(|e| e == "gz") { name.with_extension("") } else { name };
        name.with_extension("png")
    };
    match given {
        Some(path) => path.to_owned(),
        None if is_standard(first) => PathBuf::from("pointillist.png"),
        None => own(),
    }
}

/// The camera of the options. What they leave open is as `suggested` (camera from world), if they say neither where the camera is nor where
/// it looks, and otherwise has all points in view. `fov_deg` is for options without one.
pub(super) fn camera<I: Iterator<Item = DVec3>>(
    given: &CameraOptions,
    suggested: Option<&Pose>,
    fov_deg: Option<f64>,
    positions: impl Fn() -> I,
) -> Result<Camera, CliError> {
    let place = |v: Option<Vector>| v.map(|Vector(v)| DVec3::from(v));
    let [width, height] = size(given);
    let aspect = f64::from(width) / f64::from(height);
    let suggested = suggested.filter(|_| given.eye.is_none() && given.target.is_none());
    let fitting = || suggested.map(|view| fitting_fov_deg(view, positions(), aspect));
    let fov_y_rad = given.fov.or(fov_deg).or_else(fitting).unwrap_or(DEFAULT_FOV_DEG).to_radians();
    let world_from_camera = suggested.map(Pose::inverse);
    let eye = world_from_camera.map(|view| view.translation);
    let along = |axis: DVec3| world_from_camera.map(|view| view.rotation * axis);
    let description = CameraDescription {
        eye: place(given.eye).or(eye),
        target: place(given.target).or(eye.zip(along(DVec3::NEG_Z)).map(|(eye, forward)| eye + forward)),
        up: place(given.up).or(along(DVec3::Y)).unwrap_or(DVec3::Y),
        projection: Some(Projection::Perspective { fov_y_rad }),
    };
    frame_around(&description, positions, aspect)
        .map_err(|fault| CliError::Usage(format!("the camera cannot be used: {fault}")))
}

/// The field of view in which all points are seen that are in front of the camera: a suggested view does not say its own. At most what is
/// usual, from within a room for example.
fn fitting_fov_deg(view: &Pose, positions: impl Iterator<Item = DVec3>, aspect: f64) -> f64 {
    let tangent = |point: DVec3| {
        let seen = view.to_world(point);
        (seen.z < 0.0).then(|| seen.y.abs().max(seen.x.abs() / aspect) / -seen.z)
    };
    let largest = positions.filter_map(tangent).fold(0.0, f64::max);
    if largest > 0.0 {
        (2.0 * (MARGIN * largest).atan()).to_degrees().min(DEFAULT_FOV_DEG)
    } else {
        DEFAULT_FOV_DEG
    }
}

/// A line of `--views`.
pub(super) struct FlightView {
    eye: [f64; 3],
    target: [f64; 3],
    up: Option<[f64; 3]>,
}

impl FlightView {
    /// The camera of the options, at this place.
    pub(super) fn of(&self, camera: &CameraOptions) -> CameraOptions {
        let mut camera = camera.clone();
        camera.eye = Some(Vector(self.eye));
        camera.target = Some(Vector(self.target));
        camera.up = self.up.map(Vector).or(camera.up);
        camera
    }
}

/// Reads the views of a flight: a line for each, six numbers for eye and target or nine with what is up, between blanks or commas. What follows a `#` does not
/// count.
pub(super) fn read_views(path: &Path) -> Result<Vec<FlightView>, InputError> {
    let name = input::name_of(path);
    let bytes = input::read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let mut views = vec![];
    for (index, line) in text.lines().enumerate() {
        let fault = |message: String| {
            InputError::in_line(&name, &bytes, index + 1, message)
                .with_help("a line is EYE and TARGET, six numbers, or nine with UP: 10 5 20  0 0 0")
        };
        let words = line.split('#').next().unwrap_or_default();
        let words = words.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty());
        let number = |word: &str| match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(fault(format!("`{word}` is no number"))),
        };
        let numbers = words.map(number).collect::<Result<Vec<_>, _>>()?;
        let three = |at: usize| [numbers[at], numbers[at + 1], numbers[at + 2]];
        match numbers.len() {
            0 => {}
            6 => views.push(FlightView { eye: three(0), target: three(3), up: None }),
            9 => views.push(FlightView { eye: three(0), target: three(3), up: Some(three(6)) }),
            count => return Err(fault(format!("a view of {count} numbers"))),
        }
    }
    if views.is_empty() {
        return Err(
            InputError::of_file(name, "there is no view in it").with_help("write a line for each picture")
        );
    }
    Ok(views)
}

/// The pictures of a flight: names with a number in the place of `{frame}`, from 1; one picture has its own name.
pub(super) fn output_paths(path: &Path, views: Option<usize>) -> Result<Vec<PathBuf>, CliError> {
    let Some(views) = views else { return Ok(vec![path.to_owned()]) };
    if !name_pattern::has(path, "frame").map_err(CliError::Usage)? {
        let message =
            "--views makes a picture for each view: give them names, such as -o flight_{frame:04}.png";
        return Err(CliError::Usage(message.to_owned()));
    }
    let numbers = 1..=u32::try_from(views).unwrap_or(u32::MAX);
    numbers.map(|number| name_pattern::fill(path, "frame", number).map_err(CliError::Usage)).collect()
}

/// Draws a view by nodes with `draw`: a coarse picture first, if one is given, then that of all points that the view needs.
pub(super) fn draw_coarse_first(
    (coarse, cut): (Option<Cut>, &Cut),
    target: &Target<'_>,
    stamp: Stamp,
    report: &Report<'_>,
    mut draw: impl FnMut(&Cut, Stamp) -> Result<(), CliError>,
) -> Result<(), CliError> {
    if let Some(coarse) = coarse {
        draw(&coarse, Stamp { unfinished: true, ..stamp.clone() })?;
        let (path, more) = (target.path.display(), cut.points - coarse.points);
        report.note(&format!("{path} is there, coarse; {more} more points are read"));
    }
    if cut.is_limited {
        let (gap, points) = (cut.spacing_px, cut.points);
        report.warn(&format!(
            "points are up to {gap:.1} pixels apart: the memory is enough for {points} of them; --memory gives more"
        ));
    }
    draw(cut, stamp)
}

/// Counts what was read of files with nodes.
pub(super) fn count_nodes(report: &Report<'_>, trees: &Trees) {
    report.stats.count("bytes_read", trees.bytes_read);
    report.stats.count("nodes_read", trees.nodes_read);
    report.stats.skip("nodes_kept", trees.nodes_kept);
}

/// Draws a frame as often as `--repeat` asks, and notes how long each took.
pub(super) fn repeat(
    report: &Report<'_>,
    times: u32,
    mut draw: impl FnMut() -> Result<(), CliError>,
) -> Result<(), CliError> {
    let progress = report.progress();
    progress.begin("draw", u64::from(times));
    for _ in 0..times {
        let (wall, cpu) = (Instant::now(), ProcessTime::try_now().ok());
        draw()?;
        let cpu = cpu.and_then(|start| start.try_elapsed().ok()).unwrap_or_default();
        report.stats.frame(wall.elapsed(), cpu);
        progress.advance(1);
    }
    progress.finish();
    Ok(())
}

/// Where a picture goes, and how.
pub(super) struct Target<'a> {
    pub(super) path: PathBuf,
    format: OutputFormat,
    options: &'a PictureOptions,
}

impl<'a> Target<'a> {
    pub(super) fn new(path: PathBuf, options: &'a PictureOptions, layers: bool) -> Result<Self, CliError> {
        let format = OutputFormat::of(&path)?;
        format.check(layers, options)?;
        check_output(&path)?;
        Ok(Self { path, format, options })
    }

    /// How points are coloured, if this picture can show it.
    pub(super) fn colouring(&self, look: &CloudLook) -> Result<Colouring, CliError> {
        if look.legend && self.format == OutputFormat::Exr {
            let message = "--legend: an EXR holds what was drawn and nothing else; add -o picture.png";
            return Err(CliError::Usage(message.to_owned()));
        }
        look.colouring()
    }

    /// Whether an earlier run wrote the same picture.
    pub(super) fn is_done(&self, stamp: &Stamp, window: PixelRect, report: &Report<'_>) -> bool {
        let done = self.format == OutputFormat::Exr
            && !self.options.overwrite
            && is_there(&self.path, stamp, window, report);
        if done {
            report.note(&format!("{} is already there; --overwrite draws it again", self.path.display()));
        }
        done
    }

    /// Writes a picture of so many points. What their colours mean is drawn into it if a legend is given; there may be no room for it.
    pub(super) fn finish(
        &self,
        mut picture: Frame,
        (legend, stamp): (Option<Legend>, Stamp),
        points: usize,
        report: &Report<'_>,
    ) -> Result<(), CliError> {
        let gain = self.format.gain(&self.options.display);
        if legend.is_some_and(|legend| !draw_legend(&mut picture, &legend, gain)) {
            report.warn("--legend: the picture is too small for one; a larger --size has room");
        }
        let write = || write_picture(&self.path, self.format, picture, stamp, self.options);
        report.stats.stage("write", write)?;
        let seconds = report.stats.elapsed().as_secs_f64();
        report.note(&format!("{}: {points} points in {seconds:.2} s", self.path.display()));
        Ok(())
    }
}

/// What a picture was made from: `points` is the fingerprint of the points, `drawn` all that was chosen.
pub(super) fn stamp(points: u64, drawn: &str, camera: &CameraOptions, region: PixelRect) -> Stamp {
    let mut hash = XxHash3_64::default();
    hash.write(&points.to_le_bytes());
    hash.write(drawn.as_bytes());
    Stamp {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint: hash.finish(),
        region,
        tile: camera.tile.map(|tile| tile.to_string()),
        unfinished: false,
        background: [0.0; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_is_called_like_the_first_file() {
        let output = |file: &str| output_path(None, Path::new(file));
        assert_eq!(output("a/bun.conf"), Path::new("bun.png"));
        assert_eq!(output("dragon_0.ply.gz"), Path::new("dragon_0.png"));
    }
}
