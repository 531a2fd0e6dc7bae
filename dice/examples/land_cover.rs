//! How much of a polygon with a hole is water, forest and field, by a raster of land cover: every cell counts by its exact share.
//!
//! `cargo run -p pointillist-dice --example land_cover`

use glam::{DVec2, dvec2};
use pointillist_dice::{Accumulator, CellWindow, DiceError, FillRule, Grid, accumulate_filled};

const CLASSES: [&str; 3] = ["water", "forest", "field"];
const COLUMNS: i32 = 12;
const ROWS: i32 = 8;
/// Metres.
const CELL: f64 = 30.0;

/// The class of a cell: a river along a diagonal, forest north of it, fields south of it. Row 0 is the northernmost.
fn class(column: i32, row: i32) -> usize {
    match 2 * row - column {
        -1..=1 => 0,
        ..-1 => 1,
        _ => 2,
    }
}

fn main() -> Result<(), DiceError> {
    // A north-up raster as GeoTIFF has it: the north-western corner, and rows that go south.
    let corner = dvec2(400_000.0, 5_600_000.0);
    let window = CellWindow { x0: 0, y0: 0, x1: COLUMNS, y1: ROWS };
    let grid = Grid::new(corner, dvec2(CELL, -CELL))?.with_window(window);

    // A parcel, and a pond in it that belongs to someone else: closed rings, as in GeoJSON, in metres from the corner.
    let place = |[east, south]: [f64; 2]| corner + dvec2(east, -south);
    let parcel = [[20.0, 25.0], [310.0, 10.0], [340.0, 200.0], [95.0, 230.0], [20.0, 25.0]].map(place);
    let pond = [[150.0, 80.0], [200.0, 80.0], [175.0, 130.0], [150.0, 80.0]].map(place);

    let mut area = [0.0; CLASSES.len()];
    accumulate_filled(&[&parcel, &pond], FillRule::EvenOdd, &grid, &mut Accumulator::new(), |run| {
        for column in run.columns {
            area[class(column, run.row)] += run.area;
        }
    })?;

    let total: f64 = area.iter().sum();
    for (name, area) in CLASSES.iter().zip(area) {
        println!("{name:6} {area:8.1} m² {:5.1} %", 100.0 * area / total);
    }
    let expected = ring_area(&parcel) - ring_area(&pond);
    println!("cells  {total:8.1} m², parcel without pond {expected:.1} m²");
    assert!((total - expected).abs() < 1e-6);
    Ok(())
}

/// Gauss's area formula.
fn ring_area(ring: &[DVec2]) -> f64 {
    let twice: f64 = ring.windows(2).map(|side| (side[0] - ring[0]).perp_dot(side[1] - ring[0])).sum();
    0.5 * twice.abs()
}
