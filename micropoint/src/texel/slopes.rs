//! Sums along rows of the slopes of a height map, from its heights.
//!
//! A slope is the difference of the two neighbours, so that along u the sums over a row are differences of heights, and along v they are
//! differences of the sums of heights over the rows above and below. Nothing but these is stored, and all of it is exact.

use super::corner::TexelWrap;
use super::rows::RowSums;
use std::sync::Arc;

/// Columns from one stored sum of heights to the next, as for other 8-bit texels.
const BLOCK: usize = 4;

/// A height map of 8-bit heights.
#[derive(Clone, Debug)]
pub(super) struct Slopes {
    heights: Arc<Vec<[u8; 1]>>,
    width: usize,
    height: usize,
    wrap: TexelWrap,
    /// Sums of the heights of a row before every fourth column.
    sums: Vec<u32>,
    /// What a difference of one step counts along u and along v.
    scale: [f64; 2],
}

impl Slopes {
    pub(super) fn new(heights: Arc<Vec<[u8; 1]>>, width: usize, height: usize, wrap: TexelWrap) -> Self {
        let mut sums = Vec::with_capacity(height * (width / BLOCK + 1));
        for row in heights.chunks_exact(width) {
            let mut sum = 0;
            for block in row.chunks(BLOCK) {
                sums.push(sum);
                sum += block.iter().map(|&[height]| u32::from(height)).sum::<u32>();
            }
            if width.is_multiple_of(BLOCK) {
                sums.push(sum);
            }
        }
        let scale = [0.5 * width as f64, 0.5 * height as f64];
        Self { heights, width, height, wrap, sums, scale }
    }

    /// Smallest and largest slope along u and v.
    pub(super) fn range(&self) -> [(f64, f64); 2] {
        let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 2];
        for (row, column) in (0..self.height).flat_map(|row| (0..self.width).map(move |x| (row, x))) {
            for ((least, most), v) in range.iter_mut().zip(self.texel::<2>(row, column)) {
                (*least, *most) = (least.min(v), most.max(v));
            }
        }
        range
    }

    #[inline]
    fn row(&self, row: usize) -> &[[u8; 1]] {
        &self.heights[row * self.width..][..self.width]
    }

    /// The height in a column from −1 to the width; the texture repeats, or its border does (a mirrored texture has it twice).
    #[inline]
    fn at(&self, row: &[[u8; 1]], column: isize) -> i32 {
        // Column −1 is beyond every length, too.
        let [height] = row.get(column as usize).copied().unwrap_or_else(|| {
            let from_left = (column < 0) != (self.wrap == TexelWrap::Repeat);
            row[if from_left { 0 } else { row.len() - 1 }]
        });
        i32::from(height)
    }

    /// Rows above and below, likewise.
    #[inline]
    fn neighbours(&self, row: usize) -> (usize, usize) {
        let last = self.height - 1;
        let repeats = self.wrap == TexelWrap::Repeat;
        let above = if row > 0 {
            row - 1
        } else if repeats {
            last
        } else {
            0
        };
        let below = if row < last {
            row + 1
        } else if repeats {
            0
        } else {
            last
        };
        (above, below)
    }

    #[inline]
    fn in_channels<const N: usize>(&self, u: i32, v: i32) -> [f64; N] {
        // Slopes have two channels: sums with others are never made of them.
        let scaled = |c: usize| self.scale[c] * f64::from(if c == 0 { u } else { v });
        std::array::from_fn(|c| scaled(c.min(1)))
    }

    #[inline]
    fn texel<const N: usize>(&self, row: usize, column: usize) -> [f64; N] {
        let (above, below) = self.neighbours(row);
        let v = i32::from(self.row(above)[column][0]) - i32::from(self.row(below)[column][0]);
        let (row, column) = (self.row(row), column as isize);
        self.in_channels(self.at(row, column + 1) - self.at(row, column - 1), v)
    }
}

impl<const N: usize> RowSums<N> for Slopes {
    #[inline]
    fn before(&self, row: usize, column: usize) -> [f64; N] {
        let stride = self.width / BLOCK + 1;
        let (above, below) = self.neighbours(row);
        let block = |row: usize| self.sums[row * stride + column / BLOCK] as i32;
        let first = column - column % BLOCK;
        let pairs = self.row(above)[first..column].iter().zip(&self.row(below)[first..column]);
        let rest: i32 = pairs.map(|([a], [b])| i32::from(*a) - i32::from(*b)).sum();
        let v = block(above) - block(below) + rest;
        let (row, column) = (self.row(row), column as isize);
        let u = self.at(row, column) + self.at(row, column - 1) - self.at(row, 0) - self.at(row, -1);
        self.in_channels(u, v)
    }

    #[inline]
    fn around(&self, row: usize, column: usize) -> ([f64; N], [f64; N]) {
        (self.before(row, column), self.texel(row, column))
    }
}
