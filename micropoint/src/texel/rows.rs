//! Sums along the rows of a texture, in fixed point, and how they are stored.

use std::sync::Arc;

/// Sums along rows: what a loop over the outline of a polygon reads. Integers of at most 32 bits, or half integers: `f64` holds them exactly.
pub(super) trait RowSums<const N: usize> {
    /// Sum of the texels before a column, `0..=width`.
    fn before(&self, row: usize, column: usize) -> [f64; N];

    /// The same and the texel of the column, `0..width`.
    fn around(&self, row: usize, column: usize) -> ([f64; N], [f64; N]);
}

/// A sum before every column.
#[derive(Clone, Debug)]
pub(super) struct Whole<S, const N: usize> {
    /// Entries of a row: one more than it has texels.
    pub(super) stride: usize,
    pub(super) sums: Vec<[S; N]>,
}

impl<S: Copy + Into<f64>, const N: usize> RowSums<N> for Whole<S, N> {
    #[inline]
    fn before(&self, row: usize, column: usize) -> [f64; N] {
        self.sums[row * self.stride + column].map(Into::into)
    }

    #[inline]
    fn around(&self, row: usize, column: usize) -> ([f64; N], [f64; N]) {
        let at = row * self.stride + column;
        let [before, after] = [self.sums[at], self.sums[at + 1]].map(|sum| sum.map(Into::<f64>::into));
        (before, std::array::from_fn(|c| after[c] - before[c]))
    }
}

/// Columns from one stored sum of [`Bytes`] to the next. A lookup adds or takes away two texels on average, from the nearer of the two, and a
/// channel takes half a byte beside that of its texel, an eighth of what [`Whole`] takes.
const BLOCK: usize = 8;

/// 8-bit texels as they are, what each byte stands for, and a sum before every eighth column and at the end.
#[derive(Clone, Debug)]
pub(super) struct Bytes<const N: usize> {
    width: usize,
    /// Stored sums of a row.
    stride: usize,
    sums: Vec<[u32; N]>,
    texels: Arc<Vec<[u8; N]>>,
    units: Box<[u32; 256]>,
}

impl<const N: usize> Bytes<N> {
    pub(super) fn new(width: usize, texels: Arc<Vec<[u8; N]>>, units: Box<[u32; 256]>) -> Self {
        let stride = width.div_ceil(BLOCK) + 1;
        let mut sums = Vec::with_capacity(texels.len() / width * stride);
        for row in texels.chunks_exact(width) {
            let mut sum = [0; N];
            for block in row.chunks(BLOCK) {
                sums.push(sum);
                for texel in block {
                    sum.iter_mut().zip(texel).for_each(|(s, &byte)| *s += units[byte as usize]);
                }
            }
            sums.push(sum);
        }
        Self { width, stride, sums, texels, units }
    }

    #[inline]
    fn sum(&self, row: usize, column: usize) -> [u32; N] {
        let (block, beyond) = (column / BLOCK, column % BLOCK);
        let at = row * self.width + column;
        let from = row * self.stride + block;
        let unit = |texel: &[u8; N], c: usize| self.units[texel[c] as usize];
        if beyond <= BLOCK / 2 {
            let mut sum = self.sums[from];
            for texel in &self.texels[at - beyond..at] {
                (0..N).for_each(|c| sum[c] += unit(texel, c));
            }
            return sum;
        }
        let mut sum = self.sums[from + 1];
        let end = ((block + 1) * BLOCK).min(self.width);
        for texel in &self.texels[at..row * self.width + end] {
            (0..N).for_each(|c| sum[c] -= unit(texel, c));
        }
        sum
    }
}

impl<const N: usize> RowSums<N> for Bytes<N> {
    #[inline]
    fn before(&self, row: usize, column: usize) -> [f64; N] {
        self.sum(row, column).map(f64::from)
    }

    #[inline]
    fn around(&self, row: usize, column: usize) -> ([f64; N], [f64; N]) {
        let texel = self.texels[row * self.width + column];
        (self.before(row, column), texel.map(|byte| f64::from(self.units[byte as usize])))
    }
}
