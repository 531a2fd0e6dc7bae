//! A triangle as one lens sees it.

use crate::geometry::{ClusterTriangle, HiddenSides, SurfaceOpacity, Triangle};
use crate::interval::Interval;
use crate::lens::{Lens, LensKind, Plane};
use glam::{DVec2, DVec3};
use pointillist_dice::{clip_ring, convex, share_before_crossing};
use std::cmp::Ordering;

/// A triangle in the frame of a lens.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// Position in the caller's triangle array.
    pub id: u32,
    /// Index of its surface.
    pub surface: u32,
    /// Where the triangle is in the prepared geometry.
    pub source: ClusterTriangle,
    /// The side from which it winds counter-clockwise is seen.
    pub front: bool,
    /// Corners in the lens's frame.
    pub corners: [DVec3; 3],
    /// Nearness over the grid.
    pub plane: Plane,
    /// Smallest and largest nearness of the visible part.
    pub nearness: Interval,
}

impl Face {
    /// Nearness at a grid position, clamped to the range of the face: the plane of a face seen almost edge-on is steep, so that
    /// extrapolation beyond the face is useless.
    #[must_use]
    #[inline]
    pub fn nearness_at(&self, p: DVec2) -> f64 {
        self.nearness.clamp(self.plane.at(p))
    }

    /// The point of the face at a grid position.
    #[must_use]
    pub fn point(&self, lens: &Lens, grid: DVec2) -> SurfacePoint {
        self.point_by(&Barycentric::new(self.corners), lens, grid)
    }

    /// The points of the face at several grid positions.
    pub fn points<'a>(
        &'a self,
        lens: &'a Lens,
        grid: impl Iterator<Item = DVec2> + 'a,
    ) -> impl Iterator<Item = SurfacePoint> + 'a {
        let barycentric = Barycentric::new(self.corners);
        grid.map(move |at| self.point_by(&barycentric, lens, at))
    }

    fn point_by(&self, barycentric: &Barycentric, lens: &Lens, grid: DVec2) -> SurfacePoint {
        let nearness = self.nearness_at(grid);
        let rational = if lens.kind == LensKind::Perspective { nearness } else { 1.0 };
        let barycentric = barycentric.of(lens.unproject(grid, nearness));
        SurfacePoint { grid, nearness, rational, barycentric }
    }

    /// An order of faces that does not depend on the order of triangles: by surface, then by place. The
    /// triangle's number decides only between triangles with the same corners.
    #[must_use]
    pub fn precedence(&self, other: &Self) -> Ordering {
        // Corner by corner: two copies of a triangle may begin with different corners.
        let corners = |f: &Self| f.corners.into_iter().flat_map(|c| c.to_array());
        let mut places = corners(self).zip(corners(other)).map(|(a, b)| a.total_cmp(&b));
        let by_place = places.find(|o| o.is_ne()).unwrap_or(Ordering::Equal);
        self.surface.cmp(&other.surface).then(by_place).then(self.id.cmp(&other.id))
    }

    /// Barycentric coordinates of a point of the plane (lens frame), kept within the triangle.
    #[must_use]
    pub fn barycentric(&self, p: DVec3) -> DVec3 {
        Barycentric::new(self.corners).of(p)
    }
}

/// Barycentric coordinates in a triangle.
struct Barycentric {
    corners: [DVec3; 3],
    /// For each corner the vector across the edge opposite it, in the plane: the distance from that edge is along it.
    across: [DVec3; 3],
}

impl Barycentric {
    #[inline]
    fn new([a, b, c]: [DVec3; 3]) -> Self {
        let n = (b - a).cross(c - a);
        Self { corners: [a, b, c], across: [(c - b).cross(n), (a - c).cross(n), (b - a).cross(n)] }
    }

    /// Those of a point of the plane, kept within the triangle.
    #[inline]
    fn of(&self, p: DVec3) -> DVec3 {
        let ([a, b, c], [from_bc, from_ca, from_ab]) = (self.corners, self.across);
        let weights = DVec3::new(from_bc.dot(b - p), from_ca.dot(c - p), from_ab.dot(a - p)).max(DVec3::ZERO);
        let sum = weights.element_sum();
        if sum > 0.0 && sum.is_finite() { weights / sum } else { DVec3::splat(1.0 / 3.0) }
    }
}

/// A point of a surface as a lens sees it; corners of the polygons over which textures are averaged.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position in the grid.
    pub grid: DVec2,
    /// Nearness (see [`Lens`]).
    pub nearness: f64,
    /// The denominator of perspective interpolation: 1/depth, or 1 where there is no perspective.
    pub rational: f64,
    /// Barycentric coordinates in its triangle.
    pub barycentric: DVec3,
}

/// Opacity that varies over a surface (an alpha mask).
pub trait TexturedOpacity: Sync {
    /// Mean opacity, 0..=1, over a polygon of the triangle, weighted by grid area.
    fn mean_opacity(&self, triangle: u32, polygon: &[SurfacePoint]) -> f32;

    /// The same, but it may be off by a hundredth where that saves time: for light that falls through several masks.
    fn rough_opacity(&self, triangle: u32, polygon: &[SurfacePoint]) -> f32 {
        self.mean_opacity(triangle, polygon)
    }

    /// The same if it is found at once that the opacity does not vary over the polygon; `None`, if it may vary or that takes long to find out. What
    /// is `None` is divided and asked again.
    fn even_opacity(&self, triangle: u32, polygon: &[SurfacePoint]) -> Option<f32> {
        let mean = self.mean_opacity(triangle, polygon);
        (mean <= 0.0 || mean >= 1.0).then_some(mean)
    }
}

/// For scenes without textured opacity.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlainOpacity;

impl TexturedOpacity for PlainOpacity {
    fn mean_opacity(&self, _triangle: u32, _polygon: &[SurfacePoint]) -> f32 {
        1.0
    }
}

/// A mask's mean opacity this close to 0 or 1 counts as 0 or 1: the sums of texels behind it are rounded to about that, and a hole
/// that is not quite empty would still be a part to compare with all others of its cell.
const OPACITY_ROUNDING: f32 = 1e-6;

/// Corners that most outlines of parts have at most.
const FEW_CORNERS: usize = 5;

impl Face {
    /// Mean opacity, 0..=1, of the face over a polygon on it: the surface's own times its mask's. `outline` is relative to `corner`.
    #[must_use]
    pub fn mean_opacity(
        &self,
        lens: &Lens,
        surface: &SurfaceOpacity,
        mask: &dyn TexturedOpacity,
        corner: DVec2,
        outline: &[DVec2],
    ) -> f32 {
        surface.behind_mask(self.over(lens, corner, outline, |polygon| mask.mean_opacity(self.id, polygon)))
    }

    /// The same by [`TexturedOpacity::rough_opacity`].
    #[must_use]
    pub fn rough_opacity(
        &self,
        lens: &Lens,
        surface: &SurfaceOpacity,
        mask: &dyn TexturedOpacity,
        corner: DVec2,
        outline: &[DVec2],
    ) -> f32 {
        surface.behind_mask(self.over(lens, corner, outline, |polygon| mask.rough_opacity(self.id, polygon)))
    }

    /// The same by [`TexturedOpacity::even_opacity`].
    #[must_use]
    pub fn even_opacity(
        &self,
        lens: &Lens,
        surface: &SurfaceOpacity,
        mask: &dyn TexturedOpacity,
        corner: DVec2,
        outline: &[DVec2],
    ) -> Option<f32> {
        let even = self.over(lens, corner, outline, |polygon| mask.even_opacity(self.id, polygon));
        even.map(|opacity| surface.behind_mask(opacity))
    }

    fn over<T>(
        &self,
        lens: &Lens,
        corner: DVec2,
        outline: &[DVec2],
        ask: impl FnOnce(&[SurfacePoint]) -> T,
    ) -> T {
        // Memory for all corners that an outline may have costs as much as the few that most have.
        match outline.len() <= FEW_CORNERS {
            true => self.over_at_most::<FEW_CORNERS, T>(lens, corner, outline, ask),
            false => self.over_at_most::<{ convex::MAX_VERTICES }, T>(lens, corner, outline, ask),
        }
    }

    #[inline]
    fn over_at_most<const N: usize, T>(
        &self,
        lens: &Lens,
        corner: DVec2,
        outline: &[DVec2],
        ask: impl FnOnce(&[SurfacePoint]) -> T,
    ) -> T {
        let zero = SurfacePoint { grid: DVec2::ZERO, nearness: 0.0, rational: 1.0, barycentric: DVec3::ZERO };
        let mut points = [zero; N];
        let found = self.points(lens, outline.iter().map(|&v| v + corner));
        points.iter_mut().zip(found).for_each(|(to, point)| *to = point);
        ask(&points[..outline.len()])
    }
}

impl SurfaceOpacity {
    /// Its opacity where a mask has this mean opacity.
    #[must_use]
    pub fn behind_mask(&self, mean: f32) -> f32 {
        let rounded = match mean {
            m if m <= OPACITY_ROUNDING => 0.0,
            m if m >= 1.0 - OPACITY_ROUNDING => 1.0,
            m => m,
        };
        (rounded * self.opacity).clamp(0.0, 1.0)
    }
}

/// A vertex of a cluster in the frame of a lens and on its grid.
#[derive(Clone, Copy, Debug)]
pub struct ProjectedVertex {
    /// Lens frame.
    pub local: DVec3,
    /// Grid; meaningless if `in_front` is false.
    pub grid: DVec2,
    /// The vertex can be projected, and lands within bounds in which f64 is still fine.
    pub in_front: bool,
}

/// Grid positions beyond this are clipped before they are used: 2¹⁸ cells leave 34 bits to a cell. A triangle that is clipped and its neighbour that is not
/// have their common edge apart by an ulp of its farther end at most.
const GUARD: f64 = (1 << 18) as f64;

/// Nearest depth relative to the largest coordinate of the triangle. What is nearer has lost its direction
/// to rounding, and is cut away; a ground that reaches 10¹² eye heights still comes out right.
const NEAR: f64 = 1e-13;

/// A plane whose distance from the eye, relative to the size of the triangle, is at most this contains
/// the eye up to rounding: it is seen edge-on and has no area, whatever its corners round to.
const EDGE_ON: f64 = 1e-14;

impl ProjectedVertex {
    /// Projects a vertex.
    #[must_use]
    #[inline]
    pub fn new(lens: &Lens, world: DVec3) -> Self {
        let local = lens.local(world);
        let grid = lens.project(local);
        let before = match lens.kind {
            LensKind::Perspective => local.z > NEAR * local.abs().max_element(),
            LensKind::Orthographic => local.z >= 0.0,
        };
        Self { local, grid, in_front: before && grid.abs().max_element() < GUARD }
    }
}

/// The depths that a lens takes in, in its own unit: what is nearer or farther is cut away, along planes across the view direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRange {
    /// Smallest depth, at least 0.
    pub near: f64,
    /// Largest depth, above `near`; may be infinite.
    pub far: f64,
}

impl DepthRange {
    /// Everything before the lens.
    pub const ALL: Self = Self { near: 0.0, far: f64::INFINITY };

    /// Whether it is a range that [`MicropointOptions`](crate::MicropointOptions) may have: 0 ≤ near < far, and near finite.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.near >= 0.0 && self.near < self.far
    }

    /// Whether nothing of a triangle before the lens is cut away.
    #[inline]
    fn holds(&self, corners: &[DVec3; 3]) -> bool {
        corners.iter().all(|p| p.z >= self.near && p.z <= self.far)
    }
}

impl Default for DepthRange {
    fn default() -> Self {
        Self::ALL
    }
}

/// A rectangle of the grid that holds everything of interest; faces that reach behind the lens are
/// clipped to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridRect {
    /// Smallest coordinates.
    pub low: DVec2,
    /// Largest coordinates.
    pub high: DVec2,
}

/// The outline of a face on the grid, in positive order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outline {
    vertices: [DVec2; MOST_CORNERS],
    len: usize,
}

/// Corners of a triangle that is cut by two planes of depth and four sides, each of which adds one.
const MOST_CORNERS: usize = 9;

impl Outline {
    /// The vertices; fewer than three if nothing is visible.
    #[must_use]
    #[inline]
    pub(crate) fn vertices(&self) -> &[DVec2] {
        &self.vertices[..self.len]
    }

    /// Leaves out corners that bend inward or coincide. Just before the eye a corner's direction is good to a few digits only,
    /// and what cuts by the outline's edges would count the bay beside it twice.
    fn fill_bays(&mut self) {
        let (mut i, mut bends) = (0, 0);
        while self.len >= 3 && bends < self.len {
            let n = self.len;
            let [a, b, c] = [i + n - 1, i, i + 1].map(|k| self.vertices[k % n]);
            if (b - a).perp_dot(c - b) > 0.0 {
                bends += 1;
                i = (i + 1) % n;
            } else {
                self.vertices.copy_within(i + 1..n, i);
                self.len -= 1;
                // Its neighbours bend differently now.
                bends = 0;
                i %= self.len;
            }
        }
    }
}

/// How a lens takes in triangles.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The lens.
    pub lens: &'a Lens,
    /// What faces that reach behind the lens are clipped to.
    pub rect: &'a GridRect,
    /// Sides of solids to leave out.
    pub hidden: &'a HiddenSides,
    /// Whether the backs of single-sided surfaces count: not for a viewer, but they still cast shadow.
    pub keeps_backs: bool,
    /// Depths outside of which faces are cut away.
    pub range: DepthRange,
}

/// Sets up a triangle for a lens: culls it, clips it if it reaches behind the lens, and gives the
/// face with its outline. `None` if there is nothing to see.
#[must_use]
#[inline]
pub(crate) fn set_up_face(
    setup: &Setup<'_>,
    triangle: &Triangle,
    source: ClusterTriangle,
    v: [&ProjectedVertex; 3],
    surface: &SurfaceOpacity,
) -> Option<(Face, Outline)> {
    let Setup { lens, hidden, keeps_backs, range, .. } = *setup;
    let corners = [v[0].local, v[1].local, v[2].local];
    let front = match v.iter().all(|p| p.in_front) {
        // The frame (right, down, forward) turns counter-clockwise into negative area.
        true => {
            let twice = (v[1].grid - v[0].grid).perp_dot(v[2].grid - v[0].grid);
            if twice == 0.0 || twice.is_nan() {
                return None;
            }
            twice < 0.0
        }
        false => {
            let n = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            match lens.kind {
                LensKind::Perspective => {
                    let distance = n.dot(corners[0]);
                    let size = corners.iter().map(|c| c.length()).fold(0.0, f64::max);
                    if distance.abs() <= EDGE_ON * n.length() * size || !distance.is_finite() {
                        return None;
                    }
                    distance < 0.0
                }
                LensKind::Orthographic => n.z < 0.0,
            }
        }
    };
    let solid = hidden.0.get(triangle.solid as usize).copied().unwrap_or(0);
    let outward_front = if solid >= 0 { front } else { !front };
    if (solid != 0 && !outward_front) || (!front && !surface.two_sided && !keeps_backs) {
        return None;
    }
    let (outline, nearness) = if v.iter().all(|p| p.in_front) && range.holds(&corners) {
        let (a, b, c) = (v[0].grid, v[1].grid, v[2].grid);
        let ring = if front { [a, c, b] } else { [a, b, c] };
        let mut outline = Outline { vertices: [DVec2::ZERO; MOST_CORNERS], len: 3 };
        outline.vertices[..3].copy_from_slice(&ring);
        let q = corners.map(|p| lens.nearness(p.z));
        let nearness = Interval { least: q[0].min(q[1]).min(q[2]), most: q[0].max(q[1]).max(q[2]) };
        (outline, nearness)
    } else {
        clip_outline(setup, corners, front)?
    };
    let plane = lens.plane(corners);
    let (id, surface) = (triangle.id, triangle.surface);
    Some((Face { id, surface, source, front, corners, plane, nearness }, outline))
}

/// Clips a triangle against the sides of the rectangle and the planes of the depth range, in the lens's frame.
#[cold]
fn clip_outline(setup: &Setup<'_>, corners: [DVec3; 3], front: bool) -> Option<(Outline, Interval)> {
    let Setup { lens, rect, range, .. } = *setup;
    let size = corners.iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    let perspective = lens.kind == LensKind::Perspective;
    let side = move |p: DVec3, axis: DVec3, line: f64, sign: f64| {
        // sign · (grid coordinate − line) ≥ 0, multiplied by depth where there is one.
        sign * (axis.dot(p) - if perspective { line * p.z } else { line })
    };
    let (x, y) = (DVec3::X * lens.scale, DVec3::Y * lens.scale);
    let near = range.near.max(if perspective { 2.0 * NEAR * size } else { 0.0 });
    let mut ring = [DVec3::ZERO; MOST_CORNERS];
    ring[..3].copy_from_slice(&corners);
    let mut len = 3;
    // The plane of what is too near depends on the size of the triangle and comes after the sides, which leave nothing behind the eye: the triangles at an
    // edge are cut in the same places, bit for bit.
    for cut in 0..6 {
        let value = |p: DVec3| match cut {
            0 => side(p, x, rect.low.x - lens.centre.x, 1.0),
            1 => side(p, x, rect.high.x - lens.centre.x, -1.0),
            2 => side(p, y, rect.low.y - lens.centre.y, 1.0),
            3 => side(p, y, rect.high.y - lens.centre.y, -1.0),
            4 => p.z - near,
            // No plane cuts at infinity, and a difference from it has no use as a weight.
            _ if range.far.is_finite() => range.far - p.z,
            _ => 1.0,
        };
        (ring, len) = clipped(&ring[..len], value);
    }
    let mut outline = Outline { vertices: [DVec2::ZERO; MOST_CORNERS], len };
    let mut nearness = Interval::EMPTY;
    for (to, p) in outline.vertices.iter_mut().zip(&ring[..len]) {
        *to = lens.project(*p).clamp(rect.low, rect.high);
        let q = lens.nearness(p.z);
        nearness.include(q);
    }
    if front {
        outline.vertices[..len].reverse();
    }
    outline.fill_bays();
    let len = outline.len;
    let area = convex::area(outline.vertices());
    (len >= 3 && area > 0.0).then_some((outline, nearness))
}

/// The part of a ring on one side of a plane; crossings do not depend on the direction of the edge.
fn clipped(ring: &[DVec3], value: impl Fn(DVec3) -> f64) -> ([DVec3; MOST_CORNERS], usize) {
    let mut out = [DVec3::ZERO; MOST_CORNERS];
    let mut len = 0;
    let crossing = |a: (DVec3, f64), b: (DVec3, f64)| {
        let swap = b.0.to_array() < a.0.to_array();
        let ((p, vp), (q, vq)) = if swap { (b, a) } else { (a, b) };
        p + (q - p) * share_before_crossing(vp, vq)
    };
    clip_ring(ring, value, crossing, |p| {
        // A convex ring gains one vertex per plane, so these are enough; rounding may invent another.
        if len < out.len() {
            out[len] = p;
            len += 1;
        }
    });
    (out, len)
}
