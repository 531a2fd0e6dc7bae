//! The light along links by rays: I = F (E + ρ (H + I)), for the irradiance I of every patch.

use glam::DVec3;

use super::gather::Gatherer;
use super::links::NONE;
use super::parts;
use super::transport::RayTransport;
use crate::error::RadiosityError;
use crate::rgb::{Rgb, add, times};
use crate::solve::SolveOptions;
use pointillist_parallel as parallel;

/// Contractions nearer to 1 bound nothing.
const MOST: f64 = 1.0 - 1e-12;

/// Radiosity of all patches, with a bound on the error of the solution of its equations.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RaySolution<'c> {
    pub(crate) transport: &'c RayTransport,
    /// Irradiance of each patch along its links.
    pub(crate) gathered: Vec<Rgb>,
    /// What rays see of each patch: its radiosity without the emission of emitters that are looked at one by one.
    pub(crate) seen: Vec<Rgb>,
    /// Radiosity of each patch, power per area.
    pub radiosity: Vec<Rgb>,
    /// Bound on the error of any patch's radiosity for the given links, from the last change and the contraction. The error of the links themselves, which
    /// are samples, is not in it.
    pub bound: f64,
    /// Largest product of reflectance and share of links that meet a patch.
    pub contraction: f64,
    /// Sweeps.
    pub steps: usize,
    /// Whether the tolerance was met.
    pub converged: bool,
}

impl RayTransport {
    /// Solves by Jacobi's iteration, bands side by side. Results are the same for any number of threads.
    ///
    /// # Errors
    /// [`RadiosityError::NoEquilibrium`] where nothing bounds the error: a closed scene that absorbs nothing. [`RadiosityError::Option`].
    pub fn solve(&self, options: &SolveOptions) -> Result<RaySolution<'_>, RadiosityError> {
        self.solve_from(vec![[0.0; 3]; self.leaves.len()], options)
    }

    /// As [`RayTransport::solve`], from a solution of the same links, as `gathered` of it says: after a change of some materials or lamps few sweeps are left.
    ///
    /// # Errors
    /// As [`RayTransport::solve`], and [`RadiosityError::CountMismatch`] if there are not as many values as patches.
    pub fn solve_from(
        &self,
        gathered: Vec<Rgb>,
        options: &SolveOptions,
    ) -> Result<RaySolution<'_>, RadiosityError> {
        options.check()?;
        let patches = self.leaves.len();
        if gathered.len() != patches {
            return Err(RadiosityError::CountMismatch { patches, given: gathered.len() });
        }
        let contraction = self.contraction();
        let proof = if contraction > MOST { self.proof() } else { Some(Proof::of_rows(contraction)) };
        let proof = proof.ok_or(RadiosityError::NoEquilibrium { contraction })?;
        let mut solution = RaySolution {
            transport: self,
            gathered,
            seen: vec![],
            radiosity: vec![],
            bound: 0.0,
            contraction,
            steps: 0,
            converged: false,
        };
        solution.send();
        while !solution.converged && solution.steps < options.max_sweeps {
            solution.sweep(&proof, options.tolerance);
        }
        Ok(solution)
    }

    /// Largest share of what arrives at a patch that arrives again.
    fn contraction(&self) -> f64 {
        (0..self.leaves.len()).fold(0.0, |most: f64, patch| {
            let row = self.links.row(patch);
            let met = row.iter().filter(|&&hit| hit != NONE).count() as f64 / row.len() as f64;
            most.max(met * self.reflectance(patch).into_iter().fold(0.0, f64::max))
        })
    }
}

/// Why the last change of the radiosity bounds its error. If w > 0 and v = (I − ρF) w > 0, then a change of at most m w leaves a
/// residual of at most m ρF w = m (w − v), and an error of at most m · max (w − v)/v · w.
struct Proof {
    /// w; empty for 1 everywhere.
    weights: Vec<f64>,
    /// max (w − v)/v · max w.
    factor: f64,
}

/// Most sweeps in which weights are looked for.
const PROOF_SWEEPS: usize = 500;
/// Least v with which they are accepted.
const PROVEN: f64 = 0.5;

impl Proof {
    /// No row reflects more than this.
    fn of_rows(contraction: f64) -> Self {
        Self { weights: vec![], factor: contraction / (1.0 - contraction) }
    }
}

impl RayTransport {
    /// Where single rows lose nothing: solves (I − ρF) w = 1 until v is large enough.
    fn proof(&self) -> Option<Proof> {
        let count = self.leaves.len();
        let brightest: Vec<f64> =
            (0..count).map(|patch| self.reflectance(patch).into_iter().fold(0.0, f64::max)).collect();
        let mut weights = vec![1.0; count];
        for _ in 0..PROOF_SWEEPS {
            let next: Vec<f64> = parallel::map(count, |patch| {
                let row = self.links.row(patch);
                let met =
                    row.iter().filter(|&&hit| hit != NONE).map(|&hit| weights[hit as usize]).sum::<f64>();
                1.0 + brightest[patch] * met / row.len() as f64
            });
            // 1 + ρFw − w is 1 − v.
            let least = next.iter().zip(&weights).fold(f64::MAX, |m, (n, w)| m.min(1.0 - (n - w)));
            if least >= PROVEN {
                let ratio = |(n, w): (&f64, &f64)| (n - 1.0) / (1.0 - (n - w));
                let ratio = next.iter().zip(&weights).map(ratio).fold(0.0, f64::max);
                let factor = ratio * weights.iter().copied().fold(0.0, f64::max);
                return Some(Proof { weights, factor });
            }
            weights = next;
        }
        None
    }
}

impl<'c> RaySolution<'c> {
    /// The links that were solved.
    #[must_use]
    pub const fn transport(&self) -> &'c RayTransport {
        self.transport
    }

    /// Irradiance of each patch from all others but emitters, from which [`RayTransport::solve_from`] goes on.
    #[must_use]
    pub fn gathered(&self) -> &[Rgb] {
        &self.gathered
    }

    /// Irradiance at a point with a normal (of any length) from all patches. Light of lamps is not in it.
    ///
    /// # Errors
    /// [`RadiosityError::BadPoint`].
    pub fn irradiance(&self, point: DVec3, normal: DVec3) -> Result<Rgb, RadiosityError> {
        let (Some(normal), true) = (normal.try_normalize(), point.is_finite()) else {
            return Err(RadiosityError::BadPoint);
        };
        let bits =
            point.to_array().into_iter().fold(0, |m, x| crate::rays::sequence::mix(m ^ (x + 0.0).to_bits()));
        let (gatherer, place) = (Gatherer::new(self), (self.transport.scene.inward(point), normal, bits));
        let mut gathered = gatherer.start(place.0, place.1, place.2);
        gatherer.go_on(place, (&parts::even(self.transport.options.most_rays), 0.0), &mut gathered);
        Ok(gathered.light())
    }

    /// One step, and whether it was the last one needed.
    fn sweep(&mut self, proof: &Proof, tolerance: f64) {
        let transport = self.transport;
        let next: Vec<Rgb> = parallel::map(transport.leaves.len(), |patch| {
            let row = transport.links.row(patch);
            let sum = row.iter().fold([0.0; 3], |sum, &hit| {
                if hit == NONE { sum } else { add(sum, 1.0, self.seen[hit as usize]) }
            });
            sum.map(|s| s / row.len() as f64)
        });
        let mut residual = 0.0_f64;
        for (patch, (new, old)) in next.iter().zip(&self.gathered).enumerate() {
            let change = add(*new, -1.0, *old);
            let change = times(transport.reflectance(patch), change);
            let weight = proof.weights.get(patch).copied().unwrap_or(1.0);
            residual = change.into_iter().fold(residual, |m, c| m.max(c.abs() / weight));
        }
        self.gathered = next;
        self.send();
        self.steps += 1;
        self.bound = residual * proof.factor;
        let largest = self.radiosity.iter().flatten().fold(0.0, |m: f64, &v| m.max(v));
        self.converged = self.bound <= tolerance * largest;
    }

    /// The radiosity of patches by what their clusters gather.
    fn send(&mut self) {
        let transport = self.transport;
        let radiosity = |patch: usize| transport.radiosity(patch, self.gathered[patch]);
        self.radiosity = parallel::map(transport.leaves.len(), radiosity);
        let seen = |patch: usize| add(self.radiosity[patch], -1.0, transport.known_emission(patch));
        self.seen = parallel::map(transport.leaves.len(), seen);
    }
}
