//! `check`.

use super::Report;
use super::report::write_text;
use crate::error::CliError;
use crate::input::name_of;
use crate::input_error::InputError;
use crate::options::{CameraOptions, CheckOptions};
use crate::scene::{self, weight};
use std::path::PathBuf;

pub(super) fn run(options: &CheckOptions) -> Result<(), CliError> {
    let result = (!options.common.quiet).then(|| PathBuf::from("-"));
    let report = Report::new(&options.common)?.writing(&result)?;
    let overrides = CameraOptions::default().overrides(&options.set);
    let loaded = report.stats.stage("load", || scene::load(&options.scene, &overrides))?;
    let faults: Vec<String> = loaded.unmatched.iter().map(InputError::to_string).collect();
    loaded.warnings.iter().filter(|w| !faults.contains(w)).for_each(|warning| report.warn(warning));
    if let Some((first, rest)) = loaded.unmatched.split_first() {
        rest.iter().for_each(|fault| report.warn(&fault.to_string()));
        return Err(first.clone().into());
    }
    let scene = &loaded.scene;
    (0..=loaded.motion.last_frame())
        .try_for_each(|frame| loaded.motion.camera(&scene.camera, frame).map(drop))?;
    weight::heavy(scene).iter().for_each(|text| report.note(&format!("note: {text}")));
    report.stats.count("triangles", scene.mesh.triangle_count() as u64);
    report.stats.count("lights", scene.lights.len() as u64);
    let text = format!(
        "{}: fine; triangles: {}, objects: {}, materials: {}, textures: {}, lights: {}; {}×{} pixels",
        name_of(&options.scene),
        scene.mesh.triangle_count(),
        scene.mesh.objects.len(),
        scene.materials.len(),
        scene.textures.len(),
        scene.lights.len(),
        scene.image.width,
        scene.image.height
    );
    if let Some(path) = &result {
        write_text(path, |output| writeln!(output, "{text}"))?;
    }
    report.finish()
}
