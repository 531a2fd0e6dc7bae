//! Options of the solvers.

use crate::error::RadiosityError;

/// Options of the solvers: when to stop, and which accelerations to use.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SolveOptions {
    /// Stops when the bound on the error of every patch's radiosity is below this share of the largest radiosity.
    /// Default: 1e-6.
    pub tolerance: f64,
    /// Most sweeps over all patches, or as many shots as that many sweeps would be. Default: 10,000.
    pub max_sweeps: usize,
    /// Gauss–Seidel: whether each sweep ends with a uniform correction that balances the energy of the whole scene. It saves most of the
    /// sweeps in bright closed rooms, and is applied only where it lowers the residual. Default: true.
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

impl SolveOptions {
    pub(crate) fn check(&self) -> Result<(), RadiosityError> {
        if self.tolerance > 0.0 {
            return Ok(());
        }
        Err(RadiosityError::Option { name: "tolerance", value: self.tolerance, expected: "above 0" })
    }
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}
