//! `probe bake --indirect`: light between surfaces that is known before probes look around.

use super::failed;
use crate::baked_file::{Fit, read_baked};
use crate::commands::Report;
use crate::error::CliError;
use crate::input;
use crate::input_error::InputError;
use crate::job::Watch;
use crate::options::{BakeOptions, Indirect};
use crate::scene::Scene;
use glam::Vec3;
use pointillist_render::solve_indirect;
use pointillist_render::{Ambient, IndirectError, IndirectOptions, Lightmap, Prepared, SceneError};
use std::path::Path;
use twox_hash::XxHash3_64;

/// Light between surfaces, and what stands for it in fingerprints and in the output.
pub(super) struct KnownLight {
    pub(super) light: Lightmap,
    /// A hash of the file, or `solve`.
    pub(super) name: String,
}

/// What `--indirect` names; nothing without it.
///
/// # Errors
/// A file that is none of radiosity or belongs to another scene; a scene that cannot be solved.
pub(super) fn known_light(
    options: &BakeOptions,
    scene: &Scene,
    report: &Report<'_>,
) -> Result<Option<KnownLight>, CliError> {
    let Some(indirect) = &options.indirect else { return Ok(None) };
    if scene.image.background != Vec3::ZERO || scene.image.environment.is_some() {
        report.warn(
            "--indirect: a radiosity solution knows nothing of the background; what surfaces reflect of it is left out \
             (probes see the background itself)",
        );
    }
    let known = match indirect {
        Indirect::File(path) => read(path, scene)?,
        Indirect::Solve => {
            let progress = report.progress();
            let watch = Watch { task: "radiosity", progress: &progress, stats: &report.stats };
            let light = solve_indirect(scene, &IndirectOptions::DEFAULT, &watch);
            progress.finish();
            KnownLight {
                light: light.map_err(|error| unsolved(&options.scene, error))?,
                name: "solve".into(),
            }
        }
    };
    Ok(Some(known))
}

/// What surfaces are lit by, beside lights.
pub(super) fn ambient<'a>(prepared: &'a Prepared<'_>, known: Option<&'a KnownLight>) -> Ambient<'a> {
    known.map_or_else(|| prepared.ambient(), |known| Ambient::Radiosity(&known.light))
}

fn read(path: &Path, scene: &Scene) -> Result<KnownLight, InputError> {
    let name = input::name_of(path);
    let baked = read_baked(path)?;
    let other = |what: &str| {
        let message = format!("was baked for another scene: {what} differ");
        let help = "bake it again with `pointillist radiosity SCENE -o baked.json`, or use --indirect solve";
        InputError { mismatched: true, ..InputError::of_file(name.as_str(), message).with_help(help) }
    };
    let fit = baked.fit(&scene.mesh);
    if fit != Fit::All {
        return Err(other("its triangles"));
    }
    if baked.is_outdated(scene, &fit) {
        return Err(other("lights or materials"));
    }
    let light = baked.lightmap(&name, scene.mesh.triangle_count(), &fit)?;
    let hash = XxHash3_64::oneshot(&input::read(path)?);
    Ok(KnownLight { light, name: format!("{hash:016x}") })
}

/// What light cannot be solved for, with the way out.
fn unsolved(path: &Path, error: IndirectError) -> CliError {
    match error {
        IndirectError::Scene(error) => {
            let refused = InputError::of_file(input::name_of(path), error.to_string());
            CliError::Input(match error {
                SceneError::Albedo { material, .. } => refused.with_help(format!(
                    "light would grow at every reflection: set [material.{material}] diffuse below 1"
                )),
                _ => refused,
            })
        }
        IndirectError::Render(error) => failed(error),
        error => CliError::Failed(format!("--indirect solve: {error}")),
    }
}
