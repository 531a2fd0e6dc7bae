//! Facts that hold for every polygon, as functions: property tests and fuzz targets call the same ones.
//!
//! Each takes any input at all. Input that is refused, or that meets so many cells that checking would take long,
//! satisfies every fact.

mod clip;
mod cut;
mod filled;
mod hide;

pub use clip::clipping_divides;
pub use cut::{
    Part, cut_equals_accumulate, cut_pieces_lie_in_their_cells, cut_shares_edges,
    cut_window_is_part_of_the_whole, parts,
};
pub use filled::{
    closed_rings_are_open_ones, filled_cells, filled_window_is_part_of_the_whole,
    mirrored_grids_mirror_the_cells, nested_rings_alternate,
};
pub use hide::{
    Rectangle, Sheet, attenuated, hidden, order_of_occluders_does_not_matter,
    rectangles_take_what_they_cover, regions_make_up_the_polygon,
};

use std::collections::BTreeMap;

use glam::{DVec2, IVec2, dvec2};

use crate::{Accumulator, Code, CodeKind, DiceError, Grid, accumulate, split};

/// Polygons that span more rows or columns than this are not checked.
const MAX_SIDE: f64 = 64.0;
/// Rounding of the slow comparators, in cells per cell of the polygon's extent; the crate's own error is far below.
const SLOW_ERROR: f64 = 64.0 * f64::EPSILON;

/// A piece that stays after the visit.
#[derive(Clone, Debug)]
pub struct OwnedPiece {
    /// The cell.
    pub cell: IVec2,
    /// The corners.
    pub vertices: Vec<DVec2>,
    /// Area in input units².
    pub area: f64,
    /// Centre of mass.
    pub centroid: DVec2,
    /// The ternary code.
    pub code: Code,
}

/// Area and centroid by cell.
pub type Cells = BTreeMap<(i32, i32), (f64, DVec2)>;

/// The pieces of a polygon.
///
/// # Errors
/// As [`split`].
pub fn pieces(polygon: &[DVec2], grid: &Grid) -> Result<Vec<OwnedPiece>, DiceError> {
    let mut pieces = vec![];
    split(polygon, grid, |p| {
        let vertices = p.vertices.to_vec();
        pieces.push(OwnedPiece { cell: p.cell, vertices, area: p.area, centroid: p.centroid, code: p.code });
    })?;
    Ok(pieces)
}

/// The cells of a polygon, runs taken apart.
///
/// # Errors
/// As [`accumulate`].
pub fn cells(ring: &[DVec2], grid: &Grid) -> Result<Cells, DiceError> {
    let mut cells = Cells::new();
    accumulate(ring, grid, &mut Accumulator::new(), |run| {
        for (cell, centroid) in run.cells(grid) {
            cells.insert((cell.y, cell.x), (run.area, centroid));
        }
    })?;
    Ok(cells)
}

/// What a check needs to know about an input; `None` if there is nothing to check.
struct Input<'a> {
    polygon: &'a [DVec2],
    grid: &'a Grid,
    /// Where moments are taken from.
    first: DVec2,
    /// Error allowed to `f64` comparators, in input units².
    tolerance: f64,
    /// The same for points, in input units.
    slack: DVec2,
}

impl<'a> Input<'a> {
    fn new(polygon: &'a [DVec2], grid: &'a Grid) -> Option<Self> {
        let (&first, _) = polygon.split_first()?;
        let low = polygon.iter().fold(first, |m, v| m.min(*v));
        let high = polygon.iter().fold(first, |m, v| m.max(*v));
        let extent = ((high - low) / grid.cell()).abs();
        if !polygon.iter().all(|v| v.is_finite())
            || extent.max_element().is_nan()
            || extent.max_element() > MAX_SIDE
        {
            return None;
        }
        // Cells whose own lines cannot be told apart after rounding to input coordinates are not checked.
        let magnitude = high.abs().max(low.abs()).max(grid.origin().abs());
        let slack = magnitude * (4.0 * f64::EPSILON) + grid.cell().abs() * SLOW_ERROR;
        if (slack / grid.cell().abs()).max_element() > 1e-4 {
            return None;
        }
        // Input coordinates are rounded by `slack`, which moves an outline of this length.
        let position = (slack / grid.cell().abs()).max_element();
        let vertices = polygon.len() as f64;
        let tolerance = (extent.max_element() + 1.0) * (SLOW_ERROR + position) * vertices * grid.cell_area();
        Some(Self { polygon, grid, first, tolerance, slack })
    }

    fn pieces(&self) -> Option<Vec<OwnedPiece>> {
        pieces(self.polygon, self.grid).ok()
    }

    /// Signed area and first moment about `first`.
    fn area_and_moment(&self, vertices: &[DVec2]) -> (f64, DVec2) {
        ring_area_and_moment(vertices, self.first)
    }
}

fn ring_area_and_moment(vertices: &[DVec2], about: DVec2) -> (f64, DVec2) {
    let (mut area, mut moment) = (0.0, DVec2::ZERO);
    for (i, v) in vertices.iter().enumerate() {
        let (a, b) = (*v - about, vertices[(i + 1) % vertices.len()] - about);
        let cross = a.perp_dot(b);
        area += 0.5 * cross;
        moment += cross / 6.0 * (a + b);
    }
    (area, moment)
}

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}

/// Neither product loses or invents area or first moments. (Convex polygons; rings that cross themselves may not be.)
///
/// # Errors
/// What differs by how much.
pub fn area_and_moments_are_conserved(polygon: &[DVec2], grid: &Grid) -> Result<(), String> {
    let Some(input) = Input::new(polygon, grid) else { return Ok(()) };
    let Some(pieces) = input.pieces() else { return Ok(()) };
    let (area, moment) = input.area_and_moment(polygon);
    let (area, moment) = (area.abs(), moment * area.signum());
    let about = |area: f64, c: DVec2| (c - input.first) * area;
    let of_pieces = pieces.iter().map(|p| (p.area, about(p.area, p.centroid))).collect::<Vec<_>>();
    let cells = cells(polygon, grid).map_err(|e| e.to_string())?;
    let of_cells = cells.values().map(|&(a, c)| (a, about(a, c))).collect::<Vec<_>>();
    let reach = polygon.iter().fold(grid.cell(), |m, v| m.max((*v - input.first).abs()));
    let area_slack = (area / grid.cell_area() + 1.0) * input.tolerance;
    for (name, parts) in [("split", of_pieces), ("accumulate", of_cells)] {
        let found: f64 = parts.iter().map(|p| p.0).sum();
        check((found - area).abs() <= area_slack, || format!("{name}: area {found} of {area}"))?;
        let found: DVec2 = parts.iter().map(|p| p.1).sum();
        let near = (found - moment).abs().cmple(reach * (4.0 * area_slack)).all();
        check(near, || format!("{name}: moment {found} of {moment}"))?;
    }
    Ok(())
}

/// Pieces lie in their closed cells, exactly: a corner beyond a line by one unit in the last place is an error.
///
/// # Errors
/// The piece and its cell.
pub fn vertices_lie_in_their_cells(polygon: &[DVec2], grid: &Grid) -> Result<(), String> {
    let Some(input) = Input::new(polygon, grid) else { return Ok(()) };
    for p in input.pieces().unwrap_or_default() {
        let (low, high) = (grid.corner(p.cell), grid.corner(p.cell + IVec2::ONE));
        for v in p.vertices.iter().chain([&p.centroid]) {
            let inside = v.cmpge(low).all() && v.cmple(high).all();
            check(inside, || format!("{v} outside of {low} to {high} in {p:?}"))?;
        }
    }
    Ok(())
}

/// Pieces are convex, turn like the polygon, have three to six corners, a possible code and a positive area.
///
/// # Errors
/// The piece.
pub fn pieces_are_convex_polygons(polygon: &[DVec2], grid: &Grid) -> Result<(), String> {
    let Some(input) = Input::new(polygon, grid) else { return Ok(()) };
    let (whole, _) = input.area_and_moment(polygon);
    for p in input.pieces().unwrap_or_default() {
        let n = p.vertices.len();
        check((3..=6).contains(&n), || format!("{n} corners: {p:?}"))?;
        let CodeKind::Cuts { corners } = p.code.kind() else { return Err(format!("code {}: {p:?}", p.code)) };
        check(n <= usize::from(corners), || format!("{n} corners for code {}", p.code))?;
        check(p.area > 0.0 && p.area <= grid.cell_area(), || format!("area: {p:?}"))?;
        let sign = if whole.abs() > input.tolerance { whole.signum() } else { 0.0 };
        let slack = 4.0 * input.slack.element_sum() * grid.cell().element_sum();
        for i in 0..n {
            let [a, b, c] = [0, 1, 2].map(|k| p.vertices[(i + k) % n]);
            check(sign * (b - a).perp_dot(c - b) >= -slack, || format!("not convex: {p:?}"))?;
        }
    }
    Ok(())
}

/// No two pieces of a cell overlap.
///
/// # Errors
/// The two pieces.
pub fn pieces_do_not_overlap(polygon: &[DVec2], grid: &Grid) -> Result<(), String> {
    let Some(input) = Input::new(polygon, grid) else { return Ok(()) };
    let pieces = input.pieces().unwrap_or_default();
    for (i, p) in pieces.iter().enumerate() {
        for q in pieces[i + 1..].iter().filter(|q| q.cell == p.cell) {
            let common = ring_area_and_moment(&clip_by_convex(&p.vertices, &q.vertices), input.first).0.abs();
            check(common <= 4.0 * input.tolerance, || format!("{common} in common: {p:?} and {q:?}"))?;
        }
    }
    Ok(())
}

/// The area in each cell is that of the polygon clipped to the cell by Sutherland and Hodgman's algorithm.
///
/// # Errors
/// The cell and both areas.
pub fn equals_sutherland_hodgman(polygon: &[DVec2], grid: &Grid) -> Result<(), String> {
    let Some(input) = Input::new(polygon, grid) else { return Ok(()) };
    let Some(pieces) = input.pieces() else { return Ok(()) };
    let mut found = BTreeMap::new();
    for p in &pieces {
        *found.entry(p.cell.to_array()).or_insert(0.0) += p.area;
    }
    for cell in cells_around(polygon, grid) {
        let wanted = cell_area_by_clipping(polygon, grid, cell).abs();
        let area = found.get(&cell.to_array()).copied().unwrap_or(0.0);
        check((area - wanted).abs() <= input.tolerance, || format!("{cell}: {area}, clipped {wanted}"))?;
    }
    Ok(())
}

/// Concave polygons too: the area in each cell is that of the clipped polygon, and lies in the cell.
///
/// # Errors
/// The cell and both areas.
pub fn accumulate_equals_clipping(ring: &[DVec2], grid: &Grid) -> Result<(), String> {
    let Some(input) = Input::new(ring, grid) else { return Ok(()) };
    let Ok(found) = cells(ring, grid) else { return Ok(()) };
    if input.area_and_moment(ring).0.abs() <= input.tolerance {
        return Ok(()); // the sign of the whole, and so of each cell, is beyond the comparator
    }
    for cell in cells_around(ring, grid) {
        // A ring that crosses itself has negative cells, which are left out.
        let wanted = cell_area_by_clipping(ring, grid, cell).max(0.0);
        let area = found.get(&(cell.y, cell.x)).map_or(0.0, |c| c.0);
        check((area - wanted).abs() <= input.tolerance, || format!("{cell}: {area}, clipped {wanted}"))?;
    }
    Ok(())
}

/// Both products find the same area in the same cells.
///
/// # Errors
/// The cell and both areas.
pub fn split_equals_accumulate(polygon: &[DVec2], grid: &Grid) -> Result<(), String> {
    let Some(input) = Input::new(polygon, grid) else { return Ok(()) };
    let Some(pieces) = input.pieces() else { return Ok(()) };
    let mut sums = cells(polygon, grid).map_err(|e| e.to_string())?;
    for p in &pieces {
        sums.entry((p.cell.y, p.cell.x)).or_insert((0.0, DVec2::ZERO)).0 -= p.area;
    }
    // Neither depends on input coordinates, so rounding is all there is; bends within the tolerance of convexity excepted.
    let tolerance =
        (8.0 * f64::EPSILON + 4.0 * crate::CONVEXITY_TOLERANCE * bend(polygon, grid)) * grid.cell_area();
    for (cell, (rest, _)) in sums {
        check(rest.abs() <= tolerance, || format!("{cell:?} differs by {rest}"))?;
    }
    Ok(())
}

/// Squared extent in cells if the polygon is more than a triangle, which may be concave by the tolerance; else 0.
fn bend(polygon: &[DVec2], grid: &Grid) -> f64 {
    let reach =
        polygon.iter().fold(0.0_f64, |m, v| m.max(((*v - polygon[0]) / grid.cell()).length_squared()));
    if polygon.len() > 3 { reach } else { 0.0 }
}

/// Two triangles on both sides of an edge, given in opposite directions, cut it into the same points, bit for bit.
///
/// # Errors
/// The points that only one of them has.
pub fn shared_edge_is_cut_alike(
    edge: [DVec2; 2],
    left: DVec2,
    right: DVec2,
    grid: &Grid,
) -> Result<(), String> {
    let ([a, b], length) = (edge, (edge[1] - edge[0]).length());
    let Some(input) = Input::new(&[a, b, left, right], grid).map(|i| i.slack.length()) else { return Ok(()) };
    let from_line = |p: DVec2| (b - a).perp_dot(p - a) / length;
    // Flat triangles have crossings of their other edges where those of the shared one are looked for, and along an
    // edge next to a line lie the ends of the bands.
    if (b - a).abs().min_element() <= 1e-3 * length
        || from_line(left).abs().min(from_line(right).abs()) < 1e-3 * length
    {
        return Ok(());
    }
    let crossings = |polygon: &[DVec2]| -> Option<Vec<[u64; 2]>> {
        let far_from_ends = |p: DVec2| p.distance(a).min(p.distance(b)) > 1e4 * input;
        // The end of a band next to a line may be rounded onto it.
        let ends_band = |p: DVec2| (p.y - left.y).abs().min((p.y - right.y).abs()) <= input;
        let on_edge = |p: &DVec2| from_line(*p).abs() <= 4.0 * input && far_from_ends(*p) && !ends_band(*p);
        let pieces = pieces(polygon, grid).ok()?;
        let corners = pieces.iter().flat_map(|p| p.vertices.iter().map(move |v| (p.cell, *v)));
        let on_line = corners.filter(|(cell, v)| {
            let (low, high) = (grid.corner(*cell), grid.corner(*cell + IVec2::ONE));
            // A corner of the grid next to the edge is a corner of pieces on one side only, and what lies between it and the edge may be
            // too small to be reported.
            let near_lines = (*v - low).abs().min((*v - high).abs()).cmple(DVec2::splat(1e4 * input));
            let on_lines = v.cmpeq(low) | v.cmpeq(high);
            on_lines.any() && !near_lines.all()
        });
        let mut points: Vec<_> =
            on_line.map(|(_, v)| v).filter(on_edge).map(|v| v.to_array().map(f64::to_bits)).collect();
        points.sort_unstable();
        points.dedup();
        Some(points)
    };
    let (Some(one), Some(other)) = (crossings(&[a, b, left]), crossings(&[b, a, right])) else {
        return Ok(());
    };
    let only = |these: &[[u64; 2]], those: &[[u64; 2]]| -> Vec<[f64; 2]> {
        these.iter().filter(|p| !those.contains(p)).map(|p| p.map(f64::from_bits)).collect()
    };
    check(one == other, || {
        format!("only left: {:?}, only right: {:?}", only(&one, &other), only(&other, &one))
    })
}

/// Moving a polygon by whole cells moves its cells, and changes no area by a bit. The shift must be exact in `f64`.
///
/// # Errors
/// What differs.
pub fn shift_by_whole_cells_shifts_the_result(polygon: &[DVec2], shift: IVec2) -> Result<(), String> {
    let moved: Vec<_> = polygon.iter().map(|v| *v + shift.as_dvec2()).collect();
    let exact = polygon
        .iter()
        .zip(&moved)
        .all(|(v, m)| *m - shift.as_dvec2() == *v && v.abs().cmpge(DVec2::splat(1e-9)).all());
    if !exact || Input::new(polygon, &Grid::UNIT).is_none() {
        return Ok(());
    }
    let of_pieces = |ring: &[DVec2], by: IVec2| {
        pieces(ring, &Grid::UNIT)
            .map(|p| p.iter().map(|p| (p.cell - by, p.area.to_bits(), p.code)).collect::<Vec<_>>())
    };
    check(of_pieces(polygon, IVec2::ZERO).ok() == of_pieces(&moved, shift).ok(), || {
        "pieces differ".to_owned()
    })?;
    let of_cells = |ring: &[DVec2], by: IVec2| {
        cells(ring, &Grid::UNIT)
            .map(|c| c.iter().map(|(k, v)| ((k.0 - by.y, k.1 - by.x), v.0.to_bits())).collect::<Vec<_>>())
    };
    check(of_cells(polygon, IVec2::ZERO).ok() == of_cells(&moved, shift).ok(), || "cells differ".to_owned())
}

/// The other orientation, or another first vertex, gives the same cells with the same areas, bit for bit.
///
/// # Errors
/// What differs.
pub fn order_of_vertices_does_not_matter(ring: &[DVec2], grid: &Grid) -> Result<(), String> {
    if Input::new(ring, grid).is_none() {
        return Ok(());
    }
    let areas = |ring: &[DVec2]| {
        cells(ring, grid).map(|c| c.iter().map(|(k, v)| (*k, v.0.to_bits())).collect::<Vec<_>>()).ok()
    };
    let reversed: Vec<_> = ring.iter().rev().copied().collect();
    let mut rotated = ring.to_vec();
    rotated.rotate_left(1);
    let wanted = areas(ring);
    check(areas(&reversed) == wanted, || "reversed ring differs".to_owned())?;
    check(areas(&rotated) == wanted, || "rotated ring differs".to_owned())
}

/// Every fact about one polygon, convex or not.
///
/// # Errors
/// The first that does not hold.
pub fn all_of(polygon: &[DVec2], grid: &Grid) -> Result<(), String> {
    area_and_moments_are_conserved(polygon, grid)?;
    vertices_lie_in_their_cells(polygon, grid)?;
    pieces_are_convex_polygons(polygon, grid)?;
    pieces_do_not_overlap(polygon, grid)?;
    equals_sutherland_hodgman(polygon, grid)?;
    accumulate_equals_clipping(polygon, grid)?;
    split_equals_accumulate(polygon, grid)
}

/// The cells of the polygon's bounding box, and one more on each side.
fn cells_around(polygon: &[DVec2], grid: &Grid) -> impl Iterator<Item = IVec2> {
    let in_cells = |v: &DVec2| (*v - grid.origin()) / grid.cell();
    let low = polygon.iter().map(in_cells).reduce(DVec2::min).unwrap_or_default().floor().as_ivec2() - 1;
    let high = polygon.iter().map(in_cells).reduce(DVec2::max).unwrap_or_default().floor().as_ivec2() + 1;
    (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec2::new(x, y)))
}

/// Area of the polygon in a cell, negative where a ring that crosses itself turns the other way than the whole: Sutherland–Hodgman against the four sides, relative to the cell's corner.
#[must_use]
pub fn cell_area_by_clipping(polygon: &[DVec2], grid: &Grid, cell: IVec2) -> f64 {
    let corner = grid.corner(cell);
    let local: Vec<_> = polygon.iter().map(|v| (*v - corner) / grid.cell()).collect();
    let unit = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
    let clipped = clip_by_convex(&local, &unit);
    let (area, _) = ring_area_and_moment(&clipped, clipped.first().copied().unwrap_or_default());
    let (sign, _) = ring_area_and_moment(&local, local[0]);
    area * sign.signum() * grid.cell_area()
}

/// Sutherland–Hodgman: the part of `subject` in the convex `window`, of either orientation.
fn clip_by_convex(subject: &[DVec2], window: &[DVec2]) -> Vec<DVec2> {
    let sign = ring_area_and_moment(window, window[0]).0.signum();
    let mut ring = subject.to_vec();
    for (i, &a) in window.iter().enumerate() {
        let along = window[(i + 1) % window.len()] - a;
        let side = |p: DVec2| sign * along.perp_dot(p - a);
        let mut kept = Vec::with_capacity(ring.len() + 1);
        for (k, &q) in ring.iter().enumerate() {
            let p = ring[(k + ring.len() - 1) % ring.len()];
            let (from, to) = (side(p), side(q));
            if (from < 0.0) != (to < 0.0) {
                kept.push(p + (q - p) * (from / (from - to)));
            }
            if to >= 0.0 {
                kept.push(q);
            }
        }
        ring = kept;
    }
    ring
}
