//! The result of a solver.

use crate::rgb::{Rgb, add};
use crate::transport::Transport;

/// Radiosity of all patches of a transport, with a bound on its error.
///
/// It borrows the transport that it solves, so that light cannot be gathered by the links of another one.
#[derive(Clone)]
#[non_exhaustive]
pub struct Solution<'t> {
    /// What was solved.
    pub(crate) transport: &'t Transport,
    /// Radiosity of every element of the tree, as links see it.
    pub(crate) of_element: Vec<Rgb>,
    /// The same, as free points see it: means by area alone.
    pub(crate) by_area: Vec<Rgb>,
    /// Radiosity of each patch, power per area.
    pub radiosity: Vec<Rgb>,
    /// Bound on the error of any patch's radiosity, for the given form factors: ‖r‖∞ / (1 − max ρ·row sum), or where rows add
    /// up to more than 1, max w · max |r|/v for a w > 0 with v = (I − ρF) w > 0.
    pub bound: f64,
    /// Largest product of reflectance and row sum: a bound on the share of the light that remains after each reflection.
    pub contraction: f64,
    /// Number of sweeps (Gauss–Seidel) or of shots (progressive).
    pub steps: usize,
    /// Power that is not accounted for, over the power put in: before the first sweep (or shot of each patch) and after each.
    pub history: Vec<f64>,
    /// Whether the tolerance was met.
    pub converged: bool,
}

impl std::fmt::Debug for Solution<'_> {
    /// Without the transport and its links, which are long.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Solution")
            .field("radiosity", &self.radiosity)
            .field("bound", &self.bound)
            .field("contraction", &self.contraction)
            .field("steps", &self.steps)
            .field("history", &self.history)
            .field("converged", &self.converged)
            .finish_non_exhaustive()
    }
}

/// Means by area of all elements, of values that are right at the leaves.
pub(super) fn by_area(transport: &Transport, of_element: &[Rgb]) -> Vec<Rgb> {
    let mut means = of_element.to_vec();
    let elements = &transport.scene.tree.elements;
    // Children come after their parents.
    for (i, element) in elements.iter().enumerate().rev().filter(|(_, e)| !e.is_leaf()) {
        let (mut sum, mut area) = ([0.0; 3], 0.0);
        for child in element.children() {
            let own = elements[child as usize].polygon.area();
            sum = add(sum, own, means[child as usize]);
            area += own;
        }
        means[i] = sum.map(|s| s / area);
    }
    means
}

impl<'t> Solution<'t> {
    /// The transport that was solved.
    #[must_use]
    pub const fn transport(&self) -> &'t Transport {
        self.transport
    }

    /// Mean irradiance of one patch from all others, by its links.
    ///
    /// # Panics
    /// If there is no patch of this index.
    #[must_use]
    pub fn gathered_by(&self, index: usize) -> Rgb {
        let transport = self.transport;
        let mut sum = [0.0; 3];
        let mut element = Some(transport.leaves[index]);
        let mut share = transport.scale[index];
        while let Some(id) = element {
            for entry in transport.row(id) {
                sum = add(sum, entry.factor * share, self.of_element[entry.to as usize]);
            }
            share *= transport.shares[id as usize];
            element = transport.parents[id as usize];
        }
        sum
    }
}
