//! Draws discs into a tile: nearest depths first, then weighted sums.

use crate::layer::{Depths, Extras, LANES, Layer, Open, PITCH, RAMP, Sums};
use crate::splat::Splat;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Keeps the nearest depth of all `splats` in the first layer.
///
/// Depths count for more towards the rim of a kernel, by up to the disc's thickness times `softness`. Seen nearly
/// edge-on, the plane of a disc at a crease stands out before the facet beyond, where its kernel is next to nothing: as
/// the nearest depth there it would put that facet's discs into the next layer, apart from those of the crease.
pub(crate) fn nearest(layer: &mut Layer, splats: &[Splat], softness: f32) {
    let (depths, splats) = (&mut layer.depths[..], splats.iter());
    Arch::new().dispatch(Nearest::<true, _> { depths, splats, softness, open: &Open::NOWHERE });
}

/// Keeps the nearest depth behind the floor, in blocks that are `open`, of the splats with these numbers, which are
/// soft.
pub(crate) fn nearest_behind(layer: &mut Layer, splats: &[Splat], numbers: &[u32], open: &Open) {
    let splats = numbers.iter().map(|&i| &splats[i as usize]);
    Arch::new().dispatch(Nearest::<false, _> { depths: &mut layer.depths, splats, softness: SOFT, open });
}

/// Puts the sharpness of the disc that is nearest into the first of the sums; the largest of those that are equally
/// near.
pub(crate) fn sharpness_of_nearest(layer: &mut Layer, splats: &[Splat]) {
    layer.sums.fill(Sums::NOTHING);
    Arch::new().dispatch(SharpnessOfNearest { layer, splats });
}

/// Adds up the splats with these numbers that belong to the nearest surface, in the `FIRST` layer or else in blocks
/// that are `open`; `behind` gets the numbers of those that have parts behind it. Discs may lie behind a surface by
/// `slack` more than their thickness (bent depth). Normals are added up if they are `WANTED`, opacities if the cloud is
/// `CLEAR`.
pub(crate) fn add<const FIRST: bool, const WANTED: bool, const CLEAR: bool>(
    layer: &mut Layer,
    splats: &[Splat],
    numbers: impl Iterator<Item = u32>,
    behind: &mut Vec<u32>,
    (open, slack): (&Open, f32),
) {
    Arch::new().dispatch(Add::<FIRST, WANTED, CLEAR, _> { layer, splats, numbers, behind, open, slack });
}

/// The farthest of the nearest depths in these columns and rows of pixels, which begin with a block: +∞ if one has none.
pub(crate) fn farthest(layer: &Layer, columns: Range<usize>, rows: Range<usize>) -> f32 {
    Arch::new().dispatch(Farthest { depths: &layer.depths, columns, rows })
}

/// `softness` of discs that are kernels.
pub(crate) const SOFT: f32 = 1.0;

/// That of discs with hard edges, which are surface up to there.
pub(crate) const HARD: f32 = 0.0;

/// Within a kernel h is at most 1/(1 − √½) = 3.4; rounding could make it anything where planes are edge-on.
const LARGEST_H: f32 = 4.0;

struct Nearest<'a, const FIRST: bool, I> {
    depths: &'a mut [Depths],
    splats: I,
    softness: f32,
    open: &'a Open,
}

impl<'s, const FIRST: bool, I: Iterator<Item = &'s Splat>> WithSimd for Nearest<'_, FIRST, I> {
    type Output = ();

    // Everything is inlined, and there are no closures: a function compiled on its own would not use the wide
    // instructions.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (none, nothing) = (simd.splat_f32s(0.0), simd.splat_f32s(f32::INFINITY));
        for s in self.splats {
            let softness = simd.splat_f32s(s.thickness * self.softness);
            for column in s.blocks() {
                for (i, ramp) in S::as_simd_f32s(&RAMP).0.iter().enumerate() {
                    let mut strip = Strip::new(simd, s, column, *ramp);
                    for row in s.rows() {
                        if !FIRST && !self.open.has(column, row) {
                            strip.step(simd);
                            continue;
                        }
                        let block = &mut self.depths[row * PITCH + column];
                        let floor = S::as_simd_f32s(&block.floor).0[i];
                        let (rest, depth) = strip.at::<FIRST>(simd, s, floor);
                        strip.step(simd);
                        let is_there = simd.greater_than_f32s(rest, none);
                        // Never nearer than it is: `rest` may exceed 1, where the plane comes towards the eye.
                        let soft =
                            simd.sub_f32s(simd.add_f32s(depth, softness), simd.mul_f32s(softness, rest));
                        let depth = simd.max_f32s(soft, depth);
                        let near = &mut S::as_mut_simd_f32s(&mut block.near).0[i];
                        // A minimum instead of a choice between the old and the new value: the latter would become a
                        // masked store, which takes longer than all the rest.
                        *near = simd.min_f32s(simd.select_f32s(is_there, depth, nothing), *near);
                    }
                }
            }
        }
    }
}

struct Farthest<'a> {
    depths: &'a [Depths],
    columns: Range<usize>,
    rows: Range<usize>,
}

impl WithSimd for Farthest<'_> {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f32 {
        let nothing = simd.splat_f32s(f32::NEG_INFINITY);
        let mut farthest = nothing;
        for row in self.rows {
            for column in self.columns.start / LANES..self.columns.end.div_ceil(LANES) {
                let count = simd.splat_f32s((self.columns.end - column * LANES) as f32);
                let near = S::as_simd_f32s(&self.depths[row * PITCH + column].near).0;
                for (near, ramp) in near.iter().zip(S::as_simd_f32s(&RAMP).0) {
                    let near = simd.select_f32s(simd.less_than_f32s(*ramp, count), *near, nothing);
                    farthest = simd.max_f32s(near, farthest);
                }
            }
        }
        simd.reduce_max_f32s(farthest)
    }
}

struct SharpnessOfNearest<'a> {
    layer: &'a mut Layer,
    splats: &'a [Splat],
}

impl WithSimd for SharpnessOfNearest<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let none = simd.splat_f32s(0.0);
        for s in self.splats {
            let own = simd.splat_f32s(s.sharpness);
            for column in s.blocks() {
                for (i, ramp) in S::as_simd_f32s(&RAMP).0.iter().enumerate() {
                    let mut strip = Strip::new(simd, s, column, *ramp);
                    for row in s.rows() {
                        let block = &self.layer.depths[row * PITCH + column];
                        let floor = S::as_simd_f32s(&block.floor).0[i];
                        let (rest, depth) = strip.at::<true>(simd, s, floor);
                        strip.step(simd);
                        let near = S::as_simd_f32s(&block.near).0[i];
                        let is_there = simd.greater_than_f32s(rest, none);
                        let is_nearest = simd.and_m32s(is_there, simd.less_than_or_equal_f32s(depth, near));
                        let sums = &mut self.layer.sums[row * PITCH + column].0;
                        let sharpness = &mut S::as_mut_simd_f32s(&mut sums[0]).0[i];
                        *sharpness = simd.max_f32s(simd.select_f32s(is_nearest, own, none), *sharpness);
                    }
                }
            }
        }
    }
}

struct Add<'a, const FIRST: bool, const WANTED: bool, const CLEAR: bool, I> {
    layer: &'a mut Layer,
    splats: &'a [Splat],
    numbers: I,
    behind: &'a mut Vec<u32>,
    open: &'a Open,
    slack: f32,
}

impl<const FIRST: bool, const WANTED: bool, const CLEAR: bool, I: Iterator<Item = u32>> WithSimd
    for Add<'_, FIRST, WANTED, CLEAR, I>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Layer { depths, sums, extras } = self.layer;
        let (depths, sums, extras) = (&depths[..], &mut sums[..], &mut extras[..]);
        let none = simd.splat_f32s(0.0);
        for number in self.numbers {
            let s = &self.splats[number as usize];
            let weight = simd.splat_f32s(s.weight);
            let thickness = simd.splat_f32s(s.thickness + self.slack);
            let mut hidden = none;
            for column in s.blocks() {
                for (i, ramp) in S::as_simd_f32s(&RAMP).0.iter().enumerate() {
                    let mut strip = Strip::new(simd, s, column, *ramp);
                    for row in s.rows() {
                        if !FIRST && !self.open.has(column, row) {
                            strip.step(simd);
                            continue;
                        }
                        let block = &depths[row * PITCH + column];
                        let near = S::as_simd_f32s(&block.near).0[i];
                        let floor = S::as_simd_f32s(&block.floor).0[i];
                        let (rest, depth) = strip.at::<FIRST>(simd, s, floor);
                        strip.step(simd);
                        let rest = simd.max_f32s(rest, none);
                        let belongs = simd.less_than_or_equal_f32s(depth, simd.add_f32s(near, thickness));
                        let shown = simd.select_f32s(belongs, rest, none);
                        hidden = simd.add_f32s(hidden, simd.sub_f32s(rest, shown));
                        let kernel = if s.flat { simd.sqrt_f32s(shown) } else { simd.mul_f32s(shown, shown) };
                        let weights = simd.mul_f32s(weight, kernel);
                        add_block(simd, s, i, weights, depth, &mut sums[row * PITCH + column]);
                        if WANTED {
                            add_normals(simd, s, i, weights, &mut extras[row * PITCH + column]);
                        }
                        if CLEAR {
                            let opacity = &mut extras[row * PITCH + column].opacity;
                            add_value(simd, s.opacity, weights, &mut S::as_mut_simd_f32s(opacity).0[i]);
                        }
                    }
                }
            }
            if simd.reduce_max_f32s(hidden) > 0.0 {
                self.behind.push(number);
            }
        }
    }
}

/// Adds a disc's values to vector `i` of a block.
#[inline(always)]
fn add_block<S: Simd>(simd: S, s: &Splat, i: usize, weights: S::f32s, depths: S::f32s, block: &mut Sums) {
    let [weight, depth, values @ ..] = &mut block.0;
    let weight = &mut S::as_mut_simd_f32s(weight).0[i];
    *weight = simd.add_f32s(*weight, weights);
    let depth = &mut S::as_mut_simd_f32s(depth).0[i];
    *depth = simd.add_f32s(*depth, simd.mul_f32s(weights, depths));
    let [red, green, blue] = s.color;
    for (sums, value) in values.iter_mut().zip([s.sharpness, red, green, blue]) {
        add_value(simd, value, weights, &mut S::as_mut_simd_f32s(sums).0[i]);
    }
}

#[inline(always)]
fn add_normals<S: Simd>(simd: S, s: &Splat, i: usize, weights: S::f32s, block: &mut Extras) {
    for (sums, value) in block.normals.iter_mut().zip(s.normal) {
        add_value(simd, value, weights, &mut S::as_mut_simd_f32s(sums).0[i]);
    }
}

#[inline(always)]
fn add_value<S: Simd>(simd: S, value: f32, weights: S::f32s, sums: &mut S::f32s) {
    *sums = simd.add_f32s(*sums, simd.mul_f32s(weights, simd.splat_f32s(value)));
}

/// A column of blocks under a splat, in one of its rows. Terms that change by a constant from row to row are advanced
/// by an addition: a third of the operations of computing them anew, at the cost of one digit in the last of 64 rows.
struct Strip<S: Simd> {
    /// xx·dx², 2·xy·dx + yy·dy, dy, 1 + kx·dx + ky·dy and the depth.
    qx: S::f32s,
    qy: S::f32s,
    dy: S::f32s,
    h: S::f32s,
    depth: S::f32s,
    /// What the next row adds.
    qy_step: S::f32s,
    h_step: S::f32s,
    depth_step: S::f32s,
}

impl<S: Simd> Strip<S> {
    /// In the first row.
    #[inline(always)]
    fn new(simd: S, s: &Splat, column: usize, ramp: S::f32s) -> Self {
        let dx = simd.add_f32s(simd.splat_f32s((column * LANES) as f32 + (0.5 - s.x)), ramp);
        let dy = s.first_dy();
        let along =
            |start: f32, k: f32| simd.add_f32s(simd.splat_f32s(start), simd.mul_f32s(simd.splat_f32s(k), dx));
        Self {
            qx: simd.mul_f32s(simd.mul_f32s(simd.splat_f32s(s.xx), dx), dx),
            qy: along(s.yy * dy, 2.0 * s.xy),
            dy: simd.splat_f32s(dy),
            h: along(1.0 + s.ky * dy, s.kx),
            depth: along(s.depth + s.depth_y * dy, s.depth_x),
            qy_step: simd.splat_f32s(s.yy),
            h_step: simd.splat_f32s(s.ky),
            depth_step: simd.splat_f32s(s.depth_y),
        }
    }

    /// Goes to the next row.
    #[inline(always)]
    fn step(&mut self, simd: S) {
        self.qy = simd.add_f32s(self.qy, self.qy_step);
        self.dy = simd.add_f32s(self.dy, simd.splat_f32s(1.0));
        self.h = simd.add_f32s(self.h, self.h_step);
        self.depth = simd.add_f32s(self.depth, self.depth_step);
    }

    /// (1 − q/R)·h², which is not above 0 outside of the kernel and in front of the floor, and the bent depth.
    ///
    /// The factor h² saves a division: it is 1 at the centre and not far from it anywhere. Beyond the horizon of the
    /// disc's plane h is not above 0. Multiplied and added apart, not fused, so that all processors agree.
    #[inline(always)]
    fn at<const FIRST: bool>(&self, simd: S, s: &Splat, floor: S::f32s) -> (S::f32s, S::f32s) {
        let none = simd.splat_f32s(0.0);
        let h = simd.min_f32s(simd.max_f32s(self.h, none), simd.splat_f32s(LARGEST_H));
        let q = simd.add_f32s(self.qx, simd.mul_f32s(self.qy, self.dy));
        let rest = simd.sub_f32s(simd.mul_f32s(h, h), q);
        if FIRST {
            return (rest, self.depth);
        }
        let is_behind =
            simd.greater_than_f32s(self.depth, simd.add_f32s(floor, simd.splat_f32s(s.thickness)));
        (simd.select_f32s(is_behind, rest, none), self.depth)
    }
}
