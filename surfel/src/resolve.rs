//! From the sums of a layer to the colors of its pixels, a block at a time.

use crate::frame::Band;
use crate::grid::{RING, TileRect};
use crate::layer::{LANES, Lanes, Layer, Open, PITCH, Pixels, Touched};
use crate::shade::{INDEPENDENT, LEAST_LIGHT, Shader, opacity};
use crate::vector::{Real, Vector};
use pulp::{Arch, NullaryFnOnce, Simd, WithSimd};
use std::ops::Range;

/// Weights below this count as 0: their inverse could overflow.
const LEAST_WEIGHT: f32 = 1e-30;

/// A pixel next to one with less weight than this lies on an edge.
const LEAST_INSIDE: f32 = 0.25;

/// Gaps that are none of a surface's: how steep edges need to be made where kernels are that wide, and how far the pixels
/// that hold the surface on either side lie from one in the gap. From the first on, kernels are wider than a pixel, and
/// gaps of a pixel are filled; from the second on (discs with a radius of a pixel) those of two and three. Between finer
/// points one may see through. (Where kernels are narrower, the steepness is 1, up to rounding.)
const GAPS: [(f32, &[[isize; 2]]); 2] = [(1.01, &[[1, 1]]), (1.44, &[[2, 2], [1, 2], [2, 1]])];

/// Columns and rows from a pixel to those neighbours that have another on the opposite side.
const DIRECTIONS: [[isize; 2]; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];

/// Composites a layer behind what is in `pixels` (nothing before the `FIRST` layer), and clears its sums. Returns the
/// blocks in which pixels that it touched are not yet opaque. Normals are kept if they are `WANTED`, and opacities
/// looked at if the cloud is `CLEAR`.
pub(crate) fn resolve<const FIRST: bool, const WANTED: bool, const CLEAR: bool>(
    layer: &mut Layer,
    pixels: &mut [Pixels],
    rect: &TileRect,
    touched: &Touched,
) -> Open {
    Arch::new().dispatch(Resolve::<FIRST, WANTED, CLEAR> { layer, pixels, rect, touched })
}

/// Puts those of the pixels of `rect` that tile `number` shows into the picture.
pub(crate) fn write(
    pixels: &[Pixels],
    shader: &Shader,
    rect: &TileRect,
    (band, number): (&mut Band<'_>, usize),
) {
    band.drawn[number] = true;
    let shown = band.rect(number);
    let first = [shown.x - rect.x, shown.y - rect.y];
    Arch::new().dispatch(Write { pixels, shader, first, shown, band });
}

struct Resolve<'a, const FIRST: bool, const WANTED: bool, const CLEAR: bool> {
    layer: &'a mut Layer,
    pixels: &'a mut [Pixels],
    rect: &'a TileRect,
    touched: &'a Touched,
}

impl<const FIRST: bool, const WANTED: bool, const CLEAR: bool> WithSimd
    for Resolve<'_, FIRST, WANTED, CLEAR>
{
    type Output = Open;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Open {
        let Self { layer, pixels, rect, touched } = self;
        let mut lines = Lines::new();
        let mut open = Open::NOWHERE;
        for row in touched.rows() {
            lines.take::<S, FIRST>(simd, layer, rect, touched, row);
            if row > touched.rows().start {
                // The rows below do not read it any more.
                layer.clear_sums::<WANTED>(touched.blocks(row - 1));
            }
            for column in touched.columns() {
                let index = row * PITCH + column;
                let depths = &mut layer.depths[index];
                for i in 0..LANES / S::F32_LANES {
                    let vector = |lanes: &Lanes| Vector::new(simd, S::as_simd_f32s(lanes).0[i]);
                    let [weight, depth, sharpness, color @ ..] = &layer.sums[index].0;
                    let weight = vector(weight);
                    // False for NaN.
                    let is_there = weight.exceeds(LEAST_WEIGHT);
                    let inverse = weight.if_set(is_there, 1.0).inverse();
                    let mean = |sums: &Lanes| vector(sums) * inverse;
                    let sharpness = mean(sharpness);
                    let mut evened = lines.evened::<S, FIRST>(weight, column, i);
                    if FIRST {
                        evened = lines.filled(simd, [weight, evened], sharpness, [row, column, i]);
                    }
                    let alpha = opacity(evened, sharpness);
                    let under = Under { alpha, is_there, i };
                    let color = [mean(&color[0]), mean(&color[1]), mean(&color[2])];
                    let pixels = &mut pixels[index];
                    let (is_first, after) = if CLEAR {
                        let opacity = mean(&layer.extras[index].opacity).at_most(1.0);
                        under.blend_clear::<FIRST>(simd, pixels, (color, opacity))
                    } else {
                        under.blend::<FIRST>(simd, &mut pixels.color, color)
                    };
                    let empty = f32::INFINITY;
                    keep::<S, FIRST>(mean(depth), is_first, empty, &mut pixels.depth, i);
                    if WANTED {
                        for (kept, sums) in pixels.normal.iter_mut().zip(&layer.extras[index].normals) {
                            keep::<S, FIRST>(mean(sums), is_first, 0.0, kept, i);
                        }
                    }
                    let light = -(after - 1.0);
                    let is_open = simd.and_m32s(is_there, light.exceeds(LEAST_LIGHT));
                    let floor = vector(&depths.near).if_set(is_open, f32::INFINITY);
                    S::as_mut_simd_f32s(&mut depths.floor).0[i] = floor.lanes;
                    if simd.first_true_m32s(is_open) < S::F32_LANES {
                        open.add(column, row);
                    }
                }
            }
        }
        if let Some(last) = touched.rows().next_back() {
            layer.clear_sums::<WANTED>(touched.blocks(last));
        }
        open
    }
}

/// A surface that is composited behind what is in vector `i` of a block.
struct Under<S: Simd> {
    alpha: Vector<S>,
    /// The pixels that the surface covers.
    is_there: S::m32s,
    i: usize,
}

impl<S: Simd> Under<S> {
    /// Returns the pixels that became half opaque by it, and the opacity of all.
    #[inline(always)]
    fn blend<const FIRST: bool>(
        &self,
        simd: S,
        pixels: &mut [Lanes; 4],
        color: [Vector<S>; 3],
    ) -> (S::m32s, Vector<S>) {
        let [channels @ .., opacity] = pixels;
        let opacity = &mut S::as_mut_simd_f32s(opacity).0[self.i];
        let before = if FIRST { Vector::all(simd, 0.0) } else { Vector::new(simd, *opacity) };
        let overlap = -(before * INDEPENDENT - 1.0);
        let share = (self.alpha * overlap).min(-(before - 1.0)).if_set(self.is_there, 0.0);
        let after = before + share;
        *opacity = after.lanes;
        for (channel, color) in channels.iter_mut().zip(color) {
            let channel = &mut S::as_mut_simd_f32s(channel).0[self.i];
            // Outside of the surface the color may be NaN.
            let added = share * color.if_set(self.is_there, 0.0);
            *channel = if FIRST { added } else { Vector::new(simd, *channel) + added }.lanes;
        }
        (self.became_half(simd, before, after), after)
    }

    /// The same where surfaces are opaque to a share; `color` is premultiplied by it.
    ///
    /// What of this surface lies beside those before it is `beside`, as above. The rest lies behind what they cover, which
    /// lets through what covers less than it keeps back.
    #[inline(always)]
    fn blend_clear<const FIRST: bool>(
        &self,
        simd: S,
        pixels: &mut Pixels,
        (color, own): ([Vector<S>; 3], Vector<S>),
    ) -> (S::m32s, Vector<S>) {
        let Pixels { color: [channels @ .., opacity], covered, .. } = pixels;
        let opacity = &mut S::as_mut_simd_f32s(opacity).0[self.i];
        let covered = &mut S::as_mut_simd_f32s(covered).0[self.i];
        let zero = Vector::all(simd, 0.0);
        let (before, by_all) =
            if FIRST { (zero, zero) } else { (Vector::new(simd, *opacity), Vector::new(simd, *covered)) };
        let overlap = -(by_all * INDEPENDENT - 1.0);
        let beside = (self.alpha * overlap).min(-(by_all - 1.0)).if_set(self.is_there, 0.0);
        let behind = self.alpha.if_set(self.is_there, 0.0) - beside;
        let through = (by_all - before).at_least(0.0) / by_all.at_least(f32::MIN_POSITIVE);
        // No more than there is light left, by rounding either.
        let seen = (beside + behind * through).min(-(before - 1.0)).at_least(0.0);
        let after = before + seen * own.if_set(self.is_there, 0.0);
        (*opacity, *covered) = (after.lanes, (by_all + beside).lanes);
        for (channel, color) in channels.iter_mut().zip(color) {
            let channel = &mut S::as_mut_simd_f32s(channel).0[self.i];
            let added = seen * color.if_set(self.is_there, 0.0);
            *channel = if FIRST { added } else { Vector::new(simd, *channel) + added }.lanes;
        }
        (self.became_half(simd, before, after), after)
    }

    /// The pixels of this surface that were less than half opaque before it, and are not after.
    #[inline(always)]
    fn became_half(&self, simd: S, before: Vector<S>, after: Vector<S>) -> S::m32s {
        let half = Vector::all(simd, 0.5);
        let was_open = simd.and_m32s(self.is_there, half.is_above(before));
        simd.and_m32s(was_open, simd.greater_than_or_equal_f32s(after.lanes, half.lanes))
    }
}

/// Sets what a pixel keeps where `mask` is set; before the first layer it has the value `empty`.
#[inline(always)]
fn keep<S: Simd, const FIRST: bool>(new: Vector<S>, mask: S::m32s, empty: f32, kept: &mut Lanes, i: usize) {
    let kept = &mut S::as_mut_simd_f32s(kept).0[i];
    *kept = if FIRST { new.if_set(mask, empty) } else { new.or_where_unset(mask, *kept) }.lanes;
}

/// A value of each pixel of a row. With a block of room on either side.
type Line = [f32; (PITCH + 2) * LANES];

/// The rows around one, and itself in the middle.
const AROUND: usize = 2 * RING + 1;

/// Sums and least weights of three pixels above one another, for each column of a row. Only pixels that were open
/// before this layer count: the weights that it would have in others are unknown, and these do not count as its edge.
struct Lines {
    /// Weights and nearest depths of the rows around, each at its number modulo [`AROUND`]. Untouched after the first
    /// layer.
    rows: [Line; AROUND],
    near: [Line; AROUND],
    sums: Line,
    least: Line,
    /// How many of the three were open.
    counts: Line,
    /// 1 where the row before was open: its floors are new already.
    above: Line,
}

impl Lines {
    #[inline(always)]
    fn new() -> Self {
        let zero = [0.0; (PITCH + 2) * LANES];
        let (rows, near) = ([zero; AROUND], [zero; AROUND]);
        Self { rows, near, sums: zero, least: zero, counts: zero, above: zero }
    }

    /// Takes the weights of a row and its neighbours, one row after the other. Beyond the tile they are those of its
    /// outermost pixels.
    #[inline(always)]
    fn take<S: Simd, const FIRST: bool>(
        &mut self,
        simd: S,
        layer: &Layer,
        rect: &TileRect,
        touched: &Touched,
        row: usize,
    ) {
        let is_first = row == touched.rows().start;
        let columns = touched.columns();
        let columns = columns.start.saturating_sub(1)..(columns.end + 1).min(rect.width.div_ceil(LANES));
        if FIRST {
            let new = if is_first { 0 } else { AROUND - 1 };
            for number in row + new..row + AROUND {
                self.take_row(layer, rect, columns.clone(), number);
            }
            self.add_rows(simd, columns, row);
        } else {
            let rows = [row.saturating_sub(1), row, (row + 1).min(rect.height - 1)];
            self.add_open(simd, layer, columns, (rows, is_first));
            widen(&mut self.counts, rect);
        }
        widen(&mut self.sums, rect);
        widen(&mut self.least, rect);
    }

    /// Takes the weights and nearest depths of row `number` − [`RING`].
    #[inline(always)]
    fn take_row(&mut self, layer: &Layer, rect: &TileRect, columns: Range<usize>, number: usize) {
        let row = number.saturating_sub(RING).min(rect.height - 1);
        let weights = &mut self.rows[number % AROUND];
        let near = &mut self.near[number % AROUND];
        let line = (columns.start + 1) * LANES..(columns.end + 1) * LANES;
        let blocks = row * PITCH + columns.start..row * PITCH + columns.end;
        for (to, sums) in weights[line.clone()].chunks_exact_mut(LANES).zip(&layer.sums[blocks.clone()]) {
            to.copy_from_slice(&sums.0[0]);
        }
        for (to, depths) in near[line].chunks_exact_mut(LANES).zip(&layer.depths[blocks]) {
            to.copy_from_slice(&depths.near);
        }
        widen(weights, rect);
        widen(near, rect);
    }

    /// Adds up three rows about this one, all of whose pixels are open.
    #[inline(always)]
    fn add_rows<S: Simd>(&mut self, simd: S, columns: Range<usize>, row: usize) {
        let [above, own, below] = [RING - 1, RING, RING + 1].map(|i| &self.rows[(row + i) % AROUND]);
        for column in columns {
            for i in 0..LANES / S::F32_LANES {
                let weight = |line: &Line| Vector::new(simd, lanes::<S>(line, column)[i]);
                let (above, own, below) = (weight(above), weight(own), weight(below));
                lanes_mut::<S>(&mut self.sums, column)[i] = (above + below + own).lanes;
                lanes_mut::<S>(&mut self.least, column)[i] = above.min(below).min(own).lanes;
            }
        }
    }

    /// Adds up three rows, as far as they are open; whether the middle one `is_first` of the layer.
    #[inline(always)]
    fn add_open<S: Simd>(
        &mut self,
        simd: S,
        layer: &Layer,
        columns: Range<usize>,
        ([above, row, below], is_first): ([usize; 3], bool),
    ) {
        for column in columns {
            for i in 0..LANES / S::F32_LANES {
                // No closures: a function compiled on its own would not use the wide instructions.
                let above = Weights::<S>::new(simd, layer, above * PITCH + column, i);
                let own = Weights::<S>::new(simd, layer, row * PITCH + column, i);
                let below = Weights::<S>::new(simd, layer, below * PITCH + column, i);
                let above_open =
                    if is_first { above.open } else { own.open.with(lanes::<S>(&self.above, column)[i]) };
                let least = own.least(own.open).min(above.least(above_open)).min(below.least(below.open));
                let sum = above.weight + below.weight + own.weight;
                lanes_mut::<S>(&mut self.sums, column)[i] = sum.lanes;
                lanes_mut::<S>(&mut self.least, column)[i] = least.lanes;
                lanes_mut::<S>(&mut self.counts, column)[i] = (above_open + own.open + below.open).lanes;
                lanes_mut::<S>(&mut self.above, column)[i] = own.open.lanes;
            }
        }
    }

    /// The weights of a vector of pixels, or, inside a surface, the means of the 3×3 pixels around each if they are larger.
    ///
    /// Weights vary between points, which the larger mean evens out. Over a blurred edge weights fall linearly, and the
    /// mean equals the weight in the middle.
    #[inline(always)]
    fn evened<S: Simd, const FIRST: bool>(&self, own: Vector<S>, column: usize, i: usize) -> Vector<S> {
        let [left, middle, right] = around(&self.sums, own, column, i);
        let sum = left + right + middle;
        let mean = if FIRST {
            sum * (1.0 / 9.0)
        } else {
            let [left, middle, right] = around(&self.counts, own, column, i);
            sum / (left + right + middle).at_least(1.0)
        };
        let [left, middle, right] = around(&self.least, own, column, i);
        let least = left.min(right).min(middle);
        mean.max(own).or_where_unset(least.exceeds(LEAST_INSIDE), own.lanes)
    }

    /// The weights of a vector of pixels, evened, where their own leave gaps raised to the lesser of two on opposite sides.
    ///
    /// It fills gaps as wide as kernels, up to three pixels, and leaves edges where they are: on one side of an edge
    /// weights are less or of another surface, and along it they are the same. Gaps into which the surface hardly reaches
    /// stay open, such as those between bars.
    #[inline(always)]
    fn filled<S: Simd>(
        &self,
        simd: S,
        [own, evened]: [Vector<S>; 2],
        sharpness: Vector<S>,
        place: [usize; 3],
    ) -> Vector<S> {
        let is_clear = Vector::all(simd, 1.0).is_above(opacity(evened, sharpness));
        let is_gap = simd.and_m32s(is_clear, own.exceeds(LEAST_INSIDE));
        let mut filled = evened;
        for (least_wide, distances) in GAPS {
            let is_wide = simd.and_m32s(is_gap, sharpness.exceeds(least_wide));
            if simd.first_true_m32s(is_wide) == S::F32_LANES {
                break;
            }
            let near = self.neighbour(own, [0, 0], place).near;
            for &[left, right] in distances {
                for [x, y] in DIRECTIONS {
                    let a = self.neighbour(own, [-left * x, -left * y], place);
                    let b = self.neighbour(own, [right * x, right * y], place);
                    let share = left as f32 / (left + right) as f32;
                    let across = between(near, [a, b], [1.0 - share, share]);
                    filled = filled.max(across.if_set(is_wide, 0.0));
                }
            }
        }
        filled
    }

    /// What is so many columns and rows from a vector of pixels.
    #[inline(always)]
    fn neighbour<S: Simd>(
        &self,
        own: Vector<S>,
        [x, y]: [isize; 2],
        [row, column, i]: [usize; 3],
    ) -> Neighbour<S> {
        let line = (row + RING).wrapping_add_signed(y) % AROUND;
        let first = ((column + 1) * LANES).wrapping_add_signed(x);
        let vector = |line: &Line| own.with(S::as_simd_f32s(&line[first..first + LANES]).0[i]);
        Neighbour { weight: vector(&self.rows[line]), near: vector(&self.near[line]) }
    }
}

/// Weights and nearest depths of a vector of pixels.
#[derive(Clone, Copy)]
struct Neighbour<S: Simd> {
    weight: Vector<S>,
    near: Vector<S>,
}

/// The lesser weight of two on opposite sides of pixels with a surface at these nearest depths; 0 where that of one of the
/// two lies behind it. A plane through both has the mean of their depths with these shares.
///
/// From pixel to pixel a surface goes farther as it came nearer. Beside an edge one side is of the surface and the other
/// of what is behind: they are farther in the mean by a third or more of what they differ by. In a gap, depths count for
/// more than beside it (see `kernel::nearest`).
#[inline(always)]
fn between<S: Simd>(near: Vector<S>, [a, b]: [Neighbour<S>; 2], shares: [f32; 2]) -> Vector<S> {
    let apart = a.near.max(b.near) - a.near.min(b.near);
    let mean = a.near * shares[0] + b.near * shares[1];
    let is_behind = (mean - near).is_above(apart * 0.25);
    near.like(0.0).or_where_unset(is_behind, a.weight.min(b.weight).lanes)
}

/// Repeats the outermost pixels of a tile beyond it.
#[inline(always)]
fn widen(line: &mut Line, rect: &TileRect) {
    for i in 0..RING {
        line[LANES - 1 - i] = line[LANES];
        line[LANES + rect.width + i] = line[LANES + rect.width - 1];
    }
}

/// The vectors of a block in a line.
#[inline(always)]
fn lanes<S: Simd>(line: &Line, column: usize) -> &[S::f32s] {
    S::as_simd_f32s(&line[(column + 1) * LANES..(column + 2) * LANES]).0
}

#[inline(always)]
fn lanes_mut<S: Simd>(line: &mut Line, column: usize) -> &mut [S::f32s] {
    S::as_mut_simd_f32s(&mut line[(column + 1) * LANES..(column + 2) * LANES]).0
}

/// Vector `i` of a block, and those of the pixels to its left and right around it.
#[inline(always)]
fn around<S: Simd>(line: &Line, own: Vector<S>, column: usize, i: usize) -> [Vector<S>; 3] {
    let first = (column + 1) * LANES;
    [
        own.with(S::as_simd_f32s(&line[first - 1..first - 1 + LANES]).0[i]),
        own.with(S::as_simd_f32s(&line[first..first + LANES]).0[i]),
        own.with(S::as_simd_f32s(&line[first + 1..first + 1 + LANES]).0[i]),
    ]
}

/// Weights of a vector of pixels, and 1 where they were open before this layer.
struct Weights<S: Simd> {
    weight: Vector<S>,
    open: Vector<S>,
}

impl<S: Simd> Weights<S> {
    /// Vector `i` of a block.
    #[inline(always)]
    fn new(simd: S, layer: &Layer, block: usize, i: usize) -> Self {
        let weight = Vector::new(simd, S::as_simd_f32s(&layer.sums[block].0[0]).0[i]);
        let floor = Vector::new(simd, S::as_simd_f32s(&layer.depths[block].floor).0[i]);
        let open = Vector::all(simd, 0.0).if_set(floor.exceeds(f32::MAX), 1.0);
        Self { weight, open }
    }

    /// The weight, +∞ where pixels were not open.
    #[inline(always)]
    fn least(&self, open: Vector<S>) -> Vector<S> {
        self.weight.if_set(open.exceeds(0.5), f32::INFINITY)
    }
}

impl Pixels {
    /// From lane `first` on.
    #[inline(always)]
    fn write(&self, first: usize, shader: &Shader, colors: &mut [[f32; 4]], depths: &mut [f32]) {
        let [red, green, blue, alpha] = &self.color;
        for (color, i) in colors.iter_mut().zip(first..) {
            *color = [red[i], green[i], blue[i], alpha[i]];
        }
        for (depth, &bent) in depths.iter_mut().zip(&self.depth[first..]) {
            *depth = shader.depth(bent);
        }
    }
}

struct Write<'a, 'b> {
    pixels: &'a [Pixels],
    shader: &'a Shader,
    /// The first pixel that is shown: column, row.
    first: [usize; 2],
    shown: TileRect,
    band: &'a mut Band<'b>,
}

impl NullaryFnOnce for Write<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { pixels, shader, first: [first, first_row], shown, band } = self;
        let in_first_block = (LANES - first).min(shown.width);
        for row in 0..shown.height {
            let from = &pixels[(first_row + row) * PITCH..];
            let to = row * band.width + shown.x..row * band.width + shown.x + shown.width;
            let (some_colors, colors) = band.color[to.clone()].split_at_mut(in_first_block);
            let (some_depths, depths) = band.depth[to.clone()].split_at_mut(in_first_block);
            from[0].write(first, shader, some_colors, some_depths);
            let blocks = colors.chunks_mut(LANES).zip(depths.chunks_mut(LANES));
            for (pixels, (colors, depths)) in from[1..].iter().zip(blocks) {
                // Whole blocks apart: copies of a length known to the compiler need no call.
                match (<&mut [_; LANES]>::try_from(&mut *colors), <&mut [_; LANES]>::try_from(&mut *depths)) {
                    (Ok(colors), Ok(depths)) => pixels.write(0, shader, colors, depths),
                    _ => pixels.write(0, shader, colors, depths),
                }
            }
            let Some(normals) = &mut band.normal else { continue };
            for (normal, i) in normals[to].iter_mut().zip(first..) {
                *normal = shader.in_world(from[i / LANES].normal.map(|n| n[i % LANES]).into());
            }
        }
    }
}
