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

/// What all tiles of a picture share. Renderers and shaders are those of the sights, in their order.
pub(crate) struct Painter<'a> {
    pub(crate) sights: &'a [Sight],
    pub(crate) renderers: &'a [Renderer<'a>],
    pub(crate) shaders: &'a [Shader<'a>],
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
    counts: TileCounts,
}

impl PainterMemory {
    pub(crate) fn take_counts(&mut self) -> (TileCounts, ShadowCounts, AreaCounts) {
        let (shadow, area) = self.scratch.take_counts();
        (std::mem::take(&mut self.counts), shadow, area)
    }
}

impl Painter<'_> {
    /// The pixels of a tile that the first renderer made. Depth and layers without colours are as the first sight has them.
    pub(crate) fn paint<'m>(&self, tile: &Tile, memory: &'m mut PainterMemory) -> &'m Pixels {
        let PainterMemory { scratch, pixels, other_tile, other_pixels, counts } = memory;
        self.shaders[0].shade(tile, self.background, self.layers, scratch, pixels, self.monitor);
        *counts += tile.counts();
        if self.sights.len() == 1 || !shows_tint(self.shaders[0].scene, tile) {
            return pixels;
        }
        let first = share(self.sights[0].channels) as f32;
        pixels.color.iter_mut().for_each(|color| color[3] *= first);
        for (k, sight) in self.sights.iter().enumerate().skip(1) {
            self.renderers[k].render(tile.rect(), other_tile);
            self.monitor.lap("visibility");
            *counts += other_tile.counts();
            let shader = &self.shaders[k];
            shader.shade(other_tile, self.background, self.layers, scratch, other_pixels, self.monitor);
            pixels.take_channels(other_pixels, sight, self.layers);
        }
        pixels
    }
}

impl Pixels {
    /// Takes over the channels of a sight, and its share of coverage.
    fn take_channels(&mut self, other: &Self, sight: &Sight, layers: &[LayerKind]) {
        let share = share(sight.channels) as f32;
        let counts = |c: usize| sight.channels[c] > 0.0;
        for (own, found) in self.color.iter_mut().zip(&other.color) {
            (0..3).filter(|&c| counts(c)).for_each(|c| own[c] = found[c]);
            own[3] += share * found[3];
        }
        let mut planes = self.planes.iter_mut().zip(&other.planes);
        for layer in layers {
            for (c, (own, found)) in planes.by_ref().take(layer.plane_count()).enumerate() {
                if layer.is_color() && counts(c) {
                    own.copy_from_slice(found);
                }
            }
        }
    }
}
