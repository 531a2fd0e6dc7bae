//! Places in a pixel and on a lens, spread evenly over all four dimensions at once.
//!
//! Sobol' points, scrambled for each pixel as Owen does: each binary digit is flipped or not by the digits before it.
//! Every pixel has the even spread, none the same points as another, so that what is left of the error is noise and no
//! pattern.

use glam::{DVec2, dvec2};

/// Digits that are scrambled one by one: enough for 4096 samples. The others are random.
const LEVELS: u32 = 12;

/// Degree, inner coefficients and first numbers of the primitive polynomials: S. Joe and F. Y. Kuo, *Constructing Sobol
/// sequences with better two-dimensional projections*, 2008. The first dimension has none.
const POLYNOMIALS: [(usize, u32, &[u32]); 3] = [(1, 0, &[1]), (2, 1, &[1, 3]), (3, 1, &[1, 3, 1])];

/// The points, not yet scrambled.
pub(crate) struct LensSamples(Vec<[u32; 4]>);

impl LensSamples {
    /// Powers of two are spread best.
    pub(crate) fn new(count: u32) -> Self {
        let numbers = direction_numbers();
        let coordinate = |index: u32, v: &[u32; 32]| {
            (0..32).filter(|b| index >> b & 1 == 1).fold(0, |sum, b| sum ^ v[b as usize])
        };
        Self((0..count).map(|i| std::array::from_fn(|d| coordinate(i, &numbers[d]))).collect())
    }

    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// Place in the unit square of a pixel, and place in the unit disc of the lens, for each sample.
    pub(crate) fn of_pixel(&self, pixel: u64, seed: u64) -> impl Iterator<Item = (DVec2, DVec2)> {
        let start = mixed(mixed(seed) ^ pixel);
        let seeds: [u64; 4] = std::array::from_fn(|d| mixed(start.wrapping_add(d as u64 + 1)));
        self.0.iter().map(move |point| {
            let at = |d: usize| (f64::from(scrambled(point[d], seeds[d])) + 0.5) / (1u64 << 32) as f64;
            (dvec2(at(0), at(1)), disc(dvec2(at(2), at(3))))
        })
    }
}

/// What each binary digit of the index adds to a coordinate.
fn direction_numbers() -> [[u32; 32]; 4] {
    let mut numbers = [[0; 32]; 4];
    numbers[0] = std::array::from_fn(|i| 1 << (31 - i));
    for (v, (degree, inner, first)) in numbers[1..].iter_mut().zip(POLYNOMIALS) {
        for i in 0..32 {
            v[i] = if i < degree {
                first[i] << (31 - i)
            } else {
                let last = v[i - degree] ^ v[i - degree] >> degree;
                let chosen = (1..degree).filter(|k| inner >> (degree - 1 - k) & 1 == 1);
                chosen.fold(last, |sum, k| sum ^ v[i - k])
            };
        }
    }
    numbers
}

/// Flips each of the first [`LEVELS`] digits as the digits before it say, and the rest as all of these say.
fn scrambled(x: u32, seed: u64) -> u32 {
    let node = |level: u32| u64::from((1 << level) | (u64::from(x) >> (32 - level)) as u32);
    let flip = |level: u32| ((mixed(seed ^ node(level)) >> 63) as u32) << (31 - level);
    let rest = mixed(seed ^ node(LEVELS)) as u32 >> LEVELS;
    (0..LEVELS).fold(x ^ rest, |x, level| x ^ flip(level))
}

/// The unit square onto the unit disc, equal areas to equal areas (Shirley and Chiu, 1997).
fn disc(square: DVec2) -> DVec2 {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    let p = 2.0 * square - 1.0;
    if p == DVec2::ZERO {
        return p;
    }
    let (radius, angle) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * p.y / p.x)
    } else {
        (p.y, FRAC_PI_2 - FRAC_PI_4 * p.x / p.y)
    };
    radius * DVec2::from_angle(angle)
}

/// A number from which each bit of `n` flips half of all bits (the last step of Appleby's MurmurHash3).
pub(crate) fn mixed(n: u64) -> u64 {
    let n = (n ^ n >> 33).wrapping_mul(0xff51_afd7_ed55_8ccd);
    let n = (n ^ n >> 33).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    n ^ n >> 33
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stratum_of_a_pixel_gets_as_many_samples() {
        let samples = LensSamples::new(256);
        for seed in 0..4 {
            let mut counts = [0; 256];
            for (p, lens) in samples.of_pixel(7, seed) {
                counts[(p.x * 16.0) as usize * 16 + (p.y * 16.0) as usize] += 1;
                assert!(lens.length() <= 1.0);
            }
            assert_eq!(counts, [1; 256]);
        }
    }

    #[test]
    fn the_lens_is_covered_evenly() {
        let lens = LensSamples::new(1024).of_pixel(3, 1).map(|s| s.1).collect::<Vec<_>>();
        let mean = |f: &dyn Fn(&DVec2) -> f64| lens.iter().map(f).sum::<f64>() / lens.len() as f64;
        // Of a uniform disc: no mean, no mixed moment, and ¼ along each axis.
        for (found, wanted) in [
            (mean(&|p| p.x), 0.0),
            (mean(&|p| p.y), 0.0),
            (mean(&|p| p.x * p.y), 0.0),
            (mean(&|p| p.x * p.x), 0.25),
            (mean(&|p| p.y * p.y), 0.25),
        ] {
            assert!((found - wanted).abs() < 2e-3, "{found} is not {wanted}");
        }
    }
}
