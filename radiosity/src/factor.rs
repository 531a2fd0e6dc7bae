//! Form factors of single pairs.

use crate::Polygon;
use crate::kernel::pair::{self, Mutual};
use crate::visible::cubature::{self, Goal};
use crate::visible::parts::Pieces;

/// Least depth of the cells of a single pair: with fewer levels, two that agree by chance would end refinement.
const SINGLE_DEPTH: u8 = 2;

/// The share of the power that leaves one polygon diffusely and arrives at another.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FormFactor {
    /// Between 0 and 1.
    pub value: f64,
    /// Bound on the absolute error: that of quadrature, estimated from the geometry where nothing is between and from the last
    /// refinement where something is, and rounding.
    pub error: f64,
}

/// How accurate a form factor shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FactorOptions {
    /// Relative error where nothing is between. Default: 1e-11. Rounding allows about 1e-14, less far away.
    pub unoccluded: f64,
    /// Relative error where something is. Default: 1e-5.
    pub occluded: f64,
    /// Absolute error that is accepted past occluders, whatever the relative error: a pair that is nearly hidden needs few digits.
    /// Default: 1e-9.
    pub absolute: f64,
    /// Most cells that are sampled for one pair. If they do not suffice, [`FormFactor::error`] is above what was asked for. Default: 20,000.
    pub max_cells: usize,
}

impl FactorOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self { unoccluded: 1e-11, occluded: 1e-5, absolute: 1e-9, max_cells: 20_000 };

    /// Another relative error where nothing is between.
    #[must_use]
    pub const fn with_unoccluded(mut self, relative: f64) -> Self {
        self.unoccluded = relative;
        self
    }

    /// Another relative error where something is between.
    #[must_use]
    pub const fn with_occluded(mut self, relative: f64) -> Self {
        self.occluded = relative;
        self
    }

    /// Another absolute error that is good enough where something is between.
    #[must_use]
    pub const fn with_absolute(mut self, absolute: f64) -> Self {
        self.absolute = absolute;
        self
    }

    /// Another limit of cells.
    #[must_use]
    pub const fn with_max_cells(mut self, cells: usize) -> Self {
        self.max_cells = cells;
        self
    }

    /// For a pair whose first polygon has this area, each cell halved at least so often.
    pub(crate) fn goal(&self, area: f64, least_depth: u8) -> Goal {
        Goal {
            unoccluded: self.unoccluded.max(1e-15),
            relative: self.occluded,
            absolute: self.absolute * area,
            max_cells: self.max_cells,
            least_depth,
        }
    }
}

impl Default for FactorOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The form factor from the front of `from` to the front of `to`, past `occluders`, which hide from both sides.
///
/// Parts of `occluders` beside, behind or in the plane of the two polygons are ignored. Coordinates are moved and scaled first, so that
/// neither a distant origin nor the unit of length matters.
///
/// Where nothing is between, the error is about that of [`FactorOptions::unoccluded`], also for polygons that touch.
#[must_use]
pub fn form_factor(
    from: &Polygon,
    to: &Polygon,
    occluders: &[Polygon],
    options: &FactorOptions,
) -> FormFactor {
    let size = (from.centre() - to.centre()).length() + from.radius() + to.radius();
    // A power of two: exact.
    let scale = 2.0_f64.powi(-(size.log2().ceil() as i32));
    let near = |p: &Polygon| p.moved(-from.centre(), scale);
    let (a, b) = (near(from), near(to));
    let goal = options.goal(a.area(), SINGLE_DEPTH);
    let mutual = if occluders.is_empty() {
        pair::mutual(&a, &b, goal.unoccluded)
    } else {
        let all: Vec<Polygon> = occluders.iter().map(near).collect();
        let all: Vec<&Polygon> = all.iter().collect();
        cubature::mutual(&a, &b, &all, goal, &mut Pieces::default()).0
    };
    of_mutual(mutual, a.area())
}

pub(crate) fn of_mutual(mutual: Mutual, area: f64) -> FormFactor {
    FormFactor { value: (mutual.value / area).min(1.0), error: mutual.error / area }
}
