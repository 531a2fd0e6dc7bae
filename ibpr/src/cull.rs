//! Selects the blocks that a frame draws.

use crate::buffer_map::depth_of;
use crate::cloud::Cloud;
use crate::frame::FrameCounts;
use crate::options::Culling;
use crate::prepared::Block;
use glam::DVec3;
use pointillist_view::{Projection, View};
use std::f64::consts::{FRAC_PI_2, PI};

/// Incidence up to which a scanner measures (the paper's observation).
const MOST_INCIDENCE_RAD: f64 = 75.0 * PI / 180.0;

/// Depths and numbers of points of the blocks in view, whether they face away or not.
pub(crate) fn depths(cloud: &Cloud, view: &View, depths: &mut Vec<(f64, usize)>) {
    let frustum = Frustum::new(view, 0.0);
    let in_view = cloud.blocks.iter().filter(|block| !frustum.misses(block));
    depths.clear();
    depths.extend(in_view.map(|block| (depth_of(view, block.origin), block.points.len())));
}

/// Indices of the blocks that may be seen in the picture or up to `margin` picture pixels beside it, in the cloud's order.
pub(crate) fn visible(
    cloud: &Cloud,
    view: &View,
    margin: f64,
    culling: Culling,
    blocks: &mut Vec<u32>,
    counts: &mut FrameCounts,
) {
    blocks.clear();
    let frustum = Frustum::new(view, margin);
    for (i, block) in cloud.blocks.iter().enumerate() {
        let skipped = if frustum.misses(block) {
            &mut counts.blocks_outside
        } else if faces_away(block, view, culling) {
            &mut counts.blocks_facing_away
        } else {
            blocks.push(i as u32);
            counts.blocks += 1;
            counts.points += block.points.len();
            continue;
        };
        *skipped += 1;
        counts.points_skipped += block.points.len();
    }
}

/// Half-spaces that hold the view and its margin: n·(p − eye) ≥ offset.
struct Frustum {
    eye: DVec3,
    planes: [(DVec3, f64); 5],
}

impl Frustum {
    fn new(view: &View, margin: f64) -> Self {
        let half = |pixels: u32| (0.5 * f64::from(pixels) + margin) / view.focal_px();
        let (x, y) = (half(view.width()), half(view.height()));
        let (r, u, f) = (view.right(), view.up(), view.forward());
        let sides = match view.projection() {
            Projection::Perspective { .. } => {
                [(x * f + r, 0.0), (x * f - r, 0.0), (y * f + u, 0.0), (y * f - u, 0.0)]
            }
            Projection::Orthographic { .. } => [(r, -x), (-r, -x), (u, -y), (-u, -y)],
        };
        let [a, b, c, d] = sides;
        Self { eye: view.eye(), planes: [a, b, c, d, (f, 0.0)] }
    }

    fn misses(&self, block: &Block) -> bool {
        let centre = block.origin - self.eye;
        let half = block.half.as_dvec3() * block.unit;
        self.planes.iter().any(|(n, offset)| n.dot(centre) + n.abs().dot(half) < *offset)
    }
}

/// From the block to the eye: unit direction, and the angle that the block's own size adds.
fn towards_eye(block: &Block, view: &View) -> (DVec3, f64) {
    match view.projection() {
        Projection::Orthographic { .. } => (-view.forward(), 0.0),
        Projection::Perspective { .. } => {
            let to_eye = view.eye() - block.origin;
            let (distance, radius) = (to_eye.length(), block.half.as_dvec3().length() * block.unit);
            // For an eye inside the block, all directions occur.
            let spread = if distance > radius { (radius / distance).asin() } else { PI };
            (to_eye / distance.max(f64::MIN_POSITIVE), spread)
        }
    }
}

fn faces_away(block: &Block, view: &View, culling: Culling) -> bool {
    let (to_eye, spread) = towards_eye(block, view);
    let angle_to = |axis: DVec3| axis.dot(to_eye).clamp(-1.0, 1.0).acos();
    let scan_beyond = |angle: f64| block.towards_scanner.is_some_and(|d| angle_to(d) > angle + spread);
    match culling {
        Culling::None => false,
        Culling::Printed => block.towards_scanner.is_some_and(|d| d.dot(-view.forward()) < 0.0),
        Culling::Scans => scan_beyond(FRAC_PI_2 + MOST_INCIDENCE_RAD),
        // Not by its scan, where a block has no cone: the steepest points of a scan that faces away by 165°
        // touch the rim from behind, and are averaged with what is seen there.
        Culling::Blocks => block
            .cone
            .is_some_and(|c| angle_to(c.axis.as_dvec3()) > FRAC_PI_2 + f64::from(c.half_angle) + spread),
    }
}
