//! Sums along rows of the slopes of a height map, from its heights.
//!
//! A slope is the difference of the two neighbours, so that along u the sums over a row are differences of heights, and along v they are
//! differences of the sums of heights over the rows above and below. Nothing but these is stored, and all of it is exact.

use super::corner::TexelWrap;
use super::levels::Levels;
use super::rows::RowSums;
use std::sync::Arc;

/// A height map of 8-bit heights.
#[derive(Clone, Debug)]
pub(super) struct Slopes {
    heights: Levels,
    width: usize,
    height: usize,
    wrap: TexelWrap,
    /// What a difference of one step counts along u and along v.
    scale: [f64; 2],
}

impl Slopes {
    pub(super) fn new(heights: Arc<Vec<[u8; 1]>>, width: usize, height: usize, wrap: TexelWrap) -> Self {
        let scale = [0.5 * width as f64, 0.5 * height as f64];
        Self { heights: Levels::new(heights, width), width, height, wrap, scale }
    }

    /// Smallest and largest slope along u and v.
    pub(super) fn range(&self) -> [(f64, f64); 2] {
        let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 2];
        for (row, column) in (0..self.height).flat_map(|row| (0..self.width).map(move |x| (row, x))) {
            let texel: [f64; 2] = self.texel(row, column);
            for ((least, most), v) in range.iter_mut().zip(texel) {
                (*least, *most) = (least.min(v), most.max(v));
            }
        }
        range
    }

    /// The height in a column from −1 to the width; the texture repeats, or its border does (a mirrored texture has it twice).
    #[inline]
    fn at(&self, row: &[u8], column: isize) -> i32 {
        // Column −1 is beyond every length, too.
        let height = row.get(column as usize).copied().unwrap_or_else(|| {
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
}

impl<const N: usize> RowSums<N> for Slopes {
    #[inline]
    fn before(&self, row: usize, column: usize) -> [f64; N] {
        let (above, below) = self.neighbours(row);
        let v = self.heights.sum(above, column) as i32 - self.heights.sum(below, column) as i32;
        let (row, column) = (self.heights.row(row), column as isize);
        let u = self.at(row, column) + self.at(row, column - 1) - self.at(row, 0) - self.at(row, -1);
        self.in_channels(u, v)
    }

    #[inline]
    fn texel(&self, row: usize, column: usize) -> [f64; N] {
        let (above, below) = self.neighbours(row);
        let v = i32::from(self.heights.row(above)[column]) - i32::from(self.heights.row(below)[column]);
        let (row, column) = (self.heights.row(row), column as isize);
        self.in_channels(self.at(row, column + 1) - self.at(row, column - 1), v)
    }
}
