//! Looking around from probes, and again in the light of what they saw.

use super::failed;
use super::solids::Solids;
use crate::commands::Report;
use crate::error::CliError;
use crate::job::{Progress, Watch};
use crate::options::{BakeOptions, Inside, What};
use crate::scene::Scene;
use glam::{DVec3, Vec3};
use pointillist_render::{
    Ambient, CaptureOptions, LookOptions, Prepared, Seen, buried, look_again, look_all,
};
use pointillist_sh::Sh;
use pointillist_shprobe::{DistanceMap, Field, ProbeError, place};

/// Pixels on a side that are enough for light on its way: what is seen at places to which probes are fitted, and what bounces. Coverage is exact at
/// any number of pixels; at 32 the harmonics of a face are known to about 1e-3.
const ENOUGH: u32 = 32;

/// All that looking around needs.
pub(super) struct Rounds<'a> {
    prepared: &'a Prepared<'a>,
    scene: &'a Scene,
    options: &'a BakeOptions,
    report: &'a Report<'a>,
    /// Where probes are, and after them other places whose light the probes are fitted to.
    places: Vec<DVec3>,
    probes: usize,
    progress: Progress,
}

/// A probe, done.
pub(super) struct Lit {
    pub(super) seen: Seen,
    /// It lies inside of a wall.
    pub(super) buried: bool,
}

impl<'a> Rounds<'a> {
    pub(super) fn new(
        prepared: &'a Prepared<'a>,
        scene: &'a Scene,
        options: &'a BakeOptions,
        report: &'a Report<'a>,
        probes: &[DVec3],
        solids: &Solids<'_>,
    ) -> Self {
        let more = between(probes, options.fit as usize, solids);
        let places = probes.iter().copied().chain(more).collect();
        let progress = report.progress();
        Self { prepared, scene, options, report, places, probes: probes.len(), progress }
    }

    /// Looks around, lights surfaces by what was seen, and looks again.
    ///
    /// What lights surfaces holds all light. In the end the light of the last bounce is looked at once more by the probes, if that shows
    /// something else: with all pixels, and without glowing surfaces if these are to be left out.
    pub(super) fn run(&self) -> Result<Vec<Lit>, CliError> {
        let Self { options, report, .. } = self;
        let bounces = if self.probes == 0 { 0 } else { options.bounces };
        let glows = self.scene.materials.iter().any(|m| m.surface.emission != Vec3::ZERO);
        let wanted = options.what == What::Total || !glows;
        let more = bounces > 0 && (!wanted || self.pixels(ENOUGH) < options.resolution);
        let looks = (bounces as usize + 1 + usize::from(more)) * self.places.len();
        self.progress.begin("bake", looks as u64);
        let mut seen = self.look(wanted || bounces > 0)?;
        for bounce in 1..=bounces {
            let field = self.field(&seen)?;
            let next = self.look_again(&field, true, ENOUGH, &seen)?;
            let change = change(&seen, &next);
            report.detail(&format!("bounce {bounce}: light changed by {:.2} %", change * 100.0));
            seen = next;
            if change < options.until || bounce == bounces {
                if more {
                    seen = self.look_again(&field, wanted, u32::MAX, &seen)?;
                }
                break;
            }
        }
        let lit = self.lit(seen);
        self.progress.finish();
        lit
    }

    /// The first look: the probes with all pixels, places between them with [`ENOUGH`].
    fn look(&self, emission: bool) -> Result<Vec<Seen>, CliError> {
        let (probes, between) = self.places.split_at(self.probes);
        let ambient = self.prepared.ambient();
        let stats = &self.report.stats;
        let all = |places: &[DVec3], most: u32| {
            look_all(self.prepared, places, self.options_of(emission, most), ambient, &self.watch())
        };
        stats
            .stage("bake", || {
                let mut seen = all(probes, u32::MAX)?;
                seen.extend(all(between, ENOUGH)?);
                Ok(seen)
            })
            .map_err(failed)
    }

    /// A further look, in the light of probes; those see at most `most` pixels on a side.
    fn look_again(
        &self,
        field: &Field,
        emission: bool,
        most: u32,
        before: &[Seen],
    ) -> Result<Vec<Seen>, CliError> {
        let (probes, between) = self.places.split_at(self.probes);
        let (first, rest) = before.split_at(self.probes);
        let ambient = Ambient::Probes(field);
        let stats = &self.report.stats;
        let again = |places: &[DVec3], most: u32, before: &[Seen]| {
            let options = self.options_of(emission, most);
            look_again(self.prepared, places, options, ambient, before, &self.watch())
        };
        stats
            .stage("bake", || {
                let mut seen = again(probes, most, first)?;
                seen.extend(again(between, ENOUGH, rest)?);
                Ok(seen)
            })
            .map_err(failed)
    }

    fn watch(&self) -> Watch<'_> {
        Watch { task: "bake", progress: &self.progress, stats: &self.report.stats }
    }

    /// Pixels on a side where `most` are enough.
    fn pixels(&self, most: u32) -> u32 {
        if self.options.thorough { self.options.resolution } else { self.options.resolution.min(most) }
    }

    fn options_of(&self, emission: bool, most: u32) -> LookOptions {
        let Self { options, .. } = self;
        let resolution = self.pixels(most);
        let capture = CaptureOptions { resolution, emission, lights: true, thorough: options.thorough };
        LookOptions { capture, order: options.order.into(), distances: options.distances as usize }
    }

    /// The light of the bounce before.
    fn field(&self, seen: &[Seen]) -> Result<Field, CliError> {
        let Known { places, distances, probes, .. } = self.known(seen);
        let radiance = self.radiance(seen)?;
        let field = Field::new(&places[..probes], &radiance).map_err(broken)?;
        match distances {
            Some(mut maps) => {
                maps.truncate(probes);
                field.with_distances(maps).map_err(broken)
            }
            None => Ok(field),
        }
    }

    /// What the probes hold that do not lie inside of walls.
    fn radiance(&self, seen: &[Seen]) -> Result<Vec<Sh>, CliError> {
        let Known { places, radiance, distances, probes } = self.known(seen);
        if places.len() == probes || probes == 0 {
            return Ok(radiance);
        }
        let mut candidates = place::Candidates::new(&places, &radiance);
        candidates.distances = distances.as_deref();
        let chosen: Vec<u32> = (0..probes as u32).collect();
        let stats = &self.report.stats;
        let fit = || place::fit(candidates, &chosen, &place::FitOptions::DEFAULT.with_balance(0.0));
        stats.stage("fit", fit).map_err(broken)
    }

    fn lit(&self, seen: Vec<Seen>) -> Result<Vec<Lit>, CliError> {
        let mut held = self.radiance(&seen)?.into_iter();
        let buried = self.buried(&seen);
        let one = |(mut seen, buried): (Seen, bool)| {
            if let Some(radiance) = if buried { None } else { held.next() } {
                seen.radiance = radiance;
            }
            if self.options.dering {
                seen.radiance = seen.radiance.deringed();
            }
            Lit { seen, buried }
        };
        Ok(seen.into_iter().zip(buried).take(self.probes).map(one).collect())
    }

    /// Places outside of walls with what is seen there, those of probes first.
    fn known(&self, seen: &[Seen]) -> Known {
        let out = self.buried(seen);
        let free: Vec<usize> = (0..seen.len()).filter(|&i| !out[i]).collect();
        Known {
            places: free.iter().map(|&i| self.places[i]).collect(),
            radiance: free.iter().map(|&i| seen[i].radiance.clone()).collect(),
            distances: free.iter().map(|&i| seen[i].distances.clone()).collect(),
            probes: free.iter().filter(|&&i| i < self.probes).count(),
        }
    }

    fn buried(&self, seen: &[Seen]) -> Vec<bool> {
        if self.options.inside == Inside::Keep { vec![false; seen.len()] } else { buried(seen) }
    }
}

/// What is known of the light.
struct Known {
    places: Vec<DVec3>,
    radiance: Vec<Sh>,
    distances: Option<Vec<DistanceMap>>,
    /// How many of the places are those of probes.
    probes: usize,
}

/// Tries for each place that is wanted: most may be in solids.
const TRIES: usize = 8;
const SEED: u64 = 1;

/// Free places anywhere in the box that the probes span.
fn between(probes: &[DVec3], count: usize, solids: &Solids<'_>) -> Vec<DVec3> {
    let infinite = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = probes.iter().fold(infinite, |(l, h), &p| (l.min(p), h.max(p)));
    if probes.is_empty() || count == 0 {
        return vec![];
    }
    let tries = place::random(low, high, count.saturating_mul(TRIES), SEED);
    tries.into_iter().filter(|&p| solids.is_free(p)).take(count).collect()
}

fn broken(error: ProbeError) -> CliError {
    CliError::Failed(error.to_string())
}

/// How much the mean light of probes changed, over the light there is.
fn change(before: &[Seen], after: &[Seen]) -> f64 {
    let mean = |s: &Seen| s.radiance.coefficients()[0];
    let difference: f64 =
        before.iter().zip(after).map(|(a, b)| (mean(a) - mean(b)).abs().element_sum()).sum();
    let light: f64 = after.iter().map(|s| mean(s).abs().element_sum()).sum();
    if light > 0.0 { difference / light } else { 0.0 }
}
