//! Light probes for a scene: what they see, with light sent on from surface to surface.
//!
//! 1. Probes, and further places if probes are to be fitted to them, look around.
//! 2. For each bounce: what was seen makes a field of probes, and all look around again in its light. Only light that does not come
//!    straight from lights is looked at again ([`look_again`]).
//! 3. In the end the probes look once more at the light of the last bounce if that shows something else: with more pixels, or without
//!    glowing surfaces.

use crate::ambient::Ambient;
use crate::bake_options::BakeOptions;
use crate::capture::CaptureOptions;
use crate::error::RenderError;
use crate::fit_places::fit_places;
use crate::look::{LookOptions, Seen, buried_places, look_again, look_all};
use crate::monitor::{Monitor, stage};
use crate::prepared::Prepared;
use crate::solids::Solids;
use crate::unbaked::Unbaked;
use glam::{DVec3, Vec3};
use pointillist_sh::Sh;
use pointillist_shprobe::{DistanceMap, Field, place};

/// A probe, baked.
#[derive(Clone, Debug)]
pub struct BakedProbe {
    /// What it sees; its radiance is what it is to hold.
    pub seen: Seen,
    /// Whether it lies inside of a wall, and is to light nothing.
    pub buried: bool,
}

/// What [`bake_probes`] gives.
#[derive(Clone, Debug, Default)]
pub struct ProbeBake {
    /// One for each position.
    pub probes: Vec<BakedProbe>,
    /// How much the mean light of all places changed at each bounce, over the light there is.
    pub changes: Vec<f64>,
}

/// Pixels on a side that are enough for light on its way: what is seen at places to which probes are fitted, and what bounces. Coverage is
/// exact at any number of pixels; at 32 the harmonics of a face are known to about 1e-3.
const ENOUGH: u32 = 32;

/// Bakes probes at these positions, on all cores. Does not depend on threads.
///
/// Time: six pictures for each place and bounce, of which shadows are most in the first round.
///
/// # Errors
/// [`RenderError`] if a position cannot be looked from, the order is beyond [`pointillist_sh::MAX_ORDER`], or the monitor cancels.
pub fn bake_probes(
    prepared: &Prepared<'_>,
    solids: &Solids<'_>,
    positions: &[DVec3],
    options: &BakeOptions,
    monitor: &dyn Monitor,
) -> Result<ProbeBake, RenderError> {
    bake_probes_in(prepared, solids, positions, prepared.ambient(), options, monitor)
}

/// As [`bake_probes`], with surfaces lit by `ambient` in the place of the scene's ambient light: by light between surfaces that is known
/// already ([`Ambient::Radiosity`], see [`solve_indirect`](crate::solve_indirect)), with no bounces in the options. Bounces that are asked
/// for begin with what surfaces show in that light, and replace it.
///
/// # Errors
/// As [`bake_probes`].
pub fn bake_probes_in(
    prepared: &Prepared<'_>,
    solids: &Solids<'_>,
    positions: &[DVec3],
    ambient: Ambient<'_>,
    options: &BakeOptions,
    monitor: &dyn Monitor,
) -> Result<ProbeBake, RenderError> {
    let more = fit_places(positions, options.fit, prepared, solids);
    let places = positions.iter().copied().chain(more.positions).collect();
    let normals = positions.iter().map(|_| DVec3::ZERO).chain(more.normals).collect();
    Rounds { prepared, options, ambient, monitor, places, normals, probes: positions.len() }.run()
}

/// All that looking around needs.
struct Rounds<'a> {
    prepared: &'a Prepared<'a>,
    options: &'a BakeOptions,
    /// What lights surfaces, beside lights, before the first bounce.
    ambient: Ambient<'a>,
    monitor: &'a dyn Monitor,
    /// Where probes are, and after them other places whose light the probes are fitted to.
    places: Vec<DVec3>,
    /// The normal of the surface that each place is on; 0 in free space.
    normals: Vec<DVec3>,
    probes: usize,
}

impl Rounds<'_> {
    fn run(&self) -> Result<ProbeBake, RenderError> {
        let options = self.options;
        let bounces = if self.probes == 0 { 0 } else { options.bounces };
        let glows = self.prepared.scene.materials.iter().any(|m| m.surface.emission != Vec3::ZERO);
        let wanted = options.emission || !glows;
        // Bounced light is smooth: half of the pixels on a side show it to the error of all.
        let last = (options.resolution / 2).max(ENOUGH);
        let more = bounces > 0 && (!wanted || self.pixels(ENOUGH) < self.pixels(last));
        let looks = (bounces as usize + 1 + usize::from(more)) * self.places.len();
        self.monitor.begin(looks as u64);
        let mut seen = self.look(wanted || bounces > 0)?;
        let mut changes = vec![];
        for bounce in 1..=bounces {
            if self.known(&seen).probes == 0 {
                // No probe sends light on.
                self.skip_rounds(bounces - bounce + 1 + u32::from(more));
                break;
            }
            let field = self.field(&seen)?;
            if bounce == bounces && wanted {
                // What is seen now is held.
                let next = self.look_again(&field, true, last, &seen)?;
                changes.push(change(&seen, &next));
                self.skip_rounds(u32::from(more));
                seen = next;
                break;
            }
            let next = self.look_again(&field, true, ENOUGH, &seen)?;
            let change = change(&seen, &next);
            changes.push(change);
            seen = next;
            if change < options.until || bounce == bounces {
                self.skip_rounds(bounces - bounce);
                if more {
                    seen = self.look_again(&field, wanted, last, &seen)?;
                }
                break;
            }
        }
        Ok(ProbeBake { probes: self.baked(seen)?, changes })
    }

    /// So many rounds that were announced are not needed.
    fn skip_rounds(&self, rounds: u32) {
        self.monitor.advance(u64::from(rounds) * self.places.len() as u64);
    }

    /// The first look: the probes with all pixels, places between them with [`ENOUGH`].
    fn look(&self, emission: bool) -> Result<Vec<Seen>, RenderError> {
        let (probes, between) = self.places.split_at(self.probes);
        let all = |places: &[DVec3], most: u32| {
            look_all(self.prepared, places, self.options_of(emission, most), self.ambient, self.monitor)
        };
        stage(self.monitor, "bake", || {
            let mut seen = all(probes, u32::MAX)?;
            seen.extend(all(between, ENOUGH)?);
            Ok(seen)
        })
    }

    /// A further look, in the light of probes; those see at most `most` pixels on a side.
    fn look_again(
        &self,
        field: &Field,
        emission: bool,
        most: u32,
        before: &[Seen],
    ) -> Result<Vec<Seen>, RenderError> {
        let (probes, between) = self.places.split_at(self.probes);
        let (first, rest) = before.split_at(self.probes);
        let ambient = Ambient::Probes(field, &Unbaked::NONE);
        let again = |places: &[DVec3], most: u32, before: &[Seen]| {
            let options = self.options_of(emission, most);
            look_again(self.prepared, places, options, ambient, before, self.monitor)
        };
        stage(self.monitor, "bake", || {
            let mut seen = again(probes, most, first)?;
            seen.extend(again(between, ENOUGH, rest)?);
            Ok(seen)
        })
    }

    /// Pixels on a side where `most` are enough.
    fn pixels(&self, most: u32) -> u32 {
        if self.options.thorough { self.options.resolution } else { self.options.resolution.min(most) }
    }

    fn options_of(&self, emission: bool, most: u32) -> LookOptions {
        let BakeOptions { order, distances, thorough, depths, .. } = *self.options;
        let capture =
            CaptureOptions { resolution: self.pixels(most), emission, lights: true, thorough, depths };
        LookOptions { capture, order, distances }
    }

    /// The light of the bounce before.
    fn field(&self, seen: &[Seen]) -> Result<Field, RenderError> {
        let Known { places, sky, distances, probes, .. } = self.known(seen);
        let radiance = self.radiance(seen)?;
        let field = Field::new(&places[..probes], &radiance)?.with_sky(&sky[..probes])?;
        Ok(match distances {
            Some(mut maps) => {
                maps.truncate(probes);
                field.with_distances(maps)?
            }
            None => field,
        })
    }

    /// What the probes hold that do not lie inside of walls.
    fn radiance(&self, seen: &[Seen]) -> Result<Vec<Sh>, RenderError> {
        let Known { places, normals, radiance, distances, probes, .. } = self.known(seen);
        if places.len() == probes || probes == 0 {
            return Ok(radiance);
        }
        let mut candidates = place::Candidates::new(&places, &radiance).with_normals(&normals);
        candidates.distances = distances.as_deref();
        let chosen: Vec<u32> = (0..probes as u32).collect();
        let fit = || place::fit(candidates, &chosen, &place::FitOptions::DEFAULT);
        Ok(stage(self.monitor, "fit", fit)?)
    }

    fn baked(&self, seen: Vec<Seen>) -> Result<Vec<BakedProbe>, RenderError> {
        let mut held = self.radiance(&seen)?.into_iter();
        let buried = self.buried(&seen);
        let one = |(mut seen, buried): (Seen, bool)| {
            if let Some(radiance) = if buried { None } else { held.next() } {
                seen.radiance = radiance;
            }
            if self.options.dering {
                seen.radiance = seen.radiance.deringed();
            }
            BakedProbe { seen, buried }
        };
        Ok(seen.into_iter().zip(buried).take(self.probes).map(one).collect())
    }

    /// Places outside of walls with what is seen there, those of probes first.
    fn known(&self, seen: &[Seen]) -> Known {
        let out = self.buried(seen);
        let free: Vec<usize> = (0..seen.len()).filter(|&i| !out[i]).collect();
        Known {
            places: free.iter().map(|&i| self.places[i]).collect(),
            normals: free.iter().map(|&i| self.normals[i]).collect(),
            radiance: free.iter().map(|&i| seen[i].radiance.clone()).collect(),
            sky: free.iter().map(|&i| seen[i].sky.clone()).collect(),
            distances: free.iter().map(|&i| seen[i].distances.clone()).collect(),
            probes: free.iter().filter(|&&i| i < self.probes).count(),
        }
    }

    fn buried(&self, seen: &[Seen]) -> Vec<bool> {
        if self.options.keep_buried { vec![false; seen.len()] } else { buried_places(seen, &self.normals) }
    }
}

/// What is known of the light.
struct Known {
    places: Vec<DVec3>,
    normals: Vec<DVec3>,
    radiance: Vec<Sh>,
    sky: Vec<Sh<f64>>,
    distances: Option<Vec<DistanceMap>>,
    /// How many of the places are those of probes.
    probes: usize,
}

/// How much the mean light of places changed, over the light there is.
fn change(before: &[Seen], after: &[Seen]) -> f64 {
    let mean = |s: &Seen| s.radiance.coefficients()[0];
    let difference: f64 =
        before.iter().zip(after).map(|(a, b)| (mean(a) - mean(b)).abs().element_sum()).sum();
    let light: f64 = after.iter().map(|s| mean(s).abs().element_sum()).sum();
    if light > 0.0 { difference / light } else { 0.0 }
}
