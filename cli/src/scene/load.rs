//! From a path and options to a [`LoadedScene`].

use super::text::{Document, Format, Value};
use super::{Description, LoadedScene, resolve};
use crate::cloud_io::DRAW_CLOUD;
use crate::input;
use crate::input_error::InputError;
use crate::json_kind::JsonKind;
use std::path::{Path, PathBuf};

/// Changes to a scene that come from the command line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// The option's name for messages, and `key=value` as for `--set`; later ones win.
    pub assignments: Vec<(String, String)>,
}

/// What kind of file a scene comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Text(Format),
    Mesh,
}

/// Reads a scene file or a mesh and everything it refers to; `-` is standard input.
///
/// A mesh alone is framed, and gets a light and some ambient light unless the overrides bring lights. A glTF alone is seen by
/// its first camera and in its own lights, if it has any.
///
/// # Errors
///
/// Whatever is wrong with the file, or with one that it names.
pub fn load(path: &Path, overrides: &Overrides) -> Result<LoadedScene, InputError> {
    let (mut document, kind, folder) = read_document(path)?;
    apply(&mut document, overrides)?;
    let description = Description::new(document)?;
    resolve::resolve(&description, &folder, kind == Kind::Mesh, None)
}

/// Whether [`load`] takes a file for a model alone, and not for a scene file.
///
/// # Errors
///
/// It is neither.
pub fn is_model(path: &Path) -> Result<bool, InputError> {
    Ok(kind_of(path)? == Kind::Mesh)
}

/// As [`load`], without the scene's baked radiosity: for baking it, when it is old or not yet there.
///
/// # Errors
///
/// As [`load`].
pub fn load_to_bake(path: &Path, overrides: &Overrides) -> Result<LoadedScene, InputError> {
    let (mut document, kind, folder) = read_document(path)?;
    apply(&mut document, overrides)?;
    document.remove("ambient", "radiosity");
    let description = Description::new(document)?;
    resolve::resolve(&description, &folder, kind == Kind::Mesh, None)
}

/// Changes a document by the overrides. A field of view takes the place of a height, and the other way round,
/// and ambient light of one kind that of any other.
pub(super) fn apply(document: &mut Document, overrides: &Overrides) -> Result<(), InputError> {
    for (option, assignment) in &overrides.assignments {
        document.set(option, assignment)?;
        match key_of(assignment) {
            "camera.fov" => document.remove("camera", "height"),
            "camera.height" => document.remove("camera", "fov"),
            key @ ("camera.eye" | "camera.target") => stand_still(document, &key["camera.".len()..]),
            key => {
                if let Some(ambient) = key.strip_prefix("ambient.") {
                    keep_ambient(document, ambient, overrides);
                }
            }
        }
    }
    Ok(())
}

/// What an assignment assigns to.
fn key_of(assignment: &str) -> &str {
    assignment.split('=').next().unwrap_or_default().trim()
}

/// An eye or a target of the command line takes the place of one on a path.
fn stand_still(document: &mut Document, key: &str) {
    const PATH: &str = "camera.path";
    let has_moved = document.has(PATH, key);
    document.remove(PATH, key);
    if has_moved && !document.has(PATH, "eye") && !document.has(PATH, "target") {
        document.remove("camera", "path");
    }
}

/// Each of these keys holds all ambient light: what the command line gives takes the place of what the scene has. Probes stay beside radiosity if
/// the command line gives both.
fn keep_ambient(document: &mut Document, key: &str, overrides: &Overrides) {
    let is_given = |name: &str| {
        let mut keys = overrides.assignments.iter().map(|(_, assignment)| key_of(assignment));
        keys.any(|key| key.strip_prefix("ambient.") == Some(name))
    };
    let belong_together = |a: &str, b: &str| match [a, b] {
        ["sky", "ground"] | ["ground", "sky"] => true,
        ["probes", "radiosity"] | ["radiosity", "probes"] => is_given(a) && is_given(b),
        _ => a == b,
    };
    for other in ["color", "sky", "ground", "probes", "radiosity", "environment"] {
        if !belong_together(key, other) {
            document.remove("ambient", other);
        }
    }
}

fn read_document(path: &Path) -> Result<(Document, Kind, PathBuf), InputError> {
    let name = input::name_of(path);
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    match kind_of(path)? {
        Kind::Text(format) => {
            let text = String::from_utf8(input::read(path)?).map_err(|error| {
                let at = error.utf8_error().valid_up_to();
                let line = error.as_bytes()[..at].iter().filter(|&&b| b == b'\n').count() + 1;
                InputError::in_line(&name, error.as_bytes(), line, "not UTF-8 text")
            })?;
            let document = Document::parse(&name, &text, format)?;
            refuse_results(&document, format)?;
            Ok((document, Kind::Text(format), folder))
        }
        Kind::Mesh => {
            // Opened here, so that the message about a missing file names the file.
            if !input::is_standard(path) {
                std::fs::File::open(path).map_err(|error| input::cannot_read(&name, &error))?;
            }
            let file = path.file_name().unwrap_or_default().to_string_lossy();
            // A JSON string is a TOML string, too, whatever characters the name holds.
            let text = format!("[[object]]\nmesh = {}\n", serde_json::Value::from(file.as_ref()));
            Ok((Document::parse(&name, &text, Format::Toml)?, Kind::Mesh, folder))
        }
    }
}

/// A JSON file may be what another command wrote; as a scene it would have nothing but unknown keys.
fn refuse_results(document: &Document, format: Format) -> Result<(), InputError> {
    let Value::Table(entries) = &document.root().value else { return Ok(()) };
    match JsonKind::of_keys(entries.iter().map(|(key, _)| key.name.as_str())) {
        kind if format == Format::Json && kind != JsonKind::Scene => {
            Err(kind.misplaced(document.name(), JsonKind::Scene))
        }
        _ => Ok(()),
    }
}

fn kind_of(path: &Path) -> Result<Kind, InputError> {
    match input::kind_of(path)?.as_str() {
        "toml" => Ok(Kind::Text(Format::Toml)),
        "json" => Ok(Kind::Text(Format::Json)),
        "obj" | "ply" | "ply.gz" | "glb" | "gltf" => Ok(Kind::Mesh),
        kind => {
            let name = input::name_of(path);
            let (message, help) = no_scene(kind);
            Err(InputError::of_file(name, message).with_help(help))
        }
    }
}

/// What a file with this ending is in the place of a scene, and what it is for.
fn no_scene(ending: &str) -> (&'static str, &'static str) {
    match ending {
        "gz" | "xyz" | "txt" | "asc" | "pts" | "csv" | "las" | "laz" | "e57" | "conf" => {
            ("this is a cloud of points, not a scene", DRAW_CLOUD)
        }
        "probes" => (
            "these are light probes, not a scene",
            "a scene names them by [ambient] probes = \"FILE\"; `pointillist probe` bakes and queries them",
        ),
        "exr" | "png" | "jpg" | "jpeg" | "hdr" => (
            "this is a picture, not a scene",
            "`pointillist compare` and `pointillist probe project` read pictures; scenes name them as textures",
        ),
        _ => (
            "the name does not say what kind of scene this is",
            "scenes end in .toml, .json, .obj, .ply, .gltf or .glb",
        ),
    }
}
