//! Rows of texels times tables: the inner loop of every projection.

/// Texels per step. Each sum is kept in this many partial sums on every processor, so that results agree bit for bit.
pub(crate) const LANES: usize = 8;

/// Number of partial sums that are stored for each sum. Adding up the lanes of each row would take as long as the row
/// itself, and would make the compiler vectorise across sums instead of along the row.
pub(crate) const PARTS: usize = LANES / 2;

/// A sum, as partial sums that are still to be added.
pub(crate) type Parts = [f64; PARTS];

/// The total of the partial sums.
pub(crate) fn total([a, b, c, d]: Parts) -> f64 {
    (a + c) + (b + d)
}

/// Sums that are computed together: as many as fit into registers.
const GROUP: usize = 5;

/// Factors of the texels of a row, for several sums. In groups of [`GROUP`] sums; within one, [`LANES`] factors of
/// each sum in turn.
pub(crate) struct Tables {
    sums: usize,
    /// Of a row, up to a multiple of [`LANES`]: factors of texels beyond the end are 0.
    width: usize,
    values: Vec<f64>,
}

impl Tables {
    /// For rows of `width` texels; all 0.
    pub(crate) fn new(sums: usize, width: usize) -> Self {
        let width = width.next_multiple_of(LANES);
        Self { sums, width, values: vec![0.0; sums * width] }
    }

    /// Sets the factors of sum k to `f(k, x)`, for x in a run of [`LANES`] texels, which `f` fills.
    #[inline(always)]
    pub(crate) fn fill(&mut self, mut f: impl FnMut(usize, usize, &mut [f64; LANES])) {
        let mut rest = self.values.as_mut_slice();
        for first in (0..self.sums).step_by(GROUP) {
            let group = GROUP.min(self.sums - first);
            let (own, others) = rest.split_at_mut(group * self.width);
            for (i, run) in own.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
                f(first + i % group, i / group * LANES, run);
            }
            rest = others;
        }
    }

    /// Σ factor·texel, for each of the sums.
    #[inline(always)]
    pub(crate) fn sums(&self, row: &[f32], out: &mut [Parts]) {
        let mut rest = self.values.as_slice();
        for out in out[..self.sums].chunks_mut(GROUP) {
            let (own, others) = rest.split_at(out.len() * self.width);
            match out.len() {
                1 => out.copy_from_slice(&group_sums::<1>(row, own)),
                2 => out.copy_from_slice(&group_sums::<2>(row, own)),
                3 => out.copy_from_slice(&group_sums::<3>(row, own)),
                4 => out.copy_from_slice(&group_sums::<4>(row, own)),
                _ => out.copy_from_slice(&group_sums::<GROUP>(row, own)),
            }
            rest = others;
        }
    }
}

/// Multiplied and added apart, not fused, so that all processors agree.
#[inline(always)]
fn group_sums<const K: usize>(row: &[f32], factors: &[f64]) -> [Parts; K] {
    let mut sums = [[0.0; LANES]; K];
    let (runs, rest) = row.as_chunks::<LANES>();
    let (factors, _) = factors.as_chunks::<LANES>();
    let (factors, _) = factors.as_chunks::<K>();
    for (texels, factors) in runs.iter().zip(factors) {
        add_run(&mut sums, texels, factors);
    }
    if !rest.is_empty() {
        let mut texels = [0.0; LANES];
        texels[..rest.len()].copy_from_slice(rest);
        add_run(&mut sums, &texels, &factors[runs.len()]);
    }
    sums.map(|[a, b, c, d, e, f, g, h]| [a + e, b + f, c + g, d + h])
}

#[inline(always)]
fn add_run<const K: usize>(sums: &mut [[f64; LANES]; K], texels: &[f32; LANES], factors: &[[f64; LANES]; K]) {
    let texels = texels.map(f64::from);
    for (sums, factors) in sums.iter_mut().zip(factors) {
        for lane in 0..LANES {
            sums[lane] += texels[lane] * factors[lane];
        }
    }
}
