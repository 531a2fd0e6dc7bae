//! Textures without filters: the exact mean of nearest texels over a polygon.
//!
//! The paper dices a surface by its texel grid, so that every piece sees one texel (\[1\], §3.3). Shading
//! is linear in the albedo, so the mean over all those pieces is all that is needed of them; and
//! that is an integral over a polygon of texels, ∬ f = ∮ F dy with F the sums along rows. It
//! costs the texels on the outline, not those inside.
//!
//! # Accuracy
//! Errors are relative to the contrast: the difference between the largest and the smallest texel. A mean is off by at most 0.015, and
//! by 0.001 in the root mean square over outlines of 1 to 400 texels, up to 60 times as long as they are wide and with depths in a ratio of up to
//! 1.5, on textures of black and white noise, the worst that was found (`means_keep_the_stated_bound`). What falls short of exact, and the
//! constants that decide when it is done, all chosen to keep this bound:
//!
//! | where | constants |
//! | --- | --- |
//! | outlines of many texels: four texels count as one, or rows are taken together | [`Precision`], [`LEAST_WIDTH`], [`MOST_ROWS`] |
//! | depths in the ratio that counts as none, or as the same within a strip | [`Precision`], [`FEW_TEXELS`] |
//! | outlines that hold the texture several times, or lines longer than `MOST_ON_LINE` | [`MOST_TEXELS`] |

mod corner;
mod levels;
mod line;
mod mask;
mod perspective;
mod plane;
mod rows;
mod slopes;
mod storage;
#[cfg(test)]
mod tests;

pub use corner::{TexelCorner, TexelWrap};
pub use mask::MaskSums;

use crate::error::MicropointError;
use corner::is_usable;
use glam::DVec2;
use levels::Levels;
use plane::Plane;
use pointillist_dice::convex;
use slopes::Slopes;
use std::sync::{Arc, OnceLock};
use storage::{Rows, with_rows};

/// Sums along the rows of a texture with `N` channels, in 32-bit fixed point: differences are exact.
///
/// What is taken together for outlines of many texels is computed when it is first asked for.
#[derive(Clone, Debug)]
pub struct TexelSums<const N: usize> {
    width: usize,
    height: usize,
    wrap: TexelWrap,
    /// Value of one unit of the fixed point.
    unit: f64,
    /// Smallest and largest texel of each channel: no mean lies beyond them.
    range: [(f64, f64); N],
    /// Sums of each row.
    rows: Rows<N>,
    /// `bands[k]`: rows of sums, each the mean of 4ᵏ⁺¹ rows of texels (fewer in the last), and the unit they are in, for
    /// outlines that are too narrow to take columns together.
    bands: Vec<OnceLock<(Rows<N>, f64)>>,
    /// The same texture with half as many texels on a side, each the mean of four.
    coarser: OnceLock<Box<TexelSums<N>>>,
}

/// Rows that an outline may cross before rows are taken together: then an outline texel is wrong by
/// at most its difference from its three neighbours, and there are hundreds of rows.
const MOST_ROWS: f64 = 128.0;

/// What is taken together where many texels are seen.
#[derive(Clone, Copy)]
struct Precision {
    /// Texels that an outline may span before four are taken together: its border is wrong by a part of the contrast between
    /// neighbours, and what is inside stays exact.
    most_span: f64,
    /// Ratio of depths up to which few texels are weighted alike. Their weights go with the cube of the depth.
    alike: f64,
    /// The same of many texels, and within a strip of them.
    strip: f64,
    /// Most strips: time grows with them where a polygon reaches from close to the eye into the distance.
    most_strips: u32,
}

impl Precision {
    /// Borders are right to about a thousandth. Weights of few texels vary by 0.3 % from their mean, and the border of two texels would have
    /// to run right through the polygon for a quarter of that to show; in a strip they vary by 1.5 %: on a 512 × 512 checker at a grazing
    /// angle the RMS error is 9e-5 (2.5e-4 with 1.05, in 0.8 of the time).
    const FINE: Self = Self { most_span: 32.0, alike: 1.002, strip: 1.01, most_strips: 256 };

    /// Where many means add up, as those of the masks before a light do.
    const ROUGH: Self = Self { most_span: 8.0, alike: 1.03, strip: 1.03, most_strips: 8 };
}

/// Mean width, relative to the span at which four are taken together, below which an outline is all border and is followed texel by texel.
const LEAST_WIDTH: f64 = 0.25;

/// Texels up to which perspective is followed texel by texel.
const FEW_TEXELS: f64 = 48.0;

/// Extent in texels beyond which the mean of the whole texture is taken: a polygon of this size holds the texture several times, and time
/// grows with the rows that its outline crosses.
const MOST_TEXELS: f64 = (1 << 16) as f64;

/// Most texels on a side of a texture that is summed up.
pub const MOST_TEXELS_ON_A_SIDE: u32 = 1 << 20;

impl<const N: usize> TexelSums<N> {
    /// Sums up a texture; `texel(x, y)` gives values of at least 0, row 0 on top, and is asked for each twice.
    ///
    /// # Errors
    /// [`MicropointError::BadTexture`] if there are no texels; [`MicropointError::BadTexel`] for a
    /// value that is NaN, infinite or negative.
    pub fn new(
        width: u32,
        height: u32,
        wrap: TexelWrap,
        texel: impl Fn(u32, u32) -> [f32; N],
    ) -> Result<Self, MicropointError> {
        check_size(width, height)?;
        let largest = |texel: [f32; N]| texel.into_iter().fold(0.0, f32::max);
        let most = places(width, height).map(|(x, y)| largest(texel(x, y))).fold(0.0, f32::max);
        let most = most.min(f32::MAX);
        Self::bounded(most, [width, height], wrap, texel, |[width, height], texels| {
            Rows::unsigned(width, height, texels, f64::from(most))
        })
    }

    /// The same for a texture whose values are at most `most`, in 16 bits: sums and texels are right to a 65535th of that (wider than 65,537 texels:
    /// to `width` · 2⁻³²). Takes 2.5 bytes for a channel of a texel (4 otherwise), and each texel is asked for once.
    ///
    /// # Errors
    /// [`MicropointError::BadTexture`] if there are no texels; [`MicropointError::BadTexel`] for a value that is NaN, negative or above `most`.
    pub fn in_16_bits(
        most: f32,
        width: u32,
        height: u32,
        wrap: TexelWrap,
        texel: impl Fn(u32, u32) -> [f32; N],
    ) -> Result<Self, MicropointError> {
        check_size(width, height)?;
        Self::bounded(most, [width, height], wrap, texel, |[width, height], texels| {
            Rows::steps(width, height, texels, f64::from(most))
        })
    }

    /// What `sum_up` makes of texels from 0 to `most`, row by row.
    fn bounded(
        most: f32,
        [width, height]: [u32; 2],
        wrap: TexelWrap,
        texel: impl Fn(u32, u32) -> [f32; N],
        sum_up: impl FnOnce([usize; 2], &mut dyn Iterator<Item = [f32; N]>) -> (Rows<N>, f64),
    ) -> Result<Self, MicropointError> {
        let mut range = [(f32::INFINITY, 0.0); N];
        let mut bad = None;
        let sound = |(index, (x, y))| {
            let texel = texel(x, y);
            if !texel.iter().all(|v| (0.0..=most).contains(v)) {
                bad.get_or_insert(index);
                return [0.0; N];
            }
            widen(&mut range, &texel);
            texel
        };
        let (rows, unit) =
            sum_up([width as usize, height as usize], &mut places(width, height).enumerate().map(sound));
        match bad {
            Some(index) => Err(MicropointError::BadTexel { index }),
            None => {
                let range = range.map(|(least, most)| (f64::from(least), f64::from(most)));
                Ok(Self::of_rows(width as usize, height as usize, wrap, range, rows, unit))
            }
        }
    }

    /// The same for a texture whose values may be negative. Sums are right to 2⁻³¹ of the largest of them.
    ///
    /// # Errors
    /// [`MicropointError::BadTexture`] if there are no texels; [`MicropointError::BadTexel`] for a value that is NaN or infinite.
    pub fn new_signed(
        width: u32,
        height: u32,
        wrap: TexelWrap,
        texel: impl Fn(u32, u32) -> [f32; N],
    ) -> Result<Self, MicropointError> {
        check_size(width, height)?;
        let texels: Vec<_> = places(width, height).map(|(x, y)| texel(x, y)).collect();
        if let Some(index) = texels.iter().position(|texel| !texel.iter().all(|v| v.is_finite())) {
            return Err(MicropointError::BadTexel { index });
        }
        let mut range = [(f32::INFINITY, f32::NEG_INFINITY); N];
        texels.iter().for_each(|texel| widen(&mut range, texel));
        let range = range.map(|(least, most)| (f64::from(least), f64::from(most)));
        let (rows, unit) = Rows::signed(width as usize, &texels);
        Ok(Self::of_rows(width as usize, height as usize, wrap, range, rows, unit))
    }

    /// The same as [`TexelSums::new`] of 8-bit texels, row by row from the top, with a table of what each byte stands for, and the same
    /// means: bit by bit over few texels, to 16 bits where texels are taken together. Takes half a byte for a channel of a texel beside
    /// `texels`, which are shared (4 bytes otherwise).
    ///
    /// # Errors
    /// [`MicropointError::BadTexture`] if there are no texels or not `width · height`; [`MicropointError::BadTexel`] for the
    /// first texel whose value is NaN, infinite or negative.
    pub fn from_bytes(
        width: u32,
        height: u32,
        wrap: TexelWrap,
        texels: Arc<Vec<[u8; N]>>,
        values: &[f32; 256],
    ) -> Result<Self, MicropointError> {
        check_count(width, height, texels.len())?;
        let sound = |v: f32| v.is_finite() && v >= 0.0;
        let mut occurs = [[false; 256]; N];
        for (index, texel) in texels.iter().enumerate() {
            for (occurs, &byte) in occurs.iter_mut().zip(texel) {
                if !std::mem::replace(&mut occurs[byte as usize], true) && !sound(values[byte as usize]) {
                    return Err(MicropointError::BadTexel { index });
                }
            }
        }
        let range = occurs.map(|occurs| {
            let found = values.iter().zip(occurs).filter(|(_, occurs)| *occurs).map(|(&v, _)| f64::from(v));
            found.fold((f64::INFINITY, 0.0_f64), |(least, most), v| (least.min(v), most.max(v)))
        });
        let (rows, unit) = Rows::bytes(width as usize, texels, values, largest(&range));
        Ok(Self::of_rows(width as usize, height as usize, wrap, range, rows, unit))
    }

    fn of_rows(
        width: usize,
        height: usize,
        wrap: TexelWrap,
        range: [(f64, f64); N],
        rows: Rows<N>,
        unit: f64,
    ) -> Self {
        let levels = (1..).take_while(|&k| height > 16 && 4_usize.pow(k) < height).count();
        let bands = vec![OnceLock::new(); levels];
        Self { width, height, wrap, unit, range, rows, bands, coarser: OnceLock::new() }
    }

    /// Half as many texels on a side, if that is a whole number.
    fn coarser(&self) -> Option<&Self> {
        let (width, height) = (self.width, self.height);
        if !width.is_multiple_of(2) || !height.is_multiple_of(2) || width.min(height) < 8 {
            return None;
        }
        let make = || {
            let (rows, unit) = self.rows.means_of_four(width, height, self.unit, largest(&self.range));
            Box::new(Self::of_rows(width / 2, height / 2, self.wrap, self.range, rows, unit))
        };
        Some(self.coarser.get_or_init(make))
    }

    fn plane<'a, R>(&self, sums: &'a R, shift: u32) -> Plane<'a, R> {
        Plane { sums, width: self.width, height: self.height, wrap: self.wrap, shift }
    }

    /// Texels in a row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width as u32
    }

    /// Rows of texels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height as u32
    }

    /// The texel at integer coordinates, wrapped.
    #[must_use]
    pub fn texel(&self, x: f64, y: f64) -> [f64; N] {
        let texel = with_rows!(&self.rows, sums => self.plane(sums, 0).texel(x, y));
        self.within_range(texel.map(|t| t * self.unit))
    }

    /// Rounding of a mean over a tiny or narrow polygon is relative to the row sums, not to the mean: without this, means
    /// would be negative where a polygon sees nothing but black texels.
    fn within_range(&self, mean: [f64; N]) -> [f64; N] {
        std::array::from_fn(|c| mean[c].max(self.range[c].0).min(self.range[c].1))
    }

    /// The mean over a convex polygon, weighted by area in the grid.
    ///
    /// Exact up to rounding where the polygon sees few texels; elsewhere off by at most 0.015 of the contrast between the largest and the smallest texel, and by
    /// 0.001 in the root mean square: many texels on the outline are taken together, and a polygon of different depths is
    /// cut into strips of nearly equal depth. A polygon that is a line in the texture sees each texel by the area that sees it or,
    /// without area in the grid, by the length of the line in it. A texel is half open: a place on a border belongs to the
    /// texel on the right (growing u) and below (falling v), so that v = 1 is the top row. Never beyond the smallest and largest texel of a channel. Corners that are
    /// not finite give the texel at the origin.
    #[must_use]
    pub fn mean(&self, corners: &[TexelCorner]) -> [f64; N] {
        self.within_range(self.unbounded_mean(corners, &Precision::FINE))
    }

    /// The same in about half the time where many texels are seen, off by at most 0.1 of the contrast and by 0.009 in the root
    /// mean square, over the outlines and textures of the module's bound.
    #[must_use]
    pub fn rough_mean(&self, corners: &[TexelCorner]) -> [f64; N] {
        self.within_range(self.unbounded_mean(corners, &Precision::ROUGH))
    }

    fn unbounded_mean(&self, corners: &[TexelCorner], precision: &Precision) -> [f64; N] {
        let (low, high) = corners
            .iter()
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), c| (l.min(c.texel), h.max(c.texel)));
        if corners.is_empty() || !corners.iter().all(|c| is_usable(c.texel)) {
            return self.texel(0.0, 0.0);
        }
        let first = low.floor();
        if high.x <= first.x + 1.0 && high.y <= first.y + 1.0 {
            return self.texel(first.x, first.y);
        }
        if line::is_line(corners, high - low) {
            return self.mean_along_line(corners);
        }
        let texels = (high.ceil() - low.floor()).max(DVec2::ONE);
        let few = texels.x * texels.y <= FEW_TEXELS;
        let rationals = corners.iter().map(|c| c.rational);
        let (least, most) = rationals.fold((f64::INFINITY, 0.0_f64), |(l, h), q| (l.min(q), h.max(q)));
        let ratio = if least > 0.0 { most / least } else { f64::INFINITY };
        if few
            && ratio > precision.alike
            && least > 0.0
            && let Some(mean) = perspective::mean_by_texels(corners, |x, y| self.texel(x, y))
        {
            return mean;
        }
        if !few && ratio > precision.strip {
            let mean = |strip: &[TexelCorner]| self.mean_in_texels(strip, precision.most_span);
            return perspective::mean_by_strips(corners, (least.max(most * 1e-6), most), precision, mean);
        }
        self.mean_in_texels(corners, precision.most_span)
    }

    /// The mean of all texels.
    #[must_use]
    pub fn whole_mean(&self) -> [f64; N] {
        let mut sum = [0.0; N];
        with_rows!(&self.rows, sums => for row in 0..self.height {
            let total: [f64; N] = self.plane(sums, 0).row_sum(row, self.width as f64);
            sum.iter_mut().zip(total).for_each(|(s, t)| *s += t);
        });
        sum.map(|s| s * self.unit / (self.width * self.height) as f64)
    }

    fn mean_along_line(&self, corners: &[TexelCorner]) -> [f64; N] {
        line::mean_along_line(corners, |texel| self.texel(texel.x, texel.y))
    }

    /// The mean weighted by area in the texture: right where there is no perspective. Outlines that span more than `most_span` texels see four of them
    /// as one.
    fn mean_in_texels(&self, corners: &[TexelCorner], most_span: f64) -> [f64; N] {
        let mut ring = [DVec2::ZERO; convex::MAX_VERTICES];
        let len = corners.len().min(ring.len());
        // Whole periods are taken away so that sums stay small.
        let size = DVec2::new(self.width as f64, self.height as f64);
        let shift_by = |period: DVec2| (corners[0].texel / period).floor() * period;
        let shift = match self.wrap {
            TexelWrap::Clamp => DVec2::ZERO,
            TexelWrap::Repeat => shift_by(size),
            TexelWrap::Mirror => shift_by(2.0 * size),
        };
        for (to, c) in ring.iter_mut().zip(corners) {
            *to = c.texel - shift;
        }
        let ring = &mut ring[..len];
        let (low, high) = convex::bounds(ring);
        let area = convex::area(ring);
        let span = (high - low).max_element();
        // Not finite where a strip of a polygon reaches behind the eye.
        // Each corner is looked at: bounds do not always keep a NaN.
        let usable = ring.iter().all(|&v| is_usable(v));
        if !usable || span > MOST_TEXELS.max(4.0 * self.width.max(self.height) as f64) {
            let middle = 0.5 * (low + high);
            return match self.wrap {
                TexelWrap::Clamp if middle.is_finite() => self.texel(middle.x, middle.y),
                _ => self.whole_mean(),
            };
        }
        // A strip of a polygon may be a line where the whole is not.
        if line::is_line(corners, high - low) {
            return self.mean_along_line(corners);
        }
        self.mean_over_ring(ring, high - low, area, most_span)
    }

    /// The mean over a ring of this extent and area, which is overwritten.
    fn mean_over_ring(
        &self,
        ring: &mut [DVec2],
        mut extent: DVec2,
        mut area: f64,
        most_span: f64,
    ) -> [f64; N] {
        let mut sums = self;
        while extent.max_element() > most_span
            && area.abs() > LEAST_WIDTH * most_span * extent.max_element()
            && let Some(coarser) = sums.coarser()
        {
            ring.iter_mut().for_each(|v| *v *= 0.5);
            (extent, area) = (0.5 * extent, 0.25 * area);
            sums = coarser;
        }
        let mut level = 0;
        while level < sums.bands.len() && extent.y > MOST_ROWS * 4.0_f64.powi(level as i32) {
            level += 1;
        }
        sums.integral(level, ring).map(|s| s / area)
    }

    /// The integral over a ring, from sums of rows or, with a `level` beyond 0, of bands of 4 to this power.
    fn integral(&self, level: usize, ring: &[DVec2]) -> [f64; N] {
        let (rows, unit) = match level.checked_sub(1) {
            None => (&self.rows, self.unit),
            Some(band) => {
                let (rows, most) = (4_usize.pow(level as u32), largest(&self.range));
                let make = || self.rows.bands(self.width, self.height, rows, self.unit, most);
                let (rows, unit) = self.bands[band].get_or_init(make);
                (rows, *unit)
            }
        };
        with_rows!(rows, sums => self.plane(sums, 2 * level as u32).integral(ring)).map(|s| s * unit)
    }
}

impl TexelSums<1> {
    /// The sums of 8-bit texels, row by row from the top, of which 255 stands for 1. Exact over few texels, in 16 bits where
    /// texels are taken together; half a byte for each texel beside `texels`, which are shared.
    ///
    /// # Errors
    /// [`MicropointError::BadTexture`] if there are no texels or not `width · height`.
    pub fn of_levels(
        width: u32,
        height: u32,
        wrap: TexelWrap,
        texels: Arc<Vec<[u8; 1]>>,
    ) -> Result<Self, MicropointError> {
        check_count(width, height, texels.len())?;
        let levels = Levels::new(texels, width as usize);
        let unit = 1.0 / 255.0;
        let (least, most) = levels.range();
        let range = [(f64::from(least) * unit, f64::from(most) * unit)];
        Ok(Self::of_rows(width as usize, height as usize, wrap, range, Rows::Levels(levels), unit))
    }
}

impl TexelSums<2> {
    /// The slopes along u and v of an 8-bit height map, row by row from the top, per unit of u and of v (v upward): differences of
    /// the two neighbours. A byte of 255 is the height 1. Exact, of the heights alone and half a byte for each.
    ///
    /// # Errors
    /// [`MicropointError::BadTexture`] if there are no texels or not `width · height`.
    pub fn slopes_of_bytes(
        width: u32,
        height: u32,
        wrap: TexelWrap,
        heights: Arc<Vec<[u8; 1]>>,
    ) -> Result<Self, MicropointError> {
        check_count(width, height, heights.len())?;
        let (width, height) = (width as usize, height as usize);
        let slopes = Slopes::new(heights, width, height, wrap);
        let unit = 1.0 / 255.0;
        let range = slopes.range().map(|(least, most)| (least * unit, most * unit));
        Ok(Self::of_rows(width, height, wrap, range, Rows::Slopes(slopes), unit))
    }
}

fn check_size(width: u32, height: u32) -> Result<(), MicropointError> {
    if width == 0 || height == 0 || width.max(height) > MOST_TEXELS_ON_A_SIDE {
        return Err(MicropointError::BadTexture { width, height, texels: 0 });
    }
    Ok(())
}

fn check_count(width: u32, height: u32, texels: usize) -> Result<(), MicropointError> {
    check_size(width, height)?;
    if texels as u64 != u64::from(width) * u64::from(height) {
        return Err(MicropointError::BadTexture { width, height, texels });
    }
    Ok(())
}

/// Columns and rows of all texels, row by row.
fn places(width: u32, height: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// Widens the smallest and the largest value of each channel to those of a texel.
fn widen<const N: usize>(range: &mut [(f32, f32); N], texel: &[f32; N]) {
    for ((least, most), &v) in range.iter_mut().zip(texel) {
        (*least, *most) = (least.min(v), most.max(v));
    }
}

fn largest<const N: usize>(range: &[(f64, f64); N]) -> f64 {
    range.iter().fold(0.0, |most, r| most.max(r.1))
}
