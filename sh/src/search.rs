//! The least value of a function of any order.

use crate::Sh;
use glam::{DVec2, DVec3, dvec2, dvec3};

/// Starting directions per coefficient: neighbours are about a sixth of the shortest wave apart.
const STARTS_PER_COEFFICIENT: usize = 40;
/// Number of starting directions, those with the lowest values, that are refined.
const KEPT: usize = 8;
/// Step of finite differences, in radians. Their error is about the square of the step times the fourth derivative; it
/// does not move the minimum, it only slows convergence.
const STEP: f64 = 1e-3;
const STEPS: usize = 20;

/// The direction of the lowest value found.
pub(crate) fn minimum(sh: &Sh<f64>) -> DVec3 {
    let count = STARTS_PER_COEFFICIENT * sh.coefficients().len();
    let mut starts: Vec<(f64, DVec3)> = (0..count).map(|i| spiral(i, count)).map(|d| (sh.at(d), d)).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let refined = starts.iter().take(KEPT).map(|&(value, direction)| descend(sh, value, direction));
    refined.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(DVec3::X, |(_, direction)| direction)
}

/// Even directions on a spiral of golden angles.
fn spiral(i: usize, count: usize) -> DVec3 {
    let z = 1.0 - (2 * i + 1) as f64 / count as f64;
    let (sin, cos) = (i as f64 * std::f64::consts::PI * (3.0 - 5.0_f64.sqrt())).sin_cos();
    let radius = (1.0 - z * z).sqrt();
    dvec3(radius * cos, radius * sin, z)
}

/// Newton's method in the tangent plane, with steps halved until they lead down.
fn descend(sh: &Sh<f64>, mut value: f64, mut direction: DVec3) -> (f64, DVec3) {
    for _ in 0..STEPS {
        let (u, v) = direction.any_orthonormal_pair();
        let moved = |by: DVec2| (direction + u * by.x + v * by.y).normalize();
        let mut step = newton_step(|by| sh.at(moved(by)), value);
        let mut lower = sh.at(moved(step));
        for _ in 0..STEPS {
            if lower < value {
                break;
            }
            step *= 0.5;
            lower = sh.at(moved(step));
        }
        // No step lowers the value any more: the minimum is found up to rounding.
        if lower >= value || lower.is_nan() {
            break;
        }
        (value, direction) = (lower, moved(step));
    }
    (value, direction)
}

/// A Newton step from finite differences; steepest descent where the function is not convex.
fn newton_step(f: impl Fn(DVec2) -> f64, value: f64) -> DVec2 {
    let at = |x: f64, y: f64| f(dvec2(x * STEP, y * STEP));
    let [e, w, n, s] = [at(1.0, 0.0), at(-1.0, 0.0), at(0.0, 1.0), at(0.0, -1.0)];
    let gradient = dvec2(e - w, n - s) / (2.0 * STEP);
    let (xx, yy) = (e + w - 2.0 * value, n + s - 2.0 * value);
    let xy = 0.25 * (at(1.0, 1.0) + at(-1.0, -1.0) - at(1.0, -1.0) - at(-1.0, 1.0));
    let det = xx * yy - xy * xy;
    if xx > 0.0 && det > 0.0 {
        let solved = dvec2(yy * gradient.x - xy * gradient.y, xx * gradient.y - xy * gradient.x) / det;
        return -solved * (STEP * STEP);
    }
    -gradient.normalize_or_zero() * 0.1
}
