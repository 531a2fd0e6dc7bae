//! A frame, from the cloud to the picture.

use crate::camera::Camera;
use crate::cloud::Cloud;
use crate::error::SurfelError;
use crate::frame::{Frame, FrameCounts};
use crate::grid::{HEIGHT, TileRect, WIDTH};
use crate::options::{Options, Procedure};
use crate::paper::{self, PaperPixel, PaperTile};
use crate::scene::Scene;
use crate::select::{self, Selected};
use crate::shade::Shader;
use crate::tile::Tile;
use pointillist_parallel::{self as parallel, Pool};
use pointillist_view::{PixelRect, View};
use std::sync::atomic::{AtomicBool, Ordering};

/// Draws frames. Keeps its working memory, so that later frames allocate next to nothing.
#[derive(Default)]
pub struct Renderer {
    selected: Vec<Selected>,
    stack: Vec<u32>,
    shown: Vec<AtomicBool>,
    tiles: Pool<Tile>,
    paper_tiles: Pool<PaperTile>,
    /// Of the paper's procedure: the picture between its two steps.
    cells: Vec<PaperPixel>,
}

impl Renderer {
    /// Largest side of a picture in pixels: frames are kept whole, and places in them are 16 bits.
    pub const LARGEST_SIDE: u32 = 16384;

    /// A renderer without memory.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Draws `cloud` into `frame`.
    ///
    /// The same for every order of points and for every number of threads, bit for bit.
    ///
    /// # Errors
    /// [`SurfelError::TooLarge`] if a side of the picture is above [`Renderer::LARGEST_SIDE`];
    /// [`SurfelError::BadOption`].
    pub fn draw(
        &mut self,
        cloud: &Cloud,
        view: &View,
        options: &Options,
        frame: &mut Frame,
    ) -> Result<(), SurfelError> {
        let (width, height) = (view.width(), view.height());
        if width.max(height) > Self::LARGEST_SIDE {
            return Err(SurfelError::TooLarge { width, height });
        }
        options.check()?;
        let camera = Camera::new(view, &cloud.lattice, &cloud.nodes[0], &options.focus, cloud.is_estimated);
        frame.reshape(width as usize, height as usize, options.surface_layers);
        let wanted = options.window.unwrap_or(view.picture());
        // What lies beside the window is not looked at, so it is not known to be hidden. The paper's procedure has no windows.
        let tiles = match options.procedure {
            Procedure::Blended => tiles_of(&wanted),
            Procedure::Paper => tiles_of(&view.picture()),
        };
        let tiles = tiles.in_ring([width as usize, height as usize]);
        let mut counts = FrameCounts::default();
        let lists = (&mut self.selected, &mut self.stack);
        select::select(cloud, &camera, options, &tiles, lists, &mut counts);
        let shader = Shader::new(&camera, options, cloud.has_colors());
        let mut shown = std::mem::take(&mut self.shown);
        shown.clear();
        // The paper's procedure hides nothing.
        let is_paper = options.procedure == Procedure::Paper;
        shown.resize_with(self.selected.len(), || AtomicBool::new(is_paper));
        let Options { culling, surface_layers: normals, .. } = *options;
        let scene = Scene { cloud, camera, shader, culling, normals, shown: &shown };
        match options.procedure {
            Procedure::Blended => self.blend(&scene, &wanted, frame),
            Procedure::Paper => self.link_and_filter(&scene, frame),
        }
        counts.nodes_hidden = shown.iter().filter(|shown| !shown.load(Ordering::Relaxed)).count();
        frame.counts = counts;
        self.shown = shown;
        Ok(())
    }

    fn blend(&self, scene: &Scene<'_>, wanted: &PixelRect, frame: &mut Frame) {
        let picture = [frame.width(), frame.height()];
        parallel::for_each_mut_heavy(&mut frame.bands(), |band| {
            let is_wanted = |rect: &TileRect| {
                let meets = |from: usize, size: usize, [low, high]: [u32; 2]| {
                    from < high as usize && from + size > low as usize
                };
                meets(rect.x, rect.width, [wanted.x0, wanted.x1])
                    && meets(rect.y, rect.height, [wanted.y0, wanted.y1])
            };
            let of_band: Vec<Selected> = if is_wanted(&band.whole()) {
                nodes_in(&self.selected, &band.whole().in_ring(picture)).collect()
            } else {
                vec![]
            };
            self.tiles.with(|tile| {
                for number in 0..band.drawn.len() {
                    let rect = band.rect(number);
                    if !is_wanted(&rect) || nodes_in(&of_band, &rect).next().is_none() {
                        band.clear(number);
                    } else {
                        let drawn = rect.in_ring(picture);
                        tile.draw(scene, &drawn, nodes_in(&of_band, &drawn), (band, number));
                    }
                }
            });
        });
    }

    fn link_and_filter(&mut self, scene: &Scene<'_>, frame: &mut Frame) {
        let (width, height) = (frame.width(), frame.height());
        paper::reshape(&mut self.cells, width, height);
        let mut bands = frame.bands();
        let mut rows: Vec<_> = paper::rows(&mut self.cells, width).zip(&bands).collect();
        parallel::for_each_mut_heavy(&mut rows, |(cells, band)| {
            self.paper_tiles.with(|tile| {
                for number in 0..band.drawn.len() {
                    let rect = band.rect(number);
                    let nodes: Vec<Selected> = nodes_in(&self.selected, &rect).collect();
                    tile.project(scene, &rect, &nodes, (&mut **cells, width));
                }
            });
        });
        let cells = &self.cells;
        parallel::for_each_mut_heavy(&mut bands, |band| paper::reconstruct(scene, cells, band));
    }
}

/// The pixels that all tiles that meet a window show, as far as they may lie beyond the picture.
fn tiles_of(window: &PixelRect) -> TileRect {
    let (x, y) = (window.x0 as usize / WIDTH * WIDTH, window.y0 as usize / HEIGHT * HEIGHT);
    let width = (window.x1 as usize).next_multiple_of(WIDTH) - x;
    let height = (window.y1 as usize).next_multiple_of(HEIGHT) - y;
    TileRect { x, y, width, height }
}

/// The nodes with parts in some of the pixels.
fn nodes_in(selected: &[Selected], rect: &TileRect) -> impl Iterator<Item = Selected> + Clone {
    selected.iter().filter(|s| s.meets(rect)).copied()
}
