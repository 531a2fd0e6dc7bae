//! Facts that hold for every view, as functions `fn fact(…) -> Result<(), String>`: `Err` says what was found instead.
//!
//! For property testers and fuzzers: the tests of this crate and its fuzz targets call them, and so can those of a
//! crate that builds on it, with the feature `invariants`. Any finite arguments are allowed: where a result is beyond
//! the range of `f64`, or rounding has swallowed the depth, a function has nothing to check.
//!
//! ```
//! use pointillist_view::{Projection, View, invariants::unprojecting_gives_the_point};
//! # use glam::DVec3;
//!
//! let view = View::look_at(DVec3::ONE, DVec3::ZERO, DVec3::Y, Projection::Orthographic { height: 4.0 }, 64, 48).unwrap();
//! unprojecting_gives_the_point(&view, DVec3::new(0.1, 0.2, 0.3))?;
//! # Ok::<(), String>(())
//! ```

use crate::{PixelRect, Projected, Projection, View};
use glam::{DMat3, DVec2, DVec3};

/// Ulps of the largest number involved that a result may be off: a dozen operations, with room.
const ULPS: f64 = 64.0 * f64::EPSILON;

/// The smallest subnormal number: what rounding cannot go below in scenes near the bottom of the range of `f64`.
const LEAST: f64 = f64::from_bits(1);

/// The largest coordinate: a length that does not overflow.
fn size(v: DVec3) -> f64 {
    v.abs().max_element()
}

/// Whether no coordinate is above the bound, nor NaN.
fn is_within(v: DVec3, bound: f64) -> bool {
    v.abs().cmple(DVec3::splat(bound)).all()
}

/// World units by which a point seen at this place may be off: ulps of the coordinates of eye and point, of their
/// distance, and of the width of the picture there.
#[must_use]
pub fn world_bound(view: &View, point: DVec3, at: &Projected) -> f64 {
    let per_pixel = match view.projection() {
        Projection::Perspective { .. } => at.depth.abs() / view.focal_px(),
        Projection::Orthographic { .. } => 1.0 / view.focal_px(),
    };
    let picture = (at.pixel.abs().max_element() + view.centre_px().max_element()) * per_pixel;
    ULPS * (size(view.eye()) + size(point) + size(point - view.eye()) + picture) + 16.0 * LEAST
}

/// Pixels by which the position of a point may be off: [`world_bound`] at its depth, and what an error of the depth
/// does to it.
fn pixel_bound(view: &View, at: &Projected, world: f64) -> f64 {
    let off_axis = (at.pixel - view.centre_px()).abs().max_element();
    let (scale, by_depth) = match view.projection() {
        Projection::Perspective { .. } => (view.focal_px() / at.depth, off_axis * (world / at.depth)),
        Projection::Orthographic { .. } => (view.focal_px(), 0.0),
    };
    2.0 * (scale * world + by_depth) + ULPS * (off_axis + view.centre_px().max_element())
}

/// The axes are orthonormal and right-handed: right × up = −forward.
///
/// # Errors
/// What is off, and by how much.
pub fn axes_are_orthonormal(view: &View) -> Result<(), String> {
    let axes = DMat3::from_cols(view.right(), view.up(), -view.forward());
    let off = (axes.transpose() * axes - DMat3::IDENTITY).to_cols_array();
    let worst = off.into_iter().fold(0.0, |worst: f64, e| worst.max(e.abs()));
    if !axes.is_finite() || worst > View::AXIS_ERROR || axes.determinant() < 0.0 {
        return Err(format!("{view:?}: axes are off orthonormal by {worst:e}"));
    }
    Ok(())
}

/// Projecting a point and unprojecting what comes out gives the point, within [`world_bound`].
///
/// # Errors
/// The point, and where it went.
pub fn unprojecting_gives_the_point(view: &View, point: DVec3) -> Result<(), String> {
    let Some(at) = view.project(point) else { return Ok(()) };
    let back = view.unproject(at.pixel, at.depth);
    let bound = world_bound(view, point, &at);
    if bound.is_finite() && !is_within(back - point, bound) {
        return Err(format!("{view:?}: {point} is seen at {at:?}, which is {back}; bound {bound:e}"));
    }
    Ok(())
}

/// Unprojecting a place in the picture and projecting what comes out gives the place.
///
/// # Errors
/// The place, and where it went.
pub fn projecting_gives_the_pixel(view: &View, pixel: DVec2, depth: f64) -> Result<(), String> {
    let point = view.unproject(pixel, depth);
    let given = Projected { pixel, depth };
    let bound = world_bound(view, point, &given);
    let is_perspective = view.projection().is_perspective();
    let is_lost = is_perspective && depth <= 4.0 * bound;
    if !(point.is_finite() && bound.is_finite() && (2.0 * pixel).is_finite()) || is_lost {
        return Ok(());
    }
    let pixels = pixel_bound(view, &given, bound);
    let wrong =
        |what: &str| Err(format!("{view:?}: {given:?} is {point}, {what}; bounds {pixels:e} px, {bound:e}"));
    let Some(at) = view.project(point) else {
        return if pixels.is_finite() { wrong("which is not in the picture") } else { Ok(()) };
    };
    let (off_px, off) = ((at.pixel - pixel).abs().max_element(), (at.depth - depth).abs());
    if off_px <= pixels && off <= bound { Ok(()) } else { wrong(&format!("seen at {at:?}")) }
}

/// The ray of a pixel position passes through what is seen there, and starts at depth 0.
///
/// # Errors
/// The point, and how far from it the ray passes.
pub fn rays_hit_what_is_seen(view: &View, point: DVec3) -> Result<(), String> {
    let Some(at) = view.project(point) else { return Ok(()) };
    let (ray, bound) = (view.ray(at.pixel), world_bound(view, point, &at));
    // Both scaled to the distance, so that products do not leave the range of numbers.
    let (away, direction) = (point - ray.origin, ray.direction / size(ray.direction));
    let unit = size(away);
    if !(bound.is_finite() && unit > 0.0) {
        return Ok(());
    }
    let off = (away / unit).cross(direction);
    if !is_within(off, 4.0 * (bound / unit + ULPS)) {
        return Err(format!("{view:?}: {point} is seen at {at:?}; {ray:?} passes by {off} of its distance"));
    }
    let start = (ray.origin - view.eye()).dot(view.forward());
    if start.abs() <= ULPS * (size(ray.origin) + size(view.eye())) + 16.0 * LEAST {
        Ok(())
    } else {
        Err(format!("{view:?}: the ray through {:?} starts at depth {start:e}", at.pixel))
    }
}

/// [`View::from_matrix`] of [`View::view_from_world`] is the same view: axes and eye to a few ulps.
///
/// # Errors
/// Both views.
pub fn the_matrix_gives_the_view(view: &View) -> Result<(), String> {
    let (w, h) = (view.width(), view.height());
    let again = View::from_matrix(view.view_from_world(), view.projection(), w, h);
    // The matrix holds the eye turned: its coordinates may be larger by √3.
    let at_the_edge = size(view.eye()) > 0.5 * View::LARGEST_COORDINATE;
    let again = match again {
        Err(_) if at_the_edge => return Ok(()),
        result => result.map_err(|error| format!("{view:?}: its matrix is refused: {error}"))?,
    };
    let same = is_within(again.forward() - view.forward(), ULPS)
        && is_within(again.right() - view.right(), ULPS)
        && is_within(again.up() - view.up(), ULPS)
        && is_within(again.eye() - view.eye(), ULPS * size(view.eye()) + 16.0 * LEAST);
    if same { Ok(()) } else { Err(format!("{view:?} came back as {again:?}")) }
}

/// The tiles of a rectangle hold each of its pixels once and no other, are at most `size` on a side, and lie in the
/// raster of the picture. Takes time in proportion to the pixels.
///
/// # Errors
/// The tile or pixel.
pub fn tiles_partition(rect: PixelRect, size: u32) -> Result<(), String> {
    let (width, size) = (rect.width() as usize, size.max(1));
    let mut times = vec![0_u32; width * rect.height() as usize];
    for tile in rect.tiles(size) {
        let raster = |v: u32| v / size;
        let is_whole = raster(tile.x0) == raster(tile.x1 - 1) && raster(tile.y0) == raster(tile.y1 - 1);
        if tile.is_empty() || tile.intersection(&rect) != tile || !is_whole {
            return Err(format!("{tile:?} is no tile of {size} pixels of {rect:?}"));
        }
        for (y, x) in (tile.y0..tile.y1).flat_map(|y| (tile.x0..tile.x1).map(move |x| (y, x))) {
            times[(y - rect.y0) as usize * width + (x - rect.x0) as usize] += 1;
        }
    }
    match times.iter().position(|&n| n != 1) {
        Some(i) => Err(format!("pixel {i} of {rect:?} is in {} tiles of {size}", times[i])),
        None => Ok(()),
    }
}
