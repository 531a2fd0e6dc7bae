//! Which rows a polygon reaches within a range of columns: a long polygon at a slope leaves most rows of its bounding box empty there.

use glam::DVec2;
use std::ops::Range;

/// The strip of columns is taken this much wider on either side, in cells: rounding of a crossing then cannot put a polygon into a column
/// without its rows being found.
const MARGIN: f64 = 1.0;

/// Heights are this far beyond those computed, relative to the largest coordinate: a few roundings of them.
const SLACK: f64 = 16.0 * f64::EPSILON;

/// Lowest and highest y of the boundary of a polygon where it is at most [`MARGIN`] away from the columns; an empty interval if it is
/// nowhere. For a convex polygon, its inside lies within the same heights.
pub(crate) fn heights(polygon: &[DVec2], columns: &Range<i32>) -> (f64, f64) {
    let (left, right) = (f64::from(columns.start) - MARGIN, f64::from(columns.end) + MARGIN);
    let (mut low, mut high, mut largest) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    let mut a = polygon[polygon.len() - 1];
    for &b in polygon {
        let (first, last) = if a.x <= b.x { (a, b) } else { (b, a) };
        if last.x >= left && first.x <= right {
            // Ends so far apart that their difference overflows have no crossing that can be computed.
            let exact = (last - first).is_finite();
            let ends =
                if exact { [height(first, last, left), height(first, last, right)] } else { [a.y, b.y] };
            (low, high) = (low.min(ends[0]).min(ends[1]), high.max(ends[0]).max(ends[1]));
            largest = largest.max(a.y.abs()).max(b.y.abs());
        }
        a = b;
    }
    (low - SLACK * largest, high + SLACK * largest)
}

/// The y of a segment at `x`, or at its end that is nearest to it.
fn height(first: DVec2, last: DVec2, x: f64) -> f64 {
    if x <= first.x {
        first.y
    } else if x >= last.x {
        last.y
    } else {
        let y = first.y + (last.y - first.y) * ((x - first.x) / (last.x - first.x));
        y.clamp(first.y.min(last.y), first.y.max(last.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    #[test]
    fn heights_are_those_within_the_columns() {
        let stripe =
            [dvec2(-1000.0, -100.0), dvec2(1000.0, 100.0), dvec2(1000.0, 100.1), dvec2(-1000.0, -99.9)];
        let near = |(low, high): (f64, f64), wanted: (f64, f64)| {
            assert!((low - wanted.0).abs() < 1e-9 && (high - wanted.1).abs() < 1e-9, "{low} {high}");
        };
        near(heights(&stripe, &(0..10)), (-0.1, 1.2));
        near(heights(&stripe, &(-2000..-1000)), (-100.0, -99.8));
        let (low, high) = heights(&stripe, &(2000..2010));
        assert!(low > high);
        // A whole side is within the columns.
        near(heights(&stripe, &(-2000..2000)), (-100.0, 100.1));
        // An edge along a column line, and numbers that overflow when they are subtracted.
        near(heights(&[dvec2(0.0, 0.0), dvec2(0.0, 5.0), dvec2(9.0, 2.0)], &(-1..0)), (0.0, 5.0));
        let far = heights(&[dvec2(-1e308, -1e308), dvec2(1e308, 1e308), dvec2(0.0, 1e308)], &(0..1));
        assert!(far.0 <= -1e308 && far.1 >= 1e308, "{far:?}");
    }
}
