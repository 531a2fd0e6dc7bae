//! Solvers of B = E + ρ (H + F B) for the radiosity B, with a bound on the error by the residual.

mod gauss_seidel;
mod importance;
mod options;
mod progressive;
mod solution;
mod state;

pub(crate) use importance::check_importance;
pub use options::SolveOptions;
pub use solution::Solution;

use crate::error::RadiosityError;
use crate::rgb::{Rgb, check_direct};
use crate::transport::Transport;

impl Transport {
    /// Solves by Gauss–Seidel on the rows of the matrix, bands side by side; on a hierarchy, root by root with push and pull.
    ///
    /// The residual's power falls with every sweep, by the contraction or more.
    ///
    /// # Errors
    /// [`RadiosityError::NoEquilibrium`] where nothing bounds the error: a closed scene that absorbs nothing. [`RadiosityError::Option`].
    pub fn gauss_seidel(&self, options: &SolveOptions) -> Result<Solution<'_>, RadiosityError> {
        gauss_seidel::solve(self, &[], options)
    }

    /// As [`Transport::gauss_seidel`], from the radiosity of each patch that was found before some materials or lamps were changed: few sweeps are left.
    ///
    /// # Errors
    /// As [`Transport::gauss_seidel`], and [`RadiosityError::CountMismatch`] or [`RadiosityError::DirectIrradiance`] for what `radiosity` says.
    pub fn gauss_seidel_from(
        &self,
        radiosity: &[Rgb],
        options: &SolveOptions,
    ) -> Result<Solution<'_>, RadiosityError> {
        if radiosity.len() != self.leaves.len() {
            return Err(RadiosityError::CountMismatch { patches: self.leaves.len(), given: radiosity.len() });
        }
        check_direct(self.leaves.len(), radiosity)?;
        gauss_seidel::solve(self, radiosity, options)
    }

    /// The solution that has this radiosity at each patch, whoever found it, with the bound on its error: to be baked, or looked at at free points.
    ///
    /// # Errors
    /// As [`Transport::gauss_seidel_from`].
    pub fn solution_of(&self, radiosity: &[Rgb]) -> Result<Solution<'_>, RadiosityError> {
        self.gauss_seidel_from(radiosity, &SolveOptions::DEFAULT.with_max_sweeps(0))
    }

    /// Solves by shooting, most unshot power first; on a hierarchy by root. Good early, slower in the end than Gauss–Seidel.
    /// `importance` weighs the order, one entry for each patch, or is empty; [`Transport::importance`] gives it for a view.
    ///
    /// # Errors
    /// As [`Transport::gauss_seidel`], and [`RadiosityError::CountMismatch`] or [`RadiosityError::Importance`] for `importance`.
    pub fn progressive(
        &self,
        importance: &[f64],
        options: &SolveOptions,
    ) -> Result<Solution<'_>, RadiosityError> {
        progressive::solve(self, importance, options)
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
