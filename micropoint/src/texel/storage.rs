//! The ways in which sums along rows are stored, and how they are computed.

use super::levels::Levels;
use super::rows::{Bytes, RowSums, Same, Steps, Whole};
use super::slopes::Slopes;
use std::sync::Arc;

/// The ways in which sums are stored.
#[derive(Clone, Debug)]
pub(super) enum Rows<const N: usize> {
    /// Of texels that are not negative.
    Unsigned(Whole<u32, N>),
    /// Of any texels.
    Signed(Whole<i32, N>),
    /// Of 8-bit texels.
    Bytes(Bytes<N>),
    /// Of texels in 16 bits.
    Steps(Steps<N>),
    /// Of 8-bit texels that count in even steps, for one channel.
    Levels(Levels),
    /// Of the slopes of 8-bit heights, for two channels.
    Slopes(Slopes),
}

/// `$call` with `$rows` as the [`RowSums`] that it holds.
macro_rules! with_rows {
    ($rows:expr, $name:ident => $call:expr) => {
        match $rows {
            $crate::texel::storage::Rows::Unsigned($name) => $call,
            $crate::texel::storage::Rows::Signed($name) => $call,
            $crate::texel::storage::Rows::Bytes($name) => $call,
            $crate::texel::storage::Rows::Steps($name) => $call,
            $crate::texel::storage::Rows::Levels($name) => $call,
            $crate::texel::storage::Rows::Slopes($name) => $call,
        }
    };
}
pub(super) use with_rows;

/// The unit in which texels from 0 to `most` add up to a row's sum below 2³², with half a unit of rounding for each.
fn unit_of(width: usize, most: f64) -> f64 {
    let steps = (f64::from(u32::MAX) - width as f64) / width as f64;
    if most > 0.0 { most / steps } else { 1.0 }
}

/// To the nearest: `f64::round` is a call on machines without an instruction for it.
fn in_units(value: f32, unit: f64) -> u32 {
    (f64::from(value) / unit + 0.5) as u32
}

/// Sums as `row_sums` gives them row by row, and the unit they are in: each is right to 2⁻³² of the largest.
fn signed_whole<const N: usize>(
    rows: usize,
    stride: usize,
    row_sums: impl Fn(usize, &mut [[f64; N]]),
) -> (Rows<N>, f64) {
    let mut row = vec![[0.0; N]; stride];
    let mut most = 0.0_f64;
    for y in 0..rows {
        row_sums(y, &mut row);
        most = row.iter().flatten().fold(most, |most, s| most.max(s.abs()));
    }
    let unit = if most > 0.0 { most / f64::from(i32::MAX) } else { 1.0 };
    let mut sums = Vec::with_capacity(rows * stride);
    for y in 0..rows {
        row_sums(y, &mut row);
        // To the nearest, and away from 0 from the middle on.
        sums.extend(row.iter().map(|sum| sum.map(|s| (s / unit + 0.5_f64.copysign(s)) as i32)));
    }
    (Rows::Signed(Whole { stride, sums }), unit)
}

impl<const N: usize> Rows<N> {
    /// Sums of texels from 0 to `most`, row by row, and the unit they are in.
    pub(super) fn unsigned(
        width: usize,
        height: usize,
        mut texels: impl Iterator<Item = [f32; N]>,
        most: f64,
    ) -> (Self, f64) {
        let unit = unit_of(width, most);
        let mut sums = Vec::with_capacity((width + 1) * height);
        for _ in 0..height {
            let mut sum = [0; N];
            sums.push(sum);
            for texel in texels.by_ref().take(width) {
                sum.iter_mut().zip(texel).for_each(|(s, v)| *s += in_units(v, unit));
                sums.push(sum);
            }
        }
        (Self::Unsigned(Whole { stride: width + 1, sums }), unit)
    }

    /// Sums of texels that are finite, and the unit they are in.
    pub(super) fn signed(width: usize, texels: &[[f32; N]]) -> (Self, f64) {
        let stride = width + 1;
        signed_whole(texels.len() / width, stride, |row, sums| {
            sums[0] = [0.0; N];
            for (x, texel) in texels[row * width..][..width].iter().enumerate() {
                sums[x + 1] = std::array::from_fn(|c| sums[x][c] + f64::from(texel[c]));
            }
        })
    }

    /// Sums of 8-bit texels that stand for `values`, which are finite and not negative, and the unit they are in.
    pub(super) fn bytes(
        width: usize,
        texels: Arc<Vec<[u8; N]>>,
        values: &[f32; 256],
        most: f64,
    ) -> (Self, f64) {
        let unit = unit_of(width, most);
        // Values of bytes that do not occur may be beyond `most`.
        let units = Box::new(values.map(|v| in_units(v.min(most as f32), unit)));
        (Self::Bytes(Bytes::new(width, texels, units)), unit)
    }

    /// Sums in 16 bits a texel of texels from 0 to `most`, row by row, and the unit they are in.
    pub(super) fn steps(
        width: usize,
        height: usize,
        mut texels: impl Iterator<Item = [f32; N]>,
        most: f64,
    ) -> (Self, f64) {
        let next_row = |_, sums: &mut [[f64; N]]| {
            sums[0] = [0.0; N];
            for (x, texel) in texels.by_ref().take(width).enumerate() {
                sums[x + 1] = std::array::from_fn(|c| sums[x][c] + f64::from(texel[c]));
            }
        };
        steps_of_sums(width, height, most, next_row)
    }

    /// Bands of rows, each the mean of `rows` of them (fewer in the last), and the unit they are in if these are in `unit` and up to `most`.
    pub(super) fn bands(
        &self,
        width: usize,
        height: usize,
        rows: usize,
        unit: f64,
        most: f64,
    ) -> (Self, f64) {
        self.taken_together(width, height.div_ceil(rows), unit, most, |band, sums| {
            let taken = band * rows..((band + 1) * rows).min(height);
            let share = 1.0 / taken.len() as f64;
            sums.fill([0.0; N]);
            for y in taken {
                with_rows!(self, all => for (x, sum) in sums.iter_mut().enumerate() {
                    let before: [f64; N] = all.before(y, x);
                    sum.iter_mut().zip(before).for_each(|(s, v)| *s += share * v);
                });
            }
        })
    }

    /// The sums of a texture with half as many texels on a side, each the mean of four, and the unit they are in if these are in `unit` and up to
    /// `most`.
    pub(super) fn means_of_four(&self, width: usize, height: usize, unit: f64, most: f64) -> (Self, f64) {
        self.taken_together(width / 2, height / 2, unit, most, |y, sums| {
            with_rows!(self, all => for (x, sum) in sums.iter_mut().enumerate() {
                let pair: [[f64; N]; 2] = [all.before(2 * y, 2 * x), all.before(2 * y + 1, 2 * x)];
                *sum = std::array::from_fn(|c| 0.25 * (pair[0][c] + pair[1][c]));
            });
        })
    }

    /// Rows of which `row_sums` gives the sums in `unit`, stored as suits these, and the unit they are in then. 8-bit texels need
    /// no more than 16 bits where they are taken together.
    fn taken_together(
        &self,
        width: usize,
        height: usize,
        unit: f64,
        most: f64,
        row_sums: impl Fn(usize, &mut [[f64; N]]),
    ) -> (Self, f64) {
        let scaled = |y: usize, sums: &mut [[f64; N]]| {
            row_sums(y, sums);
            sums.iter_mut().flatten().for_each(|s| *s *= unit);
        };
        match self {
            Self::Unsigned(_) => {
                let mut row = vec![[0.0; N]; width + 1];
                let mut sums = Vec::with_capacity((width + 1) * height);
                for y in 0..height {
                    row_sums(y, &mut row);
                    sums.extend(row.iter().map(|sum| sum.map(|s| (s + 0.5) as u32)));
                }
                (Self::Unsigned(Whole { stride: width + 1, sums }), unit)
            }
            Self::Bytes(_) | Self::Levels(_) | Self::Steps(_) => steps_of_sums(width, height, most, scaled),
            Self::Signed(_) | Self::Slopes(_) => signed_whole(height, width + 1, scaled),
        }
    }
}

/// Texels from 0 to `most` in 16 bits, from the sums of rows, and the unit they are in. A sum is right to half a unit, however many texels are
/// before it, and a texel is the difference of two.
fn steps_of_sums<const N: usize>(
    width: usize,
    height: usize,
    most: f64,
    mut row_sums: impl FnMut(usize, &mut [[f64; N]]),
) -> (Rows<N>, f64) {
    // The sum of the widest row is below 2³².
    let steps = (u32::MAX as usize / width).min(u16::MAX as usize) as u32;
    let unit = if most > 0.0 { most / f64::from(steps) } else { 1.0 };
    let mut row = vec![[0.0; N]; width + 1];
    let mut texels = Vec::with_capacity(width * height);
    for y in 0..height {
        row_sums(y, &mut row);
        let in_units = |sum: &[f64; N]| sum.map(|s| (s / unit + 0.5) as u32);
        let mut before = in_units(&row[0]);
        texels.extend(row[1..].iter().map(|sum| {
            let sum = in_units(sum);
            let texel = std::array::from_fn(|c| sum[c].saturating_sub(before[c]).min(steps) as u16);
            before = sum;
            texel
        }));
    }
    (Rows::Steps(Steps::new(width, Arc::new(texels), Same)), unit)
}
