//! From a prepared scene to a frame: micropoints, shadows and shading, tile by tile.
//!
//! Each tile goes through three stages on one thread: its visible micropoints are found; for each light the lit fractions of those
//! that can use its light; then each is shaded once. Memory is that of a tile per thread, plus the frame.

use crate::background::Background;
use crate::error::RenderError;
use crate::frame::{Frame, LayerKind};
use crate::lights::{SceneLights, scene_lights};
use crate::monitor::{Monitor, go_on};
use crate::painter::{Painter, PainterMemory};
use crate::partial::PartialFrame;
use crate::prepared::Prepared;
use crate::shader::{Economy, Glow, Shader, Style};
use glam::Vec3;
use pointillist_micropoint::{DepthRange, Renderer, TileCounts};
use pointillist_parallel::Pool;
use pointillist_shadow::{AreaCounts, ShadowCounts};
use pointillist_view::{PixelRect, View};
use std::sync::{Mutex, MutexGuard, PoisonError};

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
        let hides_environment = self.scene.image.hides_environment;
        let style =
            Style { ambient, glow: Glow::Everything, lights: true, economy: None, depths, hides_environment };
        self.draw_styled(view, &style, options, monitor)
    }

    /// A picture of the scene's camera of which nothing is drawn yet: for [`Prepared::continue_view`].
    ///
    /// # Errors
    /// [`RenderError`] if the camera, the size of the picture or a layer is refused.
    pub fn begin(&self, options: &DrawOptions) -> Result<PartialFrame, RenderError> {
        self.begin_view(self.scene.view()?, options)
    }

    /// A picture of another camera of which nothing is drawn yet: for [`Prepared::continue_view`], so that what is drawn survives when the
    /// monitor cancels.
    ///
    /// # Errors
    /// [`RenderError::Layer`].
    pub fn begin_view(&self, view: View, options: &DrawOptions) -> Result<PartialFrame, RenderError> {
        self.check_layers(&options.layers)?;
        Ok(PartialFrame::new(self.scene, view, options))
    }

    /// Draws the tiles that a picture lacks. Once all are there, [`PartialFrame::into_frame`] is what [`Prepared::draw_view`] gives, to the
    /// last bit, however often the work was ended in between.
    ///
    /// ```
    /// # use pointillist_render::glam::{DVec3, Vec3};
    /// # use pointillist_render::{Camera, DrawOptions, Material, Part, Prepared, RenderError, Scene, Watch, shade};
    /// # use std::sync::atomic::{AtomicBool, Ordering};
    /// # let mut scene = Scene::new(Camera::perspective(DVec3::Z, DVec3::ZERO, 1.0), [64, 64]);
    /// # scene.add_material(Material::new("white", shade::Material::lambert(Vec3::ONE)));
    /// # scene.mesh.add(&Part::new("triangle", &[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]))?;
    /// let prepared = Prepared::new(&scene, &())?;
    /// let mut picture = prepared.begin(&DrawOptions::DEFAULT)?;
    ///
    /// // A caller who loses patience after the first tile, and comes back later.
    /// let stop = AtomicBool::new(false);
    /// let after_one = |done, _| stop.store(done > 0, Ordering::Relaxed);
    /// let watch = Watch::new().with_progress(&after_one).with_cancel(&stop);
    /// assert!(matches!(prepared.continue_view(&mut picture, &watch), Err(RenderError::Cancelled)));
    /// assert!(picture.tiles_drawn() > 0);
    ///
    /// prepared.continue_view(&mut picture, &())?;
    /// assert_eq!(picture.into_frame(), prepared.draw(&DrawOptions::DEFAULT, &())?);
    /// # Ok::<(), RenderError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Prepared::draw`]. What was drawn until then stays in the picture.
    pub fn continue_view(
        &self,
        picture: &mut PartialFrame,
        monitor: &dyn Monitor,
    ) -> Result<(), RenderError> {
        let (ambient, depths) = (self.ambient(), DepthRange::ALL);
        let hides_environment = self.scene.image.hides_environment;
        let style =
            Style { ambient, glow: Glow::Everything, lights: true, economy: None, depths, hides_environment };
        self.draw_missing(&style, picture, monitor)
    }

    /// Draws a view as `style` says.
    pub(crate) fn draw_styled(
        &self,
        view: View,
        style: &Style<'_>,
        options: &DrawOptions,
        monitor: &dyn Monitor,
    ) -> Result<Frame, RenderError> {
        let mut picture = self.begin_view(view, options)?;
        self.draw_missing(style, &mut picture, monitor)?;
        Ok(picture.into_frame())
    }

    fn draw_missing(
        &self,
        style: &Style<'_>,
        picture: &mut PartialFrame,
        monitor: &dyn Monitor,
    ) -> Result<(), RenderError> {
        self.check_layers(picture.layers())?;
        let view = *picture.view();
        let missing = picture.missing();
        let before = picture.tiles_drawn() as u64;
        monitor.begin(picture.tile_count() as u64);
        monitor.advance(before);
        if missing.is_empty() && before > 0 {
            return Ok(());
        }
        let mut micropoints = self.scene.render.micropoints().with_depths(style.depths);
        if style.economy.is_some() {
            micropoints = micropoints.with_squares_under_masks(Economy::SQUARES_UNDER_MASKS);
        }
        let sights = self.sights.iter();
        let renderers = sights
            .map(|sight| Renderer::new(&sight.geometry, &*self.surfaces, view, micropoints))
            .collect::<Result<Vec<_>, _>>()?;
        let renderer = &renderers[0];
        monitor.start_lap();
        let lights = if style.lights {
            let shown = |light| picture.layers().contains(&LayerKind::Lit(light));
            scene_lights(self, renderer.lens(), style.economy, &shown)?
        } else {
            SceneLights::default()
        };
        monitor.lap("lights");
        let environment = (*self.environment).as_ref().filter(|_| !style.hides_environment);
        let background = Background::new(self.scene, environment, &view);
        let shader = |sight, channels| Shader::new(self, &lights, &view, style, (sight, channels));
        let by_sight: Vec<Shader<'_>> = self.sights.iter().map(|s| shader(s, s.channels)).collect();
        let layers = picture.layers().to_vec();
        let painter = Painter {
            sights: &self.sights,
            renderers: &renderers,
            by_sight: &by_sight,
            all_colors: shader(&self.sights[0], Vec3::ONE),
            background: &background,
            layers: &layers,
            monitor,
        };
        let canvas = Mutex::new(picture);
        let totals = Mutex::new((TileCounts::default(), ShadowCounts::default(), AreaCounts::default()));
        let memory = Pool::<PainterMemory>::default();
        renderer.for_each_rect(
            &missing,
            || monitor.start_lap(),
            |(), tile| {
                monitor.lap("visibility");
                memory.with(|memory| {
                    // Before the lock is taken: others paint meanwhile.
                    let painted = painter.paint(tile, memory);
                    lock(&canvas).put(tile.rect(), painted);
                    let (visible, shadow, whole) = memory.take_counts();
                    let mut totals = lock(&totals);
                    totals.0 += visible;
                    totals.1 += shadow;
                    totals.2 += whole;
                });
                monitor.advance(1);
                go_on(monitor)
            },
        )?;
        let (tile_counts, shadow_counts, area_counts) = *lock(&totals);
        monitor.count("tiles", missing.len() as u64);
        if before > 0 {
            monitor.skip("tiles_drawn_before", before);
        }
        record(monitor, &tile_counts, &shadow_counts, &area_counts);
        Ok(())
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
