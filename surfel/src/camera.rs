//! A view of one cloud: all that a frame needs to know to put points onto the picture, in units of the cloud's lattice.

use crate::focus::Focus;
use crate::lattice::Lattice;
use crate::node::Node;
use crate::vector::Real;
use glam::{DVec3, Vec3};
use pointillist_view::View;

/// How far the plane of a blurred disc is followed beyond the disc itself, in blur radii: what lies on one slanted
/// surface then has one depth in a pixel, and belongs to one layer. Found by experiment.
const BLURRED_PLANE: f32 = 2.0;

/// How far behind the nearest disc another may lie and still belong to the same surface, as a sum of four lengths, all
/// found by experiment: these multiples of the disc's radius and of its blur radius, and the change of depth of a
/// slanted surface over these multiples of a pixel and of the blur radius.
pub(crate) const THICKNESS: f32 = 1.1;
const BLURRED_DISC_THICKNESS: f32 = 1.75;
const SLANTED_THICKNESS: f32 = 1.5;
const BLURRED_THICKNESS: f32 = 0.7;

/// Slopes (depth over width) are clamped to this.
const STEEPEST: f32 = 8.0;

/// Reach of a disc's kernel in standard deviations: the square root of [`crate::splat::REACH2`].
pub(crate) const REACH: f32 = std::f32::consts::SQRT_2 * 2.0;

/// Coordinates of a direction along right, down and forward.
pub(crate) fn turned(view: &View, v: DVec3) -> DVec3 {
    DVec3::new(v.dot(view.right()), -v.dot(view.up()), v.dot(view.forward()))
}

/// Whether the eye is in the box around a node; an orthographic one, whether any part of its plane is.
fn is_among(view: &View, lattice: &Lattice, root: &Node) -> bool {
    let middle = lattice.way(view.eye(), root.origin) / lattice.side;
    let half = root.half.as_dvec3();
    if view.projection().is_perspective() {
        middle.abs().cmple(half).all()
    } else {
        let forward = view.forward();
        middle.dot(forward).abs() <= half.dot(forward.abs())
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Camera {
    pub(crate) view: View,
    lattice: Lattice,
    pub(crate) is_perspective: bool,
    /// Pixels per unit at depth 1 (perspective), or at any depth.
    pub(crate) focal: f32,
    /// The principal point, pixels.
    pub(crate) centre: [f64; 2],
    /// Depths are kept relative to this one, near the cloud: a telephoto view of a far cloud then loses nothing in
    /// `f32`.
    pub(crate) reference: f64,
    /// Relative depths must be above this.
    pub(crate) near: f32,
    /// Radius of the blur per unit of distance from the focus, and relative depth of the focus.
    pub(crate) blur: f32,
    pub(crate) focus: f32,
    /// World axes of the picture.
    pub(crate) axes: [Vec3; 3],
    /// Whether everything is drawn from both sides.
    pub(crate) sees_both_sides: bool,
}

impl Camera {
    /// `is_estimated`: which side of a closed surface is its outside was found out. An eye among such surfaces may be in one of them, as
    /// in a room, whose walls it sees from within: it sees both sides of everything.
    pub(crate) fn new(
        view: &View,
        lattice: &Lattice,
        root: &Node,
        focus: &Focus,
        is_estimated: bool,
    ) -> Self {
        let middle = turned(view, lattice.way(view.eye(), root.origin)).z / lattice.side;
        let extent = f64::from(root.half.length()) + f64::from(root.widest);
        let reference = middle.max(0.01 * extent);
        let is_perspective = view.projection().is_perspective();
        let unit = if is_perspective { 1.0 } else { lattice.side };
        let (depth, focus) = focus.depth_and_focus();
        // Clamped: a blur wider than every picture looks the same as an infinite one, and stays finite.
        let blur = depth.min(1e9) as f32;
        Self {
            view: *view,
            lattice: *lattice,
            is_perspective,
            focal: (view.focal_px() * unit) as f32,
            centre: view.centre_px().to_array(),
            reference,
            near: (1e-5 * extent - reference) as f32,
            blur,
            focus: (focus / lattice.side - reference).clamp(-1e12, 1e12) as f32,
            axes: [view.right(), -view.up(), view.forward()].map(|v| v.as_vec3()),
            sees_both_sides: is_estimated && is_among(view, lattice, root),
        }
    }

    /// Coordinates of a node's origin along right, down and forward, units.
    pub(crate) fn local(&self, node: &Node) -> DVec3 {
        turned(&self.view, self.lattice.way(self.view.eye(), node.origin)) / self.lattice.side
    }

    /// Pixels per unit at a relative depth.
    pub(crate) fn pixels_per_unit(&self, depth: f32) -> f32 {
        if self.is_perspective { self.focal / (depth + self.reference as f32) } else { self.focal }
    }

    /// Radius of the blur at a relative depth, units.
    #[inline(always)]
    pub(crate) fn blur_radius<R: Real>(&self, depth: R) -> R {
        (depth - self.focus).abs() * self.blur
    }

    /// The depth that is affine over the picture on planes: d·z₀/z for a perspective camera, d = z − z₀ from the
    /// reference z₀.
    pub(crate) fn bent(&self, depth: f32) -> f32 {
        if self.is_perspective {
            let reference = self.reference as f32;
            depth * (reference / (depth + reference))
        } else {
            depth
        }
    }

    /// The relative depth again.
    #[inline(always)]
    fn unbent(&self, bent: f32) -> f64 {
        let bent = f64::from(bent);
        if self.is_perspective { bent / (1.0 - bent / self.reference).max(0.0) } else { bent }
    }

    /// Distance along the view axis in the world.
    #[inline(always)]
    pub(crate) fn world_depth(&self, bent: f32) -> f32 {
        // Planes of discs beside the eye reach behind it.
        ((self.unbent(bent) + self.reference).max(0.0) * self.lattice.side) as f32
    }

    /// Radius of the blur at a bent depth, pixels.
    pub(crate) fn blur_px(&self, bent: f32) -> f32 {
        let depth = self.unbent(bent) as f32;
        self.blur_radius(depth) * self.pixels_per_unit(depth)
    }

    /// A length in pixels at a bent depth as a difference of bent depths.
    pub(crate) fn bent_length(&self, pixels: f32, bent: f32) -> f32 {
        let depth = self.unbent(bent) as f32;
        let inverse = 1.0 / (depth + self.reference as f32);
        pixels / self.pixels_per_unit(depth) * self.bending(inverse)
    }

    /// Bent depth per depth.
    #[inline(always)]
    pub(crate) fn bending<R: Real>(&self, inverse: R) -> R {
        let ratio = inverse * self.reference as f32;
        if self.is_perspective { ratio * ratio } else { ratio.like(1.0) }
    }

    /// How far a disc's plane is followed from its centre, units of depth.
    #[inline(always)]
    pub(crate) fn plane_reach<R: Real>(&self, deviation: R, blur_radius: R) -> R {
        deviation * REACH + blur_radius * BLURRED_PLANE
    }

    /// Depth within which discs belong to one surface, units. `pixel` is the side of a pixel there.
    #[inline(always)]
    pub(crate) fn thickness<R: Real>(&self, radius: R, slope: R, pixel: R, blur_radius: R) -> R {
        let slanted = pixel * SLANTED_THICKNESS + blur_radius * BLURRED_THICKNESS;
        let upright = radius * THICKNESS + blur_radius * BLURRED_DISC_THICKNESS;
        upright + slope.at_most(STEEPEST) * slanted
    }
}
