//! Targets behind masks, divided.
//!
//! Holes of one mask may lie before those of another or beside them, and what passes them may fall on bright texels or on dark ones: the product of
//! means is not the mean of the product. In a small piece of the target all of these vary less, and many masks are open or closed throughout.

use crate::query::Measure;
use glam::DVec2;
use pointillist_dice::{CellWindow, ConvexPolygon, Cut, MAX_CUT_VERTICES, convex, cut};

/// Gives the pieces of an outline on the light grid: as many as it is larger than a square of which `squares` lie on a side of one of the viewer's
/// cells, in columns and rows of the light grid.
pub(crate) fn divide(
    outline: &[DVec2],
    squares: u32,
    measure: &Measure<'_>,
    mut visit: impl FnMut(&ConvexPolygon),
) {
    let (low, high) = convex::bounds(outline);
    let may_be_divided = squares > 1 && outline.len() <= MAX_CUT_VERTICES;
    let [columns, rows] = if may_be_divided { counts(outline, high - low, squares, measure) } else { [1; 2] };
    if columns * rows == 1 {
        visit(&ConvexPolygon::from_vertices(outline));
        return;
    }
    let size = (high - low) / DVec2::new(f64::from(columns), f64::from(rows));
    let mut scaled = ConvexPolygon::EMPTY;
    outline.iter().for_each(|&v| scaled.push((v - low) / size));
    let window = CellWindow { x0: 0, y0: 0, x1: columns, y1: rows };
    cut(scaled.vertices(), window, |found| match found {
        Cut::Span { row, first, end } => {
            for column in first..end {
                let corner = DVec2::new(f64::from(column), f64::from(row));
                visit(&ConvexPolygon::rectangle(low + corner * size, low + (corner + 1.0) * size));
            }
        }
        Cut::Piece { polygon, .. } => {
            let mut piece = ConvexPolygon::EMPTY;
            polygon.vertices().iter().for_each(|&v| piece.push(low + v * size));
            visit(&piece);
        }
    });
}

/// Squares in a target from which it is divided.
const LEAST: f64 = 2.0;

/// How many columns and rows of about equal sides its bounds are divided into.
fn counts(outline: &[DVec2], extent: DVec2, squares: u32, measure: &Measure<'_>) -> [i32; 2] {
    let mut seen = ConvexPolygon::EMPTY;
    outline.iter().for_each(|&v| seen.push(measure.in_picture(v)));
    let pieces = f64::from(squares * squares) * seen.area().abs();
    // Squares of a cell that is divided already stay whole.
    if pieces < LEAST {
        return [1; 2];
    }
    let within_bounds = pieces * extent.x * extent.y / convex::area(outline);
    let ratio = extent.x / extent.y;
    // A number that is none, as of an outline without area, becomes 1.
    let count = |n: f64| n.sqrt().round().max(1.0).min(f64::from(squares)) as i32;
    [count(within_bounds * ratio), count(within_bounds / ratio)]
}
