//! Tiles from all over a picture that stand for all of it.

use crate::image_io::PixelRect;

/// Pixels on a side: a tile of the renderer.
pub(super) const TILE: u32 = 16;
/// One of so many tiles is taken, if that is no more than [`MOST_TILES`] and no less than [`LEAST_TILES`].
const SHARE: usize = 12;
const LEAST_TILES: usize = 24;
const MOST_TILES: usize = 512;

/// How many of so many tiles are looked at.
pub(super) fn sample_size(all: usize) -> usize {
    (all / SHARE).clamp(LEAST_TILES, MOST_TILES).min(all)
}

/// Tiles from all over the picture: steps of the golden section through their list come close to no place twice.
pub(super) fn spread(all: &[PixelRect]) -> Vec<PixelRect> {
    let count = sample_size(all.len());
    let golden = 0.5 * (5_f64.sqrt() - 1.0);
    let mut chosen = vec![false; all.len()];
    let mut list = Vec::with_capacity(count);
    for k in 0..count {
        let mut at = ((k as f64 + 0.5) * golden).fract() * all.len() as f64;
        while chosen[at as usize % all.len()] {
            at += 1.0;
        }
        chosen[at as usize % all.len()] = true;
        list.push(all[at as usize % all.len()]);
    }
    list
}
