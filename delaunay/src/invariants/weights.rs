//! Facts about weights between points.

use crate::{Blend, DelaunayError, Hint, Locator, Partition};
use glam::DVec3;

/// The cells between these points, of the dimension that they have up to rounding, ready for queries; `None` for points that are refused.
fn locator(points: &[DVec3]) -> Option<Locator> {
    Locator::new(points, &Partition::up_to_rounding(points).ok()?).ok()
}

fn mixed(points: &[DVec3], blend: &Blend) -> DVec3 {
    blend.parts().map(|(point, weight)| points[point as usize] * weight).sum()
}

/// Weights are in [0, 1] and sum to 1, and mixing the positions of the points by them gives the position asked for, or
/// the nearest point of the hull where that is outside: what is linear is reproduced. `tolerance` is relative to the
/// size of the whole.
///
/// # Errors
/// The first query at which it does not hold.
pub fn weights_find_the_nearest_point(
    points: &[DVec3],
    queries: &[DVec3],
    tolerance: f64,
) -> Result<(), String> {
    let Some(locator) = locator(points) else { return Ok(()) };
    let mut hint = Hint::default();
    for &p in queries.iter().filter(|p| p.is_finite()) {
        let blend = locator.locate(p, &mut hint).map_err(|error| error.to_string())?;
        let sum: f64 = blend.weights.iter().sum();
        if !blend.weights.iter().all(|w| (0.0..=1.0).contains(w)) || (sum - 1.0).abs() > 1e-14 {
            return Err(format!("at {p} the weights are {:?}", blend.weights));
        }
        let x = mixed(points, &blend);
        let reach = points.iter().fold(0.0_f64, |m, v| m.max(v.distance(x)));
        // Nearest on a convex body: no point of it lies on p's side of x.
        for v in points {
            let beyond = (*v - x).dot(p - x);
            if beyond > tolerance * reach * (reach + p.distance(x)) {
                return Err(format!("at {p} the weights give {x}, but towards {v} it is nearer"));
            }
        }
    }
    Ok(())
}

/// With a hint from anywhere or without one the answer is the same, up to rounding.
///
/// # Errors
/// The first query at which it is not.
pub fn hints_do_not_matter(points: &[DVec3], queries: &[DVec3], tolerance: f64) -> Result<(), String> {
    let Some(locator) = locator(points) else { return Ok(()) };
    let size = points.iter().fold(0.0_f64, |m, p| m.max(p.distance(points[0])));
    let mut hint = Hint::default();
    for &p in queries.iter().filter(|p| p.is_finite()) {
        let with = locator.locate(p, &mut hint).map_err(|error| error.to_string())?;
        let without = locator.locate_anywhere(p).map_err(|error| error.to_string())?;
        let apart = mixed(points, &with).distance(mixed(points, &without));
        if apart > tolerance * size {
            return Err(format!("at {p} the hint moves the answer by {apart}"));
        }
    }
    Ok(())
}

/// Where one cell ends and the next begins, what is between points does not jump: `values` on the way from `a` to `b`.
///
/// # Errors
/// The place of a jump by more than `tolerance`.
pub fn nothing_jumps(
    points: &[DVec3],
    values: &[f64],
    a: DVec3,
    b: DVec3,
    tolerance: f64,
) -> Result<(), String> {
    let Some(locator) = locator(points) else { return Ok(()) };
    let blend = |t: f64| locator.locate_anywhere(a.lerp(b, t));
    let value = |b: &Blend| b.parts().map(|(point, weight)| values[point as usize] * weight).sum::<f64>();
    let set = |b: &Blend| {
        let mut points = b.points;
        points.sort_unstable();
        points
    };
    let mut from = 0.0;
    while from < 1.0 {
        // The first of a few steps that ends in another cell, and in it the place where the cell changes.
        let fault = |error: DelaunayError| error.to_string();
        let start = blend(from).map_err(fault)?;
        let mut to = (from + 1.0 / 64.0).min(1.0);
        let (mut low, mut high) = (from, to);
        if set(&blend(to).map_err(fault)?) != set(&start) {
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                let same = set(&blend(middle).map_err(fault)?) == set(&start);
                if same { low = middle } else { high = middle }
            }
            let jump = (value(&blend(low).map_err(fault)?) - value(&blend(high).map_err(fault)?)).abs();
            if jump > tolerance {
                return Err(format!("at {} the value jumps by {jump}", a.lerp(b, high)));
            }
            to = high.max(from + 1e-6);
        }
        from = to;
    }
    Ok(())
}
