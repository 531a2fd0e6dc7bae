//! Facts about lines that shine.

use super::area::{
    SeenPicture, Shape, agrees_with_rays_to, picture_of_shape, tiles_do_not_matter_to,
    triangle_order_does_not_matter_to,
};
use crate::AreaOptions;
use glam::DVec3;
use pointillist_micropoint::View;
use pointillist_micropoint::invariants::Soup;

/// Renders a scene whole; `None` if something is refused.
#[must_use]
pub fn seen_picture(soup: &Soup, view: View, ends: [DVec3; 2]) -> Option<SeenPicture> {
    picture_of_shape(soup, view, Shape::Line(ends), AreaOptions::DEFAULT)
}

/// What is seen of a line does not depend on the rectangles in which a picture is rendered, bit for bit.
///
/// # Errors
/// The first pixel that differs.
pub fn tiles_do_not_matter(soup: &Soup, view: View, ends: [DVec3; 2]) -> Result<(), String> {
    tiles_do_not_matter_to(soup, view, Shape::Line(ends))
}

/// What is seen of a line does not depend on the order of triangles, bit for bit.
///
/// # Errors
/// The first pixel that differs.
pub fn triangle_order_does_not_matter(
    soup: &Soup,
    view: View,
    ends: [DVec3; 2],
    seed: u64,
) -> Result<(), String> {
    triangle_order_does_not_matter_to(soup, view, Shape::Line(ends), seed)
}

/// What is seen of a line agrees with rays to `n` places on it, each in the middle of its part, to within `tolerance` of its length.
///
/// # Errors
/// The first point at which it does not.
pub fn agrees_with_rays(
    soup: &Soup,
    view: View,
    [from, to]: [DVec3; 2],
    n: u32,
    tolerance: f64,
) -> Result<(), String> {
    let Some(picture) = seen_picture(soup, view, [from, to]) else { return Ok(()) };
    for p in picture.iter().flatten() {
        let targets = (0..n).map(|k| from + (to - from) * ((f64::from(k) + 0.5) / f64::from(n)));
        agrees_with_rays_to(soup, p, targets, tolerance)?;
    }
    Ok(())
}
