//! The nodes that a view needs.

use crate::cube::Cube;
use crate::tree::Tree;
use glam::DVec3;
use pointillist_view::{Projection, View};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// How finely a view is served.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CutOptions {
    /// Nodes are opened until neighbouring points are at most this many pixels apart. Default: 1.
    pub spacing_px: f64,
    /// Most points of all nodes together. Default: `u64::MAX`.
    pub most_points: u64,
    /// Points outside the picture count as seen up to so many pixels from its edge: their discs, or their blur, reach into it. Default: 16.
    pub margin_px: f64,
}

impl CutOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self { spacing_px: 1.0, most_points: u64::MAX, margin_px: 16.0 };

    /// Sets how many pixels neighbouring points may be apart; above 0.
    #[must_use]
    pub const fn with_spacing_px(mut self, spacing_px: f64) -> Self {
        self.spacing_px = spacing_px;
        self
    }

    /// Sets how many points there may be.
    #[must_use]
    pub const fn with_most_points(mut self, most_points: u64) -> Self {
        self.most_points = most_points;
        self
    }

    /// Sets how far outside the picture points count as seen.
    #[must_use]
    pub const fn with_margin_px(mut self, margin_px: f64) -> Self {
        self.margin_px = margin_px;
        self
    }
}

impl Default for CutOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Nodes for a view, the coarsest and nearest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cut {
    /// Number of the tree, and of the node in it. A node comes after the one around it.
    pub nodes: Vec<(usize, u32)>,
    /// Points in them.
    pub points: u64,
    /// How many pixels points are apart at most, where the cut is coarsest: at most [`CutOptions::spacing_px`] unless points ran out, or were too many.
    pub spacing_px: f64,
    /// Whether [`CutOptions::most_points`] ended it.
    pub is_limited: bool,
}

/// A node that is still to be taken.
struct Candidate {
    /// Pixels between points of the node around it: what is wrong with the picture as long as this one is missing.
    gap_px: f64,
    tree: usize,
    node: u32,
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Candidate {}
impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        // The lower number first where gaps are equal.
        self.gap_px.total_cmp(&other.gap_px).then((other.tree, other.node).cmp(&(self.tree, self.node)))
    }
}

/// Chooses the nodes of some trees that a view needs: those that are in view, from the roots down to where points are close enough, the widest gap in
/// the picture first. A cut with fewer points is the beginning of one with more.
#[must_use]
pub fn cut(trees: &[&Tree], view: &View, options: &CutOptions) -> Cut {
    let roots = trees
        .iter()
        .enumerate()
        .filter_map(|(tree, t)| t.root().map(|node| Candidate { gap_px: f64::INFINITY, tree, node }));
    let mut open: BinaryHeap<Candidate> = roots.collect();
    let mut cut = Cut::default();
    while let Some(candidate) = open.pop() {
        let tree = trees[candidate.tree];
        let node = tree.nodes()[candidate.node as usize];
        let cube = tree.cube().of(node.key);
        let Some(depth) = nearest_depth(view, cube, options.margin_px) else { continue };
        let points = cut.points.saturating_add(node.count);
        if points > options.most_points {
            cut.is_limited = true;
            cut.spacing_px = cut.spacing_px.max(candidate.gap_px);
            break;
        }
        cut.points = points;
        cut.nodes.push((candidate.tree, candidate.node));
        let gap_px = tree.spacing(candidate.node) * pixels_per_unit(view, depth);
        if gap_px > options.spacing_px {
            let tree_number = candidate.tree;
            open.extend(tree.children(candidate.node).map(|node| Candidate {
                gap_px,
                tree: tree_number,
                node,
            }));
        } else {
            cut.spacing_px = cut.spacing_px.max(gap_px);
        }
    }
    cut
}

/// Whether a cube may be in view.
pub(crate) fn is_seen(view: &View, cube: Cube, margin_px: f64) -> bool {
    nearest_depth(view, cube, margin_px).is_some()
}

/// Pixels that a length of 1 takes at a depth.
fn pixels_per_unit(view: &View, depth: f64) -> f64 {
    match view.projection() {
        Projection::Perspective { .. } => view.focal_px() / depth,
        Projection::Orthographic { .. } => view.focal_px(),
    }
}

/// The depth of what is nearest in a cube, at least a tiny one; nothing if the cube is out of view. Its ball decides: a cube that is near the edge of the
/// picture may count as seen without being it.
fn nearest_depth(view: &View, cube: Cube, margin_px: f64) -> Option<f64> {
    let radius = 0.5 * cube.side * 3f64.sqrt();
    let from_eye = cube.low + DVec3::splat(0.5 * cube.side) - view.eye();
    let depth = from_eye.dot(view.forward());
    let half = [f64::from(view.width()), f64::from(view.height())]
        .map(|pixels| (0.5 * pixels + margin_px) / view.focal_px());
    let across = [from_eye.dot(view.right()).abs(), from_eye.dot(view.up()).abs()];
    match view.projection() {
        Projection::Perspective { .. } => {
            // Distance from the plane through the eye and the edge of the picture, whose slope is `half`.
            let outside = |(across, slope): (f64, f64)| (across - slope * depth) / slope.hypot(1.0) > radius;
            let behind = depth + radius <= 0.0;
            if behind || across.into_iter().zip(half).any(outside) {
                return None;
            }
            // The eye itself may be in the cube.
            Some((depth - radius).max(1e-6 * cube.side))
        }
        Projection::Orthographic { .. } => {
            let outside = across.into_iter().zip(half).any(|(across, half)| across - half > radius);
            (!outside).then_some(depth - radius)
        }
    }
}
