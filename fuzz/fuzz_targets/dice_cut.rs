//! Triangles on both sides of an edge, anywhere: every fact about the engine that the renderers use.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DVec2, dvec2};
use libfuzzer_sys::fuzz_target;
use pointillist_dice::{CellWindow, cut, invariants};

/// Corners in steps of 1/4096 of their scale, often on grid lines, and any floats for what those cannot say.
#[derive(Arbitrary, Debug)]
struct Input {
    steps: [[i16; 2]; 4],
    exponent: u8,
    shift: [f64; 2],
    nudge: f64,
    window: [i8; 4],
    raw: Option<[[f64; 2]; 3]>,
}

fuzz_target!(|input: Input| {
    let scale = 2f64.powi(-i32::from(input.exponent % 64)) * 16.0;
    let shift = dvec2(input.shift[0] % 1e9, input.shift[1] % 1e9);
    let mut points = input.steps.map(|[x, y]| dvec2(x.into(), y.into()) / 4096.0 * scale + shift);
    points[2].x += input.nudge % 1e-9;
    if !points.iter().all(|p| p.is_finite()) {
        return;
    }
    let [a, b, left, right] = points;
    let [x0, y0, width, height] = input.window.map(i32::from);
    let low = shift.floor().as_ivec2();
    let window = CellWindow {
        x0: low.x.saturating_add(x0),
        y0: low.y.saturating_add(y0),
        x1: low.x.saturating_add(x0 + width.abs()),
        y1: low.y.saturating_add(y0 + height.abs()),
    };
    let facts = invariants::cut_equals_accumulate(&[a, b, left])
        .and_then(|()| invariants::cut_pieces_lie_in_their_cells(&[a, b, left]))
        .and_then(|()| invariants::cut_window_is_part_of_the_whole(&[a, b, left], window))
        .and_then(|()| invariants::cut_shares_edges([a, b], left, right));
    if let Err(broken) = facts {
        panic!("{broken}");
    }
    // Finite numbers near a small window, however large and however thin what they span.
    if let Some(raw) = input.raw {
        let raw = raw.map(DVec2::from_array);
        if raw.iter().all(|p| p.is_finite() && p.abs().max_element() <= f64::from(1 << 30)) {
            cut(&raw, CellWindow { x0: -4, y0: -4, x1: 4, y1: 4 }, |_| ());
        }
    }
});
