//! Scenes from the text of a scene file.

use pointillist_cli::scene::{Overrides, load};
use pointillist_render::Scene;

/// Reads it as the program reads a file; paths in it are absolute.
pub(crate) fn read_text(text: &str) -> Result<Scene, Box<dyn std::error::Error + Send + Sync>> {
    let path = std::env::temp_dir().join(format!("studies-{}.toml", std::process::id()));
    std::fs::write(&path, text)?;
    let scene = load(&path, &Overrides::default());
    std::fs::remove_file(&path)?;
    Ok(scene?.scene)
}
