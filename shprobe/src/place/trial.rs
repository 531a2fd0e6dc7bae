//! The error of light interpolated between some of the candidates, over all of them.

use crate::delaunay::{Blend, Hint, Locator, Partition};
use crate::field::{BIAS, common_order, spacing};
use crate::sh::{Lobe, MAX_COUNT, Sh, basis};
use crate::sight::{Shares, Spot, by_cell, by_sight};
use crate::tree::Tree;
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
    /// The surface that each lies on, by its unit normal on the lit side; 0 in free space, as all are without.
    pub normals: Option<&'a [DVec3]>,
}

impl<'a> Candidates<'a> {
    /// Positions and as many functions, all of one order; light passes through walls, and all count alike.
    #[must_use]
    pub const fn new(positions: &'a [DVec3], radiance: &'a [Sh]) -> Self {
        Self { positions, radiance, distances: None, weights: None, normals: None }
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

    /// Sets which lie on surfaces: one unit normal per position, 0 in free space. On a surface only the irradiance for
    /// that normal counts, from probes in front of it, and no probe is placed there. Its radiance is what arrives just
    /// above the surface.
    #[must_use]
    pub const fn with_normals(mut self, normals: &'a [DVec3]) -> Self {
        self.normals = Some(normals);
        self
    }

    /// The normal of the surface that a candidate lies on; 0 in free space.
    pub(super) fn normal(&self, i: usize) -> DVec3 {
        self.normals.map_or(DVec3::ZERO, |n| n[i])
    }

    /// Whether a probe can be there.
    pub(super) fn is_free(&self, i: usize) -> bool {
        self.normal(i) == DVec3::ZERO
    }
}

/// The default balance of errors in the dark and in the light, of placement and of fitting: relative errors are what the
/// eye sees. By experiment with two rooms of which one is 20 times as dark as the other (`studies shprobe wall`), 96
/// probes: the dark face of the wall errs half as much as with 0.5, free space on the whole a tenth more.
pub const BALANCE: f64 = 1.0;

/// Candidates ready to be tried.
pub(super) struct Bench<'a> {
    candidates: Candidates<'a>,
    /// Coefficients of irradiance over √(4π): sums of squares are means over all normals.
    irradiance: Vec<Vec<DVec3>>,
    /// For each candidate on a surface √(4π) times the basis functions of its normal: its irradiance is their product
    /// with the coefficients.
    bases: Vec<Option<[f64; MAX_COUNT]>>,
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
            candidates.normals.map_or(count, <[_]>::len),
        ];
        if let Some(&given) = lengths.iter().find(|&&n| n != count) {
            return Err(ProbeError::CountMismatch { probes: count, given });
        }
        if let Some(index) = candidates.positions.iter().position(|p| !p.is_finite()) {
            return Err(ProbeError::PositionNotFinite { index });
        }
        if let Some(index) = (0..count).find(|&i| !candidates.normal(i).is_finite()) {
            return Err(ProbeError::QueryNotFinite { index });
        }
        if !(0..count).any(|i| candidates.is_free(i)) {
            return Err(ProbeError::NoProbes);
        }
        let order = common_order(candidates.radiance)?;
        check_weights(candidates.weights)?;
        check_share("balance", balance)?;
        let norm = (4.0 * std::f64::consts::PI).sqrt();
        let normed = |sh: &Sh| sh.convolved(&Lobe::COSINE).scaled(1.0 / norm).into_coefficients();
        let irradiance: Vec<Vec<DVec3>> = candidates.radiance.iter().map(normed).collect();
        let basis_of = |i: usize| {
            let basis: [f64; MAX_COUNT] = basis(order, candidates.normal(i).normalize_or_zero());
            (!candidates.is_free(i)).then(|| basis.map(|y| y * norm))
        };
        let bases: Vec<_> = (0..count).map(basis_of).collect();
        let squares: Vec<f64> = irradiance
            .iter()
            .zip(&bases)
            .map(|(c, basis)| square(c.iter().copied(), basis.as_ref()))
            .collect();
        let given = |i: usize| candidates.weights.map_or(1.0, |w| w[i]);
        let total: f64 = (0..count).map(given).sum();
        let mean = squares.iter().enumerate().map(|(i, s)| given(i) * s).sum::<f64>() / total;
        let weight = |i: usize| given(i) * (squares[i] + DARK * DARK * mean).powf(-balance);
        let weights: Vec<f64> = (0..count).map(weight).collect();
        let power: f64 = weights.iter().zip(&squares).map(|(w, s)| w * s).sum();
        // Without light there is no error.
        let scale = if power > 0.0 { 1.0 / power } else { 0.0 };
        let weights = weights.into_iter().map(|w| if scale > 0.0 { w * scale } else { 0.0 }).collect();
        Ok(Self { candidates, irradiance, bases, weights })
    }

    pub(super) fn count(&self) -> usize {
        self.irradiance.len()
    }

    /// The candidates that can be probes.
    pub(super) fn free(&self) -> Vec<u32> {
        (0..self.count() as u32).filter(|&i| self.candidates.is_free(i as usize)).collect()
    }

    /// Whether it is known what probes see.
    pub(super) const fn sees(&self) -> bool {
        self.candidates.distances.is_some()
    }

    pub(super) const fn positions(&self) -> &'a [DVec3] {
        self.candidates.positions
    }

    /// Lights all candidates from those chosen.
    pub(super) fn outcome(&self, chosen: &[u32]) -> Result<Outcome, ProbeError> {
        let net = self.net(chosen)?;
        let mut hint = Hint::default();
        let mut outcome =
            Outcome { error2: 0.0, parts: vec![], cells: vec![], partition: Partition::Point(0) };
        for i in 0..self.count() {
            let plain = net.locator.locate(self.candidates.positions[i], &mut hint)?;
            let part = self.squared_error(i, chosen, &self.shares_in(i, &net, &plain));
            outcome.error2 += part;
            outcome.parts.push(part);
            outcome.cells.push(plain.points);
        }
        outcome.partition = net.partition;
        Ok(outcome)
    }

    /// The errors of a few candidates, lit from those chosen.
    pub(super) fn errors_of(&self, candidates: &[u32], chosen: &[u32]) -> Result<f64, ProbeError> {
        let net = self.net(chosen)?;
        let mut hint = Hint::default();
        let mut sum = 0.0;
        for &i in candidates {
            let plain = net.locator.locate(self.candidates.positions[i as usize], &mut hint)?;
            sum += self.squared_error(i as usize, chosen, &self.shares_in(i as usize, &net, &plain));
        }
        Ok(sum)
    }

    /// What finds the probes around a position, for those chosen.
    fn net(&self, chosen: &[u32]) -> Result<Net, ProbeError> {
        let positions: Vec<DVec3> = chosen.iter().map(|&i| self.candidates.positions[i as usize]).collect();
        let partition = Partition::up_to_rounding(&positions)?;
        let spacing = spacing(&positions, &partition);
        let locator = Locator::new(&positions, &partition)?;
        let tree = Tree::new(positions.iter().copied().zip(0..), spacing);
        let maps = match self.candidates.distances {
            Some(maps) => chosen.iter().map(|&i| maps[i as usize].clone()).collect(),
            None => vec![],
        };
        Ok(Net { positions, partition, locator, tree, maps, spacing })
    }

    /// The tree of those chosen, numbered as candidates, and their mean spacing.
    pub(super) fn tree(&self, chosen: &[u32]) -> Result<(Tree, f64), ProbeError> {
        let positions: Vec<DVec3> = chosen.iter().map(|&i| self.candidates.positions[i as usize]).collect();
        let spacing = spacing(&positions, &Partition::up_to_rounding(&positions)?);
        Ok((Tree::new(positions.into_iter().zip(chosen.iter().copied()), spacing), spacing))
    }

    /// What each candidate counts.
    pub(super) fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The order of what candidates saw.
    pub(super) fn order(&self) -> usize {
        self.candidates.radiance[0].order()
    }

    /// The factor of each coefficient of radiance in irradiance over √(4π).
    pub(super) fn cosine(&self) -> Vec<f64> {
        let norm = (4.0 * std::f64::consts::PI).sqrt();
        let band = |l: usize| std::iter::repeat_n(Lobe::COSINE.bands()[l] / norm, 2 * l + 1);
        (0..=self.order()).flat_map(band).collect()
    }

    /// See [`Bench::bases`].
    pub(super) fn basis(&self, i: usize) -> Option<&[f64; MAX_COUNT]> {
        self.bases[i].as_ref()
    }

    /// From which of those chosen each candidate takes how much.
    pub(super) fn shares(&self, chosen: &[u32]) -> Result<Vec<Shares>, ProbeError> {
        let net = self.net(chosen)?;
        let mut hint = Hint::default();
        let mut one = |i: usize| {
            let cell = net.locator.locate(self.candidates.positions[i], &mut hint)?;
            Ok(self.shares_in(i, &net, &cell))
        };
        (0..self.count()).map(&mut one).collect()
    }

    fn shares_in(&self, i: usize, net: &Net, cell: &Blend) -> Shares {
        let spot = self.spot(i, net.spacing);
        if net.maps.is_empty() {
            by_cell(&spot, cell, &net.tree, |probe| net.positions[probe as usize])
        } else {
            by_sight(&spot, &net.tree, |probe| net.maps.get(probe as usize))
        }
    }

    /// Where a candidate is, among probes of a mean spacing.
    pub(super) fn spot(&self, i: usize, spacing: f64) -> Spot {
        Spot::new(self.candidates.positions[i], self.candidates.normal(i), BIAS * spacing, spacing)
    }

    /// How much a candidate sees of a spot as a probe.
    pub(super) fn seen(&self, spot: &Spot, probe: u32) -> f64 {
        let map = self.candidates.distances.map(|maps| &maps[probe as usize]);
        spot.seen(self.candidates.positions[probe as usize], map)
    }

    /// How much a candidate in free space sees of another, where a quarter is as good as all, since maps are coarse; all where it is not known what
    /// candidates see.
    pub(super) fn sees_of(&self, i: usize, other: u32) -> f64 {
        let offset = self.candidates.positions[other as usize] - self.candidates.positions[i];
        match self.candidates.distances {
            Some(maps) if self.candidates.is_free(i) => (4.0 * maps[i].visibility(offset)).min(1.0),
            _ => 1.0,
        }
    }

    /// The error of a candidate with these shares of `chosen`.
    fn squared_error(&self, i: usize, chosen: &[u32], shares: &Shares) -> f64 {
        let of_candidates: Vec<(u32, f64)> = shares.iter().map(|(p, w)| (chosen[p as usize], w)).collect();
        self.error_with(i, &of_candidates)
    }

    /// The error of a candidate that takes these shares from others.
    pub(super) fn error_with(&self, i: usize, shares: &[(u32, f64)]) -> f64 {
        let truth = &self.irradiance[i];
        let rest = (0..truth.len()).map(|k| {
            let mixed = |&(p, w): &(u32, f64)| self.irradiance[p as usize][k] * w;
            shares.iter().map(mixed).sum::<DVec3>() - truth[k]
        });
        self.weights[i] * square(rest, self.bases[i].as_ref())
    }
}

/// Probes that were chosen, ready to light candidates.
struct Net {
    positions: Vec<DVec3>,
    partition: Partition,
    locator: Locator,
    tree: Tree,
    /// None if it is not known what they see.
    maps: Vec<DistanceMap>,
    spacing: f64,
}

/// The square of irradiance from its coefficients: for the normal of a surface, or the mean over all normals.
fn square(coefficients: impl Iterator<Item = DVec3>, basis: Option<&[f64; MAX_COUNT]>) -> f64 {
    match basis {
        None => coefficients.map(|c| c.length_squared()).sum(),
        Some(basis) => coefficients.zip(basis).map(|(c, y)| c * *y).sum::<DVec3>().length_squared(),
    }
}
