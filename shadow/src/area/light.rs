//! A polygonal light, and what of it a point sees.

use super::group::AreaScratch;
use crate::error::ShadowError;
use crate::receiver::{Receivers, Viewer};
use glam::{DVec2, DVec3, dvec2, dvec3};
use pointillist_dice::{convex, lambert};
use pointillist_micropoint::{Geometry, TexturedOpacity};

/// Most vertices of a light's outline.
pub const LARGEST_OUTLINE: usize = 12;

/// How far vertices may lie off the plane of the light, and its corners bend inward, relative to its size: that of coordinates with six
/// digits.
const SHAPE_TOLERANCE: f64 = 1e-6;

/// An outline is a line if twice its area is no larger than this times the square of its size: its normal is rounding.
const NO_AREA: f64 = 1e-12;

/// Distances below this, times the size of the scene, are 0: of a receiver from the plane of a caster that it lies on, and of a caster from
/// the plane of the light. Visible surfaces coincide below the same share of their depth (`pointillist-micropoint`).
pub(crate) const COINCIDENT: f64 = 1e-10;

/// How finely a polygonal light is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AreaOptions {
    /// A receiver is asked at one point if no outline of a shadow on the light moves by more than this share of the light's width over it;
    /// otherwise it is halved. What is seen through something counts by what is seen of it: at a [`Tile::visibility`] of 0.1, outlines
    /// may move ten times as far, with the same effect on the picture. Default: 0.1.
    ///
    /// [`Tile::visibility`]: pointillist_micropoint::Tile::visibility
    pub largest_shift: f64,
    /// How often a receiver is halved at most. Default: 5.
    pub most_halvings: u32,
}

impl AreaOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self { largest_shift: 0.1, most_halvings: 5 };

    /// Sets the largest shift of an outline, relative to the light's width.
    #[must_use]
    pub const fn with_largest_shift(mut self, share: f64) -> Self {
        self.largest_shift = share;
        self
    }

    /// Sets how often a receiver is halved at most.
    #[must_use]
    pub const fn with_most_halvings(mut self, count: u32) -> Self {
        self.most_halvings = count;
        self
    }
}

impl Default for AreaOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Axes of a light: x and y in its plane, z towards the side that it shines to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) origin: DVec3,
    axes: [DVec3; 3],
}

impl Frame {
    /// The axes of the world about a point.
    pub(crate) fn at(origin: DVec3) -> Self {
        Self { origin, axes: [DVec3::X, DVec3::Y, DVec3::Z] }
    }

    pub(crate) fn local(&self, world: DVec3) -> DVec3 {
        self.local_vector(world - self.origin)
    }

    pub(crate) fn local_vector(&self, v: DVec3) -> DVec3 {
        dvec3(self.axes[0].dot(v), self.axes[1].dot(v), self.axes[2].dot(v))
    }

    pub(crate) fn world_vector(&self, v: DVec3) -> DVec3 {
        self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z
    }
}

/// A planar convex light that shines to its front, ready to be asked from any thread.
///
/// A light that shines to both sides is two of these.
pub struct AreaLight<'a> {
    pub(crate) geometry: &'a Geometry,
    pub(crate) opacity: &'a dyn TexturedOpacity,
    pub(crate) frame: Frame,
    /// In positive order.
    pub(crate) outline: Vec<DVec2>,
    pub(crate) options: AreaOptions,
    /// Something may stand before it.
    pub(crate) casts: bool,
    /// Side of a square of its area.
    pub(crate) width: f64,
    /// Distances up to this are 0.
    pub(crate) coincident: f64,
    /// The triangles that shine, rising.
    pub(crate) own: Vec<u32>,
}

impl<'a> AreaLight<'a> {
    /// A light with these vertices, counter-clockwise as seen from the side that it shines to.
    ///
    /// # Errors
    /// [`ShadowError`] if there are fewer than 3 vertices or more than [`LARGEST_OUTLINE`], if one is not finite, or if together they are
    /// not a planar convex polygon with an area.
    pub fn new(
        geometry: &'a Geometry,
        opacity: &'a dyn TexturedOpacity,
        vertices: &[DVec3],
        options: AreaOptions,
    ) -> Result<Self, ShadowError> {
        let frame = frame_of(vertices)?;
        let outline: Vec<DVec2> = vertices.iter().map(|&v| frame.local(v).truncate()).collect();
        let bounds = geometry.bounds();
        let reach = |p: DVec3| (p - frame.origin).abs().max_element();
        let scene =
            if bounds.low.x <= bounds.high.x { reach(bounds.low).max(reach(bounds.high)) } else { 0.0 };
        let size = vertices.iter().map(|&v| reach(v)).fold(scene, f64::max);
        let width = convex::area(&outline).sqrt();
        Ok(Self {
            geometry,
            opacity,
            frame,
            outline,
            options,
            casts: true,
            width,
            coincident: COINCIDENT * size,
            own: vec![],
        })
    }

    /// The same light as the shine of these triangles, by their positions in the caller's array: they cast no shadow on it, and it does not
    /// light them. Their plane is the light's up to rounding, which decides about neither.
    #[must_use]
    pub fn of_triangles(mut self, triangles: &[u32]) -> Self {
        self.own = triangles.to_vec();
        self.own.sort_unstable();
        self
    }

    /// The same light, asked as finely as these options say.
    #[must_use]
    pub fn with_options(mut self, options: AreaOptions) -> Self {
        self.options = options;
        self
    }

    /// The same light without shadows.
    #[must_use]
    pub fn without_shadows(mut self) -> Self {
        self.casts = false;
        self
    }

    /// Unit normal of the side that it shines to.
    #[must_use]
    pub fn front(&self) -> DVec3 {
        self.frame.world_vector(DVec3::Z)
    }

    /// Area of the light.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.width * self.width
    }

    /// What a point of a surface with this unit normal would see with nothing in between.
    #[must_use]
    pub fn whole(&self, position: DVec3, normal: DVec3) -> SeenLight {
        let mut seen =
            SeenLight { frame: self.frame, point: self.frame.local(position), ..SeenLight::default() };
        if seen.point.z > self.coincident {
            let mut kept = vec![];
            above_horizon(&self.outline, seen.point, self.frame.local_vector(normal), &mut kept);
            if !kept.is_empty() {
                seen.push(kept.into_iter(), 1.0);
            }
        }
        seen
    }

    /// Calls `visit` for every receiver with what its points see of the light: the receiver's position in the list (that of its first piece,
    /// [`Receivers::push_point`]), and the share of its area, or of its weight, that the point stands for. Receivers that see nothing of the light, or turn a dark side to it, are left out.
    ///
    /// Casters that are nearer to a point than a millionth of its distance from the light's plane, measured along the light's normal, do
    /// not count.
    ///
    /// What a receiver sees depends on the receiver, the viewer and the scene only, not on its companions. Their order in `visit` is
    /// not that of the list.
    pub fn visit(
        &self,
        viewer: Viewer<'_>,
        receivers: &Receivers,
        scratch: &mut AreaScratch,
        mut visit: impl FnMut(usize, f64, &SeenLight),
    ) {
        let behind = |bounds| self.is_behind(bounds, viewer.lens.origin);
        if receivers.bounds(viewer).is_none_or(behind) {
            scratch.counts.batch(receivers.wholes(), 0);
        } else {
            super::group::visit(self, viewer, receivers, scratch, &mut visit);
        }
    }
}

impl AreaLight<'_> {
    /// Whether a triangle is part of the light.
    pub(crate) fn is_own(&self, triangle: u32) -> bool {
        !self.own.is_empty() && self.own.binary_search(&triangle).is_ok()
    }

    /// Whether everything in a box, relative to a point, is behind the light.
    fn is_behind(&self, (low, high): (DVec3, DVec3), origin: DVec3) -> bool {
        let front = self.front();
        let farthest = DVec3::select(front.cmpgt(DVec3::ZERO), high, low);
        front.dot(farthest + (origin - self.frame.origin)) <= 0.0
    }
}

/// Whether these vertices are the outline of a light.
///
/// # Errors
/// As [`AreaLight::new`].
pub fn check_outline(vertices: &[DVec3]) -> Result<(), ShadowError> {
    frame_of(vertices).map(|_| ())
}

/// The frame of a light with these vertices.
fn frame_of(vertices: &[DVec3]) -> Result<Frame, ShadowError> {
    if !(3..=LARGEST_OUTLINE).contains(&vertices.len()) {
        return Err(ShadowError::OutlineLength { found: vertices.len(), most: LARGEST_OUTLINE });
    }
    if let Some(index) = vertices.iter().position(|v| !v.is_finite()) {
        return Err(ShadowError::OutlineNotFinite { index });
    }
    let origin = vertices[0];
    let at = |i: usize| vertices[i % vertices.len()] - origin;
    let normal: DVec3 = (1..vertices.len() - 1).map(|i| at(i).cross(at(i + 1))).sum();
    let size = (0..vertices.len()).map(|i| at(i).length()).fold(0.0, f64::max);
    let z = normal.normalize_or_zero();
    if z == DVec3::ZERO || normal.length() <= NO_AREA * size * size {
        return Err(ShadowError::OutlineWithoutArea);
    }
    if let Some(index) = (0..vertices.len()).find(|&i| at(i).dot(z).abs() > SHAPE_TOLERANCE * size) {
        return Err(ShadowError::OutlineNotPlanar { index });
    }
    let bends_inward = |&i: &usize| {
        let (a, b) = (at(i + 1) - at(i), at(i + 2) - at(i + 1));
        a.cross(b).dot(z) < -SHAPE_TOLERANCE * size * size || (a.dot(b) < 0.0 && a.cross(b).length() == 0.0)
    };
    let turning: f64 = (0..vertices.len())
        .map(|i| {
            let (a, b) = (at(i + 1) - at(i), at(i + 2) - at(i + 1));
            a.cross(b).dot(z).atan2(a.dot(b))
        })
        .sum();
    if let Some(i) = (0..vertices.len()).find(bends_inward) {
        return Err(ShadowError::OutlineNotConvex { index: (i + 1) % vertices.len() });
    }
    // A star bends the same way everywhere, but turns round more than once.
    if turning > 3.0 * std::f64::consts::PI {
        return Err(ShadowError::OutlineNotConvex { index: 0 });
    }
    let x = (at(1) - z * at(1).dot(z)).normalize_or(z.any_orthonormal_vector());
    Ok(Frame { origin, axes: [x, z.cross(x), z] })
}

/// What a point sees of a light: convex parts, each with the share of light that passes through what is translucent in front of it.
#[derive(Debug)]
pub struct SeenLight {
    pub(crate) frame: Frame,
    /// The point, in the light's frame.
    pub(crate) point: DVec3,
    pub(crate) vertices: Vec<DVec2>,
    parts: Vec<(u32, f64)>,
}

impl Default for SeenLight {
    fn default() -> Self {
        Self { frame: Frame::at(DVec3::ZERO), point: DVec3::Z, vertices: vec![], parts: vec![] }
    }
}

impl SeenLight {
    pub(crate) fn clear(&mut self) {
        self.vertices.clear();
        self.parts.clear();
    }

    pub(crate) fn push(&mut self, ring: impl Iterator<Item = DVec2>, transmittance: f64) {
        self.vertices.extend(ring);
        self.parts.push((self.vertices.len() as u32, transmittance));
    }

    /// Takes the parts of another, which gets these.
    pub(crate) fn take_parts(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.vertices, &mut other.vertices);
        std::mem::swap(&mut self.parts, &mut other.parts);
    }

    /// Bounding rectangle of the parts, in the light's plane.
    pub(crate) fn bounds(&self) -> (DVec2, DVec2) {
        convex::bounds(&self.vertices)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// The point, in the world.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.frame.origin + self.frame.world_vector(self.point)
    }

    /// The parts in the light's plane, with their transmittance.
    pub(crate) fn plane_parts(&self) -> impl Iterator<Item = (&[DVec2], f64)> {
        let first = |i: usize| if i == 0 { 0 } else { self.parts[i - 1].0 as usize };
        let part = move |(i, &(end, transmittance)): (usize, &(u32, f64))| {
            (&self.vertices[first(i)..end as usize], transmittance)
        };
        self.parts.iter().enumerate().map(part)
    }

    /// Calls `visit` with each part, relative to the point in world axes, counter-clockwise from the light's front, and its transmittance.
    pub fn for_each_part(&self, mut visit: impl FnMut(&[DVec3], f64)) {
        let mut ring = [DVec3::ZERO; convex::MAX_VERTICES];
        for (part, transmittance) in self.plane_parts() {
            for (to, v) in ring.iter_mut().zip(part) {
                *to = self.frame.world_vector(v.extend(0.0) - self.point);
            }
            visit(&ring[..part.len()], transmittance);
        }
    }

    /// Form factor of what is seen for a surface element with this unit normal, 0..=1: its irradiance over π times the light's radiance.
    #[must_use]
    pub fn share(&self, normal: DVec3) -> f64 {
        let normal = self.frame.local_vector(normal);
        let mut ring = [DVec3::ZERO; convex::MAX_VERTICES];
        let mut sum = 0.0;
        for (part, transmittance) in self.plane_parts() {
            for (to, v) in ring.iter_mut().zip(part) {
                *to = v.extend(0.0);
            }
            sum += transmittance * lambert::share_above_horizon(self.point, normal, &ring[..part.len()]);
        }
        sum.max(0.0)
    }

    /// Area of what is seen, each part times its transmittance.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.plane_parts().map(|(part, transmittance)| transmittance * convex::area(part)).sum()
    }
}

/// The part of a light's outline that is above the horizon of a point, or nothing: `normal` is that of the point's surface.
pub(crate) fn above_horizon(outline: &[DVec2], point: DVec3, normal: DVec3, kept: &mut Vec<DVec2>) {
    kept.clear();
    let side = |v: DVec2| normal.dot(dvec2(v.x, v.y).extend(0.0) - point);
    let crossing = |(a, va): (DVec2, f64), (b, vb): (DVec2, f64)| {
        a + (b - a) * pointillist_dice::share_before_crossing(va, vb)
    };
    pointillist_dice::clip_ring(outline, side, crossing, |v| kept.push(v));
}
