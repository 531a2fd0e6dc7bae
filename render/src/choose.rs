//! Which of many places should get a probe: those between which light is interpolated best.

use crate::ambient::Ambient;
use crate::capture::CaptureOptions;
use crate::error::RenderError;
use crate::fit_places::on_surfaces;
use crate::look::{LookOptions, Seen, buried_places, look_again, look_all};
use crate::monitor::{Monitor, stage};
use crate::prepared::Prepared;
use crate::solids::Solids;
use crate::unbaked::Unbaked;
use glam::DVec3;
use pointillist_sh::Sh;
use pointillist_shprobe::{DEFAULT_DISTANCE_SIZE, DistanceMap, Field, place};

/// How [`choose_places`] looks around, and when it has enough.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ChooseOptions {
    /// Pixels on a side of each of the six pictures. Default: 32.
    pub resolution: u32,
    /// Most places. Default: 96.
    pub max_count: usize,
    /// Relative RMS error of irradiance at the candidates that is small enough. Default: 0, which takes `max_count` places.
    pub max_error: f64,
    /// Whether candidates that see mostly backs of surfaces count like others. Default: they are left out.
    pub keep_buried: bool,
}

impl ChooseOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self { resolution: 32, max_count: 96, max_error: 0.0, keep_buried: false };

    /// Looks at pictures of this many pixels on a side.
    #[must_use]
    pub const fn with_resolution(mut self, resolution: u32) -> Self {
        self.resolution = resolution;
        self
    }

    /// Chooses at most so many places.
    #[must_use]
    pub const fn with_max_count(mut self, max_count: usize) -> Self {
        self.max_count = max_count;
        self
    }

    /// Ends at this relative RMS error of irradiance.
    #[must_use]
    pub const fn with_max_error(mut self, max_error: f64) -> Self {
        self.max_error = max_error;
        self
    }

    /// Keeps candidates that see mostly backs of surfaces, or leaves them out.
    #[must_use]
    pub const fn with_keep_buried(mut self, keep_buried: bool) -> Self {
        self.keep_buried = keep_buried;
        self
    }
}

impl Default for ChooseOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What [`choose_places`] gives.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chosen {
    /// The places: first candidates in their order, then those about openings.
    pub positions: Vec<DVec3>,
    /// Relative RMS error of irradiance over the candidates, if probes at these places light them.
    pub error: f64,
    /// Candidates that were left out because they see mostly backs of surfaces.
    pub buried: usize,
    /// Places that were tried: the other candidates, and more about openings between them.
    pub candidates: usize,
}

/// Further candidates in and about openings, a fifth of those that are given: light changes quickly there.
const MORE: usize = 5;

/// Places on surfaces at which light must be right, too, a third of the candidates.
const ON_SURFACES: usize = 3;

/// Of the random places among these.
const SEED: u64 = 2;

/// Chooses places for probes among candidates and about openings between them, by what is seen from each with light
/// reflected once: light is to be right there and on the surfaces around.
///
/// Time: some 18 pictures for each candidate, and [`place::adaptive`].
///
/// # Errors
/// [`RenderError`] if a candidate cannot be looked from, there is none, or the monitor cancels.
pub fn choose_places(
    prepared: &Prepared<'_>,
    candidates: &[DVec3],
    options: &ChooseOptions,
    monitor: &dyn Monitor,
) -> Result<Chosen, RenderError> {
    let capture = CaptureOptions { resolution: options.resolution, ..CaptureOptions::DEFAULT };
    let look = LookOptions { capture, order: 2, distances: DEFAULT_DISTANCE_SIZE };
    let (known, buried) = look_first(prepared, candidates, options, look, monitor)?;
    let (direct, distances) = split(&known.seen[..known.free]);
    let field = Field::new(&known.positions[..known.free], &direct)?.with_distances(distances)?;
    let again = || {
        look_again(
            prepared,
            &known.positions,
            look,
            Ambient::Probes(&field, &Unbaked::NONE),
            &known.seen,
            monitor,
        )
    };
    let (radiance, distances) = split(&stage(monitor, "look", again)?);
    let candidates = place::Candidates::new(&known.positions, &radiance)
        .with_distances(&distances)
        .with_normals(&known.normals);
    let limits =
        place::AdaptiveOptions::DEFAULT.with_max_count(options.max_count).with_max_error(options.max_error);
    let chosen = stage(monitor, "choose", || place::adaptive(candidates, &limits))?;
    let positions = chosen.chosen.iter().map(|&i| known.positions[i as usize]).collect();
    Ok(Chosen { positions, error: chosen.error, buried, candidates: known.free })
}

/// Places outside of walls, and what is seen from them under the lights alone.
#[derive(Default)]
struct Known {
    positions: Vec<DVec3>,
    /// Of the surface that each is on; 0 in free space.
    normals: Vec<DVec3>,
    seen: Vec<Seen>,
    /// How many are in free space: the first ones.
    free: usize,
}

impl Known {
    fn push(&mut self, position: DVec3, normal: DVec3, seen: Seen) {
        self.free += usize::from(normal == DVec3::ZERO);
        self.positions.push(position);
        self.normals.push(normal);
        self.seen.push(seen);
    }
}

/// Looks from the candidates, from more about openings between them, and from surfaces; returns also how many of the
/// candidates are in walls.
fn look_first(
    prepared: &Prepared<'_>,
    candidates: &[DVec3],
    options: &ChooseOptions,
    look: LookOptions,
    monitor: &dyn Monitor,
) -> Result<(Known, usize), RenderError> {
    // What surfaces emit is reflected by others, but as in `bake_probes` probes need not hold it.
    let look = LookOptions { capture: CaptureOptions { emission: true, ..look.capture }, ..look };
    let (more, on_surfaces) = (candidates.len() / MORE, candidates.len() / ON_SURFACES);
    let all = candidates.len() + more + on_surfaces;
    monitor.begin(2 * all as u64);
    let look_from = |from: &[DVec3]| {
        stage(monitor, "look", || look_all(prepared, from, look, prepared.ambient(), monitor))
    };
    let mut known = Known::default();
    let seen = look_from(candidates)?;
    let in_space = vec![DVec3::ZERO; candidates.len()];
    let out = if options.keep_buried { vec![false; seen.len()] } else { buried_places(&seen, &in_space) };
    for ((&p, seen), _) in candidates.iter().zip(seen).zip(&out).filter(|(_, out)| !**out) {
        known.push(p, DVec3::ZERO, seen);
    }
    let buried = candidates.len() - known.free;
    let mut looks = candidates.len();
    if known.free > 0 {
        let (_, distances) = split(&known.seen);
        let solids = Solids::new(prepared);
        let mut places = place::near_openings(&known.positions, &distances, more, SEED)?;
        places.retain(|&p| solids.is_free(p));
        let surfaces = self::on_surfaces(candidates, on_surfaces, prepared, &solids);
        let mut normals = vec![DVec3::ZERO; places.len()];
        places.extend(surfaces.iter().map(|s| s.0));
        normals.extend(surfaces.iter().map(|s| s.1));
        looks += places.len();
        let seen = look_from(&places)?;
        let out = buried_places(&seen, &normals);
        (0..places.len()).zip(seen).filter(|(i, _)| !out[*i]).for_each(|(i, seen)| {
            known.push(places[i], normals[i], seen);
        });
    }
    // Looks that were announced and are not needed, in this round and the next.
    monitor.advance((2 * all - looks - known.positions.len()) as u64);
    Ok((known, buried))
}

fn split(seen: &[Seen]) -> (Vec<Sh>, Vec<DistanceMap>) {
    seen.iter().filter_map(|s| s.distances.clone().map(|d| (s.radiance.clone(), d))).unzip()
}
