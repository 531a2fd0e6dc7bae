//! Facts about [`cut`], the engine of the renderers: no area is lost, cells agree with [`accumulate`](crate::accumulate), neighbours share
//! their crossings, and a window shows what the whole has.

use super::{cells, check};
use crate::convex;
use crate::{CUT_ERROR, CellWindow, Cut, Grid, cut};
use glam::DVec2;
use std::collections::BTreeMap;

/// What lies in one cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// The whole cell, as part of a span.
    Full,
    /// A piece, by its corners.
    Piece(Vec<DVec2>),
}

/// Row and column of each cell with what lies in it, in the order in which they are reported.
#[must_use]
pub fn parts(polygon: &[DVec2], window: CellWindow) -> Vec<((i32, i32), Part)> {
    let mut parts = vec![];
    cut(polygon, window, |part| match part {
        Cut::Span { row, first, end } => parts.extend((first..end).map(|x| ((row, x), Part::Full))),
        Cut::Piece { cell, polygon } => {
            parts.push(((cell.y, cell.x), Part::Piece(polygon.vertices().to_vec())));
        }
    });
    parts
}

/// The polygon in positive order, if it is one for [`cut`] and small enough to be checked.
fn checkable(polygon: &[DVec2]) -> Option<Vec<DVec2>> {
    let (low, high) = convex::bounds(polygon);
    let fits = (3..=crate::MAX_CUT_VERTICES).contains(&polygon.len())
        && polygon.iter().all(|v| v.is_finite() && v.abs().max_element() <= f64::from(1 << 30))
        && (high - low).max_element() <= super::MAX_SIDE;
    let mut ring = polygon.to_vec();
    if convex::area(&ring) < 0.0 {
        ring.reverse();
    }
    fits.then_some(ring)
}

/// The largest coordinate, at least 1: rounding is in proportion to it.
fn reach(polygon: &[DVec2]) -> f64 {
    polygon.iter().fold(1.0, |reach, v| reach.max(v.abs().max_element()))
}

fn area(part: &Part) -> f64 {
    match part {
        Part::Full => 1.0,
        Part::Piece(corners) => convex::area(corners),
    }
}

/// The area in each cell is that of [`accumulate`](crate::accumulate), which is exact, within [`CUT_ERROR`] times the largest coordinate;
/// so the pieces make up the polygon. Triangles only: a ring of more corners may be concave by rounding.
///
/// # Errors
/// The cell and both areas.
pub fn cut_equals_accumulate(triangle: &[DVec2; 3]) -> Result<(), String> {
    let Some(ring) = checkable(triangle) else { return Ok(()) };
    let Ok(exact) = cells(&ring, &Grid::UNIT) else { return Ok(()) };
    let bound = CUT_ERROR * reach(&ring);
    let mut left: BTreeMap<_, f64> = exact.into_iter().map(|(cell, (area, _))| (cell, area)).collect();
    for (cell, part) in parts(&ring, CellWindow::ALL) {
        *left.entry(cell).or_default() -= area(&part);
    }
    // Written so that NaN fails.
    left.iter().try_for_each(|(cell, rest)| {
        check(rest.abs() <= bound, || format!("cell {cell:?} of {ring:?} differs by {rest:e}, not {bound:e}"))
    })
}

/// Pieces have three corners or more, lie in their closed cells exactly, and turn like the polygon within rounding. Cells come row by row
/// and from left to right, each once.
///
/// # Errors
/// The piece.
pub fn cut_pieces_lie_in_their_cells(polygon: &[DVec2]) -> Result<(), String> {
    let Some(ring) = checkable(polygon) else { return Ok(()) };
    let bound = CUT_ERROR * reach(&ring);
    let parts = parts(&ring, CellWindow::ALL);
    let ordered = parts.windows(2).all(|pair| pair[0].0 < pair[1].0);
    check(ordered, || format!("cells of {ring:?} are out of order"))?;
    for ((row, column), part) in &parts {
        let Part::Piece(corners) = part else { continue };
        let low = DVec2::new(f64::from(*column), f64::from(*row));
        let inside = |v: &DVec2| v.cmpge(low).all() && v.cmple(low + 1.0).all();
        check(corners.len() >= 3 && corners.iter().all(inside), || format!("{corners:?} in {low}"))?;
        check(area(part) >= -bound, || format!("area {:e} of {corners:?}", area(part)))?;
    }
    Ok(())
}

/// The cells of a window are those of the whole, bit for bit.
///
/// # Errors
/// The polygon and its window.
pub fn cut_window_is_part_of_the_whole(polygon: &[DVec2], window: CellWindow) -> Result<(), String> {
    let Some(ring) = checkable(polygon) else { return Ok(()) };
    let CellWindow { x0, y0, x1, y1 } = window;
    let mut wanted = parts(&ring, CellWindow::ALL);
    wanted.retain(|((row, column), _)| (x0..x1).contains(column) && (y0..y1).contains(row));
    check(parts(&ring, window) == wanted, || format!("{ring:?} in {window:?}"))
}

/// Two triangles on both sides of an edge cross every grid line in the same point of it, bit for bit.
///
/// # Errors
/// The cell, and the corners on the edge that each of them has there.
pub fn cut_shares_edges(edge: [DVec2; 2], left: DVec2, right: DVec2) -> Result<(), String> {
    let [a, b] = edge;
    let (Some(one), Some(other)) = (checkable(&[a, b, left]), checkable(&[b, a, right])) else {
        return Ok(());
    };
    let along = b - a;
    let slack = CUT_ERROR * reach(&[a, b, left, right]);
    let from_edge = |p: DVec2| along.perp_dot(p - a) / along.length();
    // Beside thin triangles, and along edges next to a grid line, corners of other edges lie on the shared one as well.
    let thin = |p: DVec2| from_edge(p).abs() < 1e-3 * (1.0 + along.length());
    if thin(left) || thin(right) || along.abs().min_element() < 1e-3 * (1.0 + along.length()) {
        return Ok(());
    }
    // Crossings with lines, far from the ends of the edge and from corners of cells, which may belong to one side only.
    let is_crossing = |p: &DVec2| {
        let from_lines = (*p - p.round()).abs();
        let on_one_line = from_lines.min_element() == 0.0 && from_lines.max_element() > 1e4 * slack;
        on_one_line && from_edge(*p).abs() <= slack && p.distance(a).min(p.distance(b)) > 1e4 * slack
    };
    let crossings = |ring: &[DVec2]| {
        let mut crossings = BTreeMap::<(i32, i32), Vec<[u64; 2]>>::new();
        for (cell, part) in parts(ring, CellWindow::ALL) {
            let Part::Piece(corners) = part else { continue };
            let mut on_edge: Vec<_> =
                corners.iter().filter(|v| is_crossing(v)).map(|v| v.to_array().map(f64::to_bits)).collect();
            on_edge.sort_unstable();
            if !on_edge.is_empty() {
                crossings.insert(cell, on_edge);
            }
        }
        crossings
    };
    let (one, other) = (crossings(&one), crossings(&other));
    for (cell, points) in &one {
        let others = other.get(cell);
        check(others == Some(points), || format!("cell {cell:?} of {edge:?}: {points:x?} and {others:x?}"))?;
    }
    check(one.len() == other.len(), || format!("{edge:?} crosses {} and {} cells", one.len(), other.len()))
}
