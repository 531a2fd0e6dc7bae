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
    top: usize,
    bottom: usize,
}

/// Projects the boxes of the visible blocks.
pub(crate) fn view_blocks(cloud: &Cloud, visible: &[u32], map: &BufferMap, views: &mut Vec<BlockView>) {
    views.clear();
    views.extend(visible.iter().map(|&i| {
        let block = &cloud.blocks[i as usize];
        let rows = map.rows(block.origin, block.unit);
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
    // One row more than rounding can move a point by.
    ((low - 1.0).max(0.0) as usize, ((high + 2.0).max(0.0) as usize).min(map.height))
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
