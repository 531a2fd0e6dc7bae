//! The visible blocks of a frame: which rows of the buffer each may touch, and a loop over their projected points.

use crate::buffer_map::BufferMap;
use crate::cloud::Cloud;
use crate::project::{BATCH, Band, Projected};
use pulp::Arch;

/// A block in this frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockView {
    rows: [f32; 12],
    start: usize,
    end: usize,
    /// First row that its points may fall into, and the first below it.
    pub(crate) top: usize,
    pub(crate) bottom: usize,
    /// The same of columns.
    pub(crate) left: usize,
    pub(crate) right: usize,
    /// No point has a smaller depth.
    pub(crate) nearest: f32,
}

/// Projects the boxes of the visible blocks.
pub(crate) fn view_blocks(cloud: &Cloud, visible: &[u32], map: &BufferMap, views: &mut Vec<BlockView>) {
    views.clear();
    views.extend(visible.iter().map(|&i| {
        let block = &cloud.blocks[i as usize];
        let rows = map.rows(block.origin, block.unit);
        let half = block.half.to_array();
        let (left, right) = range(&rows, 0, half, map);
        let (top, bottom) = range(&rows, 4, half, map);
        let (start, end) = (block.points.start, block.points.end);
        BlockView { rows, start, end, top, bottom, left, right, nearest: nearest(&rows, half) }
    }));
}

/// A bound of the depths in a box.
fn nearest(rows: &[f32; 12], half: [f32; 3]) -> f32 {
    /// Each depth is a sum of four rounded terms.
    const ROUNDING: f32 = 8.0 * f32::EPSILON;
    let reach: f32 = (0..3).map(|axis| rows[8 + axis].abs() * half[axis]).sum();
    rows[11] - reach - (rows[11].abs() + reach) * ROUNDING
}

/// Columns (`axis` 0) or rows (4) of the buffer that a box may touch; all if a corner is at the eye or behind it.
fn range(rows: &[f32; 12], axis: usize, half: [f32; 3], map: &BufferMap) -> (usize, usize) {
    let size = if axis == 0 { map.width } else { map.height };
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for corner in 0..8 {
        let side = |axis: usize| if corner >> axis & 1 == 0 { -half[axis] } else { half[axis] };
        let row = |r: usize| rows[r] * side(0) + rows[r + 1] * side(1) + rows[r + 2] * side(2) + rows[r + 3];
        let depth = row(8) + map.reference as f32;
        let w = if map.is_perspective() { depth } else { 1.0 };
        if w <= 0.0 {
            return (0, size);
        }
        let y = row(axis) / w;
        (low, high) = (low.min(y), high.max(y));
    }
    // One row more than rounding can move a point by.
    ((low - 1.0).max(0.0) as usize, ((high + 2.0).max(0.0) as usize).min(size))
}

/// Calls `each` for the points in `band` of those `views` that are not `hidden`: number in the projected lanes, pixel in
/// the band, number in the cloud.
pub(crate) fn walk(
    cloud: &Cloud,
    views: &[BlockView],
    band: &Band,
    hidden: impl Fn(&BlockView) -> bool,
    mut each: impl FnMut(&Projected, usize, usize, usize),
) {
    let mut projected = Projected::new();
    let arch = Arch::new();
    let [x, y, z] = &cloud.offsets;
    let end_row = band.first_row + band.rows;
    let meets = |v: &&BlockView| v.top < end_row && v.bottom > band.first_row;
    for view in views.iter().filter(meets).filter(|v| !hidden(v)) {
        for start in (view.start..view.end).step_by(BATCH) {
            let lanes = start..(start + BATCH).min(view.end);
            let points = [&x[lanes.clone()], &y[lanes.clone()], &z[lanes]];
            projected.transform(arch, &view.rows, points, band);
            for k in projected.kept() {
                each(&projected, k, projected.pixel(k, band), start + k);
            }
        }
    }
}
