//! Which nodes of the octree a frame draws: in view, not facing away, coarse enough.

use crate::camera::{Camera, REACH};
use crate::cloud::{Cloud, Node};
use crate::frame::FrameCounts;
use crate::options::Options;
use crate::splat::{DEVIATION_PER_RADIUS, PIXEL_DEVIATION};
use std::f32::consts::{FRAC_PI_2, PI};

/// Points with a blur of radius R may be 1.3 + 0.4·R apart (pixels), but never more than 0.5·R. Found by experiment: wider apart
/// they show as dots.
const BLURRED_START: f32 = 1.3;
const BLURRED_SLOPE: f32 = 0.4;
const BLURRED_MOST: f32 = 0.5;

/// Between the levels of the tree, of blurred points down to a fourth is drawn, for all.
const MOST_THINNING: f32 = 4.0;

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
    /// How many of its items are drawn, for all.
    pub(crate) drawn: u32,
    /// Nothing of it has a smaller bent depth.
    pub(crate) nearest: f32,
    /// Nor does anything belong to a surface farther before it than this.
    pub(crate) thickness: f32,
}

/// Walks the tree from its root. The nearest nodes come first.
pub(crate) fn select(
    cloud: &Cloud,
    camera: &Camera,
    options: &Options,
    selected: &mut Vec<Selected>,
    stack: &mut Vec<u32>,
    counts: &mut FrameCounts,
) {
    selected.clear();
    stack.clear();
    stack.push(0);
    while let Some(number) = stack.pop() {
        let node = &cloud.nodes[number as usize];
        let Some(seen) = Seen::of(node, camera) else {
            counts.nodes_outside += 1;
            continue;
        };
        if options.culling && faces_away(node, camera) {
            counts.nodes_facing_away += 1;
            continue;
        }
        let spacing_px = node.spacing * camera.pixels_per_unit(seen.depths[0].max(camera.near));
        let blurred_px = seen.blurred_spacing_px(camera, options.level);
        if !node.is_leaf() && spacing_px > options.level.max(blurred_px) {
            stack.extend(node.children.clone());
            continue;
        }
        let thinning = (blurred_px / spacing_px).powi(2);
        // Not `clamp`, which keeps NaN: points that have no extent on the picture, and no blur.
        let thinning = if thinning > 1.0 { thinning.min(MOST_THINNING) } else { 1.0 };
        let drawn = (node.items.len() as f32 / thinning).ceil() as usize;
        counts.nodes += 1;
        counts.points += drawn;
        counts.links += if node.is_leaf() { 0 } else { drawn };
        let Seen { x, y, margin, nearest, thickness, .. } = seen;
        selected.push(Selected {
            node: number,
            place: 0,
            x,
            y,
            margin,
            drawn: drawn as u32,
            nearest,
            thickness,
        });
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
    /// Relative depths of its points.
    depths: [f32; 2],
}

impl Seen {
    /// `None` if nothing of it falls onto the picture.
    fn of(node: &Node, camera: &Camera) -> Option<Self> {
        let middle = camera.local(node);
        let half = node.half;
        let reach = camera.axes.map(|axis| axis.abs().dot(half) * (1.0 + 1e-5));
        let middle_depth = (middle.z - camera.reference) as f32;
        let depths = [middle_depth - reach[2], middle_depth + reach[2]];
        if depths[1] <= camera.near {
            return None;
        }
        let nearest_point = depths[0].max(camera.near);
        let blur_radius = camera.blur_radius(nearest_point).max(camera.blur_radius(depths[1]));
        let scale = camera.pixels_per_unit(nearest_point);
        let deviation = DEVIATION_PER_RADIUS * node.widest;
        let axis = |i: usize| {
            let [low, high] = interval(middle[i] as f32, reach[i], depths, camera);
            // Discs off the axis look longer than they are.
            let slope = low.abs().max(high.abs()) / camera.focal;
            let stretch = if camera.is_perspective { (1.0 + slope * slope).sqrt() } else { 1.0 };
            let blur = 0.5 * REACH * blur_radius * scale;
            let margin = REACH * (deviation * scale * stretch + PIXEL_DEVIATION) + blur + 1.0;
            let size = if i == 0 { camera.view.width } else { camera.view.height };
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
            camera.thickness(node.widest, f32::INFINITY, 1.0 / scale, blur_radius) * camera.bending(inverse);
        // Rounding of what is drawn, relative to its largest number.
        let slack = 1e-5 * (before.abs() + camera.bent(before).abs());
        Some(Self {
            x,
            y,
            margin,
            nearest: camera.bent(before) - slack,
            thickness: thickness + slack,
            depths,
        })
    }

    /// How far apart, in pixels, points may be for their blur.
    fn blurred_spacing_px(&self, camera: &Camera, level: f32) -> f32 {
        if self.depths[0] <= camera.focus && camera.focus <= self.depths[1] {
            return 0.0;
        }
        let px = |depth: f32| camera.blur_radius(depth) * camera.pixels_per_unit(depth);
        let least_blur = px(self.depths[0].max(camera.near)).min(px(self.depths[1]));
        let apart = (BLURRED_START + BLURRED_SLOPE * least_blur).min(BLURRED_MOST * least_blur);
        apart * level.min(1.0)
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

/// Whether every point of a node faces away from the eye.
fn faces_away(node: &Node, camera: &Camera) -> bool {
    let Some(cone) = node.cone else { return false };
    let axis = glam::Vec3::from_array(camera.axes.map(|a| a.dot(cone.axis)));
    let (towards_eye, spread) = if camera.is_perspective {
        let to_eye = -camera.local(node).as_vec3();
        let (distance, radius) = (to_eye.length(), node.half.length());
        // An eye inside the box sees it from everywhere.
        let spread = if distance > radius { (radius / distance).asin() } else { PI };
        (to_eye / distance.max(f32::MIN_POSITIVE), spread)
    } else {
        (glam::Vec3::NEG_Z, 0.0)
    };
    let angle = axis.dot(towards_eye).clamp(-1.0, 1.0).acos();
    angle > FRAC_PI_2 + cone.half_angle_rad + spread + 1e-3
}
