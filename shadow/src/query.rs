//! What both occlusion rules use: the casters of a target's group with their opacity, and the measure of areas.

use crate::casters::{Caster, Nearby};
use crate::covered::Shape;
use glam::{DVec2, DVec3};
use pointillist_dice::HalfPlane;
use pointillist_micropoint::{Face, Geometry, Lens, LensKind, TexturedOpacity};

/// A target with the casters that may darken it.
#[derive(Clone, Copy)]
pub(crate) struct Query<'a> {
    pub(crate) lens: &'a Lens,
    pub(crate) geometry: &'a Geometry,
    pub(crate) opacity: &'a dyn TexturedOpacity,
    pub(crate) casters: &'a [Caster],
    /// The half-planes of their edges.
    pub(crate) sides: &'a [HalfPlane],
    /// Their corners.
    pub(crate) vertices: &'a [DVec2],
    /// Those of them that may darken the target's group.
    pub(crate) nearby: &'a [Nearby],
}

impl<'a> Query<'a> {
    /// The outline of a caster, and the half-planes of its edges.
    pub(crate) fn shape(&self, caster: u32) -> Shape<'a> {
        let caster = &self.casters[caster as usize];
        (&self.vertices[caster.outline.clone()], &self.sides[caster.sides.clone()])
    }

    /// Opacity of a caster over a polygon of the light grid.
    pub(crate) fn opacity(&self, caster: &Caster, polygon: &[DVec2]) -> f64 {
        caster.opacity.unwrap_or_else(|| {
            let surface = &self.geometry.surfaces()[caster.face.surface as usize];
            f64::from(caster.face.rough_opacity(self.lens, surface, self.opacity, DVec2::ZERO, polygon))
        })
    }
}

/// Distance of a face's plane from the eye over the face's own, up to which the face is edge-on: where a region of it is in the picture
/// is known to the rounding of its corners over this.
const EDGE_ON: f64 = 1e-9;

/// Whether the viewer sees a face edge-on, up to rounding.
pub(crate) fn is_edge_on(viewer: &Lens, face: &Face) -> bool {
    let [a, b, c] = face.corners;
    let normal = (b - a).cross(c - a);
    let (towards, length) = match viewer.kind {
        LensKind::Perspective => (a, a.length().max(b.length()).max(c.length())),
        LensKind::Orthographic => (DVec3::Z, 1.0),
    };
    normal.dot(towards).abs() <= EDGE_ON * normal.length() * length
}

/// Areas in the viewer's picture of polygons of the light grid, up to a factor that is constant on a face.
///
/// Positions in the picture are a projective map of positions in the light grid, whose denominator is the viewer's
/// depth over the light's. Such a map turns a triangle of area A with denominators a, b, c at its corners into
/// one of area A / (a b c), up to a constant: exact, however much the depths vary.
pub(crate) struct Measure<'a> {
    pub(crate) lens: &'a Lens,
    pub(crate) viewer: &'a Lens,
    pub(crate) face: &'a Face,
}

impl Measure<'_> {
    /// Area of a polygon in the picture.
    pub(crate) fn area(&self, polygon: &[DVec2]) -> f64 {
        let Some((&first, rest)) = polygon.split_first() else { return 0.0 };
        let at_first = self.denominator(first);
        let mut sum = 0.0;
        let mut previous = (DVec2::ZERO, 1.0);
        for (i, &v) in rest.iter().enumerate() {
            let next = (v - first, self.denominator(v));
            if i > 0 {
                sum += 0.5 * previous.0.perp_dot(next.0) / (at_first * previous.1 * next.1);
            }
            previous = next;
        }
        sum.abs()
    }

    /// Where the viewer sees a point of the light grid, on the viewer's grid.
    pub(crate) fn in_picture(&self, p: DVec2) -> DVec2 {
        let (_, seen) = self.both(p);
        self.viewer.project(self.viewer.local_vector(seen))
    }

    /// A point of the light grid relative to the light in the frame of its lens, and relative to the viewer in world axes.
    fn both(&self, p: DVec2) -> (DVec3, DVec3) {
        let local = self.lens.unproject(p, self.face.nearness_at(p));
        (local, self.lens.to_world_axes(local) + (self.lens.origin - self.viewer.origin))
    }

    fn denominator(&self, p: DVec2) -> f64 {
        let (local, world) = self.both(p);
        let light_depth = if self.lens.kind == LensKind::Perspective { local.z } else { 1.0 };
        let viewer_depth =
            if self.viewer.kind == LensKind::Perspective { self.viewer.forward.dot(world) } else { 1.0 };
        viewer_depth / light_depth
    }
}
