//! How much each texel counts.

use crate::ShError;
use crate::cube_map::{texel_centre, texel_count};
use crate::texel_solid_angle;
use std::f64::consts::PI;

/// Smaller faces have too few texels for end corrections: [`Weights::Gregory`] is [`Weights::Paper`] there.
pub const GREGORY_FROM: usize = 16;

/// Factors of the outer five texels of a row or column: the midpoint rule, sixth order. They integrate what the
/// Euler–Maclaurin formula leaves at an end, −f′/24 + 7f‴/5760, of polynomials of degree up to 4 through the five
/// samples.
const GREGORY: [f64; 5] = [741.0 / 640.0, 3547.0 / 5760.0, 527.0 / 384.0, 1571.0 / 1920.0, 2983.0 / 2880.0];

/// How much each sample of an image counts in an integral over the sphere. Whichever it is, coefficients are then
/// scaled by 4π/ΣA, so that a constant image is projected exactly.
///
/// Errors of the worst L2 coefficient of smooth skies (quadratic in the direction), relative to L00, with faces of
/// 128²; and of panoramas of 256×128:
///
/// | rule | cube | panorama |
/// |---|---|---|
/// | `Gregory` | 3e-10, rounding of the texels; 1e-7 with 32², sixth order | 5e-9, rounding of the pixels |
/// | `Exact` | 4e-6, second order | 5e-5, second order |
/// | `Paper` | 2e-6, second order | the same |
///
/// With hard edges all are equally good. The solid angle is not the best weight of a *point* sample: it would be of a
/// texel's mean. `Gregory` integrates the smooth function through the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Weights {
    /// Cubes: the differential solid angle of the centre with Gregory's end corrections, factors of the outer five
    /// texels of each row and column; below [`GREGORY_FROM`] as `Paper`. Panoramas: Fejér's rule, whose nodes the rows'
    /// centres are.
    #[default]
    Gregory,
    /// The exact solid angle of each texel or pixel: of panoramas Δφ·(cos θ₀ − cos θ₁), which is sin θ of the centre
    /// but for a factor.
    Exact,
    /// The paper's rule dS·(n·r̂)/|r|²: the differential solid angle of the centre. Panoramas: as `Exact`.
    Paper,
}

impl Weights {
    /// The share of each texel of a face, in rows: a sixth of the sphere, 4π/6, in all.
    ///
    /// # Errors
    /// `CubeSize`.
    pub fn of_face(self, size: usize) -> Result<Vec<f64>, ShError> {
        texel_count(size)?;
        let quarter = self.of_quarter(size);
        let half = size.div_ceil(2);
        let mirror = |i: usize| i.min(size - 1 - i);
        let row = |y: usize| (0..size).map(move |x| mirror(y) * half + mirror(x));
        Ok((0..size).flat_map(row).map(|i| quarter[i]).collect())
    }

    /// As [`Weights::of_face`], of the upper left quarter with the middle row and column: the others are its mirror
    /// images.
    pub(crate) fn of_quarter(self, size: usize) -> Vec<f64> {
        let half = size.div_ceil(2);
        let mut weights = vec![0.0; half * half];
        let mut sum = 0.0;
        // Number of rows or columns that have these weights: one for the middle one of an odd number, otherwise two.
        let times = |i: usize| if 2 * i + 1 == size { 1.0 } else { 2.0 };
        for y in 0..half {
            // A texel and the one across the diagonal weigh the same: an eighth of the face is computed.
            for x in 0..=y {
                let weight = self.of_texel(size, x, y);
                (weights[y * half + x], weights[x * half + y]) = (weight, weight);
                sum += times(x) * times(y) * if x == y { weight } else { 2.0 * weight };
            }
        }
        let scale = 4.0 * PI / (6.0 * sum);
        weights.iter_mut().for_each(|weight| *weight *= scale);
        weights
    }

    /// A(ω) of a texel of the upper left quarter, up to a factor that all have in common.
    fn of_texel(self, size: usize, x: usize, y: usize) -> f64 {
        let (s, t) = (texel_centre(size, x), texel_centre(size, y));
        // n·r̂ = 1/|r| as n·r = 1.
        let differential = (1.0 + s * s + t * t).powf(-1.5);
        match self {
            Self::Exact => texel_solid_angle(size, x, y),
            Self::Gregory if size >= GREGORY_FROM => differential * end_factor(x) * end_factor(y),
            Self::Gregory | Self::Paper => differential,
        }
    }

    /// The weights of the rows of a panorama, from the zenith: 2 in all, as ∫ sin θ dθ.
    pub(crate) fn of_rows(self, height: usize) -> Vec<f64> {
        let step = PI / height as f64;
        // Of the upper half; the lower is its mirror image.
        let theta = |row: usize| (row.min(height - 1 - row) as f64 + 0.5) * step;
        let mut weights: Vec<f64> = match self {
            // ∫ sin θ dθ over a row = 2·sin(middle)·sin(half a step): as `Paper`, up to a factor.
            Self::Exact | Self::Paper => (0..height).map(|row| theta(row).sin()).collect(),
            Self::Gregory => (0..height).map(|row| fejer(height, theta(row))).collect(),
        };
        let scale = 2.0 / weights.iter().sum::<f64>();
        weights.iter_mut().for_each(|weight| *weight *= scale);
        weights
    }
}

/// A weight of Fejér's first rule \[5\], 1 − 2 Σ cos(2kθ)/(4k² − 1), up to a factor that all have in common: exact for
/// polynomials in cos θ of degree below `height`. Summed backwards by Clenshaw's recurrence.
fn fejer(height: usize, theta: f64) -> f64 {
    let twice_cos = 2.0 * (2.0 * theta).cos();
    let (mut next, mut after) = (0.0, 0.0);
    for k in (1..=height / 2).rev() {
        let k = k as f64;
        (next, after) = (1.0 / (4.0 * k * k - 1.0) + twice_cos * next - after, next);
    }
    1.0 - 2.0 * (0.5 * twice_cos * next - after)
}

fn end_factor(i: usize) -> f64 {
    GREGORY.get(i).copied().unwrap_or(1.0)
}
