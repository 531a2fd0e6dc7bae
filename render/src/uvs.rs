//! Where textures lie on triangles, and means of texels over what is seen of them.

use crate::scene::{MapPlace, Mesh, Storage, UvSet};
use glam::{DVec2, DVec3};
use pointillist_micropoint::{MaskSums, SurfacePoint, TexelCorner, TexelSums, TexelWrap};
use pointillist_shade::Wrap;

/// Texture coordinates of the corners of all triangles; nothing for a scene without textures.
#[derive(Default)]
pub(crate) struct Uvs {
    storage: Storage,
    /// By where triangles are stored.
    first: Vec<[DVec2; 3]>,
    /// Empty if no triangle has other coordinates than those of the first set.
    second: Vec<[DVec2; 3]>,
}

impl Uvs {
    /// Those of a mesh; zero where it has none.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let set = |set: UvSet| -> Vec<[DVec2; 3]> {
            let place = MapPlace { set, ..MapPlace::default() };
            let of = |mesh: &Mesh, t: usize| mesh.own_map_corners(t, &place).unwrap_or_default();
            mesh.stores().flat_map(|mesh| (0..mesh.triangles.len()).map(move |t| of(mesh, t))).collect()
        };
        let has_second = mesh.stores().any(|mesh| !mesh.second_uv_of.is_empty());
        let second = if has_second { set(UvSet::Second) } else { vec![] };
        Self { storage: mesh.storage(), first: set(UvSet::First), second }
    }

    /// The coordinates of a triangle in both sets, by where it is stored.
    pub(crate) fn stored(&self, index: usize) -> [[DVec2; 3]; 2] {
        [UvSet::First, UvSet::Second].map(|set| self.set(set).get(index).copied().unwrap_or_default())
    }

    fn set(&self, set: UvSet) -> &[[DVec2; 3]] {
        let has_own = set == UvSet::Second && !self.second.is_empty();
        if has_own { &self.second } else { &self.first }
    }

    /// Coordinates of a triangle's corners on a map.
    pub(crate) fn of(&self, triangle: u32, place: &MapPlace) -> [DVec2; 3] {
        let set = self.set(place.set);
        if set.is_empty() {
            return place.of(<[DVec2; 3]>::default());
        }
        let (index, order) = self.storage.find(triangle);
        let stored = set.get(index).copied().unwrap_or_default();
        place.of(order.map(|k| stored[k]))
    }

    /// Mean of a map over a polygon of a triangle.
    pub(crate) fn mean<const N: usize>(
        &self,
        triangle: u32,
        polygon: &[SurfacePoint],
        map: &TexelSums<N>,
        place: &MapPlace,
    ) -> [f64; N] {
        self.over(triangle, polygon, map, place, |corners| map.mean(corners))
    }

    /// Mean of a mask over a polygon of a triangle.
    pub(crate) fn mean_of_mask(
        &self,
        triangle: u32,
        polygon: &[SurfacePoint],
        mask: &MaskSums,
        place: &MapPlace,
    ) -> f64 {
        self.over(triangle, polygon, mask.sums(), place, |corners| mask.mean(corners))
    }

    /// The same roughly ([`MaskSums::rough_mean`]).
    pub(crate) fn rough_mean_of_mask(
        &self,
        triangle: u32,
        polygon: &[SurfacePoint],
        mask: &MaskSums,
        place: &MapPlace,
    ) -> f64 {
        self.over(triangle, polygon, mask.sums(), place, |corners| mask.rough_mean(corners))
    }

    /// The mean of a mask if it is uniform ([`MaskSums::uniform_mean`]).
    pub(crate) fn uniform_mean_of_mask(
        &self,
        triangle: u32,
        polygon: &[SurfacePoint],
        mask: &MaskSums,
        place: &MapPlace,
    ) -> Option<f64> {
        self.over(triangle, polygon, mask.sums(), place, |corners| mask.uniform_mean(corners))
    }

    /// What is found of a polygon's corners in a map.
    fn over<const N: usize, T>(
        &self,
        triangle: u32,
        polygon: &[SurfacePoint],
        map: &TexelSums<N>,
        place: &MapPlace,
        ask: impl FnOnce(&[TexelCorner]) -> T,
    ) -> T {
        debug_assert!(polygon.len() <= MOST_CORNERS, "{} corners", polygon.len());
        let uv = &self.of(triangle, place);
        let size = DVec2::new(f64::from(map.width()), f64::from(map.height()));
        let corner = |p: &SurfacePoint| {
            let at = weighted(uv, p.barycentric);
            let texel = DVec2::new(at.x, 1.0 - at.y) * size;
            TexelCorner { grid: p.grid, rational: p.rational, texel }
        };
        let corners = polygon.iter().map(corner);
        // Memory for all corners that a polygon may have costs as much as the few that most have.
        match polygon.len() <= FEW_CORNERS {
            true => ask(collected::<FEW_CORNERS>(corners).as_slice()),
            false => ask(collected::<MOST_CORNERS>(corners).as_slice()),
        }
    }
}

/// Most corners of what is seen of a micropoint: as many as `pointillist-dice`'s convex polygons hold.
const MOST_CORNERS: usize = 16;

/// Corners that most of it has at most.
const FEW_CORNERS: usize = 5;

/// Corners of a polygon in a texture, on the stack.
struct Corners<const M: usize> {
    list: [TexelCorner; M],
    len: usize,
}

#[inline]
fn collected<const M: usize>(corners: impl Iterator<Item = TexelCorner>) -> Corners<M> {
    let zero = TexelCorner { grid: DVec2::ZERO, rational: 1.0, texel: DVec2::ZERO };
    let mut found = Corners { list: [zero; M], len: 0 };
    for (to, corner) in found.list.iter_mut().zip(corners) {
        *to = corner;
        found.len += 1;
    }
    found
}

impl<const M: usize> Corners<M> {
    fn as_slice(&self) -> &[TexelCorner] {
        &self.list[..self.len]
    }
}

/// By differences: where all corners have the same coordinate, which may be that of a border between texels, it comes out exactly.
fn weighted([a, b, c]: &[DVec2; 3], share: DVec3) -> DVec2 {
    *a + (*b - *a) * share.y + (*c - *a) * share.z
}

pub(crate) fn texel_wrap(wrap: Wrap) -> TexelWrap {
    match wrap {
        Wrap::Clamp => TexelWrap::Clamp,
        Wrap::Mirror => TexelWrap::Mirror,
        Wrap::Repeat => TexelWrap::Repeat,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;
    use pointillist_micropoint::MicropointError;

    #[test]
    fn what_runs_along_the_top_of_a_texture_sees_its_top_row() -> Result<(), MicropointError> {
        let rows = TexelSums::<1>::new(4, 3, TexelWrap::Repeat, |_, y| [y as f32])?;
        let first = vec![[dvec2(0.1, 1.0), dvec2(0.7, 1.0), dvec2(0.3, 1.0)]];
        let uvs = Uvs { storage: Storage::of_own(1), first, second: vec![] };
        let plain = MapPlace::default();
        for k in 1..100 {
            let (y, z) = (f64::from(k) / 301.0, f64::from(k) / 207.0);
            let place = |y: f64, z: f64| SurfacePoint {
                grid: dvec2(y, z),
                nearness: 1.0,
                rational: 1.0,
                barycentric: DVec3::new(1.0 - y - z, y, z),
            };
            let seen = [place(y, z), place(0.9 * y, z), place(y, 0.9 * z)];
            assert_eq!(uvs.mean(0, &seen, &rows, &plain), [0.0]);
        }
        Ok(())
    }
}
