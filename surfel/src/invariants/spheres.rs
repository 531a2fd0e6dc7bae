//! Pictures of things whose pictures are known: one point, and spheres.

use super::{check, drawn};
use crate::{Cloud, Frame, Options, View};
use glam::{DVec3, dvec2};

/// Sum of all opacities, pixels.
#[must_use]
pub fn covered_px(frame: &Frame) -> f64 {
    frame.color().iter().map(|c| f64::from(c[3])).sum()
}

/// The ray through the centre of pixel `i`: where it starts, and its unit direction.
#[must_use]
pub fn ray(view: &View, i: usize) -> (DVec3, DVec3) {
    let width = view.width() as usize;
    let ray = view.ray(dvec2((i % width) as f64, (i / width) as f64) + 0.5);
    (ray.origin, ray.direction.normalize())
}

/// Depth along the view axis, and place, at which pixel `i` shows a sphere that is before the eye; `None` beside the
/// sphere, and nearer than `margin_px` to its outline.
#[must_use]
pub fn sphere_at(view: &View, i: usize, centre: DVec3, radius: f64, margin_px: f64) -> Option<(f64, DVec3)> {
    let (from, along) = ray(view, i);
    let offset = centre - from;
    let middle = offset.dot(along);
    let away2 = (offset - along * middle).length_squared();
    // A pixel is nowhere more than 1/focal wide, in radians.
    let inside = if view.projection().is_perspective() {
        let distance = offset.length();
        let angle = (away2.sqrt()).atan2(middle);
        distance > radius && angle < (radius / distance).asin() - margin_px / view.focal_px()
    } else {
        away2.sqrt() < radius - margin_px / view.focal_px()
    };
    let place = from + along * (middle - (radius * radius - away2).max(0.0).sqrt());
    (inside && middle > 0.0).then(|| ((place - view.eye()).dot(view.forward()), place))
}

/// All pixels inside a sphere's outline, by more than `margin_px`, are opaque.
///
/// # Errors
/// How many are not, and the worst.
pub fn sphere_has_no_holes(
    cloud: &Cloud,
    view: &View,
    options: &Options,
    centre: DVec3,
    radius: f64,
    margin_px: f64,
) -> Result<(), String> {
    let frame = drawn(cloud, view, options).ok_or("refused")?;
    let alpha = |i: usize| frame.color()[i][3];
    let inside =
        (0..frame.color().len()).filter(|i| sphere_at(view, *i, centre, radius, margin_px).is_some());
    let bare: Vec<usize> = inside.filter(|i| alpha(*i) < 0.999).collect();
    let worst = bare.iter().min_by(|a, b| alpha(**a).total_cmp(&alpha(**b)));
    worst.map_or(Ok(()), |&i| {
        let (x, y) = (i % frame.width(), i / frame.width());
        Err(format!("{} pixels are not opaque; ({x}, {y}) covers {}", bare.len(), alpha(i)))
    })
}

/// Root of the mean squared difference of two frames' colors and opacities.
#[must_use]
pub fn difference(a: &Frame, b: &Frame) -> f64 {
    let values = || a.color().iter().flatten().zip(b.color().iter().flatten());
    let sum: f64 = values().map(|(p, q)| f64::from(p - q).powi(2)).sum();
    (sum / values().count() as f64).sqrt()
}

/// Frames of coarser levels differ from that of all points by at most `most` for each of `levels`, and by less for
/// finer ones.
///
/// # Errors
/// The differences.
pub fn level_of_detail_converges(
    cloud: &Cloud,
    view: &View,
    options: &Options,
    levels: &[(f32, f64)],
) -> Result<(), String> {
    let by = |level| drawn(cloud, view, &Options { level, ..*options }).ok_or("refused");
    let full = by(0.0)?;
    let mut found = vec![];
    for (level, _) in levels {
        found.push(difference(&by(*level)?, &full));
    }
    let bounded = found.iter().zip(levels).all(|(found, (_, most))| found <= most);
    check(bounded && found.is_sorted(), || format!("levels {levels:?} differ by {found:?}"))
}
