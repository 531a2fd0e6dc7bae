//! Which of many places should get a probe: those between which light is interpolated best.

use crate::ambient::Ambient;
use crate::capture::CaptureOptions;
use crate::error::RenderError;
use crate::look::{LookOptions, Seen, buried, look_again, look_all, shares_of};
use crate::monitor::{Monitor, stage};
use crate::prepared::Prepared;
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
    /// The places, in the order of the candidates.
    pub positions: Vec<DVec3>,
    /// Relative RMS error of irradiance over the candidates, if probes at these places light them.
    pub error: f64,
    /// Candidates that were left out because they see mostly backs of surfaces.
    pub buried: usize,
}

/// Chooses places for probes among candidates, by what is seen from each with light reflected once.
///
/// Time: twelve pictures for each candidate, and [`place::adaptive`].
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
    // What surfaces emit is reflected by others, but as in `bake_probes` probes need not hold it.
    let first = LookOptions { capture: CaptureOptions { emission: true, ..capture }, ..look };
    monitor.begin(2 * candidates.len() as u64);
    let seen = stage(monitor, "look", || look_all(prepared, candidates, first, prepared.ambient(), monitor))?;
    let out = if options.keep_buried { vec![false; seen.len()] } else { buried(&shares_of(&seen)) };
    let free: Vec<usize> = (0..seen.len()).filter(|&i| !out[i]).collect();
    let buried = seen.len() - free.len();
    monitor.advance(buried as u64);
    let candidates: Vec<DVec3> = free.iter().map(|&i| candidates[i]).collect();
    let seen: Vec<Seen> = free.iter().map(|&i| seen[i].clone()).collect();
    let (direct, distances) = split(&seen);
    let field = Field::new(&candidates, &direct)?.with_distances(distances)?;
    let again = || look_again(prepared, &candidates, look, Ambient::Probes(&field), &seen, monitor);
    let (radiance, distances) = split(&stage(monitor, "look", again)?);
    let known = place::Candidates::new(&candidates, &radiance).with_distances(&distances);
    let limits =
        place::AdaptiveOptions::DEFAULT.with_max_count(options.max_count).with_max_error(options.max_error);
    let chosen = stage(monitor, "choose", || place::adaptive(known, &limits))?;
    let positions = chosen.chosen.iter().map(|&i| candidates[i as usize]).collect();
    Ok(Chosen { positions, error: chosen.error, buried })
}

fn split(seen: &[Seen]) -> (Vec<Sh>, Vec<DistanceMap>) {
    seen.iter().filter_map(|s| s.distances.clone().map(|d| (s.radiance.clone(), d))).unzip()
}
