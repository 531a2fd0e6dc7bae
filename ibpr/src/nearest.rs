//! The nearest surface of each buffer pixel: the weighted mean of the points within γ of the nearest one.

use crate::block_view::{BlockView, walk};
use crate::border::PAD;
use crate::buffer::{BufferBand, DepthScale};
use crate::cloud::Cloud;
use crate::hidden::Limits;
use crate::options::Weighting;
use crate::project::{Band, Projected};
use crate::rules::Rules;

/// Entries of [`Sums`].
const WEIGHT: usize = 0;
const X: usize = 1;
const Y: usize = 2;
const DEPTH: usize = 3;
const COUNT: usize = 4;
const COLOR: usize = 5;

/// Weight, weighted position about the pixel's centre and weighted depth about the nearest one, number
/// of points, weighted color.
type Sums = [f32; 8];

/// Working memory of a band.
#[derive(Debug, Default)]
pub(crate) struct NearestScratch {
    /// Depth of the nearest point of each pixel; infinite where there is none.
    near: Vec<f32>,
    /// Mean depth of each pixel, for [`Weighting::Symmetric`].
    mean: Vec<f32>,
    sums: Vec<Sums>,
    limits: Limits,
}

/// Averages the points of each pixel of a band that are within γ of the nearest one.
pub(crate) fn fill_band(
    cloud: &Cloud,
    views: &[BlockView],
    band: &Band,
    rules: Rules,
    scratch: &mut NearestScratch,
    out: BufferBand<'_>,
) {
    sum_band(cloud, views, band, rules, scratch);
    resolve(scratch, band, &rules.scale, cloud.has_colors(), out);
}

fn sum_band(cloud: &Cloud, views: &[BlockView], band: &Band, rules: Rules, scratch: &mut NearestScratch) {
    let pixels = band.width * band.rows;
    let NearestScratch { near, mean, sums, limits } = scratch;
    near.clear();
    near.resize(pixels, f32::INFINITY);
    walk(cloud, views, band, |_| false, |p, k, pixel, _| near[pixel] = near[pixel].min(p.depth[k]));
    // A little more than γ, by which points are told from those that do not count: both are rounded.
    let rounding = |near: f32| 4.0 * f32::EPSILON * near.abs();
    let slab = |near: f32| 1.001 * rules.gamma * rules.scale.unit(near);
    limits.find(near, band, |near| near + slab(near) + rounding(near));
    sums.clear();
    sums.resize(pixels, [0.0; 8]);
    let behind =
        |p: &Projected, k: usize, near: f32| (p.depth[k] - near) / (rules.gamma * rules.scale.unit(near));
    if rules.weighting == Weighting::Symmetric {
        let all = |_: &Projected, _: usize, _: usize, u: f32| if u <= 1.0 { 1.0 } else { 0.0 };
        let weight = |p: &Projected, k: usize, pixel: usize| all(p, k, pixel, behind(p, k, near[pixel]));
        add(cloud, views, band, (near, limits), sums, weight);
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
    add(cloud, views, band, (near, limits), sums, weight);
}

fn add(
    cloud: &Cloud,
    views: &[BlockView],
    band: &Band,
    (near, limits): (&[f32], &Limits),
    sums: &mut [Sums],
    weight: impl Fn(&Projected, usize, usize) -> f32,
) {
    let colored = cloud.has_colors();
    let hidden = |view: &BlockView| limits.hide(view, band);
    walk(cloud, views, band, hidden, |p, k, pixel, point| {
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
            for (s, c) in sum[COLOR..].iter_mut().zip(color) {
                *s += w * c;
            }
        }
    });
}

fn resolve(scratch: &NearestScratch, band: &Band, scale: &DepthScale, colored: bool, out: BufferBand<'_>) {
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
                let [r, g, b] = [0, 1, 2].map(|c| sum[COLOR + c] * inverse);
                out.color[to] = [r, g, b, 1.0];
            }
        }
    }
}
