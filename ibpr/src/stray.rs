//! Normals that stand out from those around them.
//!
//! At the rim of a body and along creases a window holds a few averages only, some of them of points that belong to what is behind or were
//! measured at a slant: single pixels then face anywhere. The eye sees them as bright grains.

use crate::buffer::{Buffer, Corner, DepthScale, STEP};
use crate::parallel::*;
use glam::Vec3;
use std::ops::Range;

/// Rows per task.
const BAND_ROWS: usize = 16;

/// Cosine of the angle to the mean of its neighbours beyond which a normal is a stray.
const MOST_APART_COS: f32 = 0.9;

/// Fewest neighbours of the same surface that can overrule a normal.
const LEAST_NEIGHBOURS: usize = 4;

/// Replaces stray normals in these rows by the mean of those of the same surface around them. `strays` is working memory.
pub(crate) fn replace(
    buffer: &mut Buffer,
    scale: &DepthScale,
    wanted: &Range<usize>,
    strays: &mut Vec<Vec<(usize, Vec3)>>,
) {
    let bands = wanted.start / BAND_ROWS..wanted.end.min(buffer.height).div_ceil(BAND_ROWS);
    strays.resize_with(bands.len().max(strays.len()), Vec::new);
    let shared = &*buffer;
    chunks(&mut strays[..bands.len()], 1).enumerate().for_each(|(i, found)| {
        let found = &mut found[0];
        found.clear();
        let first = (bands.start + i) * BAND_ROWS;
        for row in first..(first + BAND_ROWS).min(shared.height) {
            let start = shared.at(0, row);
            let strays =
                (start..start + shared.width).filter_map(|at| Some((at, mean_if_stray(shared, at, scale)?)));
            found.extend(strays);
        }
    });
    for &(at, normal) in strays[..bands.len()].iter().flatten() {
        buffer.corners[at].surface[1..].copy_from_slice(&normal.to_array());
    }
}

fn normal(corner: &Corner) -> Vec3 {
    Vec3::from_slice(&corner.surface[1..])
}

/// The mean of the normals around, if that of this pixel is far from it.
fn mean_if_stray(buffer: &Buffer, at: usize, scale: &DepthScale) -> Option<Vec3> {
    let corner = &buffer.corners[at];
    if !corner.is_some() {
        return None;
    }
    let own = normal(corner);
    let s = buffer.pitch;
    let is_apart = |i: usize| normal(&buffer.corners[i]).dot(own) < MOST_APART_COS;
    // Nearly all pixels end here.
    if !is_apart(at - 1) && !is_apart(at + 1) && !is_apart(at - s) && !is_apart(at + s) {
        return None;
    }
    let step = scale.bent_step(corner.surface[0], STEP);
    let around = [at - s - 1, at - s, at - s + 1, at - 1, at + 1, at + s - 1, at + s, at + s + 1];
    let (mut sum, mut count) = (Vec3::ZERO, 0);
    for other in around
        .into_iter()
        .map(|i| &buffer.corners[i])
        .filter(|c| (c.surface[0] - corner.surface[0]).abs() < step)
    {
        sum += normal(other);
        count += 1;
    }
    let mean = sum.try_normalize().filter(|_| count >= LEAST_NEIGHBOURS)?;
    (mean.dot(own) < MOST_APART_COS).then_some(mean)
}
