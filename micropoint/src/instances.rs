//! Triangles that stand in several places and are stored once.

use crate::closed::OPEN;
use crate::geometry::Triangle;
use glam::{DAffine3, DVec3};

/// Triangles that stand in several places: what [`Geometry::with_instances`](crate::Geometry::with_instances) takes.
#[derive(Clone, Copy, Debug)]
pub struct Shape<'a> {
    /// Vertices in the shape's own space.
    pub positions: &'a [DVec3],
    /// Corners, counter-clockwise seen from the front.
    pub triangles: &'a [[u32; 3]],
    /// For each triangle, the index of its surface.
    pub surface_of: &'a [u32],
    /// Where it stands; nowhere if there are none.
    pub places: &'a [Placement],
}

/// One of the places of a [`Shape`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Takes the shape to its place. One that mirrors keeps fronts in front: it swaps the second and the third corner of each triangle.
    pub world_from_shape: DAffine3,
    /// The number of the shape's first triangle in this place; the others follow. [`Face::id`](crate::Face::id) has it. Numbers below those
    /// of the triangles that are not instances, or of another place, are for the caller to avoid.
    pub first_id: u32,
}

/// How the stored triangles of a cluster become those of a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// `None` for triangles that are stored as they stand.
    pub(crate) world_from_shape: Option<DAffine3>,
    pub(crate) mirrors: bool,
    pub(crate) first_id: u32,
    pub(crate) first_solid: u32,
}

impl Placed {
    /// Triangles that are stored as they stand.
    pub(crate) const AS_STORED: Self =
        Self { world_from_shape: None, mirrors: false, first_id: 0, first_solid: 0 };

    pub(crate) fn new(place: &Placement, first_solid: u32) -> Self {
        let Placement { world_from_shape, first_id } = *place;
        let mirrors = world_from_shape.matrix3.determinant() < 0.0;
        Self { world_from_shape: Some(world_from_shape), mirrors, first_id, first_solid }
    }

    #[inline]
    pub(crate) fn point(&self, stored: DVec3) -> DVec3 {
        match &self.world_from_shape {
            None => stored,
            Some(world) => world.transform_point3(stored),
        }
    }

    #[inline]
    pub(crate) fn triangle(&self, stored: &Triangle) -> Triangle {
        if self.world_from_shape.is_none() {
            return *stored;
        }
        let [a, b, c] = stored.corners;
        Triangle {
            corners: if self.mirrors { [a, c, b] } else { [a, b, c] },
            id: stored.id + self.first_id,
            surface: stored.surface,
            solid: if stored.solid == OPEN { OPEN } else { stored.solid + self.first_solid },
        }
    }
}
