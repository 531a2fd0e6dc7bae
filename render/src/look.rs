//! What probes see, as spherical harmonics.

use crate::ambient::Ambient;
use crate::capture::{Capture, CaptureOptions};
use crate::error::RenderError;
use crate::fingerprint::ByteHash;
use crate::monitor::{Monitor, go_on};
use crate::prepared::Prepared;
use glam::DVec3;
use pointillist_parallel as parallel;
use pointillist_sh::{CubeMap, CubeProjector, Sh, Weights};
use pointillist_shprobe::{DistanceMap, ProbeError};

/// How probes look around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookOptions {
    /// The six pictures.
    pub capture: CaptureOptions,
    /// Highest band of the harmonics. Default: 2.
    pub order: usize,
    /// Texels on a side of maps of distances; 0 for none. Default: none.
    pub distances: usize,
}

impl LookOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self { capture: CaptureOptions::DEFAULT, order: 2, distances: 0 };
}

impl Default for LookOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Probes that see backs of surfaces in more than this share of all directions lie inside of walls.
const BURIED: f64 = 0.5;

/// Which probes lie inside of walls, by the share of all directions in which each sees backs of surfaces ([`Seen::back_share`]).
///
/// If more than half of them would, none does: the scene's surfaces are then turned the wrong way. The answer for one probe therefore
/// depends on the others; ask for all probes of a field at once.
#[must_use]
pub fn buried(back_shares: &[f64]) -> Vec<bool> {
    let buried: Vec<bool> = back_shares.iter().map(|&share| share > BURIED).collect();
    let count = buried.iter().filter(|&&b| b).count();
    if 2 * count > buried.len() { vec![false; buried.len()] } else { buried }
}

/// The same of places of which some are on surfaces, with a normal that is not 0: in half of all directions those see the front of their own.
pub(crate) fn buried_places(seen: &[Seen], normals: &[DVec3]) -> Vec<bool> {
    let above = |(seen, normal): (&Seen, &DVec3)| {
        let share_above = if *normal == DVec3::ZERO { 1.0 } else { 0.5 };
        seen.back_share / share_above
    };
    buried(&seen.iter().zip(normals).map(above).collect::<Vec<_>>())
}

/// What a probe saw.
#[derive(Clone, Debug)]
pub struct Seen {
    /// What arrives.
    pub radiance: Sh,
    /// What of it surfaces reflect straight from the lights: the same whatever other light there is.
    pub direct: Sh,
    /// The share of sky.
    pub sky: Sh<f64>,
    /// The share of all directions in which the back of a surface is seen.
    pub back_share: f64,
    /// How far it sees.
    pub distances: Option<DistanceMap>,
}

/// Looks around from every position, on all cores.
///
/// # Errors
/// [`RenderError`] if a position cannot be looked from, what it sees is not finite, or the monitor cancels.
pub fn look_all(
    prepared: &Prepared<'_>,
    positions: &[DVec3],
    options: LookOptions,
    ambient: Ambient<'_>,
    monitor: &dyn Monitor,
) -> Result<Vec<Seen>, RenderError> {
    let size = options.capture.resolution as usize;
    let projector = CubeProjector::new(size, options.order, Weights::Gregory)?;
    let bounds = prepared.geometry().bounds();
    // An empty scene has no bounds: its diagonal is infinite.
    let far = ((bounds.high - bounds.low).length() * 2.0) as f32;
    let far = far.clamp(f32::MIN_POSITIVE, DistanceMap::FARTHEST);
    at_all(positions, monitor, |position| {
        let capture = prepared.capture(position, options.capture, ambient, monitor)?;
        monitor.count("faces", u64::from(6 - capture.empty_faces));
        monitor.skip("faces_empty", u64::from(capture.empty_faces));
        monitor.advance(1);
        Ok(seen(&capture, &projector, options.distances, far)?)
    })
}

/// Does something at every position, on all cores, until the monitor cancels.
fn at_all<T: Send>(
    positions: &[DVec3],
    monitor: &dyn Monitor,
    one: impl Fn(DVec3) -> Result<T, RenderError> + Sync,
) -> Result<Vec<T>, RenderError> {
    let unless_cancelled = |i: usize| go_on(monitor).and_then(|()| one(positions[i]));
    parallel::map_heavy(positions.len(), unless_cancelled).into_iter().collect()
}

/// Looks around again in other ambient light. Shadows are most of the time of a look, and are as they were `before`: only what does not come
/// straight from the lights is looked at.
///
/// # Errors
/// As [`look_all`].
pub fn look_again(
    prepared: &Prepared<'_>,
    positions: &[DVec3],
    options: LookOptions,
    ambient: Ambient<'_>,
    before: &[Seen],
    monitor: &dyn Monitor,
) -> Result<Vec<Seen>, RenderError> {
    let capture = CaptureOptions { lights: false, ..options.capture };
    let options = LookOptions { capture, distances: 0, ..options };
    let rest = look_all(prepared, positions, options, ambient, monitor)?;
    let sum = |(rest, before): (Seen, &Seen)| {
        let both =
            rest.radiance.coefficients().iter().zip(before.direct.coefficients()).map(|(a, b)| *a + *b);
        Ok(Seen { radiance: Sh::new(both.collect())?, ..before.clone() })
    };
    rest.into_iter().zip(before).map(sum).collect()
}

fn seen(
    capture: &Capture,
    projector: &CubeProjector,
    distances: usize,
    far: f32,
) -> Result<Seen, ProbeError> {
    let cube = CubeMap::from_planes(capture.size, capture.radiance.clone())?;
    let map = match distances {
        0 => None,
        size => Some(DistanceMap::from_cube(size, capture.size, &capture.distance, far)?),
    };
    Ok(Seen {
        radiance: projector.project(&cube)?,
        direct: projector.project(&CubeMap::from_planes(capture.size, capture.direct.clone())?)?,
        back_share: capture.back_share(),
        sky: projector.project_plane(&capture.sky)?,
        distances: map,
    })
}

/// Pixels on a side of the pictures that tell whether anything changed. Coverage is exact: whatever is seen leaves its mark in some
/// pixel, however small it is.
const WATCHED: u32 = 16;

/// A hash of everything that is seen from each position: surfaces and their sides, their light and their shadows, as `capture` has it
/// show them; its resolution is not used.
///
/// # Errors
/// As [`look_all`].
pub fn fingerprints(
    prepared: &Prepared<'_>,
    positions: &[DVec3],
    capture: CaptureOptions,
    ambient: Ambient<'_>,
    monitor: &dyn Monitor,
) -> Result<Vec<u64>, RenderError> {
    let options = CaptureOptions { resolution: WATCHED, ..capture };
    at_all(positions, monitor, |position| {
        let capture = prepared.capture(position, options, ambient, monitor)?;
        let mut hash = ByteHash::default();
        let planes = capture.radiance.iter().chain([&capture.sky, &capture.distance, &capture.back]);
        planes.flatten().for_each(|v| hash.write(&v.to_le_bytes()));
        Ok(hash.finish())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a wall, inside of another that stands before it, a place sees the front of the wall and nothing but backs.
    #[test]
    fn places_on_surfaces_are_buried_by_what_they_see_above_these() {
        let seen = |back_share| {
            let radiance = Sh::constant(DVec3::ZERO, 2).unwrap();
            let sky = Sh::constant(0.0, 2).unwrap();
            Seen { direct: radiance.clone(), radiance, sky, back_share, distances: None }
        };
        let seen = [seen(0.49), seen(0.49), seen(0.2), seen(0.6), seen(0.0)];
        let normals = [DVec3::X, DVec3::ZERO, DVec3::X, DVec3::ZERO, DVec3::X];
        assert_eq!(buried_places(&seen, &normals), [true, false, false, true, false]);
    }
}
