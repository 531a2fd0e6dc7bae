//! Light between the surfaces of a scene, solved with the defaults of `pointillist-radiosity`, as ambient light.

use crate::error::RenderError;
use crate::lamps::{Lamps, with_lamps};
use crate::lightmap::{Lightmap, LightmapError};
use crate::monitor::{Monitor, go_on, stage};
use crate::radiosity_surfaces::{SceneSurfaces, scene_surfaces};
use crate::scene::{Scene, SceneError};
use glam::DVec3;
use pointillist_radiosity as radiosity;
use pointillist_radiosity::{RadiosityError, SceneOptions, SolveOptions};

/// How light between surfaces is solved for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct IndirectOptions {
    /// Patches along the longest side of the scene. Default: 32, for irradiance to about 1 % in rooms.
    pub patches_across: f64,
    /// Error of a link between two groups of patches, over what passes it, where scenes have more patches than `most_full`. Default: 0.01.
    pub tolerance: f64,
    /// Scenes of more patches are linked by groups. Default: 1000.
    pub most_full: usize,
}

impl IndirectOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self { patches_across: 32.0, tolerance: 0.01, most_full: 1000 };

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
    let mut patches = stage(monitor, "divide", || divided(&surfaces, options))?;
    go_on(monitor)?;
    let lamps = Lamps::new(scene);
    let direct = stage(monitor, "direct", || with_lamps(&lamps, |list| patches.direct(list)))?;
    go_on(monitor)?;
    let transport = stage(monitor, "factors", || patches.transport(&direct))?;
    go_on(monitor)?;
    let solution = stage(monitor, "solve", || transport.gauss_seidel(&SolveOptions::DEFAULT))?;
    let baked = stage(monitor, "gather", || solution.bake());
    monitor.count("patches", transport.patch_count() as u64);
    Ok(Lightmap::of_baked(&baked, &surfaces.faces, scene.mesh.triangles.len())?)
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
