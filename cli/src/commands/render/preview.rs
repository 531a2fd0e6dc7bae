//! `render --preview`: the picture in the terminal, two pixels a character, in 24-bit colour.

use super::draw::failed;
use crate::commands::Report;
use crate::commands::report::write_text;
use crate::error::CliError;
use crate::image_io::Frame;
use crate::options::RenderOptions;
use crate::scene::LoadedScene;
use pointillist_render::{DrawOptions, Prepared, srgb_from_linear};
use std::path::Path;

/// Columns and rows of a terminal that does not say, and of what is no terminal.
const USUAL_SIZE: [u32; 2] = [80, 24];
/// Rows that stay free for the prompt.
const PROMPT_ROWS: u32 = 2;

/// Options that are about a file, and would do nothing here.
pub(super) fn check(options: &RenderOptions) -> Result<(), CliError> {
    let given = [
        ("--layers", !options.layers.is_empty()),
        ("--tile", options.camera.tile.is_some()),
        ("--crop", options.camera.crop.is_some()),
        ("--frames", options.frames.is_some()),
        ("--turntable", options.turntable.is_some()),
        ("--time-budget", options.time_budget.is_some()),
        ("--error", options.error.is_some()),
    ];
    match given.iter().find(|(_, given)| *given && options.output.is_none()) {
        Some((name, _)) => Err(CliError::Usage(format!(
            "{name} is about a picture file; --preview alone writes none: add -o picture.png"
        ))),
        None => Ok(()),
    }
}

/// Draws the scene's picture as large as the terminal, and prints it.
pub(super) fn show(
    loaded: &LoadedScene,
    options: &RenderOptions,
    report: &Report<'_>,
) -> Result<(), CliError> {
    let scene = &loaded.scene;
    let terminal = terminal_size::terminal_size().map(|(columns, rows)| [columns.0.into(), rows.0.into()]);
    let size = fitting(terminal.unwrap_or(USUAL_SIZE), [scene.image.width, scene.image.height]);
    let prepared = Prepared::new(scene, &report.stats).map_err(failed)?;
    let view = scene.camera.view(size).map_err(|error| failed(error.into()))?;
    let frame = report
        .stats
        .stage("preview", || prepared.draw_view(view, &DrawOptions::DEFAULT, &report.stats))
        .map_err(failed)?;
    let text = half_blocks(&frame, options.picture.display.exposure.exp2());
    write_text(Path::new("-"), |output| output.write_all(text.as_bytes()))
}

/// The largest picture of an aspect that fits into a terminal with two pixels, one above the other, in each character.
fn fitting([columns, rows]: [u32; 2], [width, height]: [u32; 2]) -> [u32; 2] {
    let (most_x, most_y) = (columns.max(1), 2 * rows.saturating_sub(PROMPT_ROWS).max(1));
    let aspect = f64::from(width) / f64::from(height);
    let x = f64::from(most_x).min(f64::from(most_y) * aspect);
    let pixels = |n: f64, most: u32| (n.round() as u32).clamp(1, most);
    [pixels(x, most_x), pixels(x / aspect, most_y)]
}

/// The upper half of a character has one colour, what is behind it another. A picture with an odd number of rows has nothing behind
/// the last.
fn half_blocks(frame: &Frame, gain: f32) -> String {
    let (width, height) = (frame.window.width() as usize, frame.window.height() as usize);
    let level = |x: usize, y: usize| {
        let [r, g, b, _] = frame.color[y * width + x];
        [r, g, b].map(|c| (srgb_from_linear((c * gain).clamp(0.0, 1.0)) * 255.0 + 0.5) as u8)
    };
    let mut text = String::with_capacity(width * height * 20);
    for y in (0..height).step_by(2) {
        for x in 0..width {
            let [r, g, b] = level(x, y);
            text += &format!("\x1b[38;2;{r};{g};{b}m");
            if y + 1 < height {
                let [r, g, b] = level(x, y + 1);
                text += &format!("\x1b[48;2;{r};{g};{b}m");
            }
            text.push('▀');
        }
        text += "\x1b[0m\n";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preview_fits_and_keeps_its_aspect() {
        assert_eq!(fitting([80, 24], [1600, 1600]), [44, 44]);
        assert_eq!(fitting([80, 24], [1600, 400]), [80, 20]);
        assert_eq!(fitting([1, 1], [1, 1000]), [1, 2]);
        assert_eq!(fitting([200, 60], [960, 540]), [200, 113]);
    }
}
