//! Pictures put side by side.

use std::path::Path;

use glam::DVec3;
use pointillist_cli::image_io::encode_rgb_png;
use pointillist_render::srgb_from_linear;

use crate::common::picture::Picture;

/// Pictures of one size in rows, with a gap of a few pixels.
pub(crate) fn sheet(pictures: &[Picture], columns: usize) -> Picture {
    const GAP: usize = 4;
    let (width, height) = (pictures[0].width, pictures[0].pixels.len() / pictures[0].width);
    let rows = pictures.len().div_ceil(columns);
    let full = [columns * (width + GAP) - GAP, rows * (height + GAP) - GAP];
    let mut sheet = Picture { width: full[0], pixels: vec![DVec3::ONE; full[0] * full[1]] };
    for (i, picture) in pictures.iter().enumerate() {
        let (x0, y0) = (i % columns * (width + GAP), i / columns * (height + GAP));
        for (y, row) in picture.pixels.chunks_exact(width).enumerate() {
            let start = (y0 + y) * full[0] + x0;
            sheet.pixels[start..start + width].copy_from_slice(row);
        }
    }
    sheet
}

/// A picture of values by the direction of each pixel of a sphere that is looked at along −z; black beside it.
pub(crate) fn sphere(size: usize, color: impl Fn(DVec3) -> DVec3 + Sync) -> Picture {
    use rayon::prelude::*;
    let pixel = |i: usize| {
        let unit = |v: usize| (2 * v + 1) as f64 / size as f64 - 1.0;
        let (x, y) = (unit(i % size), -unit(i / size));
        let z2 = 1.0 - x * x - y * y;
        if z2 > 0.0 { color(DVec3::new(x, y, z2.sqrt())) } else { DVec3::ZERO }
    };
    Picture { width: size, pixels: (0..size * size).into_par_iter().map(pixel).collect() }
}

/// Writes a PNG; colours are multiplied by `gain` first.
pub(crate) fn save(picture: &Picture, gain: f64, path: &Path) -> std::io::Result<()> {
    let byte = |v: f64| (srgb_from_linear((v * gain).clamp(0.0, 1.0) as f32) * 255.0).round() as u8;
    let bytes: Vec<u8> = picture.pixels.iter().flat_map(|p| p.to_array()).map(byte).collect();
    let height = picture.pixels.len() / picture.width;
    let file = std::io::BufWriter::new(std::fs::File::create(path)?);
    encode_rgb_png(file, &bytes, picture.width as u32, height as u32)
}
