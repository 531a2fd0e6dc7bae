//! Which frames are drawn, and which file each goes to.

use super::super::report::check_output;
use crate::error::CliError;
use crate::input::is_standard;
use crate::name_pattern;
use crate::options::{FrameRange, RenderOptions};
use crate::scene::{FRAME_MARGIN, LoadedScene, Motion, framing_distance};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// What messages call the places of frame numbers.
const FRAME: &str = "frame";

/// A frame, and the file that it goes to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shot {
    pub(super) frame: u32,
    pub(super) output: PathBuf,
}

/// All frames of a run, in their order. A run without `--frames` has one: frame 0.
pub(super) fn shots(options: &RenderOptions) -> Result<Vec<Shot>, CliError> {
    let output = output_path(options);
    let wrong = |message: String| CliError::Usage(format!("-o {}: {message}", output.display()));
    let frames = match (options.frames, options.turntable) {
        (Some(frames), Some(views)) if frames.last >= views => {
            let message = format!("--frames {frames}: --turntable {views} has frames 0 to {}", views - 1);
            return Err(CliError::Usage(message));
        }
        (Some(frames), _) => frames,
        (None, Some(views)) => FrameRange { first: 0, last: views - 1 },
        (None, None) => FrameRange { first: 0, last: 0 },
    };
    let is_sequence = options.frames.is_some() || options.turntable.is_some();
    let has_place = name_pattern::has(&output, FRAME).map_err(wrong)?;
    if has_place && !is_sequence {
        return Err(wrong("{frame} is for --frames or --turntable, and neither is given".to_owned()));
    }
    if !has_place && frames.count() > 1 {
        let example = numbered(&output);
        let message =
            format!("{} frames need {{frame}} in the name, as in {}", frames.count(), example.display());
        return Err(wrong(message));
    }
    let shot = |frame| Ok(Shot { frame, output: name_pattern::fill(&output, FRAME, frame).map_err(wrong)? });
    (frames.first..=frames.last).map(shot).collect()
}

/// Looks whether the files can be written: one in each folder.
pub(super) fn check_outputs(shots: &[Shot]) -> Result<(), CliError> {
    let mut seen = HashSet::new();
    let mut first_in_folder = shots.iter().filter(|shot| seen.insert(shot.output.parent()));
    first_in_folder.try_for_each(|shot| check_output(&shot.output))
}

/// What moves: the scene's own paths, or the camera around a plain model.
pub(super) fn motion(options: &RenderOptions, loaded: &LoadedScene) -> Motion {
    options.turntable.map_or_else(|| loaded.motion.clone(), Motion::turntable)
}

/// Refuses a turntable of a scene file: its lights and its camera are its own.
pub(super) fn check_turntable(options: &RenderOptions) -> Result<(), CliError> {
    let is_scene_file = |path: &Path| {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        ["toml", "json"].contains(&extension.as_str())
    };
    if options.turntable.is_some() && options.scene.as_deref().is_none_or(is_scene_file) {
        let message = "--turntable goes around a plain model (.obj, .ply, .gltf, .glb); in a scene file, [camera.path] moves \
                       the camera";
        return Err(CliError::Usage(message.to_owned()));
    }
    Ok(())
}

/// What to say of a turntable that cuts the model off: it is framed for the first view, and may be wider in others.
pub(super) fn cut_off(
    options: &RenderOptions,
    loaded: &LoadedScene,
    motion: &Motion,
    shots: &[Shot],
) -> Option<String> {
    if options.turntable.is_none() || options.camera.eye.is_some() {
        return None;
    }
    let start = &loaded.scene.camera;
    let image = &loaded.scene.image;
    let aspect = f64::from(image.width) / f64::from(image.height);
    let cameras = shots.iter().filter_map(|shot| motion.camera(start, shot.frame).ok());
    let needed =
        cameras.map(|camera| framing_distance(&camera, &loaded.scene.mesh, aspect)).fold(0.0, f64::max);
    let away = start.eye - start.target;
    // Up to the margin that the first view has, nothing is cut off.
    if needed <= FRAME_MARGIN * away.length() {
        return None;
    }
    let eye = start.target + away * (needed / away.length());
    let digits = (3.0 - needed.log10().floor()).clamp(0.0, 12.0) as usize;
    Some(format!(
        "--turntable: the model is framed for the first view and reaches beyond others; `--eye {:.digits$},{:.digits$},{:.digits$}` \
         shows all of it",
        eye.x, eye.y, eye.z
    ))
}

fn output_path(options: &RenderOptions) -> PathBuf {
    let own = match (&options.output, &options.scene) {
        (Some(output), _) => return output.clone(),
        (None, Some(scene)) if !is_standard(scene) => {
            PathBuf::from(scene.with_extension("png").file_name().unwrap_or_default())
        }
        _ => PathBuf::from("pointillist.png"),
    };
    if options.frames.is_some() || options.turntable.is_some() { numbered(&own) } else { own }
}

/// The name with a place for the frame's number: `a.png` as `a.{frame:04}.png`.
pub(in crate::commands) fn numbered(path: &Path) -> PathBuf {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_extension(format!("{{frame:04}}.{extension}"))
}
