//! A polygon over a grid: `polygon COLUMNS ROWS RULE X Y …`, in cells from the upper left corner of the grid; rule `even-odd` or `non-zero`.
//!
//! * `areas`: the share of each cell that is covered, row by row;
//! * `sum`: of these;
//! * `inside`: the area of the polygon within the grid, and `whole`: all of it. Each is asked of one large cell, a computation of its own.

use crate::SiteError;
use crate::reply::Reply;
use crate::request::Request;
use glam::{DVec2, dvec2};
use pointillist_dice::{Accumulator, CellWindow, DiceError, FillRule, Grid, accumulate_filled};

/// Most columns and rows.
const MOST: u32 = 64;
/// Half a side of the cell that holds all polygons of the page: a power of two, so that coordinates in it are exact.
const EVERYWHERE: f64 = 1024.0;

pub(crate) fn answer(request: &mut Request<'_>) -> Result<Reply, SiteError> {
    let columns = request.count("columns", 1, MOST)?;
    let rows = request.count("rows", 1, MOST)?;
    let rules = [("even-odd", FillRule::EvenOdd), ("non-zero", FillRule::NonZero)];
    let rule = request.one_of("rule", "even-odd or non-zero", &rules)?;
    let polygon = corners(request)?;

    let mut areas = vec![0.0; (columns * rows) as usize];
    let window = CellWindow { x0: 0, y0: 0, x1: columns as i32, y1: rows as i32 };
    let all = [&polygon[..]];
    accumulate_filled(&all, rule, &Grid::UNIT.with_window(window), &mut Accumulator::new(), |run| {
        for column in run.columns {
            areas[(run.row * columns as i32 + column) as usize] = run.area;
        }
    })?;
    let sum: f64 = areas.iter().sum();
    let inside = area_in_cell(&polygon, rule, DVec2::ZERO, dvec2(columns.into(), rows.into()))?;
    let whole = area_in_cell(&polygon, rule, DVec2::splat(-EVERYWHERE), DVec2::splat(2.0 * EVERYWHERE))?;
    Ok(Reply::default()
        .with("areas", areas)
        .with("sum", [sum])
        .with("inside", [inside])
        .with("whole", [whole]))
}

fn corners(request: &mut Request<'_>) -> Result<Vec<DVec2>, SiteError> {
    let numbers = request.numbers("corner")?;
    let is_near = |n: &f64| n.abs() < EVERYWHERE;
    match numbers.iter().find(|n| !is_near(n)) {
        Some(far) => {
            Err(SiteError::Word { name: "corner", expected: "within 1024 cells", word: far.to_string() })
        }
        None => Ok(numbers.chunks_exact(2).map(DVec2::from_slice).collect()),
    }
}

/// The polygon's area in one cell.
fn area_in_cell(polygon: &[DVec2], rule: FillRule, origin: DVec2, cell: DVec2) -> Result<f64, DiceError> {
    let window = CellWindow { x0: 0, y0: 0, x1: 1, y1: 1 };
    let grid = Grid::new(origin, cell)?.with_window(window);
    let mut area = 0.0;
    accumulate_filled(&[polygon], rule, &grid, &mut Accumulator::new(), |run| area = run.area)?;
    Ok(area)
}
