//! Where the large data are, if they are.

use std::path::{Path, PathBuf};

use pointillist_cli::scene::{Overrides, load};
use pointillist_render::Scene;

use crate::common::picture::Picture;

/// The folder named by `POINTILLIST_DATA`, or the one beside the repository.
pub(crate) fn folder() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("POINTILLIST_DATA").map_or_else(beside, PathBuf::from);
    folder.is_dir().then_some(folder)
}

/// What reports say where a part needs the data and they are not there.
pub(crate) const SKIPPED: &str = "The reference scenes were skipped: `POINTILLIST_DATA` names no folder with them, and there is none beside the \
     repository.";

/// A scene that comes with its picture.
pub(crate) struct Reference {
    pub(crate) name: &'static str,
    pub(crate) scene: Scene,
    pub(crate) picture: Picture,
}

/// The reference scenes that can be read; exact pictures are preferred. Says which cannot.
pub(crate) fn references() -> Vec<Reference> {
    let Some(folder) = folder() else { return vec![] };
    let read = |name: &'static str| {
        let path = |ending: &str| folder.join("reference").join(format!("{name}{ending}"));
        let scene = load(&path(".toml"), &Overrides::default()).map_err(|e| e.to_string())?.scene;
        let exact = path(".exact.npz");
        let picture = Picture::read(&if exact.exists() { exact } else { path(".ref.exr") })?;
        Ok::<_, String>(Reference { name, scene, picture })
    };
    let mut list = vec![];
    for name in ["spheres", "terrain", "layers", "quads"] {
        match read(name) {
            Ok(reference) => list.push(reference),
            Err(error) => eprintln!("reference scene {name} left out: {error}"),
        }
    }
    list
}
