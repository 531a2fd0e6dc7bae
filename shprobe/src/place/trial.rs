//! The error of light interpolated between some of the candidates, over all of them.

use crate::delaunay::{Blend, Delaunay, Hint, Locator, Partition};
use crate::field::{common_order, help};
use crate::sh::{Lobe, Sh};
use crate::sight::{Near, Shares, by_sight};
use crate::{DistanceMap, ProbeError};
use glam::DVec3;

/// Positions at which probes may be, and the light there. Start from [`Candidates::new`]: further fields may come.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Candidates<'a> {
    /// Where they are.
    pub positions: &'a [DVec3],
    /// What arrives there; all of one order.
    pub radiance: &'a [Sh],
    /// What they see, as distances; without these, light passes through walls.
    pub distances: Option<&'a [DistanceMap]>,
    /// Weight of the error at each, for example the volume that it stands for; 1 without.
    pub weights: Option<&'a [f64]>,
}

impl<'a> Candidates<'a> {
    /// Positions and as many functions, all of one order; light passes through walls, and all count alike.
    #[must_use]
    pub const fn new(positions: &'a [DVec3], radiance: &'a [Sh]) -> Self {
        Self { positions, radiance, distances: None, weights: None }
    }

    /// Sets the distances that each sees: one map per position.
    #[must_use]
    pub const fn with_distances(mut self, distances: &'a [DistanceMap]) -> Self {
        self.distances = Some(distances);
        self
    }

    /// Sets what the error at each counts: one finite number of at least 0 per position, not all 0.
    #[must_use]
    pub const fn with_weights(mut self, weights: &'a [f64]) -> Self {
        self.weights = Some(weights);
        self
    }
}

/// Candidates ready to be tried.
pub(super) struct Bench<'a> {
    candidates: Candidates<'a>,
    /// Coefficients of irradiance over √(4π): sums of squares are means over all normals.
    irradiance: Vec<Vec<DVec3>>,
    /// Weight of a squared error at each candidate.
    weights: Vec<f64>,
}

/// Lower bound, as a share of the RMS, of the light that errors are divided by: relative errors in the dark stay
/// bounded.
const DARK: f64 = 0.02;

/// The error of a set of probes.
pub(super) struct Outcome {
    /// Square of the relative error over all candidates.
    pub(super) error2: f64,
    /// The part of it at each candidate.
    pub(super) parts: Vec<f64>,
    /// For each candidate the probes of the cell it is in, as indices into those chosen.
    pub(super) cells: Vec<[u32; 4]>,
    pub(super) partition: Partition,
}

/// Weights are finite and not negative, and one is above 0.
fn check_weights(weights: Option<&[f64]>) -> Result<(), ProbeError> {
    let Some(weights) = weights else { return Ok(()) };
    let is_bad = |w: &f64| !(*w >= 0.0 && w.is_finite());
    let nothing = || (!weights.iter().any(|w| *w > 0.0)).then_some(0);
    match weights.iter().position(is_bad).or_else(nothing) {
        Some(index) => Err(ProbeError::BadWeight { index, weight: weights[index] }),
        None => Ok(()),
    }
}

/// Refuses an option that is not from 0 to 1.
fn check_share(name: &'static str, value: f64) -> Result<(), ProbeError> {
    let is_share = (0.0..=1.0).contains(&value);
    if is_share { Ok(()) } else { Err(ProbeError::BadOption { name, value, range: "it must be 0 to 1" }) }
}

/// Refuses an option that is negative or not finite.
pub(super) fn check_amount(name: &'static str, value: f64) -> Result<(), ProbeError> {
    let range = "it must be finite and at least 0";
    if value >= 0.0 && value.is_finite() { Ok(()) } else { Err(ProbeError::BadOption { name, value, range }) }
}

impl<'a> Bench<'a> {
    pub(super) fn new(candidates: Candidates<'a>, balance: f64) -> Result<Self, ProbeError> {
        let count = candidates.positions.len();
        if count == 0 {
            return Err(ProbeError::NoProbes);
        }
        let lengths = [
            candidates.radiance.len(),
            candidates.distances.map_or(count, <[_]>::len),
            candidates.weights.map_or(count, <[_]>::len),
        ];
        if let Some(&given) = lengths.iter().find(|&&n| n != count) {
            return Err(ProbeError::CountMismatch { probes: count, given });
        }
        if let Some(index) = candidates.positions.iter().position(|p| !p.is_finite()) {
            return Err(ProbeError::PositionNotFinite { index });
        }
        common_order(candidates.radiance)?;
        check_weights(candidates.weights)?;
        check_share("balance", balance)?;
        let norm = (4.0 * std::f64::consts::PI).sqrt();
        let normed = |sh: &Sh| sh.convolved(&Lobe::COSINE).scaled(1.0 / norm).into_coefficients();
        let irradiance: Vec<Vec<DVec3>> = candidates.radiance.iter().map(normed).collect();
        let square = |c: &Vec<DVec3>| c.iter().map(|v| v.length_squared()).sum::<f64>();
        let squares: Vec<f64> = irradiance.iter().map(square).collect();
        let given = |i: usize| candidates.weights.map_or(1.0, |w| w[i]);
        let total: f64 = (0..count).map(given).sum();
        let mean = squares.iter().enumerate().map(|(i, s)| given(i) * s).sum::<f64>() / total;
        let weight = |i: usize| given(i) * (squares[i] + DARK * DARK * mean).powf(-balance);
        let weights: Vec<f64> = (0..count).map(weight).collect();
        let power: f64 = weights.iter().zip(&squares).map(|(w, s)| w * s).sum();
        // Without light there is no error.
        let scale = if power > 0.0 { 1.0 / power } else { 0.0 };
        let weights = weights.into_iter().map(|w| if scale > 0.0 { w * scale } else { 0.0 }).collect();
        Ok(Self { candidates, irradiance, weights })
    }

    pub(super) fn count(&self) -> usize {
        self.irradiance.len()
    }

    /// Lights all candidates from those chosen.
    pub(super) fn outcome(&self, chosen: &[u32]) -> Result<Outcome, ProbeError> {
        let (locator, near, partition) = self.locator(chosen)?;
        let mut hint = Hint::default();
        let mut outcome = Outcome { error2: 0.0, parts: vec![], cells: vec![], partition };
        for i in 0..self.count() {
            let plain = locator.locate(self.candidates.positions[i], &mut hint)?;
            let part = self.squared_error(i, chosen, &plain, &near);
            outcome.error2 += part;
            outcome.parts.push(part);
            outcome.cells.push(plain.points);
        }
        Ok(outcome)
    }

    /// The errors of a few candidates, lit from those chosen.
    pub(super) fn errors_of(&self, candidates: &[u32], chosen: &[u32]) -> Result<f64, ProbeError> {
        let (locator, near, _) = self.locator(chosen)?;
        let mut hint = Hint::default();
        let mut sum = 0.0;
        for &i in candidates {
            let plain = locator.locate(self.candidates.positions[i as usize], &mut hint)?;
            sum += self.squared_error(i as usize, chosen, &plain, &near);
        }
        Ok(sum)
    }

    fn locator(&self, chosen: &[u32]) -> Result<(Locator, Near, Partition), ProbeError> {
        let positions: Vec<DVec3> = chosen.iter().map(|&i| self.candidates.positions[i as usize]).collect();
        let partition = Delaunay::new(&positions)?.partition();
        let reach = if self.candidates.distances.is_some() { help(&positions, &partition) } else { 0.0 };
        Ok((Locator::new(&positions, &partition)?, Near::new(&positions, reach), partition))
    }

    /// What each candidate counts.
    pub(super) fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// From which of those chosen each candidate takes how much.
    pub(super) fn shares(&self, chosen: &[u32]) -> Result<Vec<Shares>, ProbeError> {
        let (locator, near, _) = self.locator(chosen)?;
        let mut hint = Hint::default();
        let mut one = |i: usize| {
            let cell = locator.locate(self.candidates.positions[i], &mut hint)?;
            Ok(self.shares_in(i, chosen, &cell, &near))
        };
        (0..self.count()).map(&mut one).collect()
    }

    fn shares_in(&self, i: usize, chosen: &[u32], cell: &Blend, near: &Near) -> Shares {
        let here = self.candidates.positions[i];
        let at = |probe: u32| self.candidates.positions[chosen[probe as usize] as usize];
        match self.candidates.distances {
            None => Shares::of_cell(cell),
            Some(maps) => by_sight(cell, here, at, near, |probe| {
                maps[chosen[probe as usize] as usize].visibility(here - at(probe))
            }),
        }
    }

    fn squared_error(&self, i: usize, chosen: &[u32], cell: &Blend, near: &Near) -> f64 {
        let shares = self.shares_in(i, chosen, cell, near);
        let truth = &self.irradiance[i];
        let square: f64 = (0..truth.len())
            .map(|k| {
                let mixed = |(p, w): (u32, f64)| self.irradiance[chosen[p as usize] as usize][k] * w;
                (shares.iter().map(mixed).sum::<DVec3>() - truth[k]).length_squared()
            })
            .sum();
        self.weights[i] * square
    }
}
