//! Facts about polygons of several rings, windows and mirrored grids.

use glam::{DVec2, dvec2};

use super::{Cells, Input, cells, check, pieces};
use crate::{Accumulator, CellWindow, DiceError, FillRule, Grid, accumulate_filled};

/// The cells of a polygon of several rings, runs taken apart.
///
/// # Errors
/// As [`accumulate_filled`].
pub fn filled_cells(rings: &[&[DVec2]], rule: FillRule, grid: &Grid) -> Result<Cells, DiceError> {
    let mut cells = Cells::new();
    accumulate_filled(rings, rule, grid, &mut Accumulator::new(), |run| {
        for (cell, centroid) in run.cells(grid) {
            cells.insert((cell.y, cell.x), (run.area, centroid));
        }
    })?;
    Ok(cells)
}

/// Whether all rings together are few enough cells to be checked.
fn is_checkable(rings: &[&[DVec2]], grid: &Grid) -> bool {
    Input::new(&rings.concat(), grid).is_some()
}

/// Rings that repeat their first vertex at the end have the pieces and cells of those that do not, bit for bit.
///
/// # Errors
/// What differs.
pub fn closed_rings_are_open_ones(rings: &[&[DVec2]], rule: FillRule, grid: &Grid) -> Result<(), String> {
    if !is_checkable(rings, grid) {
        return Ok(());
    }
    let closed: Vec<Vec<DVec2>> =
        rings.iter().map(|ring| ring.iter().chain(ring.first()).copied().collect()).collect();
    let closed: Vec<&[DVec2]> = closed.iter().map(Vec::as_slice).collect();
    check(filled_cells(rings, rule, grid) == filled_cells(&closed, rule, grid), || {
        format!("filled, closed: {rings:?}")
    })?;
    for (ring, closed) in rings.iter().zip(closed) {
        check(cells(ring, grid) == cells(closed, grid), || format!("accumulated, closed: {ring:?}"))?;
        let of_pieces = |ring: &[DVec2]| {
            pieces(ring, grid)
                .map(|found| found.into_iter().map(|p| (p.cell, p.vertices, p.area)).collect::<Vec<_>>())
        };
        check(of_pieces(ring) == of_pieces(closed), || format!("split, closed: {ring:?}"))?;
    }
    Ok(())
}

/// In a window there are the cells of the whole, with the same areas bit for bit.
///
/// # Errors
/// The window and the rings.
pub fn filled_window_is_part_of_the_whole(
    rings: &[&[DVec2]],
    rule: FillRule,
    grid: &Grid,
    window: CellWindow,
) -> Result<(), String> {
    if !is_checkable(rings, grid) {
        return Ok(());
    }
    let areas = |grid: &Grid| -> Option<Vec<((i32, i32), u64)>> {
        let cells = filled_cells(rings, rule, grid).ok()?;
        Some(cells.into_iter().map(|(cell, (area, _))| (cell, area.to_bits())).collect())
    };
    let CellWindow { x0, y0, x1, y1 } = window;
    let mut whole = areas(grid);
    whole.iter_mut().for_each(|cells| {
        cells.retain(|((row, column), _)| (x0..x1).contains(column) && (y0..y1).contains(row));
    });
    let limited = areas(&grid.with_window(window));
    check(limited == whole, || format!("{window:?} of {rings:?}: {limited:x?}, not {whole:x?}"))
}

/// A grid with negative sides has the cells that the grid with positive sides has of the mirrored polygon, with the same areas and mirrored
/// corners and centroids, bit for bit.
///
/// # Errors
/// What differs.
pub fn mirrored_grids_mirror_the_cells(
    rings: &[&[DVec2]],
    rule: FillRule,
    grid: &Grid,
) -> Result<(), String> {
    if !is_checkable(rings, grid) {
        return Ok(());
    }
    for sign in [dvec2(-1.0, 1.0), dvec2(1.0, -1.0), dvec2(-1.0, -1.0)] {
        let Ok(other) = Grid::new(grid.origin() * sign, grid.cell() * sign) else { continue };
        let mirrored: Vec<Vec<DVec2>> = rings.iter().map(|r| r.iter().map(|v| *v * sign).collect()).collect();
        let mirrored: Vec<&[DVec2]> = mirrored.iter().map(Vec::as_slice).collect();
        let wanted = filled_cells(rings, rule, grid);
        let mut found = filled_cells(&mirrored, rule, &other);
        found.iter_mut().flat_map(Cells::values_mut).for_each(|(_, centroid)| *centroid *= sign);
        check(found == wanted, || format!("cells of {rings:?} times {sign}: {found:?}, not {wanted:?}"))?;
        for (ring, mirrored) in rings.iter().zip(mirrored) {
            let of_pieces = |ring: &[DVec2], grid: &Grid, sign: DVec2| {
                let turned = |p: super::OwnedPiece| {
                    let vertices: Vec<_> = p.vertices.iter().map(|v| *v * sign).collect();
                    (p.cell, vertices, p.area, p.centroid * sign)
                };
                pieces(ring, grid).map(|found| found.into_iter().map(turned).collect::<Vec<_>>())
            };
            check(of_pieces(ring, grid, DVec2::ONE) == of_pieces(mirrored, &other, sign), || {
                format!("pieces of {ring:?} times {sign}")
            })?;
        }
    }
    Ok(())
}

/// Rings within rings, each the outline made smaller towards `centre` by a factor of `shares`: the even-odd rule, and the non-zero rule with
/// rings that go round in turns, count outline, hole, island, … with alternating signs in every cell; the non-zero rule for rings of one
/// direction counts the outline alone, bit for bit. Checked for outlines that are star-shaped about `centre`.
///
/// # Errors
/// The cell and both areas.
pub fn nested_rings_alternate(
    outline: &[DVec2],
    centre: DVec2,
    shares: &[f64],
    grid: &Grid,
) -> Result<(), String> {
    let mut shares: Vec<f64> = [1.0].into_iter().chain(shares.iter().copied()).collect();
    let spokes =
        || outline.iter().zip(outline.iter().cycle().skip(1)).map(|(a, b)| (*a - centre, *b - centre));
    let size = outline.iter().fold(0.0_f64, |m, v| m.max((*v - centre).length_squared()));
    let turns = spokes().map(|(a, b)| a.angle_to(b)).sum::<f64>() / std::f64::consts::TAU;
    let is_star = spokes().all(|(a, b)| a.perp_dot(b) > 1e-3 * size) && (turns - 1.0).abs() < 0.1;
    shares.sort_by(|a, b| b.total_cmp(a));
    let are_apart =
        shares.windows(2).all(|s| s[0] - s[1] > 1e-3) && shares.iter().all(|s| (1e-3..=1.0).contains(s));
    if !is_star || !are_apart || !is_checkable(&[outline], grid) {
        return Ok(());
    }
    let ring = |share: f64| outline.iter().map(|v| centre + (*v - centre) * share).collect::<Vec<_>>();
    let one_way: Vec<Vec<DVec2>> = shares.iter().map(|&share| ring(share)).collect();
    let mut in_turns = one_way.clone();
    in_turns.iter_mut().skip(1).step_by(2).for_each(|ring| ring.reverse());
    let filled = |rings: &[Vec<DVec2>], rule: FillRule| {
        let rings: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
        filled_cells(&rings, rule, grid).map_err(|e| e.to_string())
    };
    let areas = |cells: &Cells| cells.iter().map(|(k, v)| (*k, v.0.to_bits())).collect::<Vec<_>>();
    let outline_cells = cells(&one_way[0], grid).map_err(|e| e.to_string())?;
    let united = filled(&one_way, FillRule::NonZero)?;
    check(areas(&united) == areas(&outline_cells), || format!("united: {united:?}, not {outline_cells:?}"))?;

    let found = filled(&one_way, FillRule::EvenOdd)?;
    check(areas(&found) == areas(&filled(&in_turns, FillRule::EvenOdd)?), || "directions matter".to_owned())?;
    check(areas(&found) == areas(&filled(&in_turns, FillRule::NonZero)?), || "the rules differ".to_owned())?;
    let mut wanted = outline_cells;
    for (i, ring) in one_way.iter().enumerate().skip(1) {
        for (cell, (area, _)) in cells(ring, grid).map_err(|e| e.to_string())? {
            let signed = if i % 2 == 1 { -area } else { area };
            wanted.entry(cell).or_insert((0.0, DVec2::ZERO)).0 += signed;
        }
    }
    // Each area is rounded once.
    let rounding = f64::EPSILON * shares.len() as f64 * grid.cell_area();
    for (cell, (wanted, _)) in wanted {
        let area = found.get(&cell).map_or(0.0, |c| c.0);
        check((area - wanted).abs() <= rounding, || format!("{cell:?}: {area}, rings {wanted}"))?;
    }
    Ok(())
}
