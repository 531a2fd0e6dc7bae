//! What `[ambient]` says, with the files of baked light that it names.

use super::description::{AmbientDescription, Description, FileReference};
use super::{AmbientLight, Scene, SkyLight};
use crate::baked_file::{Fit, read_baked};
use crate::input;
use crate::input_error::InputError;
use crate::probe_io::read_probes;
use glam::Vec3;
use pointillist_render::shprobe::Field;
use pointillist_render::{Lightmap, Unbaked};
use std::path::{Path, PathBuf};
use twox_hash::XxHash3_64;

/// The ambient light of a scene, of which the rest is there already.
///
/// # Errors
/// A file that is missing or wrong, or was baked for other triangles.
pub(super) fn ambient(
    description: &Description,
    folder: &Path,
    scene: &Scene,
    warnings: &mut Vec<String>,
) -> Result<AmbientLight, InputError> {
    let files = Files { description, folder, scene };
    match &description.ambient {
        AmbientDescription::Nothing => Ok(AmbientLight::Color(Vec3::ZERO)),
        AmbientDescription::Color(color) => Ok(AmbientLight::Color(*color)),
        &AmbientDescription::Sky { sky, ground } => {
            Ok(AmbientLight::Sky(SkyLight { sky, ground, up: Vec3::Y }))
        }
        AmbientDescription::Environment => match description.image.environment {
            Some(_) => Ok(AmbientLight::Environment),
            None => {
                let message = "`ambient.environment` needs `image.environment`, and there is none";
                Err(InputError::of_file(description.document.name(), message)
                    .with_help("name a map: [image] environment = \"sky.hdr\""))
            }
        },
        AmbientDescription::Radiosity(file) => {
            let Light { value: light, unbaked, fingerprint } = files.radiosity(file, warnings)?;
            if unbaked != Unbaked::NONE {
                return Err(files.other_triangles(
                    file,
                    "objects were added since: bake again with `pointillist radiosity`, or have them lit between probes of the scene \
                     that was baked, by `ambient.probes` besides",
                ));
            }
            Ok(AmbientLight::Radiosity { light, fingerprint })
        }
        AmbientDescription::Probes(file) => {
            let Light { value: field, unbaked, fingerprint } = files.probes(file)?;
            Ok(AmbientLight::Probes { field, unbaked, fingerprint })
        }
        AmbientDescription::RadiosityAndProbes { radiosity, probes } => {
            let Light { value: light, unbaked, fingerprint: first } = files.radiosity(radiosity, warnings)?;
            let Light { value: field, fingerprint: second, .. } = files.probes(probes)?;
            let fingerprint = XxHash3_64::oneshot(&[first.to_le_bytes(), second.to_le_bytes()].concat());
            Ok(AmbientLight::RadiosityAndProbes { light, field, unbaked, fingerprint })
        }
    }
}

/// Light from a file, what it was not baked for, and a hash of the file.
struct Light<T> {
    value: Box<T>,
    unbaked: Unbaked,
    fingerprint: u64,
}

/// What files of a scene are read for.
struct Files<'a> {
    description: &'a Description,
    folder: &'a Path,
    scene: &'a Scene,
}

impl Files<'_> {
    fn radiosity(
        &self,
        file: &FileReference,
        warnings: &mut Vec<String>,
    ) -> Result<Light<Lightmap>, InputError> {
        let (path, fingerprint) = self.find(file, "bake it with `pointillist radiosity`")?;
        let name = path.display().to_string();
        let baked = read_baked(&path)?;
        let mesh = &self.scene.mesh;
        let fit = baked.fit(mesh);
        if fit == Fit::Other {
            let help =
                "objects were moved, changed or taken out since: bake again with `pointillist radiosity`";
            return Err(self.other_triangles(file, help));
        }
        if baked.is_outdated(self.scene, &fit) {
            warnings
                .push(format!("`{name}` was baked with other lights or materials; bake again to see them"));
        }
        let value = Box::new(baked.lightmap(&name, mesh.triangle_count(), &fit)?);
        Ok(Light { value, unbaked: fit.unbaked(mesh), fingerprint })
    }

    fn probes(&self, file: &FileReference) -> Result<Light<Field>, InputError> {
        let (path, fingerprint) = self.find(file, "bake it with `pointillist probe bake`")?;
        let probes = read_probes(&path)?;
        let value = Box::new(probes.field(&path.display().to_string())?);
        Ok(Light { value, unbaked: probes.unbaked(&self.scene.mesh), fingerprint })
    }

    /// The file that a key of `[ambient]` names, and a hash of it.
    fn find(&self, file: &FileReference, help: &str) -> Result<(PathBuf, u64), InputError> {
        let path = file.path_from(self.folder);
        if !input::is_standard(&path) && !path.is_file() {
            let message = format!("`{}` is not there", path.display());
            return Err(self.description.document.error(file.span, message).with_help(help));
        }
        let fingerprint = XxHash3_64::oneshot(&input::read(&path)?);
        Ok((path, fingerprint))
    }

    fn other_triangles(&self, file: &FileReference, help: &str) -> InputError {
        let name = file.path_from(self.folder).display().to_string();
        let message = format!("`{name}` was baked for other triangles than this scene's");
        let error = self.description.document.error(file.span, message).with_help(help);
        InputError { mismatched: true, ..error }
    }
}
