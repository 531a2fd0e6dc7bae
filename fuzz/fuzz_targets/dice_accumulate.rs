//! Rings of any shape, also crossing themselves and one another: order of vertices, closed rings, windows, mirrored grids, and areas of those
//! that are star-shaped, with holes.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DVec2, dvec2};
use libfuzzer_sys::fuzz_target;
use pointillist_dice::{Accumulator, CellWindow, FillRule, Grid, accumulate, invariants};

#[derive(Arbitrary, Debug)]
struct Input {
    ring: Vec<[i16; 2]>,
    radii: Vec<u8>,
    raw: Vec<[f64; 2]>,
    more_rings: Vec<Vec<[i16; 2]>>,
    shares: Vec<u8>,
    window: [i8; 4],
    non_zero: bool,
    cell: [i8; 2],
}

fuzz_target!(|input: Input| {
    let check = |result: Result<(), String>| {
        if let Err(broken) = result {
            panic!("{broken}");
        }
    };
    // Steps of 1/2048 of a cell are often on the lines.
    let ring: Vec<_> = input.ring.iter().take(64).map(|&[x, y]| dvec2(x.into(), y.into()) / 2048.0).collect();
    check(invariants::order_of_vertices_does_not_matter(&ring, &Grid::UNIT));
    let step = std::f64::consts::TAU / input.radii.len().max(1) as f64;
    let star = |(i, r): (usize, &u8)| DVec2::from_angle(i as f64 * step) * (f64::from(*r) + 1.0) / 32.0;
    let star: Vec<_> = input.radii.iter().take(64).enumerate().map(star).collect();
    if star.len() == input.radii.len() {
        check(invariants::accumulate_equals_clipping(&star, &Grid::UNIT));
        let shares: Vec<_> = input.shares.iter().take(6).map(|&s| f64::from(s) / 256.0).collect();
        check(invariants::nested_rings_alternate(&star, DVec2::ZERO, &shares, &Grid::UNIT));
    }
    let place = |&[x, y]: &[i16; 2]| dvec2(x.into(), y.into()) / 2048.0;
    let more = input.more_rings.iter().take(5).map(|ring| ring.iter().take(24).map(place).collect());
    let rings: Vec<Vec<DVec2>> = [ring].into_iter().chain(more).collect();
    let rings: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
    let rule = if input.non_zero { FillRule::NonZero } else { FillRule::EvenOdd };
    let [x0, y0, width, height] = input.window.map(|v| i32::from(v) / 4);
    let window = CellWindow { x0, y0, x1: x0 + width.abs(), y1: y0 + height.abs() };
    let cell = dvec2(input.cell[0].into(), input.cell[1].into()) / 32.0;
    let grid = Grid::new(DVec2::ZERO, cell).unwrap_or(Grid::UNIT);
    check(invariants::closed_rings_are_open_ones(&rings, rule, &grid));
    check(invariants::filled_window_is_part_of_the_whole(&rings, rule, &grid, window));
    check(invariants::mirrored_grids_mirror_the_cells(&rings, rule, &grid));
    // Any floats: an answer or an error. Those that take seconds by right are left out.
    let raw: Vec<_> = input.raw.iter().map(|&v| DVec2::from_array(v)).collect();
    let size = raw.iter().fold(0.0_f64, |m, v| m.max(v.abs().max_element()));
    if !(1e4..2e9).contains(&size) {
        let _ = accumulate(&raw, &Grid::UNIT, &mut Accumulator::new(), |_| ());
    }
});
