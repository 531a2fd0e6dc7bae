//! Solving B = E + ρ (H + F B), with a bound on what is still missing.

mod gauss_seidel;
mod importance;
mod progressive;
mod state;

pub(crate) use state::{add, times};

use crate::error::RadiosityError;
use crate::surface::{Rgb, is_light};
use crate::transport::Transport;

/// How to solve, and how far.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SolveOptions {
    /// Stops when the bound on the error of every patch's radiosity is below this share of the largest radiosity.
    /// Default: 1e-6.
    pub tolerance: f64,
    /// Most sweeps over all patches, or as many shots as that many sweeps would be. Default: 10,000.
    pub max_sweeps: usize,
    /// Gauss–Seidel: whether each sweep ends with an even correction that balances the energy of the whole scene. It takes most of
    /// the work out of bright closed rooms, and is taken only where it lowers the residual. Default: true.
    pub balance: bool,
    /// Progressive: whether a shot also sends what the patch is expected to receive later (\[5\]). Without importance only. Default: true.
    pub overshoot: bool,
}

impl SolveOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self { tolerance: 1e-6, max_sweeps: 10_000, balance: true, overshoot: true };

    /// Another tolerance.
    #[must_use]
    pub const fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Another limit of sweeps.
    #[must_use]
    pub const fn with_max_sweeps(mut self, sweeps: usize) -> Self {
        self.max_sweeps = sweeps;
        self
    }

    /// With or without the balance of energy.
    #[must_use]
    pub const fn with_balance(mut self, balance: bool) -> Self {
        self.balance = balance;
        self
    }

    /// With or without overshooting.
    #[must_use]
    pub const fn with_overshoot(mut self, overshoot: bool) -> Self {
        self.overshoot = overshoot;
        self
    }
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Radiosity of all patches, and how sure it is.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Of every element of the tree.
    pub(crate) of_element: Vec<Rgb>,
    /// Radiosity of each patch, power per area.
    pub radiosity: Vec<Rgb>,
    /// Bound on the error of any patch's radiosity, for the given form factors: ‖r‖∞ / (1 − max ρ·row sum), or where rows add
    /// up to more than 1, max w · max |r|/v for a w > 0 with v = (I − ρF) w > 0.
    pub bound: f64,
    /// Largest reflectance times row sum: what is left of light after each reflection, at most.
    pub contraction: f64,
    /// Sweeps, or shots.
    pub steps: usize,
    /// Power that is not accounted for, over the power put in: before the first sweep (or shot of each patch) and after each.
    pub history: Vec<f64>,
    /// Whether the tolerance was met.
    pub converged: bool,
}

impl Transport {
    /// Solves by Gauss–Seidel on the rows of the matrix, bands side by side; on a hierarchy, root by root with push and pull.
    /// `direct` is the irradiance that does not come from patches, in the order of patches, or empty for none.
    ///
    /// The residual's power falls with every sweep, by the contraction or more.
    ///
    /// # Errors
    /// [`RadiosityError::CountMismatch`] and [`RadiosityError::DirectIrradiance`] for `direct`, [`RadiosityError::NoEquilibrium`] where nothing bounds the error:
    /// a closed scene that absorbs nothing. [`RadiosityError::Option`].
    pub fn gauss_seidel(&self, direct: &[Rgb], options: &SolveOptions) -> Result<Solution, RadiosityError> {
        gauss_seidel::solve(self, direct, options)
    }

    /// Solves by shooting, most unshot power first; on a hierarchy by root. Good early, slower in the end than Gauss–Seidel.
    /// `importance` weighs the order, one entry for each patch, or is empty; [`Transport::importance`] gives it for a view.
    ///
    /// # Errors
    /// As [`Transport::gauss_seidel`], and [`RadiosityError::CountMismatch`] or [`RadiosityError::Importance`] for `importance`.
    pub fn progressive(
        &self,
        direct: &[Rgb],
        importance: &[f64],
        options: &SolveOptions,
    ) -> Result<Solution, RadiosityError> {
        progressive::solve(self, direct, importance, options)
    }

    /// How much each patch's radiosity matters for what is seen: the adjoint of light, I = S + F ρ I, where `seen` is
    /// how much of each patch the camera sees.
    ///
    /// # Errors
    /// [`RadiosityError::CountMismatch`] and [`RadiosityError::Importance`] for `seen`; else as [`Transport::gauss_seidel`].
    pub fn importance(&self, seen: &[f64], options: &SolveOptions) -> Result<Vec<f64>, RadiosityError> {
        importance::solve(self, seen, options)
    }
}

fn check(options: &SolveOptions) -> Result<(), RadiosityError> {
    if options.tolerance > 0.0 {
        return Ok(());
    }
    Err(RadiosityError::Option { name: "tolerance", value: options.tolerance, expected: "above 0" })
}

/// Checks weights of patches: one for each, all of them usable.
fn check_importance(patches: usize, importance: &[f64]) -> Result<(), RadiosityError> {
    if importance.len() != patches {
        return Err(RadiosityError::CountMismatch { patches, given: importance.len() });
    }
    match importance.iter().position(|&value| !is_light(value)) {
        Some(patch) => Err(RadiosityError::Importance { patch, value: importance[patch] }),
        None => Ok(()),
    }
}
