//! Facts about [`hide`](crate::hide): light that occluders do not take is conserved, in any order, and is what an independent method finds.

use super::check;
use crate::ConvexPolygon;
use crate::hide::{Blocker, Occluders, Regions};
use glam::{DVec2, dvec2};

/// How far the light on a polygon of area 1 may be off: some hundred cuts of rounded corners, and pieces too small to cut off.
const LIGHT_ERROR: f64 = 1e-11;

/// Pieces of at most this area are not cut off in these checks.
const NEGLIGIBLE: f64 = 1e-13;

/// A sheet: a convex outline in positive order, and how much of the light it takes, 0 to 1.
pub type Sheet = (Vec<DVec2>, f64);

struct Sheets<'a>(&'a [Sheet]);

impl Occluders for Sheets<'_> {
    fn outline(&self, number: u32) -> &[DVec2] {
        &self.0[number as usize].0
    }

    fn is_opaque(&self, number: u32) -> bool {
        self.0[number as usize].1 >= 1.0
    }

    fn opacity(&self, number: u32, _: &ConvexPolygon) -> f64 {
        self.0[number as usize].1
    }
}

/// The unit square, which all checks look at.
fn unit() -> ConvexPolygon {
    ConvexPolygon::rectangle(DVec2::ZERO, DVec2::ONE)
}

fn light(regions: &Regions) -> f64 {
    regions.list().iter().map(|r| r.polygon.area() * r.transmittance).sum()
}

/// What is left of the unit square behind sheets, one after the other in this order.
#[must_use]
pub fn attenuated(sheets: &[Sheet]) -> Regions {
    let mut regions = Regions::default();
    regions.start(unit(), NEGLIGIBLE);
    for (outline, opacity) in sheets {
        regions.attenuate(outline, None, |_| *opacity);
    }
    regions
}

/// The same by [`Regions::hide`], which halves the square where many sheets overlap.
#[must_use]
pub fn hidden(sheets: &[Sheet]) -> Regions {
    let mut regions = Regions::default();
    let blockers: Vec<Blocker> =
        (0..sheets.len() as u32).map(|number| Blocker { number, front: None }).collect();
    regions.hide(unit(), NEGLIGIBLE, &blockers, &Sheets(sheets));
    regions
}

/// Behind sheets that let through what they like, but something, regions make up the square and lie in it.
///
/// # Errors
/// The area that is missing, or the corner outside.
pub fn regions_make_up_the_polygon(sheets: &[Sheet]) -> Result<(), String> {
    let thin: Vec<Sheet> = sheets.iter().map(|(outline, opacity)| (outline.clone(), 0.5 * opacity)).collect();
    for regions in [attenuated(&thin), hidden(&thin)] {
        let area: f64 = regions.list().iter().map(|r| r.polygon.area()).sum();
        check((area - 1.0).abs() <= LIGHT_ERROR, || format!("the regions' areas sum to {area:.17}"))?;
        for region in regions.list() {
            let inside =
                |v: &DVec2| v.cmpge(DVec2::splat(-1e-12)).all() && v.cmple(DVec2::splat(1.0 + 1e-12)).all();
            check(region.polygon.vertices().iter().all(inside), || {
                format!("{:?} sticks out", region.polygon)
            })?;
            let is_share = (0.0..=1.0).contains(&region.transmittance);
            check(is_share, || format!("transmittance {}", region.transmittance))?;
        }
    }
    Ok(())
}

/// The order of the sheets does not matter, nor whether the square is halved first.
///
/// # Errors
/// The amounts of light.
pub fn order_of_occluders_does_not_matter(sheets: &[Sheet]) -> Result<(), String> {
    let reversed: Vec<Sheet> = sheets.iter().rev().cloned().collect();
    let wanted = light(&attenuated(sheets));
    for (how, regions) in [("reversed", attenuated(&reversed)), ("halved", hidden(sheets))] {
        let found = light(&regions);
        check((found - wanted).abs() <= LIGHT_ERROR, || format!("{how}: {found:.17} of {wanted:.17}"))?;
    }
    Ok(())
}

/// A rectangle by its low and high corner, and its opacity.
pub type Rectangle = (DVec2, DVec2, f64);

/// Behind rectangles, the light is that of the cells into which all of their sides divide the square, each behind those that cover its
/// middle.
///
/// # Errors
/// The amounts of light.
pub fn rectangles_take_what_they_cover(rectangles: &[Rectangle]) -> Result<(), String> {
    let mut sides: [Vec<f64>; 2] = [vec![0.0, 1.0], vec![0.0, 1.0]];
    for corner in rectangles.iter().flat_map(|(low, high, _)| [low, high]) {
        sides[0].push(corner.x.clamp(0.0, 1.0));
        sides[1].push(corner.y.clamp(0.0, 1.0));
    }
    sides.iter_mut().for_each(|sides| sides.sort_by(f64::total_cmp));
    let mut wanted = 0.0;
    for x in sides[0].windows(2) {
        for y in sides[1].windows(2) {
            let middle = dvec2(0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]));
            let covers = |low: DVec2, high: DVec2| low.cmple(middle).all() && middle.cmple(high).all();
            let passes = rectangles.iter().filter(|(low, high, _)| covers(*low, *high)).map(|r| 1.0 - r.2);
            wanted += (x[1] - x[0]) * (y[1] - y[0]) * passes.product::<f64>();
        }
    }
    let outline = |low: DVec2, high: DVec2| vec![low, dvec2(high.x, low.y), high, dvec2(low.x, high.y)];
    let sheets: Vec<Sheet> =
        rectangles.iter().map(|&(low, high, opacity)| (outline(low, high), opacity)).collect();
    for (how, regions) in [("one by one", attenuated(&sheets)), ("halved", hidden(&sheets))] {
        let found = light(&regions);
        check((found - wanted).abs() <= LIGHT_ERROR, || format!("{how}: {found:.17} of {wanted:.17}"))?;
    }
    Ok(())
}
