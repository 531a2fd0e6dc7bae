//! Colour, depth and normals of a picture, as renderers give them and EXR files keep them.

use std::path::Path;

use pointillist_cli::image_io::ExrFile;
use pointillist_surfel::Frame;

/// A picture with its layers, row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PictureLayers {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Linear, premultiplied, with opacity.
    pub(crate) colour: Vec<[f32; 4]>,
    /// Along the view axis; +∞ where nothing is.
    pub(crate) depth: Vec<f32>,
    /// Unit, or 0 where nothing is.
    pub(crate) normal: Vec<[f32; 3]>,
}

impl PictureLayers {
    /// Whether a pixel shows a surface.
    pub(crate) fn is_valid(&self, i: usize) -> bool {
        0.0 < self.depth[i] && self.depth[i] < 1e30
    }

    /// A frame with normals.
    pub(crate) fn of(frame: &Frame) -> Self {
        Self {
            width: frame.width(),
            height: frame.height(),
            colour: frame.color().to_vec(),
            depth: frame.depth().to_vec(),
            normal: frame.normal().to_vec(),
        }
    }

    /// Reads the channels R G B A Z N.X N.Y N.Z.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let fault = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let file = ExrFile::read(&std::fs::read(path).map_err(|e| fault(&e))?).map_err(|e| fault(&e))?;
        let plane = |name: &str| file.plane(name).ok_or_else(|| fault(&format!("no channel {name}")));
        let colour = [plane("R")?, plane("G")?, plane("B")?, plane("A")?];
        let normal = [plane("N.X")?, plane("N.Y")?, plane("N.Z")?];
        let depth = plane("Z")?.into_iter().map(|z| if z > 0.0 && z < 1e30 { z } else { f32::INFINITY });
        let depth: Vec<f32> = depth.collect();
        Ok(Self {
            width: file.window.width() as usize,
            height: file.window.height() as usize,
            colour: (0..depth.len()).map(|i| std::array::from_fn(|c| colour[c][i])).collect(),
            normal: (0..depth.len()).map(|i| std::array::from_fn(|c| normal[c][i])).collect(),
            depth,
        })
    }
}
