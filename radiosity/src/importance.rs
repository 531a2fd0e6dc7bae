//! What errors of light count on each patch, by how much of it a camera sees: refinement spends links where they show (\[11\]).

use glam::DVec3;

use crate::by_rays::surroundings::{LIFT, Surroundings};
use crate::error::RadiosityError;
use crate::rays::sequence::{lattice, point_of};
use crate::rgb::Rgb;
use crate::scene::{Scene, SceneOptions};
use crate::solve::SolveOptions;
use pointillist_parallel as parallel;

/// Points of a patch that are looked at, its corners apart.
const POINTS: u32 = 16;
/// Corners are looked at this share of the way to the centre: on an edge, rounding decides which of two surfaces hides the other.
const INWARD: f64 = 0.01;
/// Tolerance of the links by which importance is found. It decides how fine others are, within a factor that is far above its own error.
const COARSE: f64 = 0.3;
/// Tolerance of its solution.
const SOLVED_TO: f64 = 1e-3;
/// Links count at least this much: a link that is too coarse for anything would still spoil the sums of rows.
const LEAST: f64 = 1e-3;

impl Scene {
    /// The share of each patch that is seen from a position, 0 to 1, in the order of patches: of 16 points and the corners, those in front of which the
    /// position is, that `in_view` accepts and that no surface hides.
    ///
    /// # Errors
    /// [`RadiosityError::BadPoint`].
    pub fn seen_from(
        &self,
        eye: DVec3,
        in_view: &(dyn Fn(DVec3) -> bool + Sync),
    ) -> Result<Vec<f64>, RadiosityError> {
        if !eye.is_finite() {
            return Err(RadiosityError::BadPoint);
        }
        let (rays, eye) = (Surroundings::without_patches(self), self.inward(eye));
        let leaves = self.tree.leaves();
        Ok(parallel::map_heavy(leaves.len(), |i| {
            let polygon = &self.tree.elements[leaves[i] as usize].polygon;
            if polygon.height(eye) <= 0.0 {
                return 0.0;
            }
            let (ring, centre) = (polygon.vertices(), polygon.centre());
            let spread = (0..POINTS).map(|k| point_of(ring, lattice(k, [0.5; 2])));
            let points = || spread.clone().chain(ring.iter().map(|v| v.lerp(centre, INWARD)));
            let is_seen =
                |p: &DVec3| in_view(self.outward(*p)) && !rays.is_blocked(*p + polygon.normal() * LIFT, eye);
            points().filter(is_seen).count() as f64 / points().count() as f64
        }))
    }

    /// How much light on each patch contributes to what is seen, in the order of patches: `seen` itself, and what is seen of it by reflection,
    /// again and again. It is found by coarse links between the patches as they are now. `direct` is as for [`Scene::transport`].
    ///
    /// # Errors
    /// As [`Scene::transport`], and [`RadiosityError::Importance`] for `seen`.
    pub fn importance(&self, direct: &[Rgb], seen: &[f64]) -> Result<Vec<f64>, RadiosityError> {
        let mut coarse = self.clone();
        coarse.options =
            SceneOptions { tolerance: Some(COARSE), smallest_patch: f64::INFINITY, ..self.options };
        let transport = coarse.transport(direct)?;
        transport.importance(seen, &SolveOptions::DEFAULT.with_tolerance(SOLVED_TO))
    }

    /// Weights of the errors on all elements, at most 1: a group counts as much as the patch that counts most.
    pub(crate) fn weights(&self, importance: &[f64]) -> Vec<f64> {
        let mut weights = vec![LEAST; self.tree.elements.len()];
        for (&leaf, &value) in self.tree.leaves().iter().zip(importance) {
            weights[leaf as usize] = value.clamp(LEAST, 1.0);
        }
        for i in (0..weights.len()).rev() {
            // Children have larger indices than their parents.
            let children = self.tree.elements[i].children();
            weights[i] = children.fold(weights[i], |most, child| most.max(weights[child as usize]));
        }
        weights
    }
}
