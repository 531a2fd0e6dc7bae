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
/// parts behind it. Discs may lie behind a surface by `slack` more than their thickness (bent depth).
pub(crate) fn add<const FIRST: bool>(
    layer: &mut Layer,
    splats: &[Splat],
    numbers: impl Iterator<Item = u32>,
    behind: &mut Vec<u32>,
    slack: f32,
) {
    Arch::new().dispatch(Add::<FIRST, _> { layer, splats, numbers, behind, slack });
}

struct Nearest<'a, const FIRST: bool, I> {
    layer: &'a mut Layer,
    splats: I,
}

impl<'s, const FIRST: bool, I: Iterator<Item = &'s Splat>> NullaryFnOnce for Nearest<'_, FIRST, I> {
    type Output = ();

    // Loops and functions that are always inlined, no closures: what is not inlined into the vectorised caller stays narrow.
    #[inline(always)]
    fn call(self) {
        let Layer { near, sharpness, floor, .. } = self.layer;
        for s in self.splats {
            let columns = usize::from(s.columns[0])..usize::from(s.columns[1]);
            for row in usize::from(s.rows[0])..usize::from(s.rows[1]) {
                for column in columns.clone().step_by(LANES) {
                    let run = Run::of(s, row, column);
                    let at = row * PITCH + column;
                    let shown = run.is_seen::<FIRST>(s, floor, at);
                    let (near, sharpness) = (lanes_mut(near, at), lanes_mut(sharpness, at));
                    for i in 0..LANES {
                        let depth = if shown[i] { run.depth[i] } else { f32::INFINITY };
                        let nearer = depth < near[i];
                        near[i] = if nearer { depth } else { near[i] };
                        sharpness[i] = if nearer { s.sharpness } else { sharpness[i] };
                    }
                }
            }
        }
    }
}

struct Add<'a, const FIRST: bool, I> {
    layer: &'a mut Layer,
    splats: &'a [Splat],
    numbers: I,
    behind: &'a mut Vec<u32>,
    slack: f32,
}

impl<const FIRST: bool, I: Iterator<Item = u32>> NullaryFnOnce for Add<'_, FIRST, I> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Layer { near, floor, sums, .. } = self.layer;
        for number in self.numbers {
            let s = &self.splats[number as usize];
            let columns = usize::from(s.columns[0])..usize::from(s.columns[1]);
            let mut is_behind = false;
            for row in usize::from(s.rows[0])..usize::from(s.rows[1]) {
                for column in columns.clone().step_by(LANES) {
                    let run = Run::of(s, row, column);
                    let at = row * PITCH + column;
                    let seen = run.is_seen::<FIRST>(s, floor, at);
                    let (weights, behind) = run.weights(s, &seen, lanes(near, at), self.slack);
                    is_behind |= behind;
                    let width = (columns.end - column).min(LANES);
                    add_run(s, &run, &weights, &mut sums[at..at + width]);
                }
            }
            if is_behind {
                self.behind.push(number);
            }
        }
    }
}

/// Pixels of a row under a splat.
struct Run {
    /// (1 − q/R)·h² where the kernel is, else 0.
    rest: [f32; LANES],
    depth: [f32; LANES],
}

impl Run {
    #[inline(always)]
    fn of(s: &Splat, row: usize, column: usize) -> Self {
        let dy = row as f32 + 0.5 - s.y;
        let first = column as f32 + 0.5 - s.x;
        // What is the same for the whole row.
        let (h_row, depth_row) = (1.0 + s.ky * dy, s.depth + s.depth_y * dy);
        let (xy, yy) = (2.0 * s.xy * dy, s.yy * dy * dy);
        let mut run = Self { rest: [0.0; LANES], depth: [0.0; LANES] };
        for i in 0..LANES {
            let dx = first + RAMP[i];
            let h = h_row + s.kx * dx;
            // (1 − q/R)·h², which spares a division: h is 1 at the centre and not far from it anywhere.
            let rest = h * h - ((s.xx * dx + xy) * dx + yy);
            // Beyond the horizon of its plane, h is not above 0.
            run.rest[i] = if (rest > 0.0) & (h > 0.0) { rest } else { 0.0 };
            run.depth[i] = depth_row + s.depth_x * dx;
        }
        run
    }

    /// Where the disc is, behind the layer before.
    #[inline(always)]
    fn is_seen<const FIRST: bool>(&self, s: &Splat, floor: &[f32], at: usize) -> [bool; LANES] {
        let mut seen = [false; LANES];
        if FIRST {
            for i in 0..LANES {
                seen[i] = self.rest[i] > 0.0;
            }
        } else {
            let floor = lanes(floor, at);
            for i in 0..LANES {
                seen[i] = (self.rest[i] > 0.0) & (self.depth[i] > floor[i] + s.thickness);
            }
        }
        seen
    }

    /// Weights in the nearest surface, and whether any pixel has the disc behind it.
    #[inline(always)]
    fn weights(
        &self,
        s: &Splat,
        seen: &[bool; LANES],
        near: &[f32; LANES],
        slack: f32,
    ) -> ([f32; LANES], bool) {
        let mut weights = [0.0; LANES];
        let mut behind = 0;
        for i in 0..LANES {
            let belongs = self.depth[i] <= near[i] + (s.thickness + slack);
            let rest = if seen[i] & belongs { self.rest[i] } else { 0.0 };
            weights[i] = s.weight * if s.flat { rest.sqrt() } else { rest * rest };
            behind |= u32::from(seen[i] & !belongs);
        }
        (weights, behind != 0)
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

#[inline(always)]
fn add_run(s: &Splat, run: &Run, weights: &[f32; LANES], sums: &mut [Sums]) {
    // Also where the weight is 0: a branch that is often guessed wrong takes longer than to add nothing.
    for ((sum, w), depth) in sums.iter_mut().zip(weights).zip(&run.depth) {
        let mut values = s.values;
        values[1] = *depth;
        for (total, value) in sum.iter_mut().zip(values) {
            *total += w * value;
        }
    }
}
