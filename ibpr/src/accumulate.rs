//! From points to one averaged point per buffer pixel.
//!
//! Bands of rows are independent: each walks the blocks whose boxes meet it, in the cloud's order, and
//! so every sum is added up in the same order whatever the number of bands or threads.

use crate::buffer::{Buffer, DepthScale, PAD};
use crate::buffer_map::BufferMap;
use crate::cloud::Cloud;
use crate::layers;
use crate::options::{Translucency, Weighting};
use crate::parallel::*;
use crate::project::{Band, LANES, Projected};
use pointillist_parallel::Pool;
use pulp::Arch;

/// Rows per band: the sums of a band of 1024 pixels fit into the second-level cache.
const BAND_ROWS: usize = 64;

/// A block as this frame sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockView {
    rows: [f32; 12],
    start: usize,
    end: usize,
    /// First row that its points may fall into, and the first below it.
    top: usize,
    bottom: usize,
}

/// Where the points of a pixel lie in [`Sums`].
const WEIGHT: usize = 0;
const X: usize = 1;
const Y: usize = 2;
const DEPTH: usize = 3;
const COUNT: usize = 4;
const COLOUR: usize = 5;

/// Weight, weighted position about the pixel's centre and weighted depth about the nearest one, number
/// of points, weighted color.
type Sums = [f32; 8];

/// Working memory of a band.
#[derive(Debug, Default)]
pub(crate) struct BandScratch {
    near: Vec<f32>,
    mean: Vec<f32>,
    sums: Vec<Sums>,
    pub(crate) layered: layers::LayerScratch,
}

/// What stays the same for all points of a frame.
#[derive(Clone, Copy)]
pub(crate) struct Rules {
    pub(crate) gamma: f32,
    pub(crate) weighting: Weighting,
    pub(crate) scale: DepthScale,
    /// Several surfaces per pixel, or only the nearest.
    pub(crate) layers: Option<Translucency>,
}

/// Projects the boxes of the visible blocks.
pub(crate) fn view_blocks(cloud: &Cloud, visible: &[u32], map: &BufferMap, views: &mut Vec<BlockView>) {
    views.clear();
    views.extend(visible.iter().map(|&i| {
        let block = &cloud.blocks[i as usize];
        let rows = map.rows(block.origin);
        let (top, bottom) = row_range(&rows, block.half.to_array(), map);
        BlockView { rows, start: block.points.start, end: block.points.end, top, bottom }
    }));
}

/// Rows of the buffer that a box may touch; all if a corner is at the eye or behind it.
fn row_range(rows: &[f32; 12], half: [f32; 3], map: &BufferMap) -> (usize, usize) {
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for corner in 0..8 {
        let side = |axis: usize| if corner >> axis & 1 == 0 { -half[axis] } else { half[axis] };
        let row = |r: usize| rows[r] * side(0) + rows[r + 1] * side(1) + rows[r + 2] * side(2) + rows[r + 3];
        let depth = row(8) + map.reference as f32;
        let w = if map.is_perspective() { depth } else { 1.0 };
        if w <= 0.0 {
            return (0, map.height);
        }
        let y = row(4) / w;
        (low, high) = (low.min(y), high.max(y));
    }
    // One row more than rounding could ask for.
    ((low - 1.0).max(0.0) as usize, ((high + 2.0).max(0.0) as usize).min(map.height))
}

/// Fills the positions, depths, counts and colors of `buffer`.
pub(crate) fn accumulate(
    cloud: &Cloud,
    views: &[BlockView],
    map: &BufferMap,
    rules: Rules,
    buffer: &mut Buffer,
    pool: &Pool<BandScratch>,
) {
    let inner = buffer.inner();
    let (stride, pitch) = (buffer.stride, buffer.pitch);
    let n = BAND_ROWS * pitch;
    chunks(&mut buffer.x[inner.clone()], n)
        .zip(chunks(&mut buffer.y[inner.clone()], n))
        .zip(chunks(&mut buffer.q[inner.clone()], n))
        .zip(chunks(&mut buffer.count[inner.clone()], n))
        .zip(chunks(&mut buffer.color[inner], n))
        .enumerate()
        .for_each(|(i, ((((x, y), q), count), color))| {
            let band = Band::new(map, i * BAND_ROWS, x.len() / pitch);
            let out = Resolved { x, y, q, count, color, stride, pitch };
            pool.with(|scratch| match rules.layers {
                None => {
                    sum_band(cloud, views, &band, rules, scratch);
                    resolve(scratch, &band, &rules.scale, cloud.has_colors(), out);
                }
                Some(layers) => layers::fill_band(cloud, views, &band, rules, layers, scratch, out),
            });
        });
}

/// Calls `each` for the points of `views` in `band`: number in the projected lanes, pixel in the band,
/// number in the cloud.
pub(crate) fn walk(
    cloud: &Cloud,
    views: &[BlockView],
    band: &Band,
    mut each: impl FnMut(&Projected, usize, usize, usize),
) {
    let mut projected = Projected::new();
    let arch = Arch::new();
    let [x, y, z] = &cloud.offsets;
    let end_row = band.first_row + band.rows;
    for view in views.iter().filter(|v| v.top < end_row && v.bottom > band.first_row) {
        for start in (view.start..view.end).step_by(LANES) {
            let lanes = start..(start + LANES).min(view.end);
            let points = [&x[lanes.clone()], &y[lanes.clone()], &z[lanes]];
            projected.transform(arch, &view.rows, points, band);
            for k in projected.kept() {
                each(&projected, k, projected.pixel(k, band), start + k);
            }
        }
    }
}

fn sum_band(cloud: &Cloud, views: &[BlockView], band: &Band, rules: Rules, scratch: &mut BandScratch) {
    let pixels = band.width * band.rows;
    let BandScratch { near, mean, sums, .. } = scratch;
    near.clear();
    near.resize(pixels, f32::INFINITY);
    walk(cloud, views, band, |p, k, pixel, _| near[pixel] = near[pixel].min(p.depth[k]));
    sums.clear();
    sums.resize(pixels, [0.0; 8]);
    let behind =
        |p: &Projected, k: usize, near: f32| (p.depth[k] - near) / (rules.gamma * rules.scale.unit(near));
    if rules.weighting == Weighting::Symmetric {
        let all = |_: &Projected, _: usize, _: usize, u: f32| if u <= 1.0 { 1.0 } else { 0.0 };
        let weight = |p: &Projected, k: usize, pixel: usize| all(p, k, pixel, behind(p, k, near[pixel]));
        add(cloud, views, band, near, sums, weight);
        mean.clear();
        mean.extend(sums.iter().zip(near.iter()).map(|(s, near)| near + s[DEPTH] / s[WEIGHT].max(1.0)));
        sums.fill([0.0; 8]);
    }
    // A count of 1 or more keeps a lone nearest point that the printed rule gives no weight.
    const LEAST: f32 = 1e-6;
    let weight = |p: &Projected, k: usize, pixel: usize| {
        let u = behind(p, k, near[pixel]);
        if u > 1.0 {
            return 0.0;
        }
        match rules.weighting {
            Weighting::Printed => u.max(LEAST),
            Weighting::Falling => (1.0 - u).max(LEAST),
            Weighting::Even => 1.0,
            Weighting::Symmetric => {
                let slab = rules.gamma * rules.scale.unit(near[pixel]);
                (1.0 - (p.depth[k] - mean[pixel]).abs() / slab).max(LEAST)
            }
        }
    };
    add(cloud, views, band, near, sums, weight);
}

fn add(
    cloud: &Cloud,
    views: &[BlockView],
    band: &Band,
    near: &[f32],
    sums: &mut [Sums],
    weight: impl Fn(&Projected, usize, usize) -> f32,
) {
    let colored = cloud.has_colors();
    walk(cloud, views, band, |p, k, pixel, point| {
        let w = weight(p, k, pixel);
        if w <= 0.0 {
            return;
        }
        // Positions in the band are not negative, and `floor` is a call where the processor has no SSE4.
        let centre = |v: f32| v as i32 as f32 + 0.5;
        let sum = &mut sums[pixel];
        sum[WEIGHT] += w;
        sum[X] += w * (p.x[k] - centre(p.x[k]));
        sum[Y] += w * (p.y[k] - centre(p.y[k]));
        sum[DEPTH] += w * (p.depth[k] - near[pixel]);
        sum[COUNT] += 1.0;
        if colored {
            let color = cloud.colors[point];
            for (s, c) in sum[COLOUR..].iter_mut().zip(color) {
                *s += w * c;
            }
        }
    });
}

/// Rows of a buffer that a band writes.
pub(crate) struct Resolved<'a> {
    pub(crate) x: &'a mut [f32],
    pub(crate) y: &'a mut [f32],
    pub(crate) q: &'a mut [f32],
    pub(crate) count: &'a mut [f32],
    pub(crate) color: &'a mut [[f32; 3]],
    /// Entries to the next layer and to the next row.
    pub(crate) stride: usize,
    pub(crate) pitch: usize,
}

fn resolve(scratch: &BandScratch, band: &Band, scale: &DepthScale, colored: bool, out: Resolved<'_>) {
    for row in 0..band.rows {
        for column in 0..band.width {
            let (from, to) = (row * band.width + column, row * out.pitch + column + PAD);
            let sum = &scratch.sums[from];
            out.count[to] = sum[COUNT];
            if sum[COUNT] == 0.0 {
                continue;
            }
            let inverse = 1.0 / sum[WEIGHT];
            out.x[to] = column as f32 + 0.5 + sum[X] * inverse;
            out.y[to] = (band.first_row + row) as f32 + 0.5 + sum[Y] * inverse;
            out.q[to] = scale.bent(scratch.near[from] + sum[DEPTH] * inverse);
            if colored {
                out.color[to] = [0, 1, 2].map(|c| sum[COLOUR + c] * inverse);
            }
        }
    }
}
