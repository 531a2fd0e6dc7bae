//! Triangles anywhere: every fact about their pieces.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DVec2, dvec2};
use libfuzzer_sys::fuzz_target;
use pointillist_dice::{Grid, invariants};

/// A triangle in steps of 1/4096 of its scale, and any floats for what those cannot say.
#[derive(Arbitrary, Debug)]
struct Triangle {
    steps: [[i16; 2]; 3],
    exponent: u8,
    shift: [f64; 2],
    nudge: f64,
}

impl Triangle {
    fn points(&self) -> [DVec2; 3] {
        let scale = 2f64.powi(-i32::from(self.exponent % 64)) * 16.0;
        let shift = dvec2(self.shift[0] % 1e7, self.shift[1] % 1e7);
        let mut points = self.steps.map(|[x, y]| dvec2(f64::from(x), f64::from(y)) / 4096.0 * scale + shift);
        points[2].x += self.nudge % 1e-9;
        points
    }
}

fuzz_target!(|triangle: Triangle| {
    let points = triangle.points();
    if let Err(broken) = invariants::all_of(&points, &Grid::UNIT) {
        panic!("{broken} for {points:?}");
    }
});
