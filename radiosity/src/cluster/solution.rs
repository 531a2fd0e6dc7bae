//! The light between clusters: I = F (E + ρ (H + I)), for the irradiance I of every cluster.

use glam::DVec3;

use super::clusters::Clusters;
use super::gather::Gatherer;
use super::links::NONE;
use crate::error::RadiosityError;
use crate::rgb::{Rgb, add, times};
use crate::solve::SolveOptions;
use pointillist_parallel as parallel;

/// Contractions nearer to 1 bound nothing.
const MOST: f64 = 1.0 - 1e-12;

/// Radiosity of all patches of a scene in clusters, with a bound on the error of the solution of its equations.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ClusterSolution<'c> {
    pub(crate) clusters: &'c Clusters,
    /// Irradiance of each cluster along its links.
    pub(crate) gathered: Vec<Rgb>,
    /// What rays see of each patch: its radiosity without the emission of emitters that are looked at one by one.
    pub(crate) seen: Vec<Rgb>,
    /// Radiosity of each patch, power per area.
    pub radiosity: Vec<Rgb>,
    /// Bound on the error of any patch's radiosity for the given links: ‖r‖∞ / (1 − contraction). The error of the links themselves, which are samples, is not in
    /// it: [`ClusterSolution::bake_with`] says how far its rays differ.
    pub bound: f64,
    /// Largest product of reflectance and share of links that meet a patch.
    pub contraction: f64,
    /// Sweeps.
    pub steps: usize,
    /// Whether the tolerance was met.
    pub converged: bool,
}

impl Clusters {
    /// Solves by Jacobi's iteration over clusters, bands side by side. Results are the same for any number of threads.
    ///
    /// # Errors
    /// [`RadiosityError::NoEquilibrium`] where nothing bounds the error: a closed scene that absorbs nothing. [`RadiosityError::Option`].
    pub fn solve(&self, options: &SolveOptions) -> Result<ClusterSolution<'_>, RadiosityError> {
        self.solve_from(vec![[0.0; 3]; self.groups.len()], options)
    }

    /// As [`Clusters::solve`], from a solution of the same links, as `gathered` of it says: after a change of some materials or lamps few sweeps are left.
    ///
    /// # Errors
    /// As [`Clusters::solve`], and [`RadiosityError::CountMismatch`] if there are not as many values as clusters.
    pub fn solve_from(&self, gathered: Vec<Rgb>, options: &SolveOptions) -> Result<ClusterSolution<'_>, RadiosityError> {
        options.check()?;
        let clusters = self.groups.len();
        if gathered.len() != clusters {
            return Err(RadiosityError::CountMismatch { patches: clusters, given: gathered.len() });
        }
        let contraction = self.contraction();
        if contraction > MOST {
            return Err(RadiosityError::NoEquilibrium { contraction });
        }
        let mut solution = ClusterSolution {
            clusters: self,
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
            solution.sweep(options.tolerance);
        }
        Ok(solution)
    }

    /// Largest share of what arrives at a patch that arrives again.
    fn contraction(&self) -> f64 {
        let met = |cluster: usize| {
            let row = self.links.row(cluster);
            row.iter().filter(|&&hit| hit != NONE).count() as f64 / row.len() as f64
        };
        (0..self.groups.len()).fold(0.0, |most, cluster| {
            let brightest = |&patch: &u32| self.reflectance(patch as usize).into_iter().fold(0.0, f64::max);
            most.max(met(cluster) * self.groups.members(cluster).iter().map(brightest).fold(0.0, f64::max))
        })
    }
}

impl<'c> ClusterSolution<'c> {
    /// The clusters that were solved.
    #[must_use]
    pub const fn clusters(&self) -> &'c Clusters {
        self.clusters
    }

    /// Irradiance of each cluster from all patches but emitters, from which [`Clusters::solve_from`] goes on.
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
        let bits = point.to_array().into_iter().fold(0, |m, x| crate::rays::sequence::mix(m ^ (x + 0.0).to_bits()));
        let (gatherer, place) = (Gatherer::new(self), (self.clusters.scene.inward(point), normal, bits));
        let mut gathered = gatherer.start(place.0, place.1, place.2);
        gatherer.go_on(place, self.clusters.options.most_rays, &mut gathered);
        Ok(gathered.light())
    }

    /// One step, and whether it was the last one needed.
    fn sweep(&mut self, tolerance: f64) {
        let clusters = self.clusters;
        let next: Vec<Rgb> = parallel::map(clusters.groups.len(), |cluster| {
            let row = clusters.links.row(cluster);
            let sum = row.iter().fold([0.0; 3], |sum, &hit| {
                if hit == NONE { sum } else { add(sum, 1.0, self.seen[hit as usize]) }
            });
            sum.map(|s| s / row.len() as f64)
        });
        let mut residual = 0.0_f64;
        for (patch, &cluster) in clusters.groups.of_patch.iter().enumerate() {
            let change = add(next[cluster as usize], -1.0, self.gathered[cluster as usize]);
            let change = times(clusters.reflectance(patch), change);
            residual = change.into_iter().fold(residual, |m, c| m.max(c.abs()));
        }
        // With the new values: what is left is at most the contraction of it.
        self.gathered = next;
        self.send();
        self.steps += 1;
        self.bound = residual * self.contraction / (1.0 - self.contraction);
        let largest = self.radiosity.iter().flatten().fold(0.0, |m: f64, &v| m.max(v));
        self.converged = self.bound <= tolerance * largest;
    }

    /// The radiosity of patches by what their clusters gather.
    fn send(&mut self) {
        let clusters = self.clusters;
        let of_patch = &clusters.groups.of_patch;
        let radiosity = |patch: usize| clusters.radiosity(patch, self.gathered[of_patch[patch] as usize]);
        self.radiosity = parallel::map(of_patch.len(), radiosity);
        let seen = |patch: usize| add(self.radiosity[patch], -1.0, clusters.known_emission(patch));
        self.seen = parallel::map(of_patch.len(), seen);
    }
}
