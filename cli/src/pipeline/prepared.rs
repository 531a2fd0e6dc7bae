//! A scene with everything that does not depend on the view computed once.

use super::ambient::Ambient;
use super::background::{Background, sum_up_environment};
use super::canvas::Canvas;
use super::lights::light_samples;
use super::reflections::Reflections;
use super::shading::{Shader, ShaderScratch, Style};
use super::surfaces::Surfaces;
use super::{PipelineError, TILE_SIZE};
use crate::image_io::Frame;
use crate::job::{Progress, RenderJob, Stats, ThreadClock};
use crate::scene::{AmbientLight, Occlusion, Scene};
use pointillist_micropoint::{Geometry, MicropointOptions, Renderer, TexelSums, TileCounts};
use pointillist_shadow::ShadowCounts;
use pointillist_view::View;
use std::sync::{Arc, Mutex};

/// What all views of a scene share: textures summed up, geometry sorted into clusters.
pub struct Prepared<'a> {
    pub(super) scene: &'a Scene,
    pub(super) surfaces: Arc<Surfaces>,
    pub(super) geometry: Geometry,
    environment: Arc<Option<TexelSums<3>>>,
    pub(super) reflections: Arc<Reflections>,
}

impl<'a> Prepared<'a> {
    /// Prepares a scene.
    ///
    /// # Errors
    /// [`PipelineError`] if the geometry or a texture is refused.
    pub fn new(scene: &'a Scene, stats: &Stats) -> Result<Self, PipelineError> {
        let surfaces = stats.stage("textures", || Surfaces::new(scene))?;
        let geometry = stats.stage("build", || surfaces.geometry(scene))?;
        let environment = stats.stage("textures", || sum_up_environment(scene))?;
        stats.count("triangles", geometry.triangle_count() as u64);
        stats.count("triangles_of_solids", geometry.solid_triangle_count() as u64);
        let mut prepared = Self {
            scene,
            surfaces: Arc::new(surfaces),
            geometry,
            environment: Arc::new(environment),
            reflections: Arc::new(Reflections::new(scene, stats)),
        };
        prepared.capture_mirrors(stats)?;
        Ok(prepared)
    }

    /// The same scene with other triangles in view.
    pub(super) fn with_geometry(&self, geometry: Geometry) -> Self {
        Self {
            scene: self.scene,
            surfaces: self.surfaces.clone(),
            geometry,
            environment: self.environment.clone(),
            reflections: self.reflections.clone(),
        }
    }

    /// The triangles.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The scene's own ambient light.
    pub fn ambient(&self) -> Ambient<'_> {
        match &self.scene.ambient {
            AmbientLight::Color(color) => Ambient::Color(*color),
            AmbientLight::Sky(light) => Ambient::Sky(*light),
            AmbientLight::Probes { field, .. } => Ambient::Probes(field),
            AmbientLight::Environment => match self.reflections.of_scene() {
                Some(map) => Ambient::Environment(map),
                None => Ambient::Color(self.scene.image.background),
            },
            AmbientLight::Radiosity { light, .. } => Ambient::Radiosity(light),
        }
    }

    pub(super) fn has_constant_background(&self) -> bool {
        self.environment.is_none()
    }

    /// Draws the job's window of a view.
    ///
    /// A pixel's value depends on the scene, the view and the style only: not on the window, on tiles or on
    /// the number of threads.
    pub(super) fn draw(
        &self,
        view: View,
        style: &Style<'_>,
        job: &RenderJob,
        progress: &Progress,
        stats: &Stats,
    ) -> Result<Frame, PipelineError> {
        let renderer = Renderer::new(&self.geometry, &*self.surfaces, view, options(self.scene))?;
        let mut clock = ThreadClock::start();
        let lights = if style.lights {
            light_samples(self.scene, &self.geometry, &self.surfaces, renderer.lens())?
        } else {
            vec![]
        };
        clock.book(stats, "lights");
        let background = Background::new(self.scene, (*self.environment).as_ref(), &view);
        let shader = Shader::new(self, &lights, &view, style);
        let canvas = Mutex::new(Canvas::new(self.scene, [view.width(), view.height()], job));
        let totals = Mutex::new((TileCounts::default(), ShadowCounts::default()));
        renderer.for_each_tile(job.window, TILE_SIZE, |scratch: &mut Scratch, tile| {
            scratch.clock.book(stats, "visibility");
            let pixels =
                shader.shade(tile, &background, &job.layers, &mut scratch.shader, &mut scratch.clock, stats);
            lock(&canvas).put(tile.rect(), pixels);
            let mut totals = lock(&totals);
            totals.0 += tile.counts();
            totals.1 += scratch.shader.take_counts();
            progress.advance(1);
        })?;
        let (tile_counts, shadow_counts) = *lock(&totals);
        record(stats, &tile_counts, &shadow_counts);
        Ok(canvas.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).into_frame())
    }

    /// The style of an ordinary picture.
    pub(super) fn plain_style(&self) -> Style<'_> {
        Style { ambient: self.ambient(), emission: true, lights: true, economy: None }
    }
}

/// Per-thread memory.
struct Scratch {
    clock: ThreadClock,
    shader: ShaderScratch,
}

impl Default for Scratch {
    fn default() -> Self {
        Self { clock: ThreadClock::start(), shader: ShaderScratch::default() }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    // What is inside is a sum or a set of finished tiles: whole after every statement.
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

fn options(scene: &Scene) -> MicropointOptions {
    let options = MicropointOptions::DEFAULT;
    let cells = scene.render.cells_per_pixel.unwrap_or(options.cells_per_pixel);
    options.with_cells_per_pixel(cells).with_occlusion(occlusion(scene))
}

pub(super) fn occlusion(scene: &Scene) -> Occlusion {
    scene.render.occlusion.unwrap_or_default()
}

fn record(stats: &Stats, t: &TileCounts, s: &ShadowCounts) {
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
        ("shadow_clusters", s.clusters_skipped),
        ("shadow_casters_culled", s.casters_culled),
    ];
    counts.iter().for_each(|(name, n)| stats.count(name, *n));
    skipped.iter().for_each(|(name, n)| stats.skip(name, *n));
}
