//! From a tile's micropoints to its pixels, by one sight or, where something coloured is seen through, by one for each colour.

use crate::background::Background;
use crate::frame::LayerKind;
use crate::lights::share;
use crate::monitor::Monitor;
use crate::partial::Pixels;
use crate::see_through::{Sight, shows_tint};
use crate::shader::Shader;
use crate::shading::ShaderScratch;
use pointillist_micropoint::{Renderer, Tile, TileCounts};
use pointillist_shadow::{AreaCounts, ShadowCounts};

/// What all tiles of a picture share.
pub(crate) struct Painter<'a> {
    pub(crate) sights: &'a [Sight],
    /// For each sight.
    pub(crate) renderers: &'a [Renderer<'a>],
    /// For each sight, its channels.
    pub(crate) by_sight: &'a [Shader<'a>],
    /// For tiles that all sights see alike.
    pub(crate) all_colors: Shader<'a>,
    pub(crate) background: &'a Background<'a>,
    pub(crate) layers: &'a [LayerKind],
    pub(crate) monitor: &'a dyn Monitor,
}

/// Per-thread memory.
#[derive(Default)]
pub(crate) struct PainterMemory {
    scratch: ShaderScratch,
    pixels: Pixels,
    /// As another sight than the first has them.
    other_tile: Tile,
    other_pixels: Pixels,
    /// Coverage by the first sight.
    coverage: Vec<f32>,
    counts: TileCounts,
}

impl PainterMemory {
    pub(crate) fn take_counts(&mut self) -> (TileCounts, ShadowCounts, AreaCounts) {
        let (shadow, area) = self.scratch.take_counts();
        (std::mem::take(&mut self.counts), shadow, area)
    }
}

impl Painter<'_> {
    /// The pixels of a tile that the first renderer made.
    pub(crate) fn paint<'m>(&self, tile: &Tile, memory: &'m mut PainterMemory) -> &'m Pixels {
        if self.sights.len() > 1 && shows_tint(self.all_colors.scene, tile) {
            self.paint_by_color(tile, memory);
        } else {
            let PainterMemory { scratch, pixels, .. } = memory;
            self.all_colors.shade(tile, self.background, self.layers, scratch, pixels, self.monitor);
            memory.counts += tile.counts();
        }
        memory.pixels.mean_of_lit(self.layers);
        &memory.pixels
    }

    /// Depth, and layers without colours, are as the first sight has them.
    fn paint_by_color(&self, tile: &Tile, memory: &mut PainterMemory) {
        let PainterMemory { scratch, pixels, other_tile, other_pixels, coverage, counts } = memory;
        self.by_sight[0].shade(tile, self.background, self.layers, scratch, pixels, self.monitor);
        *counts += tile.counts();
        coverage.clear();
        coverage.extend(pixels.color.iter().map(|color| color[3]));
        for ((sight, renderer), shader) in self.sights.iter().zip(self.renderers).zip(self.by_sight).skip(1) {
            renderer.render(tile.rect(), other_tile);
            self.monitor.lap("visibility");
            shader.shade(other_tile, self.background, self.layers, scratch, other_pixels, self.monitor);
            *counts += other_tile.counts();
            pixels.take_channels(other_pixels, sight, coverage, self.layers);
        }
    }
}

impl Pixels {
    /// Takes over the channels of a sight. Coverage becomes the mean over the colours; where all agree, to the last bit what it was.
    fn take_channels(&mut self, other: &Self, sight: &Sight, coverage: &[f32], layers: &[LayerKind]) {
        let share = share(sight.channels) as f32;
        let counts = |c: usize| sight.channels[c] > 0.0;
        for ((own, found), first) in self.color.iter_mut().zip(&other.color).zip(coverage) {
            (0..3).filter(|&c| counts(c)).for_each(|c| own[c] = found[c]);
            own[3] += share * (found[3] - first);
        }
        let mut planes = self.planes.iter_mut().zip(&other.planes);
        for layer in layers {
            for (c, (own, found)) in planes.by_ref().take(layer.tile_planes()).enumerate() {
                if layer.is_by_color() && counts(c) {
                    own.copy_from_slice(found);
                }
            }
        }
    }

    /// Of shares of light that were found for each colour, leaves the mean.
    fn mean_of_lit(&mut self, layers: &[LayerKind]) {
        let mut first = 0;
        for layer in layers {
            if matches!(layer, LayerKind::Lit(_)) {
                let others: Vec<Vec<f32>> = self.planes.drain(first + 1..first + 3).collect();
                for (i, value) in self.planes[first].iter_mut().enumerate() {
                    *value += ((others[0][i] - *value) + (others[1][i] - *value)) / 3.0;
                }
                first += 1;
            } else {
                first += layer.tile_planes();
            }
        }
    }
}
