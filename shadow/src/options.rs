//! Options of a light.

use pointillist_micropoint::Occlusion;

/// How fine the light grid is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Resolution {
    /// As the receivers need it: a light cell is about as large as a receiver.
    #[default]
    Auto,
    /// This many cells per side of a light screen, 1..=2²⁰.
    Cells(u32),
}

/// Options of a light: the occlusion rule, and the resolution of its grid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShadowOptions {
    /// How casters in one light cell hide a receiver. Default: [`Occlusion::Correlated`], which is exact.
    pub occlusion: Occlusion,
    /// Size of the light cells. Default: [`Resolution::Auto`]. It changes the result under [`Occlusion::Paper`] only; under
    /// the correlated rule the grid merely sorts casters.
    pub resolution: Resolution,
    /// What a receiver gets through several masks is computed in as many pieces as it is larger than a square of which so many are on a side of
    /// one of the viewer's cells: 1, 2 or 4. Default: 4. Masks are taken to be independent within a piece.
    pub squares_under_masks: u32,
}

impl Default for ShadowOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl ShadowOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self =
        Self { occlusion: Occlusion::Correlated, resolution: Resolution::Auto, squares_under_masks: 4 };

    /// Sets the occlusion rule.
    #[must_use]
    pub const fn with_occlusion(mut self, occlusion: Occlusion) -> Self {
        self.occlusion = occlusion;
        self
    }

    /// Sets the resolution of the light grid.
    #[must_use]
    pub const fn with_resolution(mut self, resolution: Resolution) -> Self {
        self.resolution = resolution;
        self
    }

    /// Sets how many pieces behind several masks are on a side of a cell.
    #[must_use]
    pub const fn with_squares_under_masks(mut self, squares: u32) -> Self {
        self.squares_under_masks = squares;
        self
    }
}
