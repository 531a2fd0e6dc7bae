//! From a prepared scene to a frame: micropoints, shadows and shading, tile by tile.
//!
//! Each tile goes through three stages on one thread: its visible micropoints are found; for each light the lit fractions of those
//! that can use its light; then each is shaded once. Memory is that of a tile per thread, plus the frame.

use crate::background::Background;
use crate::canvas::Canvas;
use crate::error::RenderError;
use crate::frame::{Frame, LayerKind};
use crate::lights::{SceneLights, scene_lights};
use crate::monitor::{Monitor, go_on};
use crate::prepared::Prepared;
use crate::shader::{Glow, Shader, Style};
use crate::shading::ShaderScratch;
use pointillist_micropoint::{DepthRange, Renderer, TileCounts};
use pointillist_parallel::Pool;
use pointillist_shadow::{AreaCounts, ShadowCounts};
use pointillist_view::{PixelRect, View};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Pixels on a side of a tile: about a thousand cells, whose state stays in the second-level cache.
const TILE_SIZE: u32 = 16;

/// What of a picture is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct DrawOptions {
    /// The part of the picture, clipped to it; `None`, the default, is all of it.
    pub window: Option<PixelRect>,
    /// What to deliver beside colour and depth, in this order. Default: nothing.
    pub layers: Vec<LayerKind>,
}

impl DrawOptions {
    /// The whole picture, colour and depth.
    pub const DEFAULT: Self = Self { window: None, layers: Vec::new() };

    /// Draws a part of the picture.
    #[must_use]
    pub fn with_window(mut self, window: PixelRect) -> Self {
        self.window = Some(window);
        self
    }

    /// Delivers these layers beside colour and depth.
    #[must_use]
    pub fn with_layers(mut self, layers: Vec<LayerKind>) -> Self {
        self.layers = layers;
        self
    }
}

impl Prepared<'_> {
    /// Draws what the scene's camera sees.
    ///
    /// The frame has the layers that are asked for, in their order. A pixel's value depends on the scene only: not on the window,
    /// on tiles or on the number of threads.
    ///
    /// # Errors
    /// [`RenderError`] if the camera, the size of the picture, a light or a layer is refused, or the monitor cancels.
    pub fn draw(&self, options: &DrawOptions, monitor: &dyn Monitor) -> Result<Frame, RenderError> {
        self.draw_view(self.scene.view()?, options, monitor)
    }

    /// Draws what another camera sees; the scene's own camera and size are not used.
    ///
    /// # Errors
    /// As [`Prepared::draw`].
    pub fn draw_view(
        &self,
        view: View,
        options: &DrawOptions,
        monitor: &dyn Monitor,
    ) -> Result<Frame, RenderError> {
        let (ambient, depths) = (self.ambient(), DepthRange::ALL);
        let style = Style { ambient, glow: Glow::Everything, lights: true, economy: None, depths };
        self.draw_styled(view, &style, options, monitor)
    }

    /// Draws a view as `style` says.
    pub(crate) fn draw_styled(
        &self,
        view: View,
        style: &Style<'_>,
        options: &DrawOptions,
        monitor: &dyn Monitor,
    ) -> Result<Frame, RenderError> {
        let layers = &options.layers;
        self.check_layers(layers)?;
        let window = options.window.unwrap_or(view.picture()).intersection(&view.picture());
        monitor.begin(window.tiles(TILE_SIZE).count() as u64);
        let mut micropoints = self.scene.render.micropoints().with_depths(style.depths);
        if style.economy.is_some() {
            micropoints = micropoints.with_cells_under_masks(1);
        }
        let renderer = Renderer::new(&self.geometry, &*self.surfaces, view, micropoints)?;
        monitor.start_lap();
        let lights = if style.lights {
            let sampled = style.economy.is_some_and(|economy| economy.samples_areas);
            scene_lights(self, renderer.lens(), sampled)?
        } else {
            SceneLights::default()
        };
        monitor.lap("lights");
        let background = Background::new(self.scene, (*self.environment).as_ref(), &view);
        let shader = Shader::new(self, &lights, &view, style);
        let canvas = Mutex::new(Canvas::new(self.scene, [view.width(), view.height()], window, layers));
        let totals = Mutex::new((TileCounts::default(), ShadowCounts::default(), AreaCounts::default()));
        let memory = Pool::<ShaderScratch>::default();
        renderer.for_each_tile(
            window,
            TILE_SIZE,
            || monitor.start_lap(),
            |(), tile| {
                monitor.lap("visibility");
                memory.with(|scratch| {
                    let pixels = shader.shade(tile, &background, layers, scratch, monitor);
                    lock(&canvas).put(tile.rect(), pixels);
                    let mut totals = lock(&totals);
                    totals.0 += tile.counts();
                    let (shadow, whole) = scratch.take_counts();
                    totals.1 += shadow;
                    totals.2 += whole;
                });
                monitor.advance(1);
                go_on(monitor)
            },
        )?;
        let (tile_counts, shadow_counts, area_counts) = *lock(&totals);
        record(monitor, &tile_counts, &shadow_counts, &area_counts);
        Ok(canvas.into_inner().unwrap_or_else(PoisonError::into_inner).into_frame())
    }

    fn check_layers(&self, layers: &[LayerKind]) -> Result<(), RenderError> {
        let count = self.scene.lights.len();
        layers.iter().try_for_each(|layer| match layer {
            LayerKind::Lit(index) if *index >= count => Err(RenderError::Layer { index: *index, count }),
            _ => Ok(()),
        })
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // What is inside is a sum or a set of finished tiles: whole after every statement.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn record(monitor: &dyn Monitor, t: &TileCounts, s: &ShadowCounts, a: &AreaCounts) {
    let counts = [
        ("clusters", t.clusters),
        ("triangles_diced", t.triangles - t.triangles_hidden),
        ("pieces", t.pieces),
        ("micropoints", t.micropoints),
        ("cells_one_part", t.cells_single),
        ("cells_tiled", t.cells_tiled),
        ("cells_parts_apart", t.cells_apart),
        ("cells_cut", t.cells_compared),
        ("shadow_receivers", s.receivers),
        ("shadow_screens", s.screens),
        ("shadow_clusters", s.clusters),
        ("shadow_casters", s.casters),
        ("shadow_receivers_cut", s.partial),
        ("area_light_receivers", a.receivers),
        ("area_light_points", a.points),
        ("area_light_points_cut", a.points - a.lit_by_group - a.dark),
        ("area_light_casters", a.casters),
    ];
    let skipped = [
        ("clusters", t.clusters_skipped),
        ("triangles_culled", t.triangles_culled),
        ("triangles_hidden", t.triangles_hidden),
        ("parts_hidden", t.parts_hidden),
        ("cells_inside_spans_not_cut", t.span_cells),
        ("cells_empty", t.cells_empty),
        ("shadow_receivers_facing_away", s.facing_away),
        ("shadow_receivers_lit_by_group", s.lit_by_group),
        ("shadow_receivers_dark_by_group", s.dark_by_group),
        ("area_light_receivers_facing_away", a.facing_away),
        ("area_light_points_lit_by_group", a.lit_by_group),
        ("area_light_points_dark", a.dark),
        ("shadow_clusters", s.clusters_skipped),
        ("shadow_casters_culled", s.casters_culled),
    ];
    counts.iter().for_each(|(name, n)| monitor.count(name, *n));
    skipped.iter().for_each(|(name, n)| monitor.skip(name, *n));
}
