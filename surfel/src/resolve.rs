//! From the sums of a layer to the colours of its pixels, a block at a time.

use crate::frame::Band;
use crate::layer::{LANES, Lanes, Layer, PITCH, Pixels, Sums, Touched};
use crate::shade::{INDEPENDENT, LEAST_LIGHT, Shader, opacity};
use crate::tile::{Place, WIDTH};
use crate::vector::Vector;
use pulp::{Arch, NullaryFnOnce, Simd, WithSimd};
use std::ops::Range;

/// Less weight is none: its inverse would not be a number that can be used.
const LEAST_WEIGHT: f32 = 1e-30;

/// Beside a pixel with less weight than this there is an edge.
const LEAST_INSIDE: f32 = 0.25;

/// Lays a layer under what is in `pixels`, which are empty before the `FIRST`, and clears its sums; whether any pixel that it
/// touched lets light through. Normals are kept if they are `WANTED`.
pub(crate) fn resolve<const FIRST: bool, const WANTED: bool>(
    layer: &mut Layer,
    pixels: &mut [Pixels],
    place: &Place,
    touched: &Touched,
) -> bool {
    Arch::new().dispatch(Resolve::<FIRST, WANTED> { layer, pixels, place, touched })
}

/// Puts the pixels of a tile into the picture.
pub(crate) fn write(pixels: &[Pixels], shader: &Shader, place: &Place, band: &mut Band<'_>) {
    band.drawn[place.x / WIDTH] = true;
    Arch::new().dispatch(Write { pixels, shader, place, band });
}

struct Resolve<'a, const FIRST: bool, const WANTED: bool> {
    layer: &'a mut Layer,
    pixels: &'a mut [Pixels],
    place: &'a Place,
    touched: &'a Touched,
}

impl<const FIRST: bool, const WANTED: bool> WithSimd for Resolve<'_, FIRST, WANTED> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { layer, pixels, place, touched } = self;
        let mut lines = Lines::new();
        let mut open = simd.splat_f32s(0.0);
        for row in touched.rows() {
            lines.take(simd, &layer.sums, place, touched.columns(), row);
            if row > touched.rows().start {
                // Rows below need it no more.
                layer.clear_sums::<WANTED>(touched.blocks(row - 1));
            }
            for column in touched.columns() {
                let index = row * PITCH + column;
                let depths = &mut layer.depths[index];
                for i in 0..LANES / S::F32_LANES {
                    let vector = |lanes: &Lanes| Vector::new(simd, S::as_simd_f32s(lanes).0[i]);
                    let [weight, depth, sharpness, colour @ ..] = &layer.sums[index].0;
                    let weight = vector(weight);
                    // Not where it is NaN.
                    let is_there = weight.exceeds(LEAST_WEIGHT);
                    let inverse = weight.if_set(is_there, 1.0).inverse();
                    let mean = |sums: &Lanes| vector(sums) * inverse;
                    let alpha = opacity(lines.evened(weight, column, i), mean(sharpness));
                    let under = Under { alpha, is_there, i };
                    let colour = [mean(&colour[0]), mean(&colour[1]), mean(&colour[2])];
                    let pixels = &mut pixels[index];
                    let (is_first, after) = under.blend::<FIRST>(simd, &mut pixels.colour, colour);
                    let empty = f32::INFINITY;
                    keep::<S, FIRST>(mean(depth), is_first, empty, &mut pixels.depth, i);
                    if WANTED {
                        for (kept, sums) in pixels.normal.iter_mut().zip(&layer.normals[index].0) {
                            keep::<S, FIRST>(mean(sums), is_first, 0.0, kept, i);
                        }
                    }
                    let light = -(after - 1.0);
                    let is_open = simd.and_m32s(is_there, light.exceeds(LEAST_LIGHT));
                    let floor = vector(&depths.near).if_set(is_open, f32::INFINITY);
                    S::as_mut_simd_f32s(&mut depths.floor).0[i] = floor.lanes;
                    open = simd.select_f32s(is_open, simd.splat_f32s(1.0), open);
                }
            }
        }
        if let Some(last) = touched.rows().next_back() {
            layer.clear_sums::<WANTED>(touched.blocks(last));
        }
        simd.reduce_max_f32s(open) > 0.0
    }
}

/// A surface that is laid under what is in vector `i` of a block.
struct Under<S: Simd> {
    alpha: Vector<S>,
    /// Where there is one.
    is_there: S::m32s,
    i: usize,
}

impl<S: Simd> Under<S> {
    /// Where pixels became half opaque, and how opaque they are.
    #[inline(always)]
    fn blend<const FIRST: bool>(
        &self,
        simd: S,
        pixels: &mut [Lanes; 4],
        colour: [Vector<S>; 3],
    ) -> (S::m32s, Vector<S>) {
        let [channels @ .., opacity] = pixels;
        let opacity = &mut S::as_mut_simd_f32s(opacity).0[self.i];
        let before = if FIRST { Vector::all(simd, 0.0) } else { Vector::new(simd, *opacity) };
        let overlap = -(before * INDEPENDENT - 1.0);
        let share = (self.alpha * overlap).min(-(before - 1.0)).if_set(self.is_there, 0.0);
        let after = before + share;
        *opacity = after.lanes;
        for (channel, colour) in channels.iter_mut().zip(colour) {
            let channel = &mut S::as_mut_simd_f32s(channel).0[self.i];
            // What is not there may be no number.
            let added = share * colour.if_set(self.is_there, 0.0);
            *channel = if FIRST { added } else { Vector::new(simd, *channel) + added }.lanes;
        }
        let half = Vector::all(simd, 0.5);
        let was_open = simd.and_m32s(self.is_there, half.is_above(before));
        (simd.and_m32s(was_open, simd.greater_than_or_equal_f32s(after.lanes, half.lanes)), after)
    }
}

/// Sets what a pixel keeps where `mask` is set; before the first layer it has the value `empty`.
#[inline(always)]
fn keep<S: Simd, const FIRST: bool>(new: Vector<S>, mask: S::m32s, empty: f32, kept: &mut Lanes, i: usize) {
    let kept = &mut S::as_mut_simd_f32s(kept).0[i];
    *kept = if FIRST { new.if_set(mask, empty) } else { new.or_where_unset(mask, *kept) }.lanes;
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
    fn evened<S: Simd>(&self, own: Vector<S>, column: usize, i: usize) -> Vector<S> {
        let first = (column + 1) * LANES;
        let at = |line: &[f32], from: usize| own.with(S::as_simd_f32s(&line[from..from + LANES]).0[i]);
        let around = |line: &[f32]| [at(line, first - 1), at(line, first), at(line, first + 1)];
        let [left, middle, right] = around(&self.sums);
        let mean = (left + right + middle) * (1.0 / 9.0);
        let [left, middle, right] = around(&self.least);
        let least = left.min(right).min(middle);
        mean.max(own).or_where_unset(least.exceeds(LEAST_INSIDE), own.lanes)
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
