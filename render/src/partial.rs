//! A picture in the making: finished tiles are put together in it, and it knows which are there.

use crate::draw::DrawOptions;
use crate::frame::{Frame, Layer, LayerKind};
use crate::scene::Scene;
use pointillist_view::{PixelRect, View};

/// Pixels on a side of the largest tiles: the state of their thousand cells stays in the second-level cache, and what lies between them and
/// the lights is found once for all of them.
const LARGEST_SIDE: u32 = 32;

/// Pixels on a side of tiles of pictures for which these would be too large.
const COMMON_SIDE: u32 = 16;

/// Pictures with fewer pixels are common: threads would share too few of the largest tiles.
const SMALL_PICTURE: u64 = 64 * (LARGEST_SIDE as u64).pow(2);

/// With more triangles a pixel than this, tiles are common.
const DENSE: u64 = 8;

/// So many triangles a pixel halve the side of common tiles, and so many more halve it again. A tile holds all that is visible in it at once: with
/// triangles so small, smaller tiles draw at the same pace in less memory, and leave fewer threads idle at the end.
const CROWDED: [u64; 2] = [32, 256];

/// Pixels on a side of a tile of a picture with so many pixels.
fn tile_side(scene: &Scene, pixels: u64) -> u32 {
    let triangles = scene.mesh.triangle_count() as u64;
    let is_above = |limit: u64| triangles / limit > pixels;
    // Behind masks much more is visible in a tile than its pixels and triangles tell.
    let has_masks = scene.materials.iter().any(|m| m.opacity_map.is_some());
    if pixels >= SMALL_PICTURE && !has_masks && !is_above(DENSE) {
        return LARGEST_SIDE;
    }
    COMMON_SIDE >> CROWDED.iter().filter(|&&limit| is_above(limit)).count()
}

/// What a tile's pixels hold: sums over their micropoints.
#[derive(Debug, Default)]
pub(crate) struct Pixels {
    pub(crate) color: Vec<[f32; 4]>,
    pub(crate) depth: Vec<f32>,
    /// The planes of all layers, one after the other.
    pub(crate) planes: Vec<Vec<f32>>,
}

/// A picture of which some tiles are drawn. [`Prepared::begin_view`](crate::Prepared::begin_view) makes one without any,
/// [`Prepared::continue_view`](crate::Prepared::continue_view) draws what is missing, and [`PartialFrame::restore`] takes over what an earlier
/// run had drawn.
#[derive(Clone, Debug)]
pub struct PartialFrame {
    frame: Frame,
    view: View,
    layers: Vec<LayerKind>,
    tile_side: u32,
    /// For each tile of the window, row by row.
    drawn: Vec<bool>,
}

impl PartialFrame {
    pub(crate) fn new(scene: &Scene, view: View, options: &DrawOptions) -> Self {
        let window = options.window.unwrap_or(view.picture()).intersection(&view.picture());
        let pixels = window.pixels() as usize;
        let lights: Vec<&str> = scene.lights.iter().map(|l| l.name.as_str()).collect();
        let layer = |kind: &LayerKind| {
            let channels = kind.channels(&lights);
            let planes = vec![vec![0.0; pixels]; channels.len()];
            let names = match kind {
                LayerKind::Cryptomatte(matte) => matte.names(scene),
                _ => vec![],
            };
            Layer { channels, planes, names }
        };
        let frame = Frame {
            size: [view.width(), view.height()],
            window,
            color: vec![[0.0; 4]; pixels],
            depth: vec![f32::INFINITY; pixels],
            layers: options.layers.iter().map(layer).collect(),
        };
        let tile_side = tile_side(scene, view.picture().pixels());
        let drawn = vec![false; window.tiles(tile_side).count()];
        Self { frame, view, layers: options.layers.clone(), tile_side, drawn }
    }

    /// The pixels. Those of tiles that are not drawn yet hold colour 0, depth +∞ and layers 0.
    #[must_use]
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The pixels, taken out.
    #[must_use]
    pub fn into_frame(self) -> Frame {
        self.frame
    }

    /// Tiles that are drawn.
    #[must_use]
    pub fn tiles_drawn(&self) -> usize {
        self.drawn.iter().filter(|&&drawn| drawn).count()
    }

    /// Tiles of the whole window.
    #[must_use]
    pub fn tile_count(&self) -> usize {
        self.drawn.len()
    }

    /// Whether no tile is missing.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.drawn.iter().all(|&drawn| drawn)
    }

    /// For each pixel of the window, row by row, whether it is drawn.
    #[must_use]
    pub fn pixels_drawn(&self) -> Vec<bool> {
        let mut pixels = vec![false; self.frame.window.pixels() as usize];
        for (tile, _) in self.tiles().zip(&self.drawn).filter(|(_, drawn)| **drawn) {
            self.rows(tile).for_each(|row| pixels[row].fill(true));
        }
        pixels
    }

    /// Takes over the pixels of a frame of the same view and scene that `drawn` marks, as [`PartialFrame::pixels_drawn`] does. Tiles of which
    /// a pixel is missing are drawn anew. `false`, and nothing is taken, if the frame has another size, window or layers.
    #[must_use]
    pub fn restore(&mut self, frame: &Frame, drawn: &[bool]) -> bool {
        let own = &self.frame;
        let count = own.color.len();
        let alike = |(a, b): (&Layer, &Layer)| {
            a.channels == b.channels
                && a.planes.len() == b.planes.len()
                && b.planes.iter().all(|plane| plane.len() == count)
        };
        let fits = (own.size, own.window) == (frame.size, frame.window)
            && [frame.color.len(), frame.depth.len(), drawn.len()] == [count; 3]
            && own.layers.len() == frame.layers.len()
            && own.layers.iter().zip(&frame.layers).all(alike);
        if !fits {
            return false;
        }
        for (index, tile) in self.tiles().enumerate() {
            if self.rows(tile).all(|row| drawn[row].iter().all(|&drawn| drawn)) {
                for row in self.rows(tile) {
                    copy_pixels(&mut self.frame, frame, row);
                }
                self.drawn[index] = true;
            }
        }
        true
    }

    pub(crate) fn view(&self) -> &View {
        &self.view
    }

    pub(crate) fn layers(&self) -> &[LayerKind] {
        &self.layers
    }

    /// The tiles that are not drawn yet.
    pub(crate) fn missing(&self) -> Vec<PixelRect> {
        self.tiles().zip(&self.drawn).filter(|(_, drawn)| !**drawn).map(|(tile, _)| tile).collect()
    }

    /// Copies a tile into its place.
    pub(crate) fn put(&mut self, rect: PixelRect, pixels: &Pixels) {
        let width = rect.width() as usize;
        for (row, to) in self.rows(rect).enumerate() {
            let from = row * width..(row + 1) * width;
            self.frame.color[to.clone()].copy_from_slice(&pixels.color[from.clone()]);
            self.frame.depth[to.clone()].copy_from_slice(&pixels.depth[from.clone()]);
            let planes = self.frame.layers.iter_mut().flat_map(|l| &mut l.planes);
            for (plane, tile) in planes.zip(&pixels.planes) {
                plane[to.clone()].copy_from_slice(&tile[from.clone()]);
            }
        }
        let index = self.index_of(rect);
        self.drawn[index] = true;
    }

    fn tiles(&self) -> impl Iterator<Item = PixelRect> + use<> {
        self.frame.window.tiles(self.tile_side)
    }

    /// The number of a tile in [`PartialFrame::tiles`]: tiles lie in the raster of the picture, whatever the window.
    fn index_of(&self, tile: PixelRect) -> usize {
        let window = self.frame.window;
        let cell = |at: u32, from: u32| (at / self.tile_side - from / self.tile_side) as usize;
        let columns = cell(window.x1 - 1, window.x0) + 1;
        cell(tile.y0, window.y0) * columns + cell(tile.x0, window.x0)
    }

    /// The pixels of each row of a tile, as indices into the window's.
    fn rows(&self, tile: PixelRect) -> impl Iterator<Item = std::ops::Range<usize>> + use<> {
        let PixelRect { x0, y0, .. } = self.frame.window;
        let stride = self.frame.window.width() as usize;
        let (first, width) = ((tile.x0 - x0) as usize, tile.width() as usize);
        (tile.y0 - y0..tile.y1 - y0).map(move |row| {
            let start = row as usize * stride + first;
            start..start + width
        })
    }
}

/// Copies some pixels, with all layers, from one frame to another of the same shape.
fn copy_pixels(to: &mut Frame, from: &Frame, at: std::ops::Range<usize>) {
    to.color[at.clone()].copy_from_slice(&from.color[at.clone()]);
    to.depth[at.clone()].copy_from_slice(&from.depth[at.clone()]);
    for (to, from) in to.layers.iter_mut().zip(&from.layers) {
        for (to, from) in to.planes.iter_mut().zip(&from.planes) {
            to[at.clone()].copy_from_slice(&from[at.clone()]);
        }
    }
}
