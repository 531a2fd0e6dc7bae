//! Masks: textures of opacity, most of whose texels are wholly open or wholly closed.

use super::TexelSums;
use super::corner::{TexelCorner, TexelWrap, is_usable};
use super::rows::RowSums;
use super::storage::with_rows;
use glam::DVec2;

/// A mask summed up for exact means, with a map of where it is the same throughout: over such a part, which is most of a leaf, no sums along
/// an outline are needed. The map takes half a byte for each texel.
#[derive(Clone, Debug)]
pub struct MaskSums {
    sums: TexelSums<1>,
    uniform: UniformBlocks,
}

impl MaskSums {
    /// A mask and the map of it.
    #[must_use]
    pub fn new(sums: TexelSums<1>) -> Self {
        let uniform = with_rows!(&sums.rows, rows => UniformBlocks::new(rows, sums.width, sums.height));
        Self { sums, uniform }
    }

    /// The mask.
    #[must_use]
    pub fn sums(&self) -> &TexelSums<1> {
        &self.sums
    }

    /// The mean over a convex polygon, as [`TexelSums::mean`]. Costs a few reads where all texels in its bounding rectangle are equal to
    /// the smallest or all to the largest of the mask.
    #[must_use]
    pub fn mean(&self, corners: &[TexelCorner]) -> f64 {
        self.uniform_mean(corners).unwrap_or_else(|| self.sums.mean(corners)[0])
    }

    /// The same as [`TexelSums::rough_mean`].
    #[must_use]
    pub fn rough_mean(&self, corners: &[TexelCorner]) -> f64 {
        self.uniform_mean(corners).unwrap_or_else(|| self.sums.rough_mean(corners)[0])
    }

    /// The mean over a convex polygon if all texels in its bounding rectangle are equal to the smallest or all to the largest of the mask.
    #[must_use]
    pub fn uniform_mean(&self, corners: &[TexelCorner]) -> Option<f64> {
        let [(least, most)] = self.sums.range;
        self.uniform_over(corners).map(|uniform| match uniform {
            Uniform::Least => least,
            Uniform::Most => most,
        })
    }

    fn uniform_over(&self, corners: &[TexelCorner]) -> Option<Uniform> {
        let size = DVec2::new(self.sums.width as f64, self.sums.height as f64);
        let bounds = |(l, h): (DVec2, DVec2), c: &TexelCorner| (l.min(c.texel), h.max(c.texel));
        let (low, high) = corners.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), bounds);
        // A NaN is not in the bounds.
        if !corners.iter().all(|c| is_usable(c.texel)) {
            return None;
        }
        let shift = match self.sums.wrap {
            TexelWrap::Repeat => (low / size).floor() * size,
            TexelWrap::Clamp | TexelWrap::Mirror => DVec2::ZERO,
        };
        let (low, high) = (low - shift, high - shift);
        let inside = low.cmpge(DVec2::ZERO).all() && high.cmplt(size).all();
        inside.then(|| self.uniform.over(low, high)).flatten()
    }
}

/// What all texels of a part are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Uniform {
    /// The smallest texel of the mask.
    Least,
    /// The largest.
    Most,
}

/// Texels on a side of a block.
const BLOCK: usize = 4;

/// Blocks of texels that are all alike, counted so that any rectangle of blocks is asked for at once (F. C. Crow: *Summed-area tables
/// for texture mapping*, SIGGRAPH 1984).
#[derive(Clone, Debug)]
struct UniformBlocks {
    /// Entries of a row: one more than there are blocks.
    stride: usize,
    /// How many blocks above and to the left hold the smallest texel only, and the largest only.
    counts: Vec<[u32; 2]>,
}

impl UniformBlocks {
    fn new(rows: &impl RowSums<1>, width: usize, height: usize) -> Self {
        let texel = |x: usize, y: usize| rows.texel(y, x)[0];
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| texel(x, y)));
        let range = texels.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), t| (l.min(t), m.max(t)));
        let (columns, lines) = (width.div_ceil(BLOCK), height.div_ceil(BLOCK));
        let stride = columns + 1;
        let mut counts = vec![[0; 2]; stride * (lines + 1)];
        for by in 0..lines {
            let mut in_line = [0; 2];
            for bx in 0..columns {
                let end = |block: usize, size: usize| ((block + 1) * BLOCK).min(size);
                let (columns, mut lines) = (bx * BLOCK..end(bx, width), by * BLOCK..end(by, height));
                let first = texel(columns.start, lines.start);
                let alike = lines.all(|y| columns.clone().all(|x| texel(x, y) == first));
                in_line[0] += u32::from(alike && first == range.0);
                in_line[1] += u32::from(alike && first == range.1);
                let above = counts[by * stride + bx + 1];
                counts[(by + 1) * stride + bx + 1] = [above[0] + in_line[0], above[1] + in_line[1]];
            }
        }
        Self { stride, counts }
    }

    /// What all texels are that a rectangle inside the mask touches, if they are alike.
    fn over(&self, low: DVec2, high: DVec2) -> Option<Uniform> {
        let first = [low.x as usize / BLOCK, low.y as usize / BLOCK];
        let end = [high.x as usize / BLOCK + 1, high.y as usize / BLOCK + 1];
        let at = |x: usize, y: usize| self.counts[y * self.stride + x];
        let corners =
            [at(end[0], end[1]), at(first[0], first[1]), at(first[0], end[1]), at(end[0], first[1])];
        let count = |k: usize| corners[0][k] + corners[1][k] - corners[2][k] - corners[3][k];
        let blocks = ((end[0] - first[0]) * (end[1] - first[1])) as u32;
        if count(0) == blocks {
            Some(Uniform::Least)
        } else if count(1) == blocks {
            Some(Uniform::Most)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    /// A disc of 1 in a mask of 0, with a rim between.
    fn disc(wrap: TexelWrap) -> MaskSums {
        let opacity = |x: u32, y: u32| {
            let d = dvec2(f64::from(x) - 18.5, f64::from(y) - 15.5).length();
            [(14.0 - d).clamp(0.0, 1.0) as f32]
        };
        MaskSums::new(TexelSums::new(37, 30, wrap, opacity).unwrap())
    }

    fn square(middle: DVec2, half: f64) -> Vec<TexelCorner> {
        let corners = [dvec2(-half, -half), dvec2(half, -half), dvec2(half, half), dvec2(-half, half)];
        let corner = |d| TexelCorner { grid: middle + d, rational: 1.0, texel: middle + d };
        corners.into_iter().map(corner).collect()
    }

    #[test]
    fn uniform_parts_are_found_and_are_what_the_sums_say() {
        for wrap in [TexelWrap::Repeat, TexelWrap::Clamp, TexelWrap::Mirror] {
            let mask = disc(wrap);
            let mut found = [0; 3];
            for i in 0..4000_u32 {
                let middle = dvec2(f64::from(i % 47) - 5.0, f64::from(i % 41) - 5.0) * 1.01;
                let polygon = square(middle, 0.3 + f64::from(i % 5));
                let expected = mask.sums().mean(&polygon)[0];
                let kind = mask.uniform_over(&polygon);
                found[kind.map_or(2, |u| u as usize)] += 1;
                assert!((mask.mean(&polygon) - expected).abs() < 1e-7, "{wrap:?} {middle}: {kind:?}");
            }
            assert!(found.iter().all(|&n| n > 100), "{wrap:?}: {found:?}");
        }
    }

    #[test]
    fn corners_that_are_not_finite_are_left_to_the_sums() {
        let mask = disc(TexelWrap::Repeat);
        let mut polygon = square(dvec2(2.0, 2.0), 0.5);
        polygon[1].texel.x = f64::NAN;
        assert_eq!(mask.uniform_over(&polygon), None);
        assert_eq!(mask.mean(&polygon), mask.sums().mean(&polygon)[0]);
    }
}
