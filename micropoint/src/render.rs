//! A view's tiles, each turned into its visible micropoints.

use crate::dicer::{DiceJob, Dicer, TileCounts};
use crate::error::MicropointError;
use crate::face::{DepthRange, GridRect, TexturedOpacity};
use crate::geometry::{Geometry, HiddenSides};
use crate::lens::Lens;
use crate::resolve::{Occlusion, Visible, resolve_by_layers, resolve_exactly};
use crate::tile::Tile;
use glam::DVec2;
use pointillist_dice::CellWindow;
use pointillist_parallel::Pool;
use pointillist_view::{PixelRect, View};

/// How a picture is diced and resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MicropointOptions {
    /// Cells per pixel side: 1, 2 or 4. Default: 1; with exact occlusion coverage does not need more,
    /// only shading that varies within a pixel does.
    pub cells_per_pixel: u32,
    /// Squares on a side of a cell in which a mask is partly open: 1, 2 or 4. Default: 4. What is seen through a mask, how it is lit and what it hides
    /// vary together, and are taken to be independent within a square.
    pub squares_under_masks: u32,
    /// How parts in one cell hide one another. Default: correlated.
    pub occlusion: Occlusion,
    /// Skip the back faces of closed opaque components. Default: true. Never changes a correlated
    /// picture; under the paper's rule it removes the coverage that silhouettes would count twice.
    pub cull_solids: bool,
    /// Depths outside of which surfaces are cut away, along planes across the view direction. A solid that is cut shows no inside: its
    /// back faces stay skipped with `cull_solids`. Default: all.
    pub depths: DepthRange,
}

impl MicropointOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self {
        cells_per_pixel: 1,
        squares_under_masks: 4,
        occlusion: Occlusion::Correlated,
        cull_solids: true,
        depths: DepthRange::ALL,
    };

    /// Sets the number of cells per pixel side.
    #[must_use]
    pub const fn with_cells_per_pixel(mut self, cells: u32) -> Self {
        self.cells_per_pixel = cells;
        self
    }

    /// Sets the number of squares on a side of a cell in which a mask is partly open.
    #[must_use]
    pub const fn with_squares_under_masks(mut self, squares: u32) -> Self {
        self.squares_under_masks = squares;
        self
    }

    /// Sets the occlusion rule.
    #[must_use]
    pub const fn with_occlusion(mut self, occlusion: Occlusion) -> Self {
        self.occlusion = occlusion;
        self
    }

    /// Sets whether back faces of closed opaque components are skipped.
    #[must_use]
    pub const fn with_cull_solids(mut self, cull: bool) -> Self {
        self.cull_solids = cull;
        self
    }

    /// Cuts away what is nearer or farther.
    #[must_use]
    pub const fn with_depths(mut self, depths: DepthRange) -> Self {
        self.depths = depths;
        self
    }
}

impl Default for MicropointOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A view of prepared geometry, ready to give tiles in any order and from any thread.
pub struct Renderer<'a> {
    geometry: &'a Geometry,
    opacity: &'a dyn TexturedOpacity,
    view: View,
    lens: Lens,
    rect: GridRect,
    hidden: HiddenSides,
    options: MicropointOptions,
}

impl<'a> Renderer<'a> {
    /// Prepares a view.
    ///
    /// # Errors
    /// [`MicropointError::BadCellsPerPixel`], [`MicropointError::BadSquaresUnderMasks`], [`MicropointError::BadDepths`].
    pub fn new(
        geometry: &'a Geometry,
        opacity: &'a dyn TexturedOpacity,
        view: View,
        options: MicropointOptions,
    ) -> Result<Self, MicropointError> {
        let cells = options.cells_per_pixel;
        if !matches!(cells, 1 | 2 | 4) {
            return Err(MicropointError::BadCellsPerPixel(cells));
        }
        if !matches!(options.squares_under_masks, 1 | 2 | 4) {
            return Err(MicropointError::BadSquaresUnderMasks(options.squares_under_masks));
        }
        if !options.depths.is_valid() {
            let DepthRange { near, far } = options.depths;
            return Err(MicropointError::BadDepths { near, far });
        }
        let mut lens = Lens::of_view(&view, cells);
        let bounds = geometry.bounds();
        if bounds.low.x <= bounds.high.x {
            lens.reach = (bounds.low - view.eye()).abs().max((bounds.high - view.eye()).abs()).length();
        }
        // Two pixels beyond the picture: faces clipped there look the same as unclipped ones.
        let margin = DVec2::splat(2.0 * f64::from(cells));
        let size = DVec2::new(f64::from(view.width()), f64::from(view.height())) * f64::from(cells);
        let rect = GridRect { low: -margin, high: size + margin };
        let hidden = if options.cull_solids { geometry.hidden_sides(&lens) } else { HiddenSides::default() };
        Ok(Self { geometry, opacity, view, lens, rect, hidden, options })
    }

    /// The whole picture.
    #[must_use]
    pub fn picture(&self) -> PixelRect {
        self.view.picture()
    }

    /// The view.
    #[must_use]
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The projection onto the picture's cells.
    #[must_use]
    pub fn lens(&self) -> &Lens {
        &self.lens
    }

    /// Renders a rectangle tile by tile and hands each to `visit`, together with a state that only one thread uses at a time,
    /// made by `start`. Tiles come in any order, and from all cores with the feature `rayon`. After an error of `visit`, which
    /// may be used to cancel, no further tile is begun.
    ///
    /// # Errors
    /// [`MicropointError::BadTileSize`] unless `size` is 4 to 64 pixels, or an error of `visit`.
    pub fn for_each_tile<S, E: From<MicropointError> + Send>(
        &self,
        rect: PixelRect,
        size: u32,
        start: impl Fn() -> S + Send + Sync,
        visit: impl Fn(&mut S, &Tile) -> Result<(), E> + Send + Sync,
    ) -> Result<(), E> {
        if !(4..=64).contains(&size) {
            return Err(MicropointError::BadTileSize(size).into());
        }
        let tiles: Vec<PixelRect> = rect.intersection(&self.picture()).tiles(size).collect();
        self.for_each_rect(&tiles, start, visit)
    }

    /// As [`Renderer::for_each_tile`], for rectangles that the caller chooses: those of a picture that are not there yet. What is large
    /// takes memory for all of its cells, on each thread.
    ///
    /// # Errors
    /// An error of `visit`.
    pub fn for_each_rect<S, E: Send>(
        &self,
        rects: &[PixelRect],
        start: impl Fn() -> S + Send + Sync,
        visit: impl Fn(&mut S, &Tile) -> Result<(), E> + Send + Sync,
    ) -> Result<(), E> {
        // Threads take up work more often than there are threads; memory that has grown is not given away each time.
        let memory = Pool::<Tile>::default();
        let render = |state: &mut S, rect: &PixelRect| {
            memory.with(|tile| {
                self.render(*rect, tile);
                visit(state, tile)
            })
        };
        #[cfg(feature = "rayon")]
        {
            use rayon::prelude::*;
            rects.par_iter().try_for_each_init(start, render)
        }
        #[cfg(not(feature = "rayon"))]
        {
            let mut state = start();
            rects.iter().try_for_each(|rect| render(&mut state, rect))
        }
    }

    /// Finds the visible micropoints of some pixels. What a pixel gets does not depend on the
    /// rectangle it is rendered in.
    /// Pixels outside the picture do not exist and see nothing.
    pub fn render(&self, rect: PixelRect, tile: &mut Tile) {
        let rect = rect.intersection(&self.picture());
        tile.start(rect, self.lens, self.options.cells_per_pixel);
        if rect.width() == 0 || rect.height() == 0 {
            tile.dicer.counts = TileCounts::default();
            return;
        }
        let cells = self.options.cells_per_pixel;
        let window = CellWindow {
            x0: (rect.x0 * cells) as i32,
            y0: (rect.y0 * cells) as i32,
            x1: (rect.x1 * cells) as i32,
            y1: (rect.y1 * cells) as i32,
        };
        let mut dicer = std::mem::take(&mut tile.dicer);
        let mut resolve = std::mem::take(&mut tile.resolve);
        let (geometry, lens, opacity) = (self.geometry, &self.lens, self.opacity);
        let squares_per_side = match self.options.occlusion {
            Occlusion::Correlated => self.options.squares_under_masks as i32,
            Occlusion::Paper => 1,
        };
        let depths = self.options.depths;
        let job = DiceJob {
            geometry,
            lens,
            rect: &self.rect,
            hidden: &self.hidden,
            opacity,
            squares_per_side,
            depths,
        };
        dicer.dice(&job, window);
        let share = 1.0 / f64::from(cells * cells);
        let rows = rect.y0 * cells..rect.y1 * cells;
        let places = rows.flat_map(|y| (rect.x0 * cells..rect.x1 * cells).map(move |x| (x, y)));
        for (cell, (x, y)) in places.enumerate() {
            let corner = DVec2::new(f64::from(x), f64::from(y));
            let pixel = (x / cells, y / cells);
            let emit = |dicer: &Dicer, seen: Visible<'_>| tile.push(dicer, &seen, corner, pixel, share);
            match self.options.occlusion {
                Occlusion::Correlated => {
                    resolve_exactly(&mut dicer, &mut resolve, &job, cell, corner, emit);
                }
                Occlusion::Paper => resolve_by_layers(&mut dicer, cell, emit),
            }
        }
        dicer.counts.micropoints = tile.points().len() as u64;
        tile.dicer = dicer;
        tile.resolve = resolve;
    }
}
