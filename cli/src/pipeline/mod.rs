//! From a scene to a frame: micropoints, shadows and shading, tile by tile.
//!
//! No algorithm lives here. Each tile goes through three stages on one thread: its visible micropoints
//! are found, for each light the lit fractions of those that can use its light, then each is
//! shaded once. Memory is that of a tile per thread, plus the frame.

mod background;
mod canvas;
mod shading;
mod surfaces;

use crate::image_io::{Frame, Window};
use crate::job::{Progress, RenderJob, Stats, ThreadClock};
use crate::scene::{Occlusion, Projection, Resolution, Scene};
use background::Background;
use canvas::Canvas;
use pointillist_micropoint as micropoint;
use pointillist_micropoint::{
    Geometry, Lens, MicropointError, MicropointOptions, PixelRect, Renderer, TileCounts, View,
};
use pointillist_shade::Source;
use pointillist_shadow as shadow;
use pointillist_shadow::{Emitter, ShadowCounts, ShadowError, ShadowLight, ShadowOptions};
use shading::{Shader, ShaderScratch};
use std::sync::Mutex;
use surfaces::Surfaces;

/// What can go wrong while a valid scene is drawn.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    /// The geometry or the view was refused.
    #[error(transparent)]
    Micropoint(#[from] MicropointError),
    /// A light was refused.
    #[error("light `{name}`: {source}")]
    Shadow {
        /// The light's name.
        name: String,
        /// Why.
        source: ShadowError,
    },
}

/// Pixels on a side of a tile: about a thousand cells, whose state stays in the second-level cache.
const TILE_SIZE: u32 = 16;

/// Draws the job's window of a scene.
///
/// The frame has the layers that the job asks for, in its order. A pixel's value depends on the scene
/// only: not on the window, on tiles or on the number of threads.
///
/// # Errors
/// [`PipelineError`] if the scene cannot be drawn.
pub fn render(
    scene: &Scene,
    job: &RenderJob,
    progress: &Progress,
    stats: &Stats,
) -> Result<Frame, PipelineError> {
    let surfaces = stats.stage("textures", || Surfaces::new(scene))?;
    let geometry = stats.stage("build", || surfaces.geometry(scene))?;
    stats.count("triangles", geometry.triangle_count() as u64);
    stats.count("triangles_of_solids", geometry.solid_triangle_count() as u64);
    let view = view(scene)?;
    let renderer = Renderer::new(&geometry, &surfaces, view, options(scene))?;
    let lights = stats.stage("lights", || light_samples(scene, &geometry, &surfaces, renderer.lens()))?;
    let background = Background::new(scene, &view)?;
    let shader = Shader::new(scene, &surfaces, &lights, &view);
    let canvas = Mutex::new(Canvas::new(scene, job));
    let totals = Mutex::new((TileCounts::default(), ShadowCounts::default()));
    let rect = pixel_rect(job.window);
    progress.begin("render", rect.tiles(TILE_SIZE).count() as u64);
    let start = std::time::Instant::now();
    renderer.for_each_tile(rect, TILE_SIZE, |scratch: &mut Scratch, tile| {
        scratch.clock.book(stats, "visibility");
        let pixels =
            shader.shade(tile, &background, &job.layers, &mut scratch.shader, &mut scratch.clock, stats);
        lock(&canvas).put(tile.rect(), pixels);
        let mut totals = lock(&totals);
        totals.0 += tile.counts();
        totals.1 += scratch.shader.take_counts();
        progress.advance(1);
    })?;
    stats.add_wall("tiles", start.elapsed());
    progress.finish();
    let (tile_counts, shadow_counts) = *lock(&totals);
    record(stats, &tile_counts, &shadow_counts);
    Ok(canvas.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).into_frame())
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

fn pixel_rect(w: Window) -> PixelRect {
    PixelRect { x0: w.x0, y0: w.y0, x1: w.x1, y1: w.y1 }
}

/// The scene's camera.
fn view(scene: &Scene) -> Result<View, MicropointError> {
    let projection = match scene.camera.projection {
        Projection::Perspective { fov_y_rad } => micropoint::Projection::Perspective { fov_y_rad },
        Projection::Orthographic { height } => micropoint::Projection::Orthographic { height },
    };
    let (camera, image) = (&scene.camera, &scene.image);
    View::look_at(camera.eye, camera.target, camera.up, projection, image.width, image.height)
}

fn options(scene: &Scene) -> MicropointOptions {
    let options = MicropointOptions::DEFAULT;
    let cells = scene.render.cells_per_pixel.unwrap_or(options.cells_per_pixel);
    options.with_cells_per_pixel(cells).with_occlusion(occlusion(scene))
}

fn occlusion(scene: &Scene) -> micropoint::Occlusion {
    match scene.render.occlusion {
        Some(Occlusion::Paper) => micropoint::Occlusion::Paper,
        Some(Occlusion::Correlated) | None => micropoint::Occlusion::Correlated,
    }
}

/// One point or direction from which light comes: a light, or a sample of an area light.
pub(crate) struct LightSample<'a> {
    /// Index into [`Scene::lights`].
    pub(crate) light: usize,
    pub(crate) sample: u32,
    /// `None`: casts no shadow.
    pub(crate) shadow: Option<ShadowLight<'a>>,
}

fn light_samples<'a>(
    scene: &Scene,
    geometry: &'a Geometry,
    surfaces: &'a Surfaces,
    lens: &Lens,
) -> Result<Vec<LightSample<'a>>, PipelineError> {
    let mut samples = Vec::new();
    for (light, source) in scene.lights.iter().enumerate() {
        let resolution = match source.resolution {
            Resolution::Auto => shadow::Resolution::Auto,
            Resolution::Cells(n) => shadow::Resolution::Cells(n),
        };
        let options = ShadowOptions::default().with_occlusion(occlusion(scene)).with_resolution(resolution);
        for sample in 0..source.light.samples() {
            let shadow = if source.shadow {
                let emitter = emitter(&source.light, sample);
                let named = |e| PipelineError::Shadow { name: source.name.clone(), source: e };
                Some(ShadowLight::new(geometry, surfaces, emitter, options).map_err(named)?.seen_from(lens))
            } else {
                None
            };
            samples.push(LightSample { light, sample, shadow });
        }
    }
    Ok(samples)
}

fn emitter(light: &pointillist_shade::Light, sample: u32) -> Emitter {
    use pointillist_shade::Light;
    // The axis decides how the six screens lie: along a spot light's beam, or an area light's normal.
    let axis = match light {
        Light::Spot { direction, .. } => *direction,
        Light::Rect { edge_u, edge_v, .. } => edge_u.cross(*edge_v),
        _ => glam::DVec3::NEG_Y,
    };
    match light.source(sample) {
        Source::Direction(direction) => Emitter::Directional { direction },
        Source::Position(position) => Emitter::Point { position, axis },
        _ => unreachable!("light comes from a point or a direction"),
    }
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
