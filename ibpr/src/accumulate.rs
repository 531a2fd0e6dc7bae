//! Averages points: one averaged point per buffer pixel and layer.
//!
//! Bands of rows are independent: each walks the blocks whose boxes meet it, in the cloud's order, and
//! so every sum is added up in the same order whatever the number of bands or threads.

use crate::block_view::BlockView;
use crate::buffer::{Buffer, BufferBand};
use crate::buffer_map::BufferMap;
use crate::cloud::Cloud;
use crate::layers::{self, LayerScratch};
use crate::nearest::{self, NearestScratch};
use crate::parallel::*;
use crate::project::Band;
use crate::rules::Rules;
use pointillist_parallel::Pool;

/// Rows per band: the sums of a band of 1024 pixels fit into the second-level cache.
const BAND_ROWS: usize = 64;

/// Working memory of a band.
#[derive(Debug, Default)]
pub(crate) struct BandScratch {
    nearest: NearestScratch,
    layers: LayerScratch,
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
            let out = BufferBand { x, y, q, count, color, stride, pitch };
            pool.with(|scratch| match rules.layers {
                None => nearest::fill_band(cloud, views, &band, rules, &mut scratch.nearest, out),
                Some(options) => {
                    layers::fill_band(cloud, views, &band, rules, options, &mut scratch.layers, out);
                }
            });
        });
}
