//! A view's tiles, each turned into its visible micropoints.

use crate::error::MicropointError;
use crate::face::{Face, GridRect, SurfacePoint, TexturedOpacity};
use crate::geometry::{Geometry, HiddenSides};
use crate::lens::Lens;
use crate::resolve::{Occlusion, ResolveScratch, Visible, resolve_by_layers, resolve_exactly};
use crate::tile::{DiceJob, Dicer, TileCounts};
use glam::{DVec2, DVec3};
use pointillist_dice::CellWindow;
use pointillist_view::{PixelRect, View};

/// How a picture is diced and resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MicropointOptions {
    /// Cells per pixel side: 1, 2 or 4. Default: 1; with exact occlusion coverage does not need more,
    /// only shading that varies within a pixel does.
    pub cells_per_pixel: u32,
    /// How parts in one cell hide one another. Default: correlated.
    pub occlusion: Occlusion,
    /// Skip the back faces of closed opaque components. Default: true. Never changes a correlated
    /// picture; under the paper's rule it removes the coverage that silhouettes would count twice.
    pub cull_solids: bool,
}

impl MicropointOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self =
        Self { cells_per_pixel: 1, occlusion: Occlusion::Correlated, cull_solids: true };

    /// Sets the number of cells per pixel side.
    #[must_use]
    pub const fn with_cells_per_pixel(mut self, cells: u32) -> Self {
        self.cells_per_pixel = cells;
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

/// A visible piece of a surface: what a shader shades, once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Micropoint {
    /// Column of its pixel in the picture.
    pub x: u32,
    /// Row of its pixel in the picture.
    pub y: u32,
    /// Index into [`Tile::faces`].
    pub face: u32,
    /// Its share of the pixel, 0..=1: visible area × transmittance in front × opacity.
    pub weight: f64,
    /// Centroid of what is seen of it, in cells of the picture.
    pub grid: DVec2,
    /// Smallest and largest nearness (1/depth, or −depth of an orthographic view).
    pub nearness: (f64, f64),
    /// Index of its first fragment in [`Tile::fragments`].
    pub first_fragment: u32,
    /// Number of its fragments.
    pub fragment_count: u32,
}

/// A convex part of the visible area of a micropoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    first_vertex: u32,
    vertex_count: u32,
    /// Its share of the pixel, as [`Micropoint::weight`].
    pub weight: f64,
}

/// The visible micropoints of a tile, and the memory to make them; reused from tile to tile.
#[derive(Debug, Default)]
pub struct Tile {
    dicer: Dicer,
    resolve: ResolveScratch,
    rect: Option<PixelRect>,
    lens: Option<Lens>,
    points: Vec<Micropoint>,
    fragments: Vec<Fragment>,
    vertices: Vec<DVec2>,
}

impl Tile {
    /// The pixels of this tile.
    #[must_use]
    pub fn rect(&self) -> PixelRect {
        self.rect.unwrap_or(PixelRect { x0: 0, y0: 0, x1: 0, y1: 0 })
    }

    /// The visible micropoints: cell by cell in rows, nearest first within a cell.
    #[must_use]
    pub fn points(&self) -> &[Micropoint] {
        &self.points
    }

    /// The faces that micropoints refer to.
    #[must_use]
    pub fn faces(&self) -> &[Face] {
        &self.dicer.faces
    }

    /// The fragments of a micropoint.
    #[must_use]
    pub fn fragments(&self, point: &Micropoint) -> &[Fragment] {
        &self.fragments[point.first_fragment as usize..][..point.fragment_count as usize]
    }

    /// Outline of a fragment in cells of the picture, in positive order.
    #[must_use]
    pub fn outline(&self, fragment: &Fragment) -> &[DVec2] {
        &self.vertices[fragment.first_vertex as usize..][..fragment.vertex_count as usize]
    }

    /// The point of a face at a grid position: barycentric coordinates and nearness.
    ///
    /// # Panics
    /// If no tile has been rendered yet.
    #[must_use]
    pub fn surface_point(&self, face: u32, grid: DVec2) -> SurfacePoint {
        self.faces()[face as usize].point(self.lens(), grid)
    }

    /// Position of a point of a face relative to the eye, in world axes.
    ///
    /// # Panics
    /// If no tile has been rendered yet.
    #[must_use]
    pub fn position(&self, grid: DVec2, nearness: f64) -> DVec3 {
        let lens = self.lens();
        lens.to_world_axes(lens.unproject(grid, nearness))
    }

    /// The lens of the view.
    ///
    /// # Panics
    /// If no tile has been rendered yet.
    #[must_use]
    pub fn lens(&self) -> &Lens {
        self.lens.as_ref().expect("a tile has been rendered")
    }

    /// Counts of the work for this tile.
    #[must_use]
    pub fn counts(&self) -> TileCounts {
        self.dicer.counts
    }

    fn push(&mut self, dicer: &Dicer, seen: &Visible<'_>, corner: DVec2, pixel: (u32, u32), share: f64) {
        let part = dicer.part(seen.part);
        let first_fragment = self.fragments.len() as u32;
        let opacity = f64::from(part.opacity) * seen.scale;
        match seen.pieces {
            None => self.push_fragment(dicer.outline(part), corner, seen.weight * share),
            Some(regions) => {
                for r in regions {
                    let weight = r.polygon.area() * r.transmittance * opacity * share;
                    self.push_fragment(r.polygon.vertices(), corner, weight);
                }
            }
        }
        self.points.push(Micropoint {
            x: pixel.0,
            y: pixel.1,
            face: part.face,
            weight: seen.weight * share,
            // Rounding may put the centroid of a sliver outside it.
            grid: seen.centroid.clamp(DVec2::ZERO, DVec2::ONE) + corner,
            nearness: part.nearness,
            first_fragment,
            fragment_count: self.fragments.len() as u32 - first_fragment,
        });
    }

    fn push_fragment(&mut self, outline: &[DVec2], corner: DVec2, weight: f64) {
        let first_vertex = self.vertices.len() as u32;
        self.vertices.extend(outline.iter().map(|&v| v + corner));
        let vertex_count = outline.len() as u32;
        self.fragments.push(Fragment { first_vertex, vertex_count, weight });
    }
}

impl<'a> Renderer<'a> {
    /// Prepares a view.
    ///
    /// # Errors
    /// [`MicropointError::BadCellsPerPixel`].
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
        let start = || (Tile::default(), start());
        let render = |(tile, state): &mut (Tile, S), rect: &PixelRect| {
            self.render(*rect, tile);
            visit(state, tile)
        };
        #[cfg(feature = "rayon")]
        {
            use rayon::prelude::*;
            tiles.par_iter().try_for_each_init(start, render)
        }
        #[cfg(not(feature = "rayon"))]
        {
            let mut state = start();
            tiles.iter().try_for_each(|rect| render(&mut state, rect))
        }
    }

    /// Finds the visible micropoints of some pixels. What a pixel gets does not depend on the
    /// rectangle it is rendered in.
    /// Pixels outside the picture do not exist and see nothing.
    pub fn render(&self, rect: PixelRect, tile: &mut Tile) {
        let rect = rect.intersection(&self.picture());
        tile.rect = Some(rect);
        tile.lens = Some(self.lens);
        tile.points.clear();
        tile.fragments.clear();
        tile.vertices.clear();
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
        dicer.dice(&DiceJob { geometry, lens, rect: &self.rect, hidden: &self.hidden, opacity }, window);
        let columns = (window.x1 - window.x0) as usize;
        let share = 1.0 / f64::from(cells * cells);
        for cell in 0..dicer.cell_count() {
            let x = window.x0 as u32 + (cell % columns) as u32;
            let y = window.y0 as u32 + (cell / columns) as u32;
            let corner = DVec2::new(f64::from(x), f64::from(y));
            let pixel = (x / cells, y / cells);
            let emit = |dicer: &Dicer, seen: Visible<'_>| tile.push(dicer, &seen, corner, pixel, share);
            match self.options.occlusion {
                Occlusion::Correlated => {
                    resolve_exactly(&mut dicer, &mut resolve, &self.lens, cell, corner, emit);
                }
                Occlusion::Paper => resolve_by_layers(&mut dicer, cell, emit),
            }
        }
        dicer.counts.micropoints = tile.points.len() as u64;
        tile.dicer = dicer;
        tile.resolve = resolve;
    }
}
