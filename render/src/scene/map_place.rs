//! Where a map lies on a surface.

use super::mesh::{Mesh, NONE};
use glam::{DAffine2, DVec2};

/// Which of a mesh's texture coordinates a map takes, and what is done to them before it is looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MapPlace {
    /// Which coordinates.
    pub set: UvSet,
    /// From those coordinates to the map's own, v upward in both. Default: the identity.
    pub map_from_uv: DAffine2,
}

/// One of the sets of texture coordinates that a mesh may have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum UvSet {
    /// [`Mesh::uv_of`].
    #[default]
    First,
    /// [`Mesh::second_uv_of`]; the first set on triangles that have no second.
    Second,
}

impl MapPlace {
    /// The map's coordinates at corners that have these.
    #[must_use]
    pub fn of(&self, corners: [DVec2; 3]) -> [DVec2; 3] {
        if self.map_from_uv == DAffine2::IDENTITY {
            // Not multiplied by 1 and 0: a −0 would become 0, and corners on borders of texels are compared by their bits.
            return corners;
        }
        corners.map(|uv| self.map_from_uv.transform_point2(uv))
    }
}

impl Mesh {
    /// Coordinates of a map at the corners of one of the mesh's own triangles; `None` where it has none.
    pub(crate) fn own_map_corners(&self, triangle: usize, place: &MapPlace) -> Option<[DVec2; 3]> {
        let second = self.second_uv_of.get(triangle).filter(|_| place.set == UvSet::Second);
        let found = |of: &&[u32; 3]| !of.contains(&NONE);
        let of = second.filter(found).or_else(|| self.uv_of.get(triangle).filter(found))?;
        Some(place.of(of.map(|i| self.uvs[i as usize])))
    }
}
