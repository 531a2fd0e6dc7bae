//! Pull-push: pixels without points that lie between pixels with points of one surface.
//!
//! Only enclosed pixels are filled, so outlines do not grow. At the buffer's own size a gap takes the mean
//! of opposite neighbours that belong together. For wider gaps the buffer is averaged to half its size
//! (pull); what is enclosed by its own surface there covers the gaps below it (push). A gap is a pixel
//! without points, or one through which a surface further behind is seen.

use crate::border::PAD;
use crate::buffer::{Buffer, DepthScale};
use crate::parallel::*;
use std::ops::Range;

/// Number of points that a filled pixel counts as: it is drawn, but has almost no weight in plane fits.
pub(crate) const FILLED: f32 = 1e-3;

/// Depths of opposite neighbours may differ by this many units: twice the step between neighbours.
const STEP: f32 = 10.0;

/// A surface this many units behind its surroundings is another one: beyond γ and what noise adds to it.
const BEHIND: f32 = 3.0;

/// Fewest of the four pairs of opposite neighbours that must agree for a pixel that shows a surface further behind to be
/// covered, and for any gap to be filled from the pyramid. A slit between two surfaces is bridged by one pair only, and
/// stays open.
const ENCLOSED: usize = 3;

/// The same for a pixel without points, from its direct neighbours.
const ENCLOSED_EMPTY: usize = 1;

/// Rows that are searched together.
const BAND_ROWS: usize = 32;

/// A pixel that gets a value.
#[derive(Clone, Copy, Debug)]
struct Fill {
    index: usize,
    x: f32,
    y: f32,
    q: f32,
    color: [f32; 4],
}

/// Working memory.
#[derive(Debug, Default)]
pub(crate) struct FillScratch {
    bands: Vec<Vec<Fill>>,
    levels: Vec<Buffer>,
}

/// Fills gaps of less than 2^`levels` pixels.
pub(crate) fn pull_push(buffer: &mut Buffer, scale: &DepthScale, levels: u32, scratch: &mut FillScratch) {
    if levels == 0 {
        return;
    }
    if buffer.layers > 1 {
        return fill_bands(buffer, &mut scratch.bands, all_columns, |buffer, i, fills| {
            layers_between(buffer, i, scale, fills)
        });
    }
    let coarser = levels as usize - 1;
    let FillScratch { bands, levels: pyramid } = scratch;
    pyramid.resize_with(coarser.max(pyramid.len()), Buffer::default);
    // Direct neighbours come first: they are finer than the pyramid.
    fill_bands(buffer, bands, near_points, |buffer, i, fills| fills.extend(between(buffer, i, scale)));
    for l in 0..coarser {
        let (finer, rest) = pyramid.split_at_mut(l);
        pull(finer.last().unwrap_or(buffer), &mut rest[0], scale);
    }
    for l in (0..coarser).rev() {
        let (finer, rest) = pyramid.split_at_mut(l);
        let (coarse, fine) = (&rest[0], finer.last_mut().unwrap_or(buffer));
        let columns = |fine: &Buffer, row: usize| {
            let above = near_points(coarse, row / 2);
            2 * above.start..(2 * above.end).min(fine.width)
        };
        fill_bands(fine, bands, columns, |fine, i, fills| fills.extend(below(coarse, fine, i, scale)));
    }
}

/// All columns of a row.
fn all_columns(buffer: &Buffer, _: usize) -> Range<usize> {
    0..buffer.width
}

/// The columns between the first and the last point of a row and of those beside it: no other pixel has points on opposite sides.
fn near_points(buffer: &Buffer, row: usize) -> Range<usize> {
    let middle = buffer.at(0, row);
    let rows = [middle - buffer.pitch, middle, middle + buffer.pitch];
    let counts = rows.map(|start| &buffer.count[start..start + buffer.width]);
    let first = counts.iter().filter_map(|row| row.iter().position(|count| *count > 0.0)).min();
    let last = counts.iter().filter_map(|row| row.iter().rposition(|count| *count > 0.0)).max();
    first.zip(last).map_or(0..0, |(first, last)| first..last + 1)
}

/// Calls `find` for each pixel of the unchanged buffer in the `columns` of its row, then writes the values found.
fn fill_bands(
    buffer: &mut Buffer,
    bands: &mut Vec<Vec<Fill>>,
    columns: impl Fn(&Buffer, usize) -> Range<usize> + Sync + Send,
    find: impl Fn(&Buffer, usize, &mut Vec<Fill>) + Sync + Send,
) {
    let count = buffer.height.div_ceil(BAND_ROWS);
    bands.resize_with(count.max(bands.len()), Vec::new);
    let shared = &*buffer;
    chunks(&mut bands[..count], 1).enumerate().for_each(|(i, fills)| {
        let fills = &mut fills[0];
        fills.clear();
        for row in i * BAND_ROWS..((i + 1) * BAND_ROWS).min(shared.height) {
            let start = shared.at(0, row);
            for i in columns(shared, row) {
                find(shared, start + i, fills);
            }
        }
    });
    for fill in bands[..count].iter().flatten() {
        apply(buffer, fill);
    }
}

fn apply(buffer: &mut Buffer, fill: &Fill) {
    let i = fill.index;
    (buffer.x[i], buffer.y[i], buffer.q[i]) = (fill.x, fill.y, fill.q);
    (buffer.count[i], buffer.color[i]) = (FILLED, fill.color);
}

/// The mean of the pairs of opposite neighbours of the surface that is nearest to the eye, for a pixel
/// that is empty or through which another surface behind that one is seen.
fn between(buffer: &Buffer, index: usize, scale: &DepthScale) -> Option<Fill> {
    let s = buffer.pitch;
    let occupied = buffer.count[index] > 0.0;
    let q = buffer.q[index];
    let apart = scale.bent_step(q, BEHIND);
    let in_front = |i: usize| buffer.count[i] > 0.0 && buffer.q[i] < q - apart;
    // Nearly all pixels end here: without a nearer neighbour beside it, two pairs at most could close it.
    if occupied && ![index - 1, index + 1, index - s, index + s].into_iter().any(in_front) {
        return None;
    }
    let behind = |pair: f32| !occupied || q > pair + scale.bent_step(pair, BEHIND);
    let mut nearest = f32::INFINITY;
    let mut pairs = [(0, 0, f32::INFINITY); 4];
    for (pair, offset) in pairs.iter_mut().zip([1, s, s + 1, s - 1]) {
        let (a, b) = (index - offset, index + offset);
        if buffer.count[a] > 0.0 && buffer.count[b] > 0.0 {
            let (qa, qb) = (buffer.q[a], buffer.q[b]);
            let mean = 0.5 * (qa + qb);
            if (qa - qb).abs() < scale.bent_step(qa, STEP) && behind(mean) {
                *pair = (a, b, mean);
                nearest = nearest.min(mean);
            }
        }
    }
    let enclosing = pairs.iter().filter(|p| p.2 < f32::INFINITY).count();
    if enclosing < if occupied { ENCLOSED } else { ENCLOSED_EMPTY } {
        return None;
    }
    let together = nearest + scale.bent_step(nearest, STEP);
    let mut fill = Fill { index, x: 0.0, y: 0.0, q: 0.0, color: [0.0; 4] };
    let mut n = 0.0;
    for (a, b, q) in pairs.into_iter().filter(|p| p.2 < together) {
        n += 2.0;
        fill.x += buffer.x[a] + buffer.x[b];
        fill.y += buffer.y[a] + buffer.y[b];
        fill.q += 2.0 * q;
        for (sum, (c, d)) in fill.color.iter_mut().zip(buffer.color[a].iter().zip(buffer.color[b])) {
            *sum += c + d;
        }
    }
    (fill.x, fill.y, fill.q) = (fill.x / n, fill.y / n, fill.q / n);
    fill.color = fill.color.map(|c| c / n);
    Some(fill)
}

/// Half the size: each pixel the mean of the up to four pixels of the surface nearest to the eye.
fn pull(fine: &Buffer, coarse: &mut Buffer, scale: &DepthScale) {
    let (width, height) = (fine.width.div_ceil(2), fine.height.div_ceil(2));
    coarse.reshape(width, height, 1);
    coarse.empty();
    for row in 0..height {
        for column in 0..width {
            let first = fine.at(2 * column, 2 * row);
            let children = [first, first + 1, first + fine.pitch, first + fine.pitch + 1];
            let valid = children.into_iter().filter(|c| fine.count[*c] > 0.0);
            let nearest = valid.clone().map(|c| fine.q[c]).fold(f32::INFINITY, f32::min);
            let together = nearest + scale.bent_step(nearest, STEP);
            let to = coarse.at(column, row);
            for c in valid.filter(|c| fine.q[*c] < together) {
                coarse.count[to] += 1.0;
                coarse.x[to] += 0.5 * fine.x[c];
                coarse.y[to] += 0.5 * fine.y[c];
                coarse.q[to] += fine.q[c];
                for (sum, v) in coarse.color[to].iter_mut().zip(fine.color[c]) {
                    *sum += v;
                }
            }
            if coarse.count[to] > 0.0 {
                let inverse = 1.0 / coarse.count[to];
                for array in [&mut coarse.x, &mut coarse.y, &mut coarse.q] {
                    array[to] *= inverse;
                }
                coarse.color[to] = coarse.color[to].map(|v| v * inverse);
            }
        }
    }
}

/// The value that the pixel of the half-size buffer gives to a pixel of `fine`: its surface, if that encloses the pixel
/// and the pixel is a gap in it.
fn below(coarse: &Buffer, fine: &Buffer, index: usize, scale: &DepthScale) -> Option<Fill> {
    let (row, column) = (index / fine.pitch - PAD, index % fine.pitch - PAD);
    let above = coarse.at(column / 2, row / 2);
    if coarse.count[above] == 0.0 {
        return None;
    }
    let surface = coarse.q[above];
    let step = scale.bent_step(surface, STEP);
    if fine.count[index] > 0.0 && fine.q[index] < surface + scale.bent_step(surface, BEHIND) {
        return None;
    }
    let s = coarse.pitch;
    let same = |i: usize| coarse.count[i] > 0.0 && (coarse.q[i] - surface).abs() < step;
    let closed = |offset: usize| same(above - offset) && same(above + offset);
    if [1, s, s + 1, s - 1].into_iter().filter(|o| closed(*o)).count() < ENCLOSED {
        return None;
    }
    // Linear between the coarse neighbours, where both are there.
    let slope = |offset: usize, at: &[f32]| {
        let run = at[above + offset] - at[above - offset];
        if closed(offset) && run > 0.5 {
            (coarse.q[above + offset] - coarse.q[above - offset]) / run
        } else {
            0.0
        }
    };
    let (x, y) = (column as f32 + 0.5, row as f32 + 0.5);
    let (dx, dy) = (0.5 * x - coarse.x[above], 0.5 * y - coarse.y[above]);
    let q = surface + dx * slope(1, &coarse.x) + dy * slope(s, &coarse.y);
    Some(Fill { index, x, y, q, color: coarse.color[above] })
}

/// Surfaces that opposite neighbours share and the pixel between them has not.
fn layers_between(buffer: &Buffer, index: usize, scale: &DepthScale, fills: &mut Vec<Fill>) {
    let layers = |pixel: usize| {
        (0..buffer.layers).map(move |l| pixel + l * buffer.stride).take_while(|i| buffer.count[*i] > 0.0)
    };
    let own = layers(index).count();
    let around = [index - 1, index + 1, index - buffer.pitch, index + buffer.pitch];
    if own == buffer.layers || around.into_iter().all(|i| layers(i).count() <= own) {
        return;
    }
    let first = fills.len();
    for offset in [1, buffer.pitch] {
        for a in layers(index - offset) {
            let qa = buffer.q[a];
            let step = scale.bent_step(qa, STEP);
            let apart = |b: &usize| (buffer.q[*b] - qa).abs();
            let opposite = layers(index + offset).min_by(|b, c| apart(b).total_cmp(&apart(c)));
            let Some(b) = opposite.filter(|b| apart(b) < step) else { continue };
            let mean = |array: &[f32]| 0.5 * (array[a] + array[b]);
            let q = mean(&buffer.q);
            let there = layers(index).map(|i| buffer.q[i]).chain(fills[first..].iter().map(|f| f.q));
            let room = own + fills.len() - first < buffer.layers;
            if room && there.into_iter().all(|other| (other - q).abs() >= step) {
                let (c, d) = (buffer.color[a], buffer.color[b]);
                fills.push(Fill {
                    index: index + (own + fills.len() - first) * buffer.stride,
                    x: mean(&buffer.x),
                    y: mean(&buffer.y),
                    q,
                    color: [0, 1, 2, 3].map(|k| 0.5 * (c[k] + d[k])),
                });
            }
        }
    }
}
