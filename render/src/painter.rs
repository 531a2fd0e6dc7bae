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
    counts: TileCounts,
}

impl PainterMemory {
    pub(crate) fn take_counts(&mut self) -> (TileCounts, ShadowCounts, AreaCounts) {
        let (shadow, area) = self.scratch.take_counts();
        (std::mem::take(&mut self.counts), shadow, area)
    }
}

impl Painter<'_> {
    /// The pixels of a tile that the first renderer made. Depth, and layers with neither colours nor shares of light, are as the first sight
    /// has them.
    pub(crate) fn paint<'m>(&self, tile: &Tile, memory: &'m mut PainterMemory) -> &'m Pixels {
        let PainterMemory { scratch, pixels, other_tile, other_pixels, counts } = memory;
        let is_tinted = self.sights.len() > 1 && shows_tint(self.all_colors.scene, tile);
        let first = if is_tinted { &self.by_sight[0] } else { &self.all_colors };
        first.shade(tile, self.background, self.layers, scratch, pixels, self.monitor);
        *counts += tile.counts();
        if !is_tinted {
            return pixels;
        }
        let of_first = share(self.sights[0].channels) as f32;
        pixels.color.iter_mut().for_each(|color| color[3] *= of_first);
        for ((sight, renderer), shader) in self.sights.iter().zip(self.renderers).zip(self.by_sight).skip(1) {
            renderer.render(tile.rect(), other_tile);
            self.monitor.lap("visibility");
            shader.shade(other_tile, self.background, self.layers, scratch, other_pixels, self.monitor);
            *counts += other_tile.counts();
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
                match layer {
                    // Shaders count the share of their channels only.
                    LayerKind::Lit(_) => own.iter_mut().zip(found).for_each(|(own, found)| *own += found),
                    _ if layer.is_color() && counts(c) => own.copy_from_slice(found),
                    _ => {}
                }
            }
        }
    }
}
