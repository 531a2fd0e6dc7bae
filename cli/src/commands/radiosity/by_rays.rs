//! `radiosity SCENE` for buildings: links are found by rays.

use super::bake::{Bake, FactorVisitor, Found, PROGRESS_STEPS};
use crate::error::CliError;
use crate::job::Progress;
use pointillist_radiosity as radiosity;
use pointillist_radiosity::{RayOptions, RaySolution, RayTransport, SceneOptions, SolveOptions};
use pointillist_render::{Lamps, with_lamps};

/// `--adaptive`, as a share of a patch, unless said otherwise.
const FINEST: f64 = 1.0 / 8.0;
/// Shares of the time after which direct light, links and the solution are there, about.
const LIT: f64 = 0.1;
const LINKED: f64 = 0.2;
const SOLVED: f64 = 0.25;
/// Tolerance of the solver: far below the error of links.
const SOLVED_TO: f64 = 1e-4;

pub(super) fn run(bake: &Bake<'_>, progress: &Progress) -> Result<(), CliError> {
    let stats = &bake.report.stats;
    progress.begin("radiosity", PROGRESS_STEPS);
    let transport = link(bake, progress)?;
    let options = SolveOptions::DEFAULT.with_tolerance(SOLVED_TO);
    let solution = stats.stage("solve", || transport.solve(&options)).map_err(|e| bake.refused(&e))?;
    progress.reach(SOLVED);
    let done = |share| progress.reach(SOLVED + (1.0 - SOLVED) * share);
    let baked = stats.stage("gather", || solution.bake_with(&done));
    progress.finish();
    tell(bake, &transport, &solution);
    let factors = |f: &mut FactorVisitor<'_>| transport.factors(f);
    let patches = transport.counts().patches;
    bake.write(&Found { patches, bound: solution.bound, factors: &factors }, &baked)
}

/// Solves for light and forgets it.
pub(super) fn trial(bake: &Bake<'_>, progress: &Progress) -> Result<(), CliError> {
    let transport = link(bake, progress)?;
    let options = SolveOptions::DEFAULT.with_tolerance(SOLVED_TO);
    let _ = transport.solve(&options).map_err(|e| bake.refused(&e))?.bake_with(&|_| ());
    Ok(())
}

/// The patches, before light divides some of them further.
pub(super) fn divided(bake: &Bake<'_>) -> Result<radiosity::Scene, CliError> {
    let settings = SceneOptions::for_rays(bake.patch()).with_max_elements(bake.most_elements());
    radiosity::Scene::new(&bake.surfaces.surfaces, &settings).map_err(|e| bake.refused(&e))
}

fn link(bake: &Bake<'_>, progress: &Progress) -> Result<RayTransport, CliError> {
    let stats = &bake.report.stats;
    let mut scene = stats.stage("divide", || divided(bake))?;
    let lamps = Lamps::new(bake.scene);
    let lit = |share| progress.reach(LIT * share);
    let direct = stats.stage("direct", || with_lamps(&lamps, |list| scene.direct_with(list, &lit)));
    let direct = direct.map_err(|e| bake.refused(&e))?;
    progress.reach(LIT);
    let finest = bake.options.adaptive.unwrap_or(bake.patch() * FINEST);
    let options = RayOptions::DEFAULT.with_finest(finest).with_tolerance(bake.ray_tolerance());
    let done = |share| progress.reach(LIT + (LINKED - LIT) * share);
    let linked = stats.stage("factors", || scene.transport_by_rays(&direct, &options, &done));
    linked.map_err(|e| bake.refused(&e))
}

fn tell(bake: &Bake<'_>, transport: &RayTransport, solution: &RaySolution<'_>) {
    let (stats, counts) = (&bake.report.stats, transport.counts());
    stats.count("surfaces", bake.surfaces.surfaces.len() as u64);
    stats.count("patches", counts.patches as u64);
    stats.count("links", counts.links as u64);
    stats.count("steps", solution.steps as u64);
    stats.skip("rays_lost", counts.lost as u64);
    stats.skip("surfaces_without_area", transport.scene().dropped() as u64);
    stats.skip("triangles_translucent", bake.surfaces.translucent as u64);
    stats.figure("error_bound", solution.bound);
    stats.figure("contraction", solution.contraction);
    bake.report.note(&format!(
        "{} patches, {} links by rays, solved in {} steps to within {:.2e}, for these links",
        counts.patches, counts.links, solution.steps, solution.bound
    ));
    if !solution.converged {
        bake.report.warn("the solution has not reached its tolerance; the bound above says how far it is");
    }
}
