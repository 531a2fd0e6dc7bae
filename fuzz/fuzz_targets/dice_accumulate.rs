//! Rings of any shape, also crossing themselves: order of vertices, and areas of those that are star-shaped.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DVec2, dvec2};
use libfuzzer_sys::fuzz_target;
use pointillist_dice::{Accumulator, Grid, accumulate, invariants};

#[derive(Arbitrary, Debug)]
struct Input {
    ring: Vec<[i16; 2]>,
    radii: Vec<u8>,
    raw: Vec<[f64; 2]>,
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
    }
    // Any floats: an answer or an error. Those that take seconds by right are left out.
    let raw: Vec<_> = input.raw.iter().map(|&v| DVec2::from_array(v)).collect();
    let size = raw.iter().fold(0.0_f64, |m, v| m.max(v.abs().max_element()));
    if !(1e4..2e9).contains(&size) {
        let _ = accumulate(&raw, &Grid::UNIT, &mut Accumulator::new(), |_| ());
    }
});
