//! Shares, and the light that they add up to.

use super::check;
use crate::sh::Sh;
use crate::{DistanceMap, Field, Hint, LitObject};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// What may be missing from a sum of shares to 1: each of up to 64 is divided by their sum, and rounded.
const SUM_ERROR: f64 = 64.0 * f64::EPSILON;

/// Relative error of irradiance in a field of constant light: sums of up to 64 terms in single precision, each a
/// product of three rounded numbers, are off by less than 70 half ulps.
pub const CONSTANT_ERROR: f64 = 70.0 * 0.5 * f32::EPSILON as f64;

/// What such a sum is off by where its terms are below the normal numbers of `f32`.
const SUBNORMAL_ERROR: f64 = 1e-40;

/// The shares of every position name probes that exist, are above 0 and at most 1, and sum to 1 within 64 ulps.
///
/// # Errors
/// The first position at which they do not.
pub fn shares_sum_to_one(field: &Field, positions: &[DVec3]) -> Result<(), String> {
    for &p in positions.iter().filter(|p| p.is_finite()) {
        let shares = field.shares(p, &mut Hint::default()).map_err(|error| error.to_string())?;
        let good = |&(probe, share): &(u32, f64)| {
            (probe as usize) < field.probe_count() && share > 0.0 && share <= 1.0 + SUM_ERROR
        };
        let sum: f64 = shares.iter().map(|s| s.1).sum();
        check(shares.iter().all(good) && (sum - 1.0).abs() <= SUM_ERROR, || {
            format!("at {p} the shares are {shares:?}")
        })?;
    }
    Ok(())
}

/// Where all probes hold the same radiance from everywhere, `radiance` ≥ 0, irradiance is π times that at every
/// position and for every normal, within [`CONSTANT_ERROR`]; also for moving objects, and whatever probes see.
///
/// # Errors
/// The first position at which it is not.
pub fn constant_light_stays_constant(
    positions: &[DVec3],
    distances: Option<&[DistanceMap]>,
    radiance: f64,
    queries: &[DVec3],
) -> Result<(), String> {
    let Ok(sh) = Sh::constant(DVec3::splat(radiance), 2) else { return Ok(()) };
    let Ok(mut field) = Field::new(positions, &vec![sh; positions.len()]) else { return Ok(()) };
    if radiance < 0.0 {
        return Ok(());
    }
    if let Some(maps) = distances {
        let Ok(seen) = field.with_distances(maps.to_vec()) else { return Ok(()) };
        field = seen;
    }
    let wanted = PI * radiance;
    let most = CONSTANT_ERROR * wanted + SUBNORMAL_ERROR;
    for &p in queries.iter().filter(|p| p.is_finite()) {
        let mut objects = [LitObject::at(p)];
        field.light_objects(&mut objects).map_err(|error| error.to_string())?;
        for normal in [Vec3::X, Vec3::NEG_Y, Vec3::ONE.normalize()] {
            let on_surface = field.irradiance(p, Vec3::ZERO, normal, &mut Hint::default());
            let on_surface = on_surface.map_err(|error| error.to_string())?;
            for found in [on_surface, objects[0].light.at(normal)] {
                let error = (found.as_dvec3() - DVec3::splat(wanted)).abs().max_element();
                check(error <= most, || format!("at {p} irradiance is {found}, not {wanted}"))?;
            }
        }
    }
    Ok(())
}

/// Where a query starts decides only how long it takes: with the hint of any other position, one by one or many at
/// once, irradiance is the same within `tolerance` of the largest that a probe holds.
///
/// # Errors
/// The first position at which it is not.
pub fn hints_do_not_matter(field: &Field, positions: &[DVec3], tolerance: f32) -> Result<(), String> {
    let finite: Vec<DVec3> = positions.iter().copied().filter(|p| p.is_finite()).collect();
    let largest = field.irradiance_coefficients().iter().fold(0.0_f32, |m, c| m.max(c.abs().max_element()));
    let normal = Vec3::Y;
    let queries: Vec<_> = finite.iter().map(|&p| (p, normal)).collect();
    let all = field.irradiance_all(&queries).map_err(|error| error.to_string())?;
    let mut hint = Hint::default();
    for (&p, with_others) in finite.iter().zip(all) {
        let of = |hint: &mut Hint| field.irradiance(p, normal, normal, hint);
        let walked = of(&mut hint).map_err(|error| error.to_string())?;
        let fresh = of(&mut Hint::default()).map_err(|error| error.to_string())?;
        for found in [walked, with_others] {
            check((found - fresh).abs().max_element() <= tolerance * largest, || {
                format!("at {p} irradiance is {fresh}, and with another hint {found}")
            })?;
        }
    }
    Ok(())
}
