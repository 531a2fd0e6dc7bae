//! Links: exchanges between two elements, and what was skipped on the way to them.

use crate::tree::ElementId;

/// An exchange between two elements.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) a: ElementId,
    pub(crate) b: ElementId,
    /// Area of `a` times form factor from it to `b`, and the same the other way; in scene units.
    pub(crate) mutual: f64,
    /// Absolute error of `mutual`.
    pub(crate) error: f64,
    /// Range of the list of occluders; empty where nothing is between.
    pub(crate) between: (u32, u32),
}

/// Unoccluded links by the rule that computed them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RuleCounts {
    /// Quadrature over both areas.
    pub areas: usize,
    /// Lambert's formula at points of one of the two.
    pub points: usize,
    /// Contour integrals.
    pub contours: usize,
}

/// Counts of links by kind, of pairs that were skipped by reason, and of errors by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LinkCounts {
    /// Links: pairs of patches, or of groups of them, that exchange light.
    pub links: usize,
    /// Links with occluders between their elements.
    pub partly_hidden: usize,
    /// Partly hidden links whose form factor was kept from before ([`Scene::transport_after`](crate::Scene::transport_after)).
    pub kept: usize,
    /// Unoccluded links, by the rule that computed them.
    pub by_rule: RuleCounts,
    /// Pairs skipped because no part of one is in front of the other.
    pub facing_apart: usize,
    /// Pairs skipped because one neither emits nor reflects.
    pub black: usize,
    /// Pairs skipped because a single surface hides one from the other entirely.
    pub hidden: usize,
    /// Pairs skipped because their form factors are below the bound of the options.
    pub below_bound: usize,
    /// The largest sum of form factors that any patch lost to that bound.
    pub left_out: f64,
    /// The largest amount by which the form factors of any patch add up to more than 1, before any scaling.
    pub row_excess: f64,
    /// The largest relative amount by which a row was scaled so that none adds up to more than 1.
    pub row_change: f64,
    /// Cells that were sampled to find what partly hidden pairs exchange.
    pub cells: usize,
}

impl std::ops::AddAssign for LinkCounts {
    fn add_assign(&mut self, o: Self) {
        self.links += o.links;
        self.partly_hidden += o.partly_hidden;
        self.kept += o.kept;
        self.by_rule.areas += o.by_rule.areas;
        self.by_rule.points += o.by_rule.points;
        self.by_rule.contours += o.by_rule.contours;
        self.facing_apart += o.facing_apart;
        self.black += o.black;
        self.hidden += o.hidden;
        self.below_bound += o.below_bound;
        self.cells += o.cells;
    }
}
