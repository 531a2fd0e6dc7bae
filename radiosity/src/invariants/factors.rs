//! Facts about single form factors.

use glam::{DQuat, DVec3};

use super::{check, reference};
use crate::{FactorOptions, FormFactor, Polygon, form_factor};

/// Rounding of a contour integral over polygons of very different size or distance: what a bound may miss, as a share of the
/// smaller polygon.
const ROUNDING: f64 = 1e-13;

/// Between 0 and 1, with an error that is a number, and no more with something between than without.
pub fn is_a_share(from: &Polygon, to: &Polygon, occluders: &[Polygon]) -> Result<(), String> {
    let options = FactorOptions::DEFAULT.with_occluded(1e-3).with_absolute(1e-4).with_max_cells(400);
    let open = form_factor(from, to, &[], &options);
    let past = form_factor(from, to, occluders, &options);
    for f in [open, past] {
        let fine = (0.0..=1.0).contains(&f.value) && f.error.is_finite() && f.error >= 0.0;
        check(fine, || format!("{f:?} from {from:?} to {to:?} past {occluders:?}"))?;
    }
    // What is sampled is only as sure as samples are: the bound is doubled.
    let slack = 2.0 * past.error + open.error + 1e-3 * open.value + 1e-9;
    check(past.value <= open.value + slack, || format!("{past:?} past occluders, {open:?} without"))
}

/// Two halves of an occluder hide together what the whole hides, and of that each its share, within twice the bounds, 2e-3 of what there is without them and 1e-5: bounds come from
/// samples, and where an occluder pierces the receiver one result in a thousand is off by several times its bound.
pub fn halves_hide_what_the_whole_hides(
    from: &Polygon,
    to: &Polygon,
    occluder: &Polygon,
) -> Result<(), String> {
    let ring = occluder.vertices();
    let halves = [&ring[..3], &[&ring[2..], &ring[..1]].concat()].map(Polygon::new);
    let [Ok(first), Ok(second)] = halves else { return Ok(()) };
    let options = FactorOptions::DEFAULT.with_occluded(1e-4).with_max_cells(1000);
    let past = |occluders: &[Polygon]| form_factor(from, to, occluders, &options);
    let (open, whole) = (past(&[]), past(std::slice::from_ref(occluder)));
    let [one, other] = [&first, &second].map(|half| past(std::slice::from_ref(half)));
    let both = past(&[first, second]);
    for (value, errors) in [
        (both.value, both.error),
        (one.value + other.value - open.value, one.error + other.error + open.error),
    ] {
        let sampled = 1e-5 + 2e-3 * open.value;
        check((value - whole.value).abs() <= 2.0 * (errors + whole.error) + sampled, || {
            format!("{whole:?} past {occluder:?}, {both:?}, {one:?}, {other:?} past halves, {open:?}")
        })?;
    }
    Ok(())
}

/// A₁F₁₂ = A₂F₂₁, within both errors.
pub fn is_reciprocal(from: &Polygon, to: &Polygon, occluders: &[Polygon]) -> Result<(), String> {
    let options = FactorOptions::DEFAULT.with_occluded(1e-3).with_max_cells(200);
    let there = form_factor(from, to, occluders, &options);
    let back = form_factor(to, from, occluders, &options);
    let (one, other) = (there.value * from.area(), back.value * to.area());
    let smaller = from.area().min(to.area());
    // The two are integrated over the same polygon but for rounding; what is sampled is only as sure as samples are.
    let sampled = if occluders.is_empty() { 1e-9 * one.abs() } else { 1e-3 * smaller };
    let error = 4.0 * (there.error * from.area() + back.error * to.area()) + ROUNDING * smaller + sampled;
    check((one - other).abs() <= error, || format!("{one:e} there and {other:e} back, errors {error:e}"))
}

/// The same wherever the pair is, however it is turned and whatever the unit of length.
pub fn does_not_depend_on_place(
    from: &Polygon,
    to: &Polygon,
    turn: DQuat,
    by: DVec3,
    scale: f64,
) -> Result<(), String> {
    let moved = |p: &Polygon| {
        let vertices: Vec<DVec3> = p.vertices().iter().map(|&v| (turn * v + by) * scale).collect();
        Polygon::new(&vertices)
    };
    let (Ok(a), Ok(b)) = (moved(from), moved(to)) else { return Ok(()) };
    let options = FactorOptions::DEFAULT;
    let before = form_factor(from, to, &[], &options);
    let after = form_factor(&a, &b, &[], &options);
    // Coordinates are rounded where the pair now is.
    let size = (from.centre() - to.centre()).length() + from.radius() + to.radius();
    let reach = size + by.length() + from.centre().length();
    let thinnest = [from, to].map(|p| p.area() / p.radius()).into_iter().fold(size, f64::min);
    let rounding = 100.0 * f64::EPSILON * reach / thinnest;
    let error = 2.0 * (before.error + after.error) + rounding + 1e-9 * before.value;
    check((before.value - after.value).abs() <= error, || {
        format!("{before:?} here, {after:?} there, rounding {rounding:e}")
    })
}

/// Within the bound of a slow integral that shares no code, for polygons in front of each other that are neither tiny nor far
/// beside their size, where the slow one has lost its digits.
pub fn agrees_with_contours(from: &Polygon, to: &Polygon, tolerance: f64) -> Result<FormFactor, String> {
    let found = form_factor(from, to, &[], &FactorOptions::DEFAULT.with_unoccluded(tolerance));
    let in_front = |a: &Polygon, b: &Polygon| {
        b.vertices().iter().all(|&v| a.height(v) >= -1e-15 * (a.radius() + b.radius()))
    };
    if !in_front(from, to) || !in_front(to, from) {
        return Ok(found);
    }
    let slow = reference::mutual(from.vertices(), to.vertices()) / from.area();
    let length = |p: &Polygon| p.radius() * p.vertices().len() as f64;
    let distance = (from.centre() - to.centre()).length();
    let digits = 1.0 + distance.max(1e-300).ln().abs();
    let rounding = 1e-15 * length(from) * length(to) * digits / from.area();
    check((found.value - slow).abs() <= found.error + rounding, || {
        format!("{found:?}, slowly {slow:e}, apart {:e}, rounding {rounding:e}", found.value - slow)
    })?;
    Ok(found)
}
