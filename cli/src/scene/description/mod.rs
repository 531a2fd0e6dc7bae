//! A scene file, parsed and checked without opening any file that it names.

mod camera;
mod image;
mod lights;
mod maps;
mod materials;
mod objects;
mod path;
mod render;

pub(crate) use camera::view_fault;
pub use camera::{CameraDescription, DEFAULT_FOV_DEG};
pub use image::{DEFAULT_SIZE, ImageDescription};
pub use lights::LightDescription;
pub use maps::{EnvironmentReference, TextureReference};
pub use materials::{DEFAULT_ALBEDO, MaterialDescription, SurroundingsDescription};
pub use objects::{Copies, ObjectDescription};
pub(super) use objects::{affine_of, placed};
pub use path::{CameraPath, Interpolation, ObjectPath};
pub use render::RenderDescription;

use super::text::{Document, Format, Span, Table};
use crate::input_error::InputError;
use glam::Vec3;
use std::path::{Path, PathBuf};

/// Longest side of a picture: what EXR and PNG viewers take, and far below what their headers could hold.
pub const LARGEST_SIDE: u32 = 1_000_000;

/// A file named by a key, and where it is named.
#[derive(Clone, Debug, PartialEq)]
pub struct FileReference {
    /// As written.
    pub path: String,
    /// The place of the path in the scene file or in an option.
    pub span: Span,
}

impl FileReference {
    /// The file: relative to the scene file in `folder`, or to where the user stands if an option names it.
    pub fn path_from(&self, folder: &Path) -> PathBuf {
        if self.span.is_in_option() { PathBuf::from(&self.path) } else { folder.join(&self.path) }
    }

    /// What the path is relative to, for messages.
    pub fn relative_to(&self) -> &'static str {
        if self.span.is_in_option() {
            "a path in an option is relative to the folder you are in"
        } else {
            "paths are relative to the scene file"
        }
    }
}

/// A scene file, read.
#[derive(Clone, Debug)]
pub struct Description {
    /// The text, for messages about it.
    pub document: Document,
    /// Eye and target may be missing: then the scene is framed.
    pub camera: CameraDescription,
    /// Where the camera moves, if it does.
    pub camera_path: Option<CameraPath>,
    /// The picture's size and what is behind everything.
    pub image: ImageDescription,
    /// How to draw.
    pub render: RenderDescription,
    /// The objects.
    pub objects: Vec<ObjectDescription>,
    /// The lights.
    pub lights: Vec<LightDescription>,
    /// The materials by name.
    pub materials: Vec<(String, MaterialDescription)>,
    /// Light that does not come straight from lights.
    pub ambient: AmbientDescription,
}

/// Reads a scene from its text, with the `--set` assignments on top; `name` is how messages call the text.
///
/// # Errors
///
/// Anything that the schema does not allow, with its place.
pub fn parse_str(name: &str, text: &str, format: Format, set: &[String]) -> Result<Description, InputError> {
    let mut document = Document::parse(name, text, format)?;
    for assignment in set {
        document.set("--set", assignment)?;
    }
    Description::new(document)
}

impl Description {
    /// Reads a tree.
    ///
    /// # Errors
    ///
    /// As [`parse_str`].
    pub fn new(document: Document) -> Result<Self, InputError> {
        let mut root = Table::new(&document, document.root(), "")?;
        let (camera, camera_path) = CameraDescription::read(&mut root)?;
        let image = ImageDescription::read(&mut root)?;
        let render = RenderDescription::read(&mut root)?;
        let objects = objects::read_all(&mut root)?;
        let lights = lights::read_all(&mut root)?;
        let materials = materials::read_all(&mut root)?;
        let ambient = read_ambient(&mut root)?;
        root.finish()?;
        Ok(Self { camera, camera_path, image, render, objects, lights, materials, ambient, document })
    }
}

/// Light that does not come straight from lights.
#[derive(Clone, Debug, PartialEq)]
pub enum AmbientDescription {
    /// Nothing is said of it.
    Nothing,
    /// The same everywhere.
    Color(Vec3),
    /// From above and from below (+Y is up).
    Sky {
        /// Radiance of the upper half space.
        sky: Vec3,
        /// Radiance of the lower half space.
        ground: Vec3,
    },
    /// A file of baked probes.
    Probes(FileReference),
    /// The environment map.
    Environment,
    /// A file of baked radiosity.
    Radiosity(FileReference),
    /// The same, and a file of baked probes for what was added since.
    RadiosityAndProbes {
        /// The file of baked radiosity.
        radiosity: FileReference,
        /// The file of baked probes.
        probes: FileReference,
    },
}

fn read_ambient(root: &mut Table<'_>) -> Result<AmbientDescription, InputError> {
    let Some(mut table) = root.table("ambient")? else { return Ok(AmbientDescription::Nothing) };
    let color = table.color("color")?;
    let (sky, ground) = (table.color("sky")?, table.color("ground")?);
    let probes = file(&mut table, "probes")?;
    let radiosity = file(&mut table, "radiosity")?;
    let environment = table.boolean("environment")?.unwrap_or(false);
    let pair = |first, has_first, second, has_second| {
        if has_first { (first, true) } else { (second, has_second) }
    };
    let given = [
        ("color", color.is_some()),
        pair("sky", sky.is_some(), "ground", ground.is_some()),
        pair("probes", probes.is_some(), "radiosity", radiosity.is_some()),
        ("environment", environment),
    ];
    let mut given = given.iter().filter(|(_, there)| *there);
    if let (Some((first, _)), Some((second, _))) = (given.next(), given.next()) {
        return Err(table
            .error(first, format!("`ambient.{first}` and `ambient.{second}` are both given"))
            .with_help("each of them holds all ambient light: leave one of them out (`radiosity` and `probes` go together)"));
    }
    table.finish()?;
    if environment {
        return Ok(AmbientDescription::Environment);
    }
    if sky.is_some() || ground.is_some() {
        let (sky, ground) = (sky.unwrap_or_default(), ground.unwrap_or_default());
        return Ok(AmbientDescription::Sky { sky, ground });
    }
    Ok(match (probes, radiosity, color) {
        (Some(probes), Some(radiosity), _) => AmbientDescription::RadiosityAndProbes { radiosity, probes },
        (Some(file), None, _) => AmbientDescription::Probes(file),
        (None, Some(file), _) => AmbientDescription::Radiosity(file),
        (None, None, Some(color)) => AmbientDescription::Color(color),
        (None, None, None) => AmbientDescription::Nothing,
    })
}

/// A key whose value names a file.
fn file(table: &mut Table<'_>, key: &'static str) -> Result<Option<FileReference>, InputError> {
    let Some(path) = table.text(key)? else { return Ok(None) };
    if path.is_empty() {
        return Err(table.error(key, format!("`{}` is empty; it must name a file", table.name_of(key))));
    }
    let span = table.span_of(key);
    Ok(Some(FileReference { path: path.to_owned(), span }))
}
