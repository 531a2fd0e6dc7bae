//! Shares that do not jump.

use super::check;
use crate::{DistanceMap, Field, Hint};
use glam::{DVec3, Vec3};

/// Pieces of a way that are looked into one by one.
const PIECES: usize = 16;

/// Halvings of a piece, at least. What a probe sees changes within as little as the inverse of [`DistanceMap::FARTHEST`], far less than what this leaves of
/// a long way: where a change is left, halving goes on as long as places differ.
const HALVINGS: usize = 44;

/// Largest sum of changes of shares from one end to the other of what is left of a piece. A jump is a share; a change
/// that is only steep is far below this by then.
const LARGEST_CHANGE: f64 = 1e-3;

/// Bounds by how much shares change over a distance, times [`nearest`]: visibility goes from 1 to 0 within a few hundredths of what that is the inverse of.
const STEEPEST: f64 = 1e3;

/// Cosine of normals that are nearly opposite.
const OPPOSITE: f32 = -0.5;

/// A place on a surface, or with a normal of 0 in free space.
pub type Place = (DVec3, Vec3);

/// On the way from one place to another, shares do not jump, also where a probe comes into sight, out of the reach of a
/// position or behind a surface. Each of some pieces of the way is halved again and again, towards the half in which
/// shares change more: the change must vanish with the length. Nothing is said of ways from surfaces into free space, and
/// of normals that are nearly opposite: between them lies one of no direction.
///
/// # Errors
/// Where the shares jump, and how.
pub fn shares_do_not_jump(field: &Field, from: Place, to: Place) -> Result<(), String> {
    if ![from, to].iter().all(|(p, n)| p.is_finite() && n.is_finite()) || !(to.0 - from.0).is_finite() {
        return Ok(());
    }
    if (from.1 == Vec3::ZERO) != (to.1 == Vec3::ZERO) || from.1.dot(to.1) < OPPOSITE {
        return Ok(());
    }
    let at = |t: f64| (from.0.lerp(to.0, t), from.1.as_dvec3().lerp(to.1.as_dvec3(), t).as_vec3());
    let shares = |t: f64| {
        let (position, normal) = at(t);
        field.surface_shares(position, normal, &mut Hint::default()).map_err(|error| error.to_string())
    };
    for piece in 0..PIECES {
        let end = |i: usize| i as f64 / PIECES as f64;
        let (mut low, mut high) = (end(piece), end(piece + 1));
        let (mut first, mut last) = (shares(low)?, shares(high)?);
        for halvings in 0.. {
            let middle = 0.5 * (low + high);
            let is_shortest = at(middle) == at(low) || at(middle) == at(high);
            if is_shortest || (halvings >= HALVINGS && change(&first, &last) <= LARGEST_CHANGE) {
                break;
            }
            let between = shares(middle)?;
            if change(&first, &between) > change(&between, &last) {
                (high, last) = (middle, between);
            } else {
                (low, first) = (middle, between);
            }
        }
        // Next to one another in double precision, places may be farther apart than what is steep is wide.
        let left = (at(high).0 - at(low).0).length();
        let is_steep = |change: f64| change <= STEEPEST * left * nearest(field, at(low).0);
        let change = change(&first, &last);
        check(change <= LARGEST_CHANGE || is_steep(change), || {
            format!("from {:?} to {:?} shares go from {first:?} to {last:?}", at(low), at(high))
        })?;
    }
    Ok(())
}

/// The inverse of how near the nearest thing is that what probes see of a position depends on, one over world units: their planes, and what else they see, which
/// changes no faster than the position's distance from them.
fn nearest(field: &Field, position: DVec3) -> f64 {
    let of_probe = |(map, probe): (&DistanceMap, &DVec3)| {
        let nodes = f64::from(map.nodes().iter().flatten().fold(0.0, |most: f32, v| most.max(*v)));
        let planes = map.planes().iter().fold(0.0, |most: f32, plane| most.max(plane.abs().max_element()));
        nodes.min((position - probe).length().recip()).max(planes.into())
    };
    let maps = field.distances().unwrap_or_default();
    maps.iter().zip(field.positions()).map(of_probe).fold(0.0, f64::max)
}

/// The sum of what shares change by.
fn change(a: &[(u32, f64)], b: &[(u32, f64)]) -> f64 {
    let of = |list: &[(u32, f64)], probe: u32| list.iter().filter(|s| s.0 == probe).map(|s| s.1).sum::<f64>();
    let gone = b.iter().filter(|s| of(a, s.0) == 0.0).map(|s| s.1).sum::<f64>();
    a.iter().map(|s| (of(b, s.0) - s.1).abs()).sum::<f64>() + gone
}
