//! How far points lie from their neighbours.

use crate::scan::Scan;

/// Number of points of which neighbours are measured.
const SAMPLE: usize = 1024;

/// Neighbours before and after in Morton order that are searched: for most points they contain the nearest ones, and
/// the median is insensitive to the others.
const WINDOW: usize = 96;

/// The neighbour whose distance is taken: on a square grid it is the spacing, and for points thrown at
/// random 1.07 times the side of the square that each has for itself.
const NEIGHBOUR: usize = 4;

/// Median distance to the fourth neighbour that is not a duplicate; 0 if no point has any.
pub(crate) fn of_scan(scan: &Scan<'_>, order: &[u32]) -> f64 {
    if let Some(given) = scan.spacing {
        return given;
    }
    let n = order.len();
    let at = |i: usize| scan.positions[order[i] as usize];
    let nearest = |i: usize| {
        let window = i.saturating_sub(WINDOW)..(i + WINDOW + 1).min(n);
        let mut nearest = [f64::INFINITY; NEIGHBOUR];
        for distance2 in window.map(|j| at(j).distance_squared(at(i))).filter(|d| *d > 0.0) {
            if let Some(place) = nearest.iter().position(|n| distance2 < *n) {
                nearest[place..].rotate_right(1);
                nearest[place] = distance2;
            }
        }
        // A point of a tiny cloud may have fewer neighbours.
        nearest.into_iter().rfind(|d| d.is_finite())
    };
    let mut distances: Vec<f64> = (0..n).step_by(n.div_ceil(SAMPLE)).filter_map(nearest).collect();
    median(&mut distances).sqrt()
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Median of the scans' spacings, each counted as often as it has points.
pub(crate) fn typical(scans: impl Iterator<Item = (f64, usize)>) -> f64 {
    let mut by_spacing: Vec<(f64, usize)> = scans.collect();
    by_spacing.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = by_spacing.iter().map(|s| s.1).sum::<usize>() / 2;
    let mut seen = 0;
    let middle = by_spacing.iter().find(|s| {
        seen += s.1;
        seen > half
    });
    middle.map_or(0.0, |s| s.0)
}
