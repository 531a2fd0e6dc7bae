//! How wide the windows of normals must be for the noise of the points.

use crate::border::PAD;
use crate::buffer::{Buffer, DepthScale};
use crate::fit::{Chunk, LANES};
use pulp::Arch;

/// Largest window by default; one more must fit into the border of the buffer.
const WIDEST: usize = PAD - 1;

/// Windows grow until the noise turns normals by less than this. Found by experiment on the bunny with
/// noise of 0 to 1 spacings (`studies -- ibpr`): larger windows lose more detail than they win.
const MOST_ERROR_RAD: f32 = 0.035;

/// The smallest window that the noise of this frame allows.
///
/// The noise is the median distance of averaged points from the surfaces fitted to 3×3 of them, over
/// every eighth row.
pub(crate) fn radius_for_noise(
    b: &Buffer,
    scale: &DepthScale,
    arch: Arch,
    histogram: &mut Histogram,
) -> usize {
    const EVERY: usize = 8;
    // 9 values and 6 unknowns: what remains is 3/9 of the variance.
    const LEFT_OVER: f32 = 3.0 / 9.0;
    histogram.clear();
    for row in (0..b.height).step_by(EVERY) {
        let start = b.at(0, row);
        for first in (start..start + b.width).step_by(LANES) {
            if b.count[first..first + LANES].iter().all(|c| *c == 0.0) {
                continue;
            }
            let fits = arch.dispatch(Chunk::<true> { b, first, scale, radius: 1 });
            for (k, fit) in fits.iter().enumerate().filter(|(_, f)| f.good) {
                let pixel = scale.footprint * (1.0 - scale.bend * b.q[first + k]);
                histogram.add((fit.residual / LEFT_OVER).sqrt() / pixel);
            }
        }
    }
    let slope_noise = histogram.median();
    // Sum of x² over the window: the variance of a slope is that of a value divided by it.
    let spread = |r: usize| {
        let side = (2 * r + 1) as f32;
        side * side * ((r * (r + 1)) as f32 / 3.0)
    };
    (1..WIDEST).find(|r| slope_noise / spread(*r).sqrt() <= MOST_ERROR_RAD).unwrap_or(WIDEST)
}

/// Counts of values on a logarithmic scale: a median that does not depend on order.
#[derive(Debug, Default)]
pub(crate) struct Histogram {
    bins: Vec<u32>,
}

impl Histogram {
    /// Eight steps to the power of 2, from 2⁻²⁰ on.
    const STEPS: f32 = 8.0;
    const LOWEST: f32 = -20.0;
    const BINS: usize = 256;

    fn clear(&mut self) {
        self.bins.clear();
        self.bins.resize(Self::BINS, 0);
    }

    fn add(&mut self, value: f32) {
        // `as` takes NaN and everything below the scale to the first bin.
        let bin = ((value.log2() - Self::LOWEST) * Self::STEPS) as usize;
        self.bins[bin.min(Self::BINS - 1)] += 1;
    }

    /// Upper end of the median's bin; 0 without values.
    fn median(&self) -> f32 {
        let half = self.bins.iter().sum::<u32>() / 2;
        let mut seen = 0;
        let bin = self.bins.iter().position(|n| {
            seen += n;
            seen > half
        });
        bin.map_or(0.0, |b| ((b + 1) as f32 / Self::STEPS + Self::LOWEST).exp2())
    }
}
