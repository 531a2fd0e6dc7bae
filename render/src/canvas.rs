//! Where finished tiles are put together.

use crate::frame::{Frame, Layer, LayerKind};
use crate::scene::Scene;
use pointillist_view::PixelRect;

/// What a tile's pixels hold: sums over their micropoints.
#[derive(Debug, Default)]
pub(crate) struct Pixels {
    pub(crate) color: Vec<[f32; 4]>,
    pub(crate) depth: Vec<f32>,
    /// The planes of all layers, one after the other.
    pub(crate) planes: Vec<Vec<f32>>,
}

/// A frame in the making.
pub(crate) struct Canvas {
    frame: Frame,
}

impl Canvas {
    pub(crate) fn new(scene: &Scene, size: [u32; 2], window: PixelRect, layers: &[LayerKind]) -> Self {
        let pixels = window.pixels() as usize;
        let lights: Vec<&str> = scene.lights.iter().map(|l| l.name.as_str()).collect();
        let layer = |kind: &LayerKind| {
            let channels = kind.channels(&lights);
            let planes = vec![vec![0.0; pixels]; channels.len()];
            Layer { channels, planes }
        };
        Self {
            frame: Frame {
                size,
                window,
                color: vec![[0.0; 4]; pixels],
                depth: vec![f32::INFINITY; pixels],
                layers: layers.iter().map(layer).collect(),
            },
        }
    }

    /// Copies a tile into its place.
    pub(crate) fn put(&mut self, rect: PixelRect, pixels: &Pixels) {
        let PixelRect { x0, y0, .. } = self.frame.window;
        let (width, stride) = (rect.width() as usize, self.frame.window.width() as usize);
        for row in 0..rect.height() as usize {
            let from = row * width..(row + 1) * width;
            let start = (rect.y0 - y0) as usize * stride + row * stride + (rect.x0 - x0) as usize;
            let to = start..start + width;
            self.frame.color[to.clone()].copy_from_slice(&pixels.color[from.clone()]);
            self.frame.depth[to.clone()].copy_from_slice(&pixels.depth[from.clone()]);
            let planes = self.frame.layers.iter_mut().flat_map(|l| &mut l.planes);
            for (plane, tile) in planes.zip(&pixels.planes) {
                plane[to.clone()].copy_from_slice(&tile[from.clone()]);
            }
        }
    }

    pub(crate) fn into_frame(self) -> Frame {
        self.frame
    }
}
