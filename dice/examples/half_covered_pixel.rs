//! Draws a triangle as text, every cell as dark as it is covered, and checks the sum of the areas.
//!
//! `cargo run -p pointillist-dice --example half_covered_pixel`

use glam::dvec2;
use pointillist_dice::{Accumulator, DiceError, Grid, accumulate};

const WIDTH: usize = 32;
const HEIGHT: usize = 12;

fn main() -> Result<(), DiceError> {
    // Characters are about twice as tall as wide, and so are the cells.
    let grid = Grid::new(dvec2(0.0, 0.0), dvec2(1.0, 2.0))?;
    let triangle = [dvec2(2.0, 1.0), dvec2(31.0, 9.0), dvec2(9.0, 23.0)];
    let mut cover = [[0.0; WIDTH]; HEIGHT];
    accumulate(&triangle, &grid, &mut Accumulator::new(), |run| {
        for (cell, _) in run.cells(&grid) {
            cover[cell.y as usize][cell.x as usize] = run.area / grid.cell_area();
        }
    })?;
    for row in cover {
        let line: String = row
            .iter()
            .map(|c| [' ', '.', ':', '-', '=', '+', '*', '%', '#', '@'][(c * 9.0) as usize])
            .collect();
        println!("{line}");
    }
    let sum: f64 = cover.iter().flatten().sum::<f64>() * grid.cell_area();
    let area = 0.5 * (triangle[1] - triangle[0]).perp_dot(triangle[2] - triangle[0]);
    println!("cells {sum}, triangle {area}");
    Ok(())
}
