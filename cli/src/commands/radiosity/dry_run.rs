//! `radiosity --dry-run`: what baking is expected to take.
//!
//! The scene is loaded, which is measured. Then light is solved for in ever larger parts of the problem, until that takes a second: with patches that are 8, 4
//! and 2 times as long, and with rays an error of light as many times as large; or, where surfaces are too small to have fewer patches, among one of 16, 8 and 4
//! surfaces. Time and memory are taken to be a power of the number of patches, the one that the last two parts show.

use super::bake::{Bake, MOST_FULL};
use super::by_rays;
use crate::error::CliError;
use crate::job::{Expected, Progress, ProgressMode};
use crate::memory;
use crate::options::{FormFactorKind, LinkKind, RadiosityBakeOptions};
use crate::scene::weight;
use pointillist_render::SceneSurfaces;
use std::ops::RangeInclusive;
use std::time::Instant;

/// How many times longer patches are in the trials, one after the other.
const COARSENINGS: [f64; 3] = [8.0, 4.0, 2.0];
/// One of how many surfaces there is in the trials where that leaves about as many patches.
const STRIDES: [usize; 3] = [16, 8, 4];
/// Longer patches must be fewer by this factor, of the 64 that patches of 8 times the length can be.
const FEWER: usize = 8;
/// A trial that took so long is the last.
const PATIENCE_S: f64 = 1.0;
/// Processor time that is too short to say how it grows, and memory.
const LEAST_S: f64 = 0.02;
const LEAST_BYTES: f64 = 1e6;
/// Powers of the number of patches that are possible: groups of patches need fewer links than there are patches, single patches as many as pairs, of
/// which each has the more in between the more surfaces there are.
const POWERS: RangeInclusive<f64> = 0.5..=2.5;
/// The same by rays, where a patch has at most so many links: halls of more and more columns took powers of 0.3 to 0.9 (`studies/results/radiosity.md`,
/// "Cost against the number of surfaces").
const POWERS_OF_RAYS: RangeInclusive<f64> = 0.5..=1.0;

/// What solving for light with some length of patches took.
struct Trial {
    wall_s: f64,
    cpu_s: f64,
    /// Memory at the peak, of the whole program so far.
    peak_bytes: u64,
    patches: usize,
}

pub(super) fn expect(bake: &Bake<'_>) -> Result<Expected, CliError> {
    let stats = &bake.report.stats;
    let threads = bake.report.threads();
    let mut expected = Expected { threads, heavy: weight::heavy(bake.scene), ..Expected::default() };
    expected.add("load", stats.elapsed().as_secs_f64(), stats.cpu_elapsed());
    let loaded = memory::peak_bytes();
    let patches = patch_count(bake)?;
    let coarse = |times: f64| with_longer_patches(bake, times, patches);
    let mut trials: Vec<Trial> = vec![];
    let is_coarser = {
        let options = coarse(COARSENINGS[0]);
        patch_count(&Bake { options: &options, ..*bake })? * FEWER <= patches
    };
    for step in 0..COARSENINGS.len() {
        let trial = if is_coarser {
            let options = coarse(COARSENINGS[step]);
            trial(&Bake { options: &options, ..*bake })?
        } else {
            let (options, surfaces) = (coarse(1.0), some_surfaces(bake, STRIDES[step]));
            trial(&Bake { options: &options, surfaces: &surfaces, ..*bake })?
        };
        let is_last = trial.wall_s > PATIENCE_S;
        trials.push(trial);
        if is_last {
            break;
        }
    }
    let last = &trials[trials.len() - 1];
    let before = trials.len().checked_sub(2).map(|i| &trials[i]);
    let powers = if bake.by_rays() { POWERS_OF_RAYS } else { POWERS };
    let middle = 0.5 * (powers.start() + powers.end());
    let power = |of: &dyn Fn(&Trial) -> f64, least: f64| match before {
        Some(before) if of(before) > least && last.patches > before.patches => {
            let growth = (of(last) / of(before)).ln() / (last.patches as f64 / before.patches as f64).ln();
            growth.clamp(*powers.start(), *powers.end())
        }
        _ => middle,
    };
    let scale = (patches as f64 / last.patches.max(1) as f64).max(1.0);
    let scaled = |of: &dyn Fn(&Trial) -> f64, least: f64| of(last) * scale.powf(power(of, least));
    let cpu = scaled(&|t| t.cpu_s, LEAST_S);
    // Parts that run on one thread keep their share.
    let parallel = (last.cpu_s / last.wall_s.max(1e-9)).clamp(1.0, threads as f64);
    expected.add("light", cpu / parallel, cpu);
    let grown = |t: &Trial| t.peak_bytes.saturating_sub(loaded) as f64;
    expected.peak_bytes = loaded + scaled(&grown, LEAST_BYTES) as u64;
    let how = if is_coarser { "with longer patches" } else { "among some of the surfaces" };
    expected.basis = format!(
        "loading was measured; light was solved for {how}, {} of {patches} patches, and time grows as it did until there",
        last.patches
    );
    Ok(expected)
}

/// How many patches there are before light divides some of them further.
fn patch_count(bake: &Bake<'_>) -> Result<usize, CliError> {
    let scene = if bake.by_rays() { by_rays::divided(bake)? } else { bake.divided()? };
    Ok(scene.patch_count())
}

/// Options with patches that are so many times as long.
fn with_longer_patches(bake: &Bake<'_>, times: f64, patches: usize) -> RadiosityBakeOptions {
    let own = bake.options;
    RadiosityBakeOptions {
        patch: Some(times * bake.patch()),
        adaptive: own.adaptive.map(|adaptive| times * adaptive),
        tolerance: if bake.by_rays() { Some(times * bake.ray_tolerance()) } else { own.tolerance },
        // A part of a large scene is solved as the whole is.
        links: match own.links {
            LinkKind::Auto if bake.by_rays() => LinkKind::Rays,
            LinkKind::Auto if own.form_factor == FormFactorKind::Analytic && patches > MOST_FULL => {
                LinkKind::Hierarchical
            }
            links => links,
        },
        ..own.clone()
    }
}

/// One of so many surfaces.
fn some_surfaces(bake: &Bake<'_>, stride: usize) -> SceneSurfaces {
    let mut some = bake.surfaces.clone();
    some.surfaces = some.surfaces.into_iter().step_by(stride).collect();
    some.faces = some.faces.into_iter().step_by(stride).collect();
    some
}

/// Solves for light and forgets it.
fn trial(bake: &Bake<'_>) -> Result<Trial, CliError> {
    let progress = Progress::new(ProgressMode::Off);
    let (start, cpu_start) = (Instant::now(), bake.report.stats.cpu_elapsed());
    let patches = if bake.by_rays() {
        by_rays::trial(bake, &progress)?;
        patch_count(bake)?
    } else {
        let transport = bake.link(&progress)?;
        let _ = bake.solve(&transport, &progress)?.bake_with(&|_| ());
        transport.patch_count()
    };
    Ok(Trial {
        wall_s: start.elapsed().as_secs_f64(),
        cpu_s: bake.report.stats.cpu_elapsed() - cpu_start,
        peak_bytes: memory::peak_bytes(),
        patches,
    })
}
