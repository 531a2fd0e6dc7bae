//! Discs into a tile: nearest depths, then weighted sums.

use crate::splat::Splat;
use crate::tile::{Layer, PITCH, Sums};
use pulp::{Arch, NullaryFnOnce};

/// Pixels that are computed together.
pub(crate) const LANES: usize = 8;

/// Distances of the pixels of a run from its first.
const RAMP: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// Keeps the nearest depth of all `splats`; of those behind the floor unless this is the `FIRST` layer.
pub(crate) fn nearest<const FIRST: bool>(layer: &mut Layer, splats: &[Splat]) {
    Arch::new().dispatch(Nearest::<FIRST, _> { layer, splats: splats.iter() });
}

/// As [`nearest`] behind the floor, of the splats with these numbers.
pub(crate) fn nearest_of(layer: &mut Layer, splats: &[Splat], numbers: &[u32]) {
    let splats = numbers.iter().map(|&i| &splats[i as usize]);
    Arch::new().dispatch(Nearest::<false, _> { layer, splats });
}

/// Adds up the splats with these numbers that belong to the nearest surface; `behind` gets the numbers of those that have
/// parts behind it.
pub(crate) fn add<const FIRST: bool>(
    layer: &mut Layer,
    splats: &[Splat],
    numbers: impl Iterator<Item = u32>,
    behind: &mut Vec<u32>,
    coloured: bool,
) {
    let arch = Arch::new();
    if coloured {
        arch.dispatch(Add::<FIRST, 12, _> { layer, splats, numbers, behind });
    } else {
        arch.dispatch(Add::<FIRST, 8, _> { layer, splats, numbers, behind });
    }
}

struct Nearest<'a, const FIRST: bool, I> {
    layer: &'a mut Layer,
    splats: I,
}

impl<'s, const FIRST: bool, I: Iterator<Item = &'s Splat>> NullaryFnOnce for Nearest<'_, FIRST, I> {
    type Output = ();

    // A closure would not be inlined into the vectorised caller, and what is not inlined stays narrow.
    #[inline(always)]
    fn call(self) {
        let Layer { near, floor, .. } = self.layer;
        for s in self.splats {
            for_each_run(s, |at, run| {
                let near = lanes_mut(near, at);
                let floor: &[f32; LANES] = if FIRST { &[0.0; LANES] } else { lanes(floor, at) };
                for i in 0..LANES {
                    let shown = run.inside[i] & (FIRST | (run.depth[i] > floor[i] + s.thickness));
                    let depth = if shown { run.depth[i] } else { f32::INFINITY };
                    near[i] = if depth < near[i] { depth } else { near[i] };
                }
            });
        }
    }
}

struct Add<'a, const FIRST: bool, const N: usize, I> {
    layer: &'a mut Layer,
    splats: &'a [Splat],
    numbers: I,
    behind: &'a mut Vec<u32>,
}

impl<const FIRST: bool, const N: usize, I: Iterator<Item = u32>> NullaryFnOnce for Add<'_, FIRST, N, I> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Layer { near, floor, sums } = self.layer;
        for number in self.numbers {
            let s = &self.splats[number as usize];
            let mut is_behind = false;
            for_each_run(s, |at, run| {
                let near = lanes(near, at);
                let floor: &[f32; LANES] = if FIRST { &[0.0; LANES] } else { lanes(floor, at) };
                let (weights, behind) = weights::<FIRST>(s, run, near, floor);
                is_behind |= behind;
                add_run::<N>(s, run, &weights, &mut sums[at..at + LANES]);
            });
            if is_behind {
                self.behind.push(number);
            }
        }
    }
}

/// A row of pixels under a splat.
struct Run {
    /// Whether the kernel is above 0 there.
    inside: [bool; LANES],
    /// 1 − q/R.
    rest: [f32; LANES],
    depth: [f32; LANES],
}

/// Calls `each` with the index of the first pixel for all runs that cover a splat.
#[inline(always)]
fn for_each_run(s: &Splat, mut each: impl FnMut(usize, &Run)) {
    let [left, right] = s.columns.map(usize::from);
    for row in usize::from(s.rows[0])..usize::from(s.rows[1]) {
        let dy = row as f32 + 0.5 - s.y;
        for column in (left..right).step_by(LANES) {
            let first = column as f32 + 0.5 - s.x;
            let mut run = Run { inside: [false; LANES], rest: [0.0; LANES], depth: [0.0; LANES] };
            for i in 0..LANES {
                let dx = first + RAMP[i];
                let h = 1.0 + s.kx * dx + s.ky * dy;
                let q = s.xx * dx * dx + 2.0 * s.xy * dx * dy + s.yy * dy * dy;
                // Beyond the horizon of its plane, h is not above 0.
                let rest = 1.0 - q / (h * h);
                run.rest[i] = rest;
                run.inside[i] = (rest > 0.0) & (h > 0.0);
                run.depth[i] = s.depth + s.depth_x * dx + s.depth_y * dy;
            }
            each(row * PITCH + column, &run);
        }
    }
}

#[inline(always)]
fn lanes(all: &[f32], at: usize) -> &[f32; LANES] {
    all[at..at + LANES].try_into().expect("a run has as many entries as there are lanes")
}

#[inline(always)]
fn lanes_mut(all: &mut [f32], at: usize) -> &mut [f32; LANES] {
    (&mut all[at..at + LANES]).try_into().expect("a run has as many entries as there are lanes")
}

/// Weights in the nearest surface, and whether any pixel has the disc behind it.
#[inline(always)]
fn weights<const FIRST: bool>(
    s: &Splat,
    run: &Run,
    near: &[f32; LANES],
    floor: &[f32; LANES],
) -> ([f32; LANES], bool) {
    let mut weights = [0.0; LANES];
    let mut behind = 0;
    for i in 0..LANES {
        let seen = run.inside[i] & (FIRST | (run.depth[i] > floor[i] + s.thickness));
        let belongs = run.depth[i] <= near[i] + s.thickness;
        let rest = if seen & belongs { run.rest[i] } else { 0.0 };
        weights[i] = s.weight * if s.flat { rest.sqrt() } else { rest * rest };
        behind |= u32::from(seen & !belongs);
    }
    (weights, behind != 0)
}

#[inline(always)]
fn add_run<const N: usize>(s: &Splat, run: &Run, weights: &[f32; LANES], sums: &mut [Sums]) {
    for i in 0..LANES {
        let w = weights[i];
        if w > 0.0 {
            let sum = &mut sums[i];
            for k in 0..N {
                sum[k] += w * s.values[k];
            }
            sum[2] += w * run.depth[i];
        }
    }
}
