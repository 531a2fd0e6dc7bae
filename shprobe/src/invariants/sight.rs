//! What probes see, and positions for them.

use super::check;
use crate::{DistanceMap, Field, Hint, place};
use glam::{DVec3, Vec3};

/// Offsets longer than this are not checked: sums of their coordinates leave the range of `f64`.
const LONGEST: f64 = 1e300;

/// Visibility is 0 to 1, 1 at the probe itself, and does not grow with the distance in one direction. Distances are
/// doubled, which leaves the direction the same to the bit.
///
/// # Errors
/// The first offset from the probe at which it does.
pub fn visibility_falls_with_distance(map: &DistanceMap, offsets: &[DVec3]) -> Result<(), String> {
    let at_probe = map.visibility(DVec3::ZERO);
    check(at_probe == 1.0, || format!("a probe sees {at_probe} of its own position"))?;
    let short = |o: &&DVec3| o.abs().cmple(DVec3::splat(LONGEST)).all();
    for &offset in offsets.iter().filter(short) {
        let (near, far) = (map.visibility(offset), map.visibility(offset * 2.0));
        check((0.0..=1.0).contains(&near) && (0.0..=near).contains(&far), || {
            format!("{near} is seen at {offset}, and {far} twice as far")
        })?;
    }
    Ok(())
}

/// [`place::spread`] chooses different finite candidates, as many as are asked for if there are so many positions, and
/// none left out is farther from those chosen than these are from one another (within 1e-12 of the distance).
///
/// # Errors
/// The candidates that are too close.
pub fn spread_positions_are_far_apart(candidates: &[DVec3], count: usize) -> Result<(), String> {
    let chosen = place::spread(candidates, count);
    let pairs = (0..chosen.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let between = |i: usize, j: usize| candidates[i].distance(candidates[j]);
    let apart = pairs.map(|(i, j)| between(chosen[i], chosen[j])).fold(f64::INFINITY, f64::min);
    check(apart > 0.0 && chosen.iter().all(|&i| candidates[i].is_finite()) && chosen.len() <= count, || {
        format!("{chosen:?} of {candidates:?} are {apart} apart")
    })?;
    let finite = (0..candidates.len()).filter(|&i| candidates[i].is_finite());
    let left = finite.map(|i| chosen.iter().map(|&c| between(c, i)).fold(f64::INFINITY, f64::min));
    let farthest = left.fold(0.0, f64::max);
    // Fewer than were asked for are all that differ.
    let most = if chosen.len() < count { 0.0 } else { apart * (1.0 + 1e-12) };
    check(count == 0 || farthest <= most, || {
        format!("{farthest} from {chosen:?} lies a candidate, {apart} apart")
    })
}

/// No position, on no surface, is lit by more than [`Field::MOST_SHARES`] probes, however many there are.
///
/// # Errors
/// The first that is.
pub fn at_most_so_many_probes_light_a_position(field: &Field, positions: &[DVec3]) -> Result<(), String> {
    for &p in positions.iter().filter(|p| p.is_finite()) {
        for normal in [Vec3::ZERO, Vec3::Y] {
            let shares = field.surface_shares(p, normal, &mut Hint::default());
            let shares = shares.map_err(|error| error.to_string())?;
            check(shares.len() <= Field::MOST_SHARES, || format!("{} probes light {p}", shares.len()))?;
        }
    }
    Ok(())
}
