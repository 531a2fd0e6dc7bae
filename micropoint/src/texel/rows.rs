//! Sums along the rows of a texture, in fixed point, and how they are stored.

use std::sync::Arc;

/// Sums along rows: what a loop over the outline of a polygon reads. Integers of at most 32 bits, or half integers: `f64` holds them exactly.
pub(super) trait RowSums<const N: usize> {
    /// Sum of the texels before a column, `0..=width`.
    fn before(&self, row: usize, column: usize) -> [f64; N];

    /// The texel of a column, `0..width`.
    fn texel(&self, row: usize, column: usize) -> [f64; N];

    /// Both.
    #[inline]
    fn around(&self, row: usize, column: usize) -> ([f64; N], [f64; N]) {
        (self.before(row, column), self.texel(row, column))
    }
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
    fn texel(&self, row: usize, column: usize) -> [f64; N] {
        let at = row * self.stride + column;
        let [before, after] = [self.sums[at], self.sums[at + 1]].map(|sum| sum.map(Into::<f64>::into));
        std::array::from_fn(|c| after[c] - before[c])
    }
}

/// Columns from one stored sum of [`Blocks`] to the next. A lookup adds or takes away two texels on average, from the nearer of the two, and a
/// channel takes half a byte beside that of its texel, an eighth of what [`Whole`] takes.
const BLOCK: usize = 8;

/// How many units of the sums a stored texel is.
pub(super) trait Units<T> {
    fn of(&self, stored: T) -> u32;
}

/// A number for each byte.
impl Units<u8> for Box<[u32; 256]> {
    #[inline]
    fn of(&self, stored: u8) -> u32 {
        self[stored as usize]
    }
}

/// The texel is the number.
#[derive(Clone, Debug)]
pub(super) struct Same;

impl Units<u16> for Same {
    #[inline]
    fn of(&self, stored: u16) -> u32 {
        u32::from(stored)
    }
}

/// Texels as they are stored, what they stand for, and a sum before every eighth column and at the end.
#[derive(Clone, Debug)]
pub(super) struct Blocks<T, U, const N: usize> {
    width: usize,
    /// Stored sums of a row.
    stride: usize,
    sums: Vec<[u32; N]>,
    texels: Arc<Vec<[T; N]>>,
    units: U,
}

/// 8-bit texels, each a number by a table.
pub(super) type Bytes<const N: usize> = Blocks<u8, Box<[u32; 256]>, N>;

/// 16-bit texels.
pub(super) type Steps<const N: usize> = Blocks<u16, Same, N>;

impl<T: Copy, U: Units<T>, const N: usize> Blocks<T, U, N> {
    pub(super) fn new(width: usize, texels: Arc<Vec<[T; N]>>, units: U) -> Self {
        let stride = width.div_ceil(BLOCK) + 1;
        let mut sums = Vec::with_capacity(texels.len() / width * stride);
        for row in texels.chunks_exact(width) {
            let mut sum = [0; N];
            for block in row.chunks(BLOCK) {
                sums.push(sum);
                for texel in block {
                    sum.iter_mut().zip(texel).for_each(|(s, &stored)| *s += units.of(stored));
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
        if beyond <= BLOCK / 2 {
            let mut sum = self.sums[from];
            for texel in &self.texels[at - beyond..at] {
                (0..N).for_each(|c| sum[c] += self.units.of(texel[c]));
            }
            return sum;
        }
        let mut sum = self.sums[from + 1];
        let end = ((block + 1) * BLOCK).min(self.width);
        for texel in &self.texels[at..row * self.width + end] {
            (0..N).for_each(|c| sum[c] -= self.units.of(texel[c]));
        }
        sum
    }
}

impl<T: Copy, U: Units<T>, const N: usize> RowSums<N> for Blocks<T, U, N> {
    #[inline]
    fn before(&self, row: usize, column: usize) -> [f64; N] {
        self.sum(row, column).map(f64::from)
    }

    #[inline]
    fn texel(&self, row: usize, column: usize) -> [f64; N] {
        self.texels[row * self.width + column].map(|stored| f64::from(self.units.of(stored)))
    }
}
