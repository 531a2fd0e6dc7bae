//! From the sums of a layer to the colours of its pixels, a block at a time.

use crate::frame::Band;
use crate::layer::{LANES, Lanes, Layer, PITCH, Pixels, RAMP, Sums, Touched};
use crate::shade::{INDEPENDENT, LEAST_LIGHT, Shader, opacity};
use crate::tile::{Place, WIDTH};
use pulp::{Arch, NullaryFnOnce, Simd, WithSimd};
use std::ops::Range;

/// Less weight is none: its inverse would not be a number that can be used.
const LEAST_WEIGHT: f32 = 1e-30;

/// Beside a pixel with less weight than this there is an edge.
const LEAST_INSIDE: f32 = 0.25;

/// Lays a layer under what is in `pixels`, which are empty before the `FIRST`, and clears its sums; whether any pixel that it
/// touched lets light through.
pub(crate) fn resolve<const FIRST: bool>(
    layer: &mut Layer,
    pixels: &mut [Pixels],
    shader: &Shader,
    place: &Place,
    touched: &Touched,
) -> bool {
    Arch::new().dispatch(Resolve::<FIRST> { layer, pixels, shader, place, touched })
}

/// Puts the pixels of a tile into the picture.
pub(crate) fn write(pixels: &[Pixels], shader: &Shader, place: &Place, band: &mut Band<'_>) {
    band.drawn[place.x / WIDTH] = true;
    Arch::new().dispatch(Write { pixels, shader, place, band });
}

struct Resolve<'a, const FIRST: bool> {
    layer: &'a mut Layer,
    pixels: &'a mut [Pixels],
    shader: &'a Shader,
    place: &'a Place,
    touched: &'a Touched,
}

impl<const FIRST: bool> WithSimd for Resolve<'_, FIRST> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { layer, pixels, shader, place, touched } = self;
        let mut lines = Lines::new();
        let mut open = simd.splat_f32s(0.0);
        for row in touched.rows() {
            lines.take(simd, &layer.sums, place, touched.columns(), row);
            if row > touched.rows().start {
                // Rows below need it no more.
                layer.sums[touched.blocks(row - 1)].fill(Sums::NOTHING);
            }
            let y = simd.splat_f32s((place.y + row) as f32);
            for column in touched.columns() {
                let index = row * PITCH + column;
                let (depths, sums) = (&mut layer.depths[index], &layer.sums[index].0);
                let pixels = &mut pixels[index];
                for (i, ramp) in S::as_simd_f32s(&RAMP).0.iter().enumerate() {
                    let x = simd.add_f32s(simd.splat_f32s((place.x + column * LANES) as f32), *ramp);
                    let weight = S::as_simd_f32s(&sums[0]).0[i];
                    let near = S::as_simd_f32s(&depths.near).0[i];
                    let evened = lines.evened(simd, weight, column, i);
                    let sums = LayerLanes { weight, evened, near, sums, i };
                    let floor = sums.lay_under::<FIRST>(simd, shader, pixels, (x, y));
                    S::as_mut_simd_f32s(&mut depths.floor).0[i] = floor;
                    let is_open = simd.less_than_f32s(floor, simd.splat_f32s(f32::INFINITY));
                    open = simd.select_f32s(is_open, simd.splat_f32s(1.0), open);
                }
            }
        }
        if let Some(last) = touched.rows().next_back() {
            layer.sums[touched.blocks(last)].fill(Sums::NOTHING);
        }
        simd.reduce_max_f32s(open) > 0.0
    }
}

/// Vector `i` of a layer's block.
struct LayerLanes<'a, S: Simd> {
    weight: S::f32s,
    evened: S::f32s,
    near: S::f32s,
    sums: &'a [Lanes; 9],
    i: usize,
}

impl<S: Simd> LayerLanes<'_, S> {
    /// Lays the surface under what is in the pixels; the floor of the next layer, +∞ where nothing below can be seen.
    #[inline(always)]
    fn lay_under<const FIRST: bool>(
        &self,
        simd: S,
        shader: &Shader,
        pixels: &mut Pixels,
        (x, y): (S::f32s, S::f32s),
    ) -> S::f32s {
        let i = self.i;
        let (none, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        // Not where it is NaN.
        let is_there = simd.greater_than_f32s(self.weight, simd.splat_f32s(LEAST_WEIGHT));
        let inverse = simd.div_f32s(one, simd.select_f32s(is_there, self.weight, one));
        let [_, depth, a, b, c, red, green, blue, sharpness] = self.sums;
        let mean = |sum: &Lanes| simd.mul_f32s(S::as_simd_f32s(sum).0[i], inverse);
        let normal = [mean(a), mean(b), mean(c)];
        let shaded = shader.lit(simd, [mean(red), mean(green), mean(blue)], normal, (x, y));
        let alpha = opacity(simd, self.evened, mean(sharpness));
        let before = if FIRST { none } else { S::as_simd_f32s(&pixels.colour[3]).0[i] };
        let left = simd.sub_f32s(one, before);
        let overlap = simd.sub_f32s(one, simd.mul_f32s(simd.splat_f32s(INDEPENDENT), before));
        let share = simd.min_f32s(simd.mul_f32s(alpha, overlap), left);
        let share = simd.select_f32s(is_there, share, none);
        let after = simd.add_f32s(before, share);
        let [channels @ .., opacity] = &mut pixels.colour;
        S::as_mut_simd_f32s(opacity).0[i] = after;
        for (channel, shaded) in channels.iter_mut().zip(shaded) {
            let channel = &mut S::as_mut_simd_f32s(channel).0[i];
            // What is not there may be no number.
            let added = simd.mul_f32s(share, simd.select_f32s(is_there, shaded, none));
            *channel = if FIRST { added } else { simd.add_f32s(*channel, added) };
        }
        let half = simd.splat_f32s(0.5);
        let was_open = simd.and_m32s(is_there, simd.less_than_f32s(before, half));
        let is_first = simd.and_m32s(was_open, simd.greater_than_or_equal_f32s(after, half));
        let empty = [f32::INFINITY, 0.0, 0.0, 0.0];
        let layers = [&mut pixels.depth].into_iter().chain(&mut pixels.normal);
        for ((kept, new), empty) in layers.zip([depth, a, b, c]).zip(empty) {
            let kept = &mut S::as_mut_simd_f32s(kept).0[i];
            *kept = simd.select_f32s(is_first, mean(new), if FIRST { simd.splat_f32s(empty) } else { *kept });
        }
        let light = simd.sub_f32s(one, after);
        let is_open = simd.and_m32s(is_there, simd.greater_than_f32s(light, simd.splat_f32s(LEAST_LIGHT)));
        simd.select_f32s(is_open, self.near, simd.splat_f32s(f32::INFINITY))
    }
}

/// Sums and minima of three pixels above one another, for a row. With a block of room on either side.
struct Lines {
    sums: [f32; WIDTH + 2 * LANES],
    least: [f32; WIDTH + 2 * LANES],
}

impl Lines {
    #[inline(always)]
    fn new() -> Self {
        Self { sums: [0.0; WIDTH + 2 * LANES], least: [0.0; WIDTH + 2 * LANES] }
    }

    /// Takes the weights of a row and its neighbours. Beyond the tile they are those of its outermost pixels.
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, sums: &[Sums], place: &Place, columns: Range<usize>, row: usize) {
        let rows = [row.saturating_sub(1), row, (row + 1).min(place.height - 1)];
        let first = columns.start.saturating_sub(1);
        let last = (columns.end + 1).min(place.width.div_ceil(LANES));
        for column in first..last {
            let [above, own, below] = rows.map(|row| S::as_simd_f32s(&sums[row * PITCH + column].0[0]).0);
            let lanes = (column + 1) * LANES..(column + 2) * LANES;
            let line = S::as_mut_simd_f32s(&mut self.sums[lanes.clone()]).0;
            let least = S::as_mut_simd_f32s(&mut self.least[lanes]).0;
            for i in 0..own.len() {
                line[i] = simd.add_f32s(simd.add_f32s(above[i], below[i]), own[i]);
                least[i] = simd.min_f32s(simd.min_f32s(above[i], below[i]), own[i]);
            }
        }
        for line in [&mut self.sums, &mut self.least] {
            line[LANES - 1] = line[LANES];
            line[LANES + place.width] = line[LANES + place.width - 1];
        }
    }

    /// The weights of a vector of pixels, or, inside a surface, those of the 3×3 pixels around each if they are larger.
    ///
    /// Weights vary between points. Over an edge that is blurred they fall evenly: there the mean is that of the middle.
    #[inline(always)]
    fn evened<S: Simd>(&self, simd: S, own: S::f32s, column: usize, i: usize) -> S::f32s {
        let first = (column + 1) * LANES;
        let [left, middle, right] = [first - 1, first, first + 1].map(|at| at..at + LANES);
        let sum = |at: &Range<usize>| S::as_simd_f32s(&self.sums[at.clone()]).0[i];
        let least = |at: &Range<usize>| S::as_simd_f32s(&self.least[at.clone()]).0[i];
        let mean = simd.add_f32s(simd.add_f32s(sum(&left), sum(&right)), sum(&middle));
        let mean = simd.mul_f32s(mean, simd.splat_f32s(1.0 / 9.0));
        let least = simd.min_f32s(simd.min_f32s(least(&left), least(&right)), least(&middle));
        let is_inside = simd.greater_than_f32s(least, simd.splat_f32s(LEAST_INSIDE));
        simd.select_f32s(is_inside, simd.max_f32s(own, mean), own)
    }
}

struct Write<'a, 'b> {
    pixels: &'a [Pixels],
    shader: &'a Shader,
    place: &'a Place,
    band: &'a mut Band<'b>,
}

impl NullaryFnOnce for Write<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { pixels, shader, place, band } = self;
        for row in 0..place.height {
            let from = &pixels[row * PITCH..];
            let to = row * band.width + place.x..row * band.width + place.x + place.width;
            let colours = band.colour[to.clone()].chunks_mut(LANES);
            let depths = band.depth[to.clone()].chunks_mut(LANES);
            for ((pixels, colours), depths) in from.iter().zip(colours).zip(depths) {
                let [red, green, blue, alpha] = &pixels.colour;
                let block: [[f32; 4]; LANES] = std::array::from_fn(|i| [red[i], green[i], blue[i], alpha[i]]);
                colours.copy_from_slice(&block[..colours.len()]);
                depths.copy_from_slice(&pixels.depth.map(|bent| shader.depth(bent))[..depths.len()]);
            }
            let Some(normals) = &mut band.normal else { continue };
            for (pixels, normals) in from.iter().zip(normals[to].chunks_mut(LANES)) {
                for (i, normal) in normals.iter_mut().enumerate() {
                    *normal = shader.in_world(pixels.normal.map(|n| n[i]).into());
                }
            }
        }
    }
}
