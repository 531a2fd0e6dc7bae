//! Eye-dome lighting: pixels behind their surroundings darken.
//!
//! C. Boucheny, *Visualisation scientifique interactive de grands volumes de données*, 2009, §4.4:
//! shade = exp(−300 · strength · mean over neighbours of max(0, log₂ z − log₂ zₙ)).

use crate::frame::Frame;
use crate::options::EyeDome;
use crate::parallel::*;
use crate::wanted::Wanted;

/// Factor in the exponent of the formula above: with it, a usual strength is 1.
const GAIN: f32 = 300.0;

/// Bound on the difference of log₂ z: larger than for any two depths above 0. Without it a depth of 0 would give 0 · ∞.
const MOST: f32 = 300.0;

/// Darkens the wanted colors of a frame, whose depth is known around them, too.
pub(crate) fn apply(frame: &mut Frame, dome: &EyeDome, wanted: &Wanted) {
    let (width, height) = (frame.width, frame.height);
    let depth = &frame.depth;
    let r = dome.radius as isize;
    let around = [(r, 0), (r, r), (0, r), (-r, r), (-r, 0), (-r, -r), (0, -r), (r, -r)];
    chunks(&mut frame.color, width).enumerate().for_each(|(y, row)| {
        if !wanted.rows.contains(&y) {
            return;
        }
        for (x, pixel) in row.iter_mut().enumerate().take(wanted.columns.end).skip(wanted.columns.start) {
            let here = depth[y * width + x];
            if here == f32::INFINITY {
                continue;
            }
            let behind = |(dx, dy): (isize, isize)| {
                let (i, j) = (x.checked_add_signed(dx)?, y.checked_add_signed(dy)?);
                let there = (i < width && j < height).then(|| depth[j * width + i])?;
                (there < here).then(|| (here / there).log2().min(MOST))
            };
            let sum: f32 = around.into_iter().filter_map(behind).sum();
            let shade = (-GAIN * (dome.strength * sum / 8.0)).exp();
            for c in &mut pixel[..3] {
                *c *= shade;
            }
        }
    });
}
