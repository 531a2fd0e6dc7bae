//! Fields that change.

use super::check;
use crate::sh::Sh;
use crate::{DistanceMap, Field, Hint};
use glam::DVec3;

/// Two fields have the same probes, cells, coefficients and distances, and give every position the same shares, all bit
/// for bit.
///
/// # Errors
/// What differs.
pub fn fields_are_equal(a: &Field, b: &Field, queries: &[DVec3]) -> Result<(), String> {
    check(a.positions() == b.positions(), || "probes are at other positions".into())?;
    check(a.partition() == b.partition(), || {
        format!("cells are {:?} and {:?}", a.partition(), b.partition())
    })?;
    check(a.irradiance_coefficients() == b.irradiance_coefficients(), || "coefficients differ".into())?;
    check(a.distances() == b.distances(), || "distances differ".into())?;
    check(a.bias().to_bits() == b.bias().to_bits(), || format!("biases {} and {}", a.bias(), b.bias()))?;
    for &p in queries.iter().filter(|p| p.is_finite()) {
        let shares = |field: &Field| field.shares(p, &mut Hint::default()).map_err(|error| error.to_string());
        let (of_a, of_b) = (shares(a)?, shares(b)?);
        check(of_a == of_b, || format!("at {p} shares are {of_a:?} and {of_b:?}"))?;
    }
    Ok(())
}

/// Probes that are inserted and removed again leave the field as it was, bit for bit; so does an insertion that is
/// refused.
///
/// # Errors
/// What differs.
pub fn insert_then_remove_restores(
    field: &Field,
    positions: &[DVec3],
    radiance: &[Sh],
    distances: &[DistanceMap],
    queries: &[DVec3],
) -> Result<(), String> {
    let mut changed = field.clone();
    if let Ok(new) = changed.insert(positions, radiance, distances.to_vec()) {
        let before = field.probe_count();
        check(new == (before as u32..(before + positions.len()) as u32), || {
            format!("{} probes behind {before} are numbered {new:?}", positions.len())
        })?;
        let new: Vec<u32> = new.collect();
        let left = changed.remove(&new).map_err(|error| error.to_string())?;
        check(left.iter().copied().eq(0..before as u32), || format!("of {before} probes are left {left:?}"))?;
    }
    fields_are_equal(field, &changed, queries)
}

/// A field to which probes are added in two steps, and from which then some are removed, is the one made of the probes
/// that are left, bit for bit. `distances` are none, or one for each probe; entries of `gone` that are no probe are
/// passed over.
///
/// # Errors
/// What differs.
pub fn changes_give_the_field_of_the_result(
    positions: &[DVec3],
    radiance: &[Sh],
    distances: &[DistanceMap],
    gone: &[u32],
    queries: &[DVec3],
) -> Result<(), String> {
    let made = |indices: &[u32]| {
        let at: Vec<DVec3> = indices.iter().map(|&i| positions[i as usize]).collect();
        let held: Vec<Sh> = indices.iter().map(|&i| radiance[i as usize].clone()).collect();
        let field = Field::new(&at, &held).ok()?;
        match distances.is_empty() {
            true => Some(field),
            false => {
                field.with_distances(indices.iter().map(|&i| distances[i as usize].clone()).collect()).ok()
            }
        }
    };
    let count = positions.len();
    if radiance.len() != count || !(distances.is_empty() || distances.len() == count) || count == 0 {
        return Ok(());
    }
    let all: Vec<u32> = (0..count as u32).collect();
    let half = count.div_ceil(2);
    let (Some(whole), Some(mut grown)) = (made(&all), made(&all[..half])) else { return Ok(()) };
    let maps = distances.get(half..).unwrap_or_default().to_vec();
    grown.insert(&positions[half..], &radiance[half..], maps).map_err(|error| error.to_string())?;
    fields_are_equal(&grown, &whole, queries)?;

    let gone: Vec<u32> = gone.iter().copied().filter(|&i| (i as usize) < count).collect();
    let left: Vec<u32> = all.into_iter().filter(|i| !gone.contains(i)).collect();
    let Some(rest) = made(&left) else { return Ok(()) };
    let found = grown.remove(&gone).map_err(|error| error.to_string())?;
    check(found == left, || format!("{found:?} are left, not {left:?}"))?;
    fields_are_equal(&grown, &rest, queries)
}
