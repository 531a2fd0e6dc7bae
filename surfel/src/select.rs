//! Which nodes of the octree a frame draws: in view, not facing away, coarse enough.

use crate::camera::{Camera, REACH};
use crate::cloud::Cloud;
use crate::frame::FrameCounts;
use crate::grid::TileRect;
use crate::node::Node;
use crate::options::Options;
use crate::spacing::{Angles, Depths, REACH_ROUNDED_UP, largest_spacing};
use crate::splat::{DEVIATION_PER_RADIUS, NEAREST_PLANE2, PIXEL_DEVIATION};
use std::f32::consts::FRAC_PI_2;

/// A node to draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Selected {
    pub(crate) node: u32,
    /// Its place among all that were selected.
    pub(crate) place: u32,
    /// First and last pixels of all that it draws, within the picture.
    pub(crate) x: [u16; 2],
    pub(crate) y: [u16; 2],
    /// How far from its centre any disc of it may touch pixels.
    pub(crate) margin: f32,
    /// Whether pairs of its items are drawn as one.
    pub(crate) in_pairs: bool,
    /// Lower bound of the bent depths of all that it draws.
    pub(crate) nearest: f32,
    /// Upper bound, as a bent depth, of how far behind the nearest disc these may lie and belong to the same surface.
    pub(crate) thickness: f32,
}

impl Selected {
    /// Whether some of its parts are in some of the pixels.
    pub(crate) fn meets(&self, rect: &TileRect) -> bool {
        let meets = |ends: [u16; 2], from: usize, size: usize| {
            usize::from(ends[0]) < from + size && usize::from(ends[1]) >= from
        };
        meets(self.y, rect.y, rect.height) && meets(self.x, rect.x, rect.width)
    }
}

/// Walks the tree from its root and lists what is to be drawn in `tiles`, the nearest nodes first.
pub(crate) fn select(
    cloud: &Cloud,
    camera: &Camera,
    options: &Options,
    tiles: &TileRect,
    (selected, stack): (&mut Vec<Selected>, &mut Vec<u32>),
    counts: &mut FrameCounts,
) {
    selected.clear();
    stack.clear();
    stack.push(0);
    while let Some(number) = stack.pop() {
        let node = &cloud.nodes[number as usize];
        let depths = Depths::of(node, camera);
        let angles = Angles::of(node, camera);
        let spacing = largest_spacing(&depths, &angles, camera, options.level);
        let in_pairs = node.pairs > 0 && node.spacing_of_pairs() <= spacing;
        let widest = if in_pairs { node.widest_of_pairs() } else { node.widest };
        let Some(seen) = Seen::of(node, &depths, widest, camera) else {
            counts.nodes_outside += 1;
            continue;
        };
        if options.culling && angles.least_rad > FRAC_PI_2 {
            counts.nodes_facing_away += 1;
            continue;
        }
        if !node.is_leaf() && (node.is_bare() || node.spacing > spacing) {
            stack.extend(node.children.clone());
            continue;
        }
        let Seen { x, y, margin, nearest, thickness, .. } = seen;
        let found = Selected { node: number, place: 0, x, y, margin, in_pairs, nearest, thickness };
        if !found.meets(tiles) {
            counts.nodes_outside += 1;
            continue;
        }
        let drawn = if in_pairs { node.count_in_pairs() } else { node.items.len() };
        counts.nodes += 1;
        counts.points += drawn;
        counts.links += if node.is_leaf() { 0 } else { drawn };
        selected.push(found);
    }
    selected.sort_unstable_by(|a, b| a.nearest.total_cmp(&b.nearest).then(a.node.cmp(&b.node)));
    selected.iter_mut().zip(0..).for_each(|(s, place)| s.place = place);
}

/// A node on the picture.
struct Seen {
    x: [u16; 2],
    y: [u16; 2],
    margin: f32,
    nearest: f32,
    thickness: f32,
}

impl Seen {
    /// `None` if nothing of it, with discs up to a radius of `widest`, falls onto the picture.
    fn of(node: &Node, &Depths(depths): &Depths, widest: f32, camera: &Camera) -> Option<Self> {
        if depths[1] <= camera.near {
            return None;
        }
        let middle = camera.local(node);
        let half = node.half;
        let reach = camera.axes.map(|axis| axis.abs().dot(half) * REACH_ROUNDED_UP);
        let nearest_point = depths[0].max(camera.near);
        let blur_radius = camera.blur_radius(nearest_point).max(camera.blur_radius(depths[1]));
        let scale = camera.pixels_per_unit(nearest_point);
        let deviation = DEVIATION_PER_RADIUS * widest;
        // Planes that come towards the eye look longer there: see `ends` in `ellipse.rs`, where this is 1/(1 − √τ).
        let towards_eye = camera.plane_reach(widest, blur_radius) * scale / camera.focal;
        let growth =
            if camera.is_perspective { 1.0 / (1.0 - towards_eye.min(NEAREST_PLANE2.sqrt())) } else { 1.0 };
        let axis = |i: usize| {
            let [low, high] = interval(middle[i] as f32, reach[i], depths, camera);
            // Discs off the axis look longer than they are.
            let slope = low.abs().max(high.abs()) / camera.focal;
            let stretch = if camera.is_perspective { (1.0 + slope * slope).sqrt() } else { 1.0 };
            let blur = 0.5 * REACH * blur_radius * scale;
            let margin = (REACH * (deviation * scale * stretch + PIXEL_DEVIATION) + blur) * growth + 1.0;
            let size = if i == 0 { camera.view.width() } else { camera.view.height() };
            let centre = camera.centre[i] as f32;
            let (first, last) = (low + centre - margin, high + centre + margin);
            let inside = last >= 0.0 && first < size as f32;
            inside.then(|| ([first.max(0.0) as u16, last.min(size as f32 - 1.0) as u16], margin))
        };
        let ((x, x_margin), (y, y_margin)) = (axis(0)?, axis(1)?);
        let margin = x_margin.max(y_margin);
        let before = (nearest_point - camera.plane_reach(deviation, blur_radius)).max(camera.near);
        let inverse = 1.0 / (nearest_point + camera.reference as f32);
        let thickness =
            camera.thickness(widest, f32::INFINITY, 1.0 / scale, blur_radius) * camera.bending(inverse);
        // Rounding of what is drawn, relative to its largest number.
        let slack = 1e-5 * (before.abs() + camera.bent(before).abs());
        Some(Self { x, y, margin, nearest: camera.bent(before) - slack, thickness: thickness + slack })
    }
}

/// Least and largest distance of a box from the principal point in pixels, along one axis of the picture.
fn interval(middle: f32, reach: f32, depths: [f32; 2], camera: &Camera) -> [f32; 2] {
    if !camera.is_perspective {
        return [(middle - reach) * camera.focal, (middle + reach) * camera.focal];
    }
    if depths[0] <= camera.near {
        // Part of it lies beside the eye: it may be seen anywhere.
        return [-1e9, 1e9];
    }
    let [near, far] = depths.map(|d| camera.focal / (d + camera.reference as f32));
    let (low, high) = (middle - reach, middle + reach);
    [low * if low < 0.0 { near } else { far }, high * if high > 0.0 { near } else { far }]
}
