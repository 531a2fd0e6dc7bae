//! Sums along the rows of 8-bit texels of one channel, in steps of a byte: exact, in half a byte for each texel beside its own.

use super::rows::RowSums;
use std::sync::Arc;

/// Columns from one stored sum to the next: what is between them is added up at once, in a word.
const BLOCK: usize = u64::BITS as usize / 8;

/// Texels from 0 to 255 and a sum before every eighth column.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    texels: Arc<Vec<[u8; 1]>>,
    width: usize,
    /// Stored sums of a row.
    stride: usize,
    sums: Vec<u32>,
}

impl Levels {
    pub(super) fn new(texels: Arc<Vec<[u8; 1]>>, width: usize) -> Self {
        let stride = width / BLOCK + 1;
        let mut sums = Vec::with_capacity(texels.len() / width * stride);
        for row in texels.chunks_exact(width) {
            let mut sum = 0;
            for block in row.chunks(BLOCK) {
                sums.push(sum);
                sum += block.iter().map(|&[level]| u32::from(level)).sum::<u32>();
            }
            if width.is_multiple_of(BLOCK) {
                sums.push(sum);
            }
        }
        Self { texels, width, stride, sums }
    }

    /// The texels of a row.
    #[inline]
    pub(super) fn row(&self, row: usize) -> &[u8] {
        &self.texels.as_flattened()[row * self.width..][..self.width]
    }

    /// The texels of a block as a number, the first in its lowest byte; beyond the last texel there are others or zeros.
    #[inline]
    fn block(&self, first: usize) -> u64 {
        let texels = self.texels.as_flattened();
        if let Some(&block) = texels.get(first..).and_then(<[u8]>::first_chunk) {
            return u64::from_le_bytes(block);
        }
        let mut block = [0; BLOCK];
        let rest = &texels[first.min(texels.len())..];
        block[..rest.len()].copy_from_slice(rest);
        u64::from_le_bytes(block)
    }

    /// The sum before a column, `0..=width`, and the block from which its texel is.
    #[inline]
    fn sum_and_block(&self, row: usize, column: usize) -> (u32, u64) {
        let (at, bits) = (column / BLOCK, 8 * (column % BLOCK));
        let block = self.block(row * self.width + at * BLOCK);
        let before = block & !(u64::MAX << bits);
        // The bytes in pairs, and the sum of the four pairs in the uppermost of them.
        const ODD: u64 = 0x00ff_00ff_00ff_00ff;
        let pairs = (before & ODD) + (before >> 8 & ODD);
        let rest = pairs.wrapping_mul(0x0001_0001_0001_0001) >> 48;
        (self.sums[row * self.stride + at] + rest as u32, block >> bits)
    }

    /// The sum before a column, `0..=width`.
    #[inline]
    pub(super) fn sum(&self, row: usize, column: usize) -> u32 {
        self.sum_and_block(row, column).0
    }

    /// The smallest and the largest texel.
    pub(super) fn range(&self) -> (u8, u8) {
        let texels = self.texels.as_flattened().iter();
        texels.fold((u8::MAX, 0), |(least, most), &texel| (least.min(texel), most.max(texel)))
    }
}

impl<const N: usize> RowSums<N> for Levels {
    #[inline]
    fn before(&self, row: usize, column: usize) -> [f64; N] {
        [f64::from(self.sum(row, column)); N]
    }

    #[inline]
    fn texel(&self, row: usize, column: usize) -> [f64; N] {
        [f64::from(self.row(row)[column]); N]
    }

    #[inline]
    fn around(&self, row: usize, column: usize) -> ([f64; N], [f64; N]) {
        let (sum, block) = self.sum_and_block(row, column);
        ([f64::from(sum); N], [f64::from(block as u8); N])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_texels_before() {
        for width in 1..40 {
            let texel = |i: usize| [(i * i % 256) as u8];
            let levels = Levels::new(Arc::new((0..3 * width).map(texel).collect()), width);
            for row in 0..3 {
                let mut sum = 0.0;
                for column in 0..width {
                    let here = f64::from(levels.row(row)[column]);
                    assert_eq!(levels.around(row, column), ([sum], [here]), "{width} {row} {column}");
                    sum += here;
                }
                assert_eq!(levels.before(row, width), [sum]);
            }
        }
    }
}
