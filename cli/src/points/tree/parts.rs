//! Points that are ready to be drawn, octant by octant of nodes, so that views share them.
//!
//! What is estimated for a point depends on its neighbours. For each octant of a node for which a view has nothing deeper (a [`Region`]), the points
//! in it, of the node and of those around it, are made ready once, with the points around the octant: then neither which other nodes a view
//! has nor what was drawn before shows, and no seams do. A view joins the octants that it needs.

use super::Trees;
use crate::input_error::InputError;
use crate::points::cloud::PointSet;
use crate::points::colouring::Legend;
use glam::DVec3;
use pointillist_octree::{Cube, Neighbourhood, Region};
use pointillist_surfel::{Cloud, Division, NO_PART};
use rayon::prelude::*;
use std::sync::Arc;

/// Points around an octant that are looked at, in distances of its points: what is estimated from 64 neighbours reaches 5 of them.
const AROUND: f64 = 6.0;

/// Octants whose points are made ready at once, on all cores.
const AT_ONCE: usize = 64;

/// Points in an octant, ready to be drawn.
#[derive(Debug)]
pub(super) struct Part {
    /// Nothing if there is no point.
    cloud: Option<Cloud>,
    legend: Option<Legend>,
}

impl Part {
    fn bytes(&self) -> u64 {
        size_of::<Self>() as u64 + self.cloud.as_ref().map_or(0, |cloud| cloud.bytes() as u64)
    }
}

/// Points in and around an octant.
struct Gathered {
    set: PointSet,
    /// 0 for those in it, or [`NO_PART`].
    parts: Vec<u8>,
    division: Division,
    legend: Option<Legend>,
}

impl Gathered {
    fn made_ready(&self, estimate_normals: bool) -> Result<Part, InputError> {
        let is_empty = self.parts.iter().all(|&part| part == NO_PART);
        let cloud = if is_empty {
            None
        } else {
            self.set.parts(estimate_normals, &self.parts, &self.division)?.pop().flatten()
        };
        Ok(Part { cloud, legend: self.legend.clone() })
    }
}

/// An octant of a node of a tree, as parts are kept by.
fn id(tree: usize, node: u32, octant: usize) -> (usize, u32) {
    (8 * tree + octant, node)
}

impl Trees {
    /// The points of regions, ready to be drawn, and what their colours mean; nothing if there are none. `done` is told how many
    /// more octants are ready, of how many that had to be made so.
    ///
    /// # Errors
    ///
    /// [`InputError`] for a node that is damaged, or points that cannot be used.
    pub fn ready(
        &mut self,
        regions: &[Region],
        estimate_normals: bool,
        done: &mut dyn FnMut(u64, u64),
    ) -> Result<Option<(Cloud, Option<Legend>)>, InputError> {
        // Some of the clouds may have normals of their own.
        let estimate_normals = estimate_normals || !self.clouds.iter().all(|cloud| cloud.has_normals());
        let octants = |region: &Region| {
            let Region { tree, node, octants } = *region;
            (0..8).filter(move |octant| octants >> octant & 1 == 1).map(move |octant| (tree, node, octant))
        };
        let wanted: Vec<(usize, u32, usize)> = regions.iter().flat_map(octants).collect();
        let mut parts: Vec<Option<Arc<Part>>> =
            wanted.iter().map(|&(tree, node, octant)| self.parts.get(id(tree, node, octant))).collect();
        let missing: Vec<usize> = (0..wanted.len()).filter(|&i| parts[i].is_none()).collect();
        self.parts_made += missing.len() as u64;
        self.parts_kept += (wanted.len() - missing.len()) as u64;
        for numbers in missing.chunks(AT_ONCE) {
            let gathered: Vec<Gathered> =
                numbers.iter().map(|&i| self.gathered(wanted[i])).collect::<Result<_, _>>()?;
            let made: Vec<Part> =
                gathered.par_iter().map(|all| all.made_ready(estimate_normals)).collect::<Result<_, _>>()?;
            for (&i, part) in numbers.iter().zip(made) {
                let (tree, node, octant) = wanted[i];
                let (bytes, part) = (part.bytes(), Arc::new(part));
                self.parts.insert(id(tree, node, octant), Arc::clone(&part), bytes);
                parts[i] = Some(part);
            }
            done(numbers.len() as u64, missing.len() as u64);
        }
        let parts: Vec<Arc<Part>> = parts.into_iter().flatten().collect();
        let drawn: Vec<&Cloud> = parts.iter().filter_map(|part| part.cloud.as_ref()).collect();
        if drawn.is_empty() {
            return Ok(None);
        }
        let cloud = Cloud::join(&drawn).map_err(|error| {
            InputError::of_file(&self.clouds[0].name, error.to_string())
                .with_help("a smaller --memory draws fewer points")
        })?;
        let legend = Legend::merged(parts.iter().filter_map(|part| part.legend.as_ref()));
        Ok(Some((cloud, legend)))
    }

    /// The points that an octant of a node needs.
    fn gathered(&mut self, (tree_number, node, octant): (usize, u32, usize)) -> Result<Gathered, InputError> {
        let tree = self.clouds[tree_number].tree();
        let near = Neighbourhood::of(tree, node, octant, AROUND);
        let (nodes, spacing) = (near.nodes(tree), tree.spacing(node));
        let Cube { low, side } = self.cube();
        let mut set = PointSet::of_file(&self.clouds[tree_number].path, tree_number);
        let (mut parts, mut chosen, mut legend) = (vec![], vec![], None);
        for node in nodes {
            let points = self.node(tree_number, node)?;
            chosen.clear();
            for (number, position) in points.set.positions().enumerate() {
                let Some(is_own) = near.holds(position) else { continue };
                chosen.push(number as u32);
                parts.push(if is_own { 0 } else { NO_PART });
            }
            if !chosen.is_empty() {
                set.add_chosen(&points.set, &chosen);
                legend = Legend::merged(legend.iter().chain(&points.legend));
            }
        }
        Ok(Gathered { set, parts, division: Division { low, side, spacing }, legend })
    }

    /// The cube around all trees.
    fn cube(&self) -> Cube {
        let cubes: Vec<Cube> = self.clouds.iter().map(|cloud| cloud.tree().cube()).collect();
        if let [only] = cubes[..] {
            return only;
        }
        let low = cubes.iter().fold(DVec3::INFINITY, |low, cube| low.min(cube.low));
        let high = cubes.iter().fold(DVec3::NEG_INFINITY, |high, cube| high.max(cube.low + cube.side));
        Cube { low, side: (high - low).max_element() }
    }
}
