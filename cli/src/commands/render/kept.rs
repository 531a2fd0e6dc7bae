//! What an interrupted run keeps for the next one: `OUTPUT.part.exr`, full floats of all finished tiles.

use super::output::write_exr;
use crate::commands::Report;
use crate::image_io::{Channel, ExrFile, Frame, Layer, Precision, Stamp};
use crate::memory;
use exr::prelude::FlatSamples;
use pointillist_render::PartialFrame;
use std::io;
use std::path::{Path, PathBuf};

/// The channel that is 1 where a pixel is drawn.
const DRAWN: &str = "drawn";

/// The file beside an output, and what has to be in its header.
pub(super) struct Kept {
    path: PathBuf,
    stamp: Stamp,
    /// Whether the file that is there is of this picture: any other is not ours to remove.
    is_own: bool,
}

impl Kept {
    /// The file that belongs to a picture.
    pub(super) fn of(output: &Path, stamp: &Stamp) -> Self {
        let mut name = output.as_os_str().to_owned();
        name.push(".part.exr");
        Self { path: PathBuf::from(name), stamp: Stamp { unfinished: true, ..stamp.clone() }, is_own: false }
    }

    /// Takes over the tiles that are there, if the file is of the same picture. Whatever else is there is left alone, and told.
    pub(super) fn restore(&mut self, picture: &mut PartialFrame, report: &Report<'_>) {
        let name = self.path.display();
        let refuse = |why: &str| {
            report.warn(&format!(
                "{name} {why}: nothing of it is used, and the picture is drawn from its beginning"
            ));
        };
        let bytes = match memory::read(&self.path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return,
            Err(error) => return refuse(&format!("cannot be read ({error})")),
        };
        let file = match ExrFile::read(&bytes) {
            Ok(file) => file,
            Err(error) => return refuse(&format!("is damaged ({error})")),
        };
        if file.stamp.as_ref() != Some(&self.stamp) {
            return refuse("is of another scene, or of other options or another version");
        }
        let restored =
            frame_of(&file, picture.frame()).is_some_and(|(frame, drawn)| picture.restore(&frame, &drawn));
        if !restored {
            return refuse("has other channels than this picture");
        }
        self.is_own = true;
        let (done, all) = (picture.tiles_drawn(), picture.tile_count());
        report.note(&format!(
            "{name}: {done} of {all} tiles are there already, from a run that was interrupted"
        ));
    }

    /// Keeps what is finished, and says what that is, or why it is nothing.
    pub(super) fn keep(&self, picture: &PartialFrame) -> String {
        let (done, all) = (picture.tiles_drawn(), picture.tile_count());
        if done == 0 {
            return "no tile was finished, so nothing is kept".to_owned();
        }
        let path = self.path.display();
        match write_exr(&self.path, self.file(picture)) {
            Ok(()) => format!("{done} of {all} tiles are kept in {path}"),
            Err(error) => format!("{done} of {all} tiles are lost: {error}"),
        }
    }

    /// Removes the file, once the picture is there and written.
    pub(super) fn remove(&self, report: &Report<'_>) {
        if !self.is_own {
            return;
        }
        if let Err(error) = std::fs::remove_file(&self.path) {
            report.warn(&format!("{} is of no use any more, but stays: {error}", self.path.display()));
        }
    }

    /// Removes the file if it is of this picture, which is there already.
    pub(super) fn remove_unused(&mut self, report: &Report<'_>) {
        let Ok(bytes) = memory::read(&self.path) else { return };
        self.is_own = ExrFile::read(&bytes).is_ok_and(|file| file.stamp.as_ref() == Some(&self.stamp));
        self.remove(report);
    }

    fn file(&self, picture: &PartialFrame) -> ExrFile {
        let mut file = ExrFile::from_frame(picture.frame(), self.stamp.clone(), Precision::Float);
        let drawn = picture.pixels_drawn().into_iter().map(|drawn| f32::from(u8::from(drawn))).collect();
        file.channels.push(Channel { name: DRAWN.to_owned(), samples: FlatSamples::F32(drawn) });
        file
    }
}

/// The pixels of a file as a frame with the layers of `like`, and which of them are drawn; `None` if a channel is missing.
fn frame_of(file: &ExrFile, like: &Frame) -> Option<(Frame, Vec<bool>)> {
    let plane = |name: &str| file.plane(name);
    let [r, g, b, a] = [plane("R")?, plane("G")?, plane("B")?, plane("A")?];
    let color = (0..r.len()).map(|i| [r[i], g[i], b[i], a[i]]).collect();
    let layer = |layer: &Layer| {
        let planes = layer.channels.iter().map(|name| plane(name)).collect::<Option<_>>()?;
        Some(Layer { channels: layer.channels.clone(), planes, names: layer.names.clone() })
    };
    let layers = like.layers.iter().map(layer).collect::<Option<_>>()?;
    let drawn = plane(DRAWN)?.into_iter().map(|drawn| drawn == 1.0).collect();
    Some((Frame { size: file.size, window: file.window, color, depth: plane("Z")?, layers }, drawn))
}
