//! Pixels through which the background shows between two surfaces, one of which ends before the other.
//!
//! The outline of what is in front covers such a pixel in part. What is behind it ends where its own points are hidden, up to
//! a pixel too early.

use crate::frame::Frame;
use crate::wanted::Wanted;

/// Opacity of what counts as opaque: two shares of a pixel add up to 1 but for rounding.
const OPAQUE: f32 = 0.9999;

/// Columns and rows to four neighbours; the others are opposite to these.
const DIRECTIONS: [[isize; 2]; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];

/// Lets what is behind show through pixels between opaque ones. `rims` are the pixels that something covers in part, with
/// nothing behind it.
pub(crate) fn close(frame: &mut Frame, rims: impl Iterator<Item = usize>, wanted: &Wanted) {
    let width = frame.width;
    let is_wanted = |i: &usize| wanted.columns.contains(&(i % width)) && wanted.rows.contains(&(i / width));
    // All are found before one is changed, so that their order does not count.
    let seams: Vec<(usize, usize)> =
        rims.filter(is_wanted).filter_map(|i| Some((i, behind(frame, i)?))).collect();
    for (seam, behind) in seams {
        let share = 1.0 - frame.color[seam][3];
        let color = frame.color[behind];
        for (sum, c) in frame.color[seam].iter_mut().zip(color) {
            *sum += share * c;
        }
        frame.color[seam][3] = 1.0;
        if frame.depth[seam] == f32::INFINITY {
            frame.depth[seam] = frame.depth[behind];
            if !frame.normal.is_empty() {
                frame.normal[seam] = frame.normal[behind];
                frame.count[seam] = frame.count[behind];
            }
        }
    }
}

/// The farthest of the neighbours of a pixel that are opaque and have an opaque one across from them.
fn behind(frame: &Frame, i: usize) -> Option<usize> {
    let (column, row) = (i % frame.width, i / frame.width);
    let at = |[x, y]: [isize; 2]| {
        let (column, row) = (column.checked_add_signed(x)?, row.checked_add_signed(y)?);
        let is_inside = column < frame.width && row < frame.height;
        is_inside.then(|| row * frame.width + column).filter(|&i| frame.color[i][3] >= OPAQUE)
    };
    let pairs = DIRECTIONS.into_iter().filter_map(|[x, y]| Some([at([x, y])?, at([-x, -y])?]));
    pairs.flatten().max_by(|&a, &b| frame.depth[a].total_cmp(&frame.depth[b]).then(b.cmp(&a)))
}
