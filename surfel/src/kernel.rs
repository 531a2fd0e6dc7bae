//! Discs into a tile: nearest depths, then weighted sums.

use crate::splat::Splat;
use crate::tile::{Layer, PITCH, Sums};
use pulp::{Arch, Simd, WithSimd};

/// Pixels that are computed together: a whole number of vectors of any processor.
pub(crate) const LANES: usize = 8;

/// Distances of the pixels of a run from its first.
const RAMP: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// The place of the depth among the values.
const IS_DEPTH: Sums = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];

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

/// Within a kernel h is at most 1/(1 − √½) = 3.4; rounding could make it anything where planes are edge-on.
const LARGEST_H: f32 = 4.0;

struct Nearest<'a, const FIRST: bool, I> {
    layer: &'a mut Layer,
    splats: I,
}

impl<'s, const FIRST: bool, I: Iterator<Item = &'s Splat>> WithSimd for Nearest<'_, FIRST, I> {
    type Output = ();

    // Everything is inlined, and there are no closures: what is compiled on its own stays narrow.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Layer { near, sharpness, floor, .. } = self.layer;
        let nothing = simd.splat_f32s(f32::INFINITY);
        for s in self.splats {
            let own_sharpness = simd.splat_f32s(s.sharpness);
            let columns = usize::from(s.columns[0])..usize::from(s.columns[1]);
            for row in usize::from(s.rows[0])..usize::from(s.rows[1]) {
                let line = Line::new(simd, s, row);
                for column in columns.clone().step_by(LANES) {
                    let run = row * PITCH + column..row * PITCH + column + LANES;
                    let near = S::as_mut_simd_f32s(&mut near[run.clone()]).0;
                    let sharpness = S::as_mut_simd_f32s(&mut sharpness[run.clone()]).0;
                    let floor = S::as_simd_f32s(&floor[run]).0;
                    for (i, ramp) in S::as_simd_f32s(&RAMP).0.iter().enumerate() {
                        let (rest, depth) = line.at::<FIRST>(simd, column, *ramp, floor[i]);
                        let is_there = simd.greater_than_f32s(rest, simd.splat_f32s(0.0));
                        let depth = simd.select_f32s(is_there, depth, nothing);
                        let is_nearer = simd.less_than_f32s(depth, near[i]);
                        near[i] = simd.select_f32s(is_nearer, depth, near[i]);
                        sharpness[i] = simd.select_f32s(is_nearer, own_sharpness, sharpness[i]);
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

impl<const FIRST: bool, I: Iterator<Item = u32>> WithSimd for Add<'_, FIRST, I> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Layer { near, floor, sums, .. } = self.layer;
        let none = simd.splat_f32s(0.0);
        for number in self.numbers {
            let s = &self.splats[number as usize];
            let weight = simd.splat_f32s(s.weight);
            let thickness = simd.splat_f32s(s.thickness + self.slack);
            let columns = usize::from(s.columns[0])..usize::from(s.columns[1]);
            let mut hidden = none;
            for row in usize::from(s.rows[0])..usize::from(s.rows[1]) {
                let line = Line::new(simd, s, row);
                for column in columns.clone().step_by(LANES) {
                    let run = row * PITCH + column..row * PITCH + column + LANES;
                    let near = S::as_simd_f32s(&near[run.clone()]).0;
                    let floor = S::as_simd_f32s(&floor[run.clone()]).0;
                    let (mut weights, mut depths) = ([0.0; LANES], [0.0; LANES]);
                    let out = S::as_mut_simd_f32s(&mut weights).0.iter_mut();
                    let out = out.zip(S::as_mut_simd_f32s(&mut depths).0);
                    for (i, (w, d)) in out.enumerate() {
                        let (rest, depth) =
                            line.at::<FIRST>(simd, column, S::as_simd_f32s(&RAMP).0[i], floor[i]);
                        let belongs = simd.less_than_or_equal_f32s(depth, simd.add_f32s(near[i], thickness));
                        let shown = simd.select_f32s(belongs, rest, none);
                        hidden = simd.add_f32s(hidden, simd.sub_f32s(rest, shown));
                        let kernel = if s.flat { simd.sqrt_f32s(shown) } else { simd.mul_f32s(shown, shown) };
                        (*w, *d) = (simd.mul_f32s(weight, kernel), depth);
                    }
                    let width = (columns.end - column).min(LANES);
                    add_run(simd, s, &weights, &depths, &mut sums[run.start..run.start + width]);
                }
            }
            if simd.reduce_max_f32s(hidden) > 0.0 {
                self.behind.push(number);
            }
        }
    }
}

/// A row of pixels under a splat: what is the same for all of them.
struct Line<S: Simd> {
    /// Way from the centre of the disc to that of the row's first pixel.
    x: f32,
    xx: S::f32s,
    xy: S::f32s,
    yy: S::f32s,
    h: S::f32s,
    kx: S::f32s,
    depth: S::f32s,
    depth_x: S::f32s,
    thickness: S::f32s,
}

impl<S: Simd> Line<S> {
    #[inline(always)]
    fn new(simd: S, s: &Splat, row: usize) -> Self {
        let dy = row as f32 + 0.5 - s.y;
        Self {
            x: 0.5 - s.x,
            xx: simd.splat_f32s(s.xx),
            xy: simd.splat_f32s(2.0 * s.xy * dy),
            yy: simd.splat_f32s(s.yy * dy * dy),
            h: simd.splat_f32s(1.0 + s.ky * dy),
            kx: simd.splat_f32s(s.kx),
            depth: simd.splat_f32s(s.depth + s.depth_y * dy),
            depth_x: simd.splat_f32s(s.depth_x),
            thickness: simd.splat_f32s(s.thickness),
        }
    }

    /// (1 − q/R)·h², or 0 where the kernel is not or lies before the floor; and the bent depth.
    ///
    /// The factor h² spares a division: it is 1 at the centre and not far from it anywhere. Beyond the horizon of the
    /// disc's plane h is not above 0. Multiplied and added apart, not fused, so that all processors agree.
    #[inline(always)]
    fn at<const FIRST: bool>(
        &self,
        simd: S,
        column: usize,
        ramp: S::f32s,
        floor: S::f32s,
    ) -> (S::f32s, S::f32s) {
        let none = simd.splat_f32s(0.0);
        let dx = simd.add_f32s(simd.splat_f32s(column as f32 + self.x), ramp);
        let h = simd.add_f32s(self.h, simd.mul_f32s(self.kx, dx));
        let h = simd.min_f32s(simd.max_f32s(h, none), simd.splat_f32s(LARGEST_H));
        let q = simd.add_f32s(simd.mul_f32s(self.xx, dx), self.xy);
        let q = simd.add_f32s(simd.mul_f32s(q, dx), self.yy);
        let rest = simd.max_f32s(simd.sub_f32s(simd.mul_f32s(h, h), q), none);
        let depth = simd.add_f32s(self.depth, simd.mul_f32s(self.depth_x, dx));
        if FIRST {
            return (rest, depth);
        }
        let is_behind = simd.greater_than_f32s(depth, simd.add_f32s(floor, self.thickness));
        (simd.select_f32s(is_behind, rest, none), depth)
    }
}

#[inline(always)]
fn add_run<S: Simd>(simd: S, s: &Splat, weights: &[f32; LANES], depths: &[f32; LANES], sums: &mut [Sums]) {
    // Also where the weight is 0: a branch that is often guessed wrong takes longer than to add nothing.
    for ((sum, w), depth) in sums.iter_mut().zip(weights).zip(depths) {
        let (w, depth) = (simd.splat_f32s(*w), simd.splat_f32s(*depth));
        let sum = S::as_mut_simd_f32s(sum).0.iter_mut();
        let values = S::as_simd_f32s(&s.values).0.iter().zip(S::as_simd_f32s(&IS_DEPTH).0);
        for (total, (value, is_depth)) in sum.zip(values) {
            let value = simd.add_f32s(*value, simd.mul_f32s(depth, *is_depth));
            *total = simd.add_f32s(*total, simd.mul_f32s(w, value));
        }
    }
}
