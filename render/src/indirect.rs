//! Light between the surfaces of a scene, solved with the defaults of `pointillist-radiosity`, as ambient light.

use crate::error::RenderError;
use crate::lamps::{Lamps, with_lamps};
use crate::lightmap::{Lightmap, LightmapError};
use crate::monitor::{Monitor, go_on, stage};
use crate::radiosity_surfaces::{SceneSurfaces, scene_surfaces};
use crate::scene::{Scene, SceneError};
use glam::DVec3;
use pointillist_radiosity as radiosity;
use pointillist_radiosity::{Baked, RadiosityError, RayOptions, Rgb, SceneOptions, SolveOptions};
use std::sync::atomic::{AtomicU64, Ordering};

/// How light between surfaces is solved for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct IndirectOptions {
    /// Patches along the longest side of the scene. Default: 32, for irradiance to about 1 % in rooms.
    pub patches_across: f64,
    /// Error of a link between two groups of patches, over what passes it, where scenes have more patches than `most_full`, and by rays that of
    /// the light at a vertex ([`IndirectOptions::ray_tolerance`]). Default: 0.01.
    pub tolerance: f64,
    /// Scenes of more patches are linked by groups. Default: 1000.
    pub most_full: usize,
    /// Scenes of more surfaces are linked by rays: every pair of surfaces is looked at for groups, cut where others stand on them. Default: 128.
    pub most_paired: usize,
}

/// Units of work that a monitor is told of, and shares of it after which direct light, links and the solution are there, about: by pairs, and by rays.
const UNITS: u64 = 1000;
const OF_PAIRS: [f64; 3] = [0.02, 0.8, 0.82];
const OF_RAYS: [f64; 3] = [0.1, 0.2, 0.25];
/// By rays, patches are divided down to this share of their size where light changes fast.
const FINEST: f64 = 1.0 / 8.0;
/// Scenes with more surfaces are buildings, for which light by rays may have more noise.
const MANY: usize = 2000;
/// Tolerance of the solver by rays: far below the error of links.
const SOLVED_TO: f64 = 1e-4;

impl IndirectOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self =
        Self { patches_across: 32.0, tolerance: 0.01, most_full: 1000, most_paired: 128 };

    /// Divides the longest side of the scene into so many patches.
    #[must_use]
    pub const fn with_patches_across(mut self, patches: f64) -> Self {
        self.patches_across = patches;
        self
    }

    /// Lets links between groups err by this share.
    #[must_use]
    pub const fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Links single patches in scenes of at most so many.
    #[must_use]
    pub const fn with_most_full(mut self, patches: usize) -> Self {
        self.most_full = patches;
        self
    }

    /// Standard error of the light at a vertex, over that light, where so many surfaces are linked by rays: `tolerance` up to 2000 surfaces, and
    /// at least 0.02 for buildings of more.
    #[must_use]
    pub const fn ray_tolerance(&self, surfaces: usize) -> f64 {
        if surfaces > MANY { self.tolerance.max(RayOptions::DEFAULT.tolerance) } else { self.tolerance }
    }

    /// Looks at pairs in scenes of at most so many surfaces.
    #[must_use]
    pub const fn with_most_paired(mut self, surfaces: usize) -> Self {
        self.most_paired = surfaces;
        self
    }
}

impl Default for IndirectOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What can go wrong while light between surfaces is solved for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IndirectError {
    /// The scene is refused, or has a material that reflects more than arrives.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An option, a surface or the number of patches was refused.
    #[error(transparent)]
    Radiosity(#[from] RadiosityError),
    /// What was solved does not fit the scene.
    #[error(transparent)]
    Lightmap(#[from] LightmapError),
    /// The monitor cancelled.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Solves for the light between a scene's surfaces: all bounces of diffuse light that lights and glowing surfaces send out. What surfaces get
/// straight from lights is not in it, nor is light from the background. For [`Ambient::Radiosity`](crate::Ambient::Radiosity).
///
/// # Errors
/// [`IndirectError`].
pub fn solve_indirect(
    scene: &Scene,
    options: &IndirectOptions,
    monitor: &dyn Monitor,
) -> Result<Lightmap, IndirectError> {
    let surfaces = scene_surfaces(scene)?;
    monitor.begin(UNITS);
    let baked = if surfaces.surfaces.len() > options.most_paired {
        by_rays(scene, &surfaces, options, monitor)?
    } else {
        by_pairs(scene, &surfaces, options, monitor)?
    };
    Ok(Lightmap::of_baked(&baked, &surfaces.faces, scene.mesh.triangle_count())?)
}

/// Tells a monitor how far all the work is.
struct Told<'m> {
    monitor: &'m dyn Monitor,
    units: AtomicU64,
}

impl Told<'_> {
    /// As far as this share of the way between two shares of all.
    fn reach(&self, [from, to]: [f64; 2], share: f64) {
        let units = ((from + (to - from) * share).clamp(0.0, 1.0) * UNITS as f64) as u64;
        let before = self.units.fetch_max(units, Ordering::Relaxed);
        if units > before {
            self.monitor.advance(units - before);
        }
    }
}

/// By links between patches, or groups of them.
fn by_pairs(
    scene: &Scene,
    surfaces: &SceneSurfaces,
    options: &IndirectOptions,
    monitor: &dyn Monitor,
) -> Result<Baked, IndirectError> {
    let [lit, linked, solved] = OF_PAIRS;
    let told = Told { monitor, units: AtomicU64::new(0) };
    let (patches, direct) = directly_lit(scene, || divided(surfaces, options), &told, lit)?;
    let done = |share| told.reach([lit, linked], share);
    let transport = stage(monitor, "factors", || patches.transport_with(&direct, &done))?;
    go_on(monitor)?;
    let solution = stage(monitor, "solve", || transport.gauss_seidel(&SolveOptions::DEFAULT))?;
    go_on(monitor)?;
    let done = |share| told.reach([solved, 1.0], share);
    monitor.count("patches", transport.patch_count() as u64);
    Ok(stage(monitor, "gather", || solution.bake_with(&done)))
}

/// By links that rays find, for buildings.
fn by_rays(
    scene: &Scene,
    surfaces: &SceneSurfaces,
    options: &IndirectOptions,
    monitor: &dyn Monitor,
) -> Result<Baked, IndirectError> {
    let [lit, linked, solved] = OF_RAYS;
    let told = Told { monitor, units: AtomicU64::new(0) };
    let patch = extent(surfaces) / options.patches_across;
    let settings = SceneOptions::for_rays(patch);
    let divide = || radiosity::Scene::new(&surfaces.surfaces, &settings);
    let (patches, direct) = directly_lit(scene, divide, &told, lit)?;
    let done = |share| told.reach([lit, linked], share);
    let tolerance = options.ray_tolerance(surfaces.surfaces.len());
    let rays = RayOptions::DEFAULT.with_finest(patch * FINEST).with_tolerance(tolerance);
    let transport = stage(monitor, "factors", || patches.transport_by_rays(&direct, &rays, &done))?;
    go_on(monitor)?;
    let settings = SolveOptions::DEFAULT.with_tolerance(SOLVED_TO);
    let solution = stage(monitor, "solve", || transport.solve(&settings))?;
    go_on(monitor)?;
    let done = |share| told.reach([solved, 1.0], share);
    monitor.count("patches", transport.counts().patches as u64);
    Ok(stage(monitor, "gather", || solution.bake_with(&done)))
}

/// The patches that `divide` makes and the direct light on them. Progress goes from 0 to `lit`.
fn directly_lit(
    scene: &Scene,
    divide: impl FnOnce() -> Result<radiosity::Scene, RadiosityError>,
    told: &Told<'_>,
    lit: f64,
) -> Result<(radiosity::Scene, Vec<Rgb>), IndirectError> {
    let monitor = told.monitor;
    let mut patches = stage(monitor, "divide", divide)?;
    go_on(monitor)?;
    let lamps = Lamps::new(scene);
    let done = |share| told.reach([0.0, lit], share);
    let direct = stage(monitor, "direct", || with_lamps(&lamps, |list| patches.direct_with(list, &done)))?;
    go_on(monitor)?;
    Ok((patches, direct))
}

/// The surfaces in patches: linked one by one if they are few, by groups if they are many.
fn divided(surfaces: &SceneSurfaces, options: &IndirectOptions) -> Result<radiosity::Scene, RadiosityError> {
    let patch = extent(surfaces) / options.patches_across;
    let settings = SceneOptions::DEFAULT.with_patch(patch).with_smallest_patch(patch);
    let plain = radiosity::Scene::new(&surfaces.surfaces, &settings)?;
    if plain.patch_count() <= options.most_full {
        return Ok(plain);
    }
    radiosity::Scene::new(&surfaces.surfaces, &settings.with_tolerance(Some(options.tolerance)))
}

/// Longest side of the box around all surfaces; 1 if they have no extent.
fn extent(surfaces: &SceneSurfaces) -> f64 {
    let all = || surfaces.surfaces.iter().flat_map(|s| &s.vertices);
    let low = all().fold(DVec3::INFINITY, |m, &v| m.min(v));
    let high = all().fold(DVec3::NEG_INFINITY, |m, &v| m.max(v));
    let longest = (high - low).max_element();
    if longest > 0.0 { longest } else { 1.0 }
}
