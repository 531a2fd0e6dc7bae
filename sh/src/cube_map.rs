//! Cube maps: radiance on six square faces.

use crate::ShError;
use crate::{CubePoint, cube_direction, cube_point};
use glam::DVec3;
use pointillist_parallel as parallel;

/// Radiance in all directions, on the six faces of a cube: +X, −X, +Y, −Y, +Z, −Z, each in rows from the top.
///
/// Colors lie in planes, red, green and blue, each with all faces one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeMap {
    size: usize,
    planes: [Vec<f32>; 3],
}

impl CubeMap {
    /// The largest number of texels along an edge; a map of that size takes 3 GiB.
    pub const MAX_SIZE: usize = 8192;

    /// A black one with faces of size × size texels.
    ///
    /// # Errors
    /// `CubeSize` if that is 0 or above [`CubeMap::MAX_SIZE`].
    pub fn black(size: usize) -> Result<Self, ShError> {
        let count = texel_count(size)?;
        Ok(Self { size, planes: std::array::from_fn(|_| vec![0.0; count]) })
    }

    /// From planes of 6·size² texels. Values are checked when they are projected.
    ///
    /// # Errors
    /// `CubeSize`, `CubeTexelCount`.
    pub fn from_planes(size: usize, planes: [Vec<f32>; 3]) -> Result<Self, ShError> {
        let expected = texel_count(size)?;
        match planes.iter().find(|plane| plane.len() != expected) {
            Some(plane) => Err(ShError::CubeTexelCount { size, expected, count: plane.len() }),
            None => Ok(Self { size, planes }),
        }
    }

    /// From 6·size² colors, face after face.
    ///
    /// # Errors
    /// `CubeSize`, `CubeTexelCount`.
    pub fn from_texels(size: usize, texels: &[[f32; 3]]) -> Result<Self, ShError> {
        Self::from_planes(size, std::array::from_fn(|c| texels.iter().map(|texel| texel[c]).collect()))
    }

    /// The radiance that `f` returns for the unit direction of each texel's centre; on all cores.
    ///
    /// # Errors
    /// `CubeSize`.
    pub fn from_fn(size: usize, f: impl Fn(DVec3) -> DVec3 + Send + Sync) -> Result<Self, ShError> {
        texel_count(size)?;
        let row = |i: usize| -> Vec<[f32; 3]> {
            let texel = |x| f(texel_way(size, i / size, x, i % size).normalize()).as_vec3().to_array();
            (0..size).map(texel).collect()
        };
        Self::from_texels(size, &parallel::map_heavy(6 * size, row).concat())
    }

    /// Texels along an edge.
    #[must_use]
    pub const fn size(&self) -> usize {
        self.size
    }

    /// Red, green and blue.
    #[must_use]
    pub const fn planes(&self) -> &[Vec<f32>; 3] {
        &self.planes
    }

    /// Red, green and blue, to write into.
    pub fn planes_mut(&mut self) -> [&mut [f32]; 3] {
        self.planes.each_mut().map(Vec::as_mut_slice)
    }

    /// A texel, or `None` outside.
    #[must_use]
    pub fn texel(&self, face: usize, x: usize, y: usize) -> Option<[f32; 3]> {
        let is_inside = face < 6 && x < self.size && y < self.size;
        is_inside.then(|| {
            let index = (face * self.size + y) * self.size + x;
            self.planes.each_ref().map(|plane| plane[index])
        })
    }

    /// The unit direction of a texel's centre (also for indices beyond the face, on its plane).
    #[must_use]
    pub fn texel_direction(&self, face: usize, x: usize, y: usize) -> DVec3 {
        texel_way(self.size, face, x, y).normalize()
    }

    /// Face, column and row of the texel that a direction meets; `None` for 0 and what is not finite.
    #[must_use]
    pub fn texel_at(&self, direction: DVec3) -> Option<[usize; 3]> {
        let CubePoint { face, s, t } = cube_point(direction)?;
        let at = |v: f64| (((v + 1.0) * 0.5 * self.size as f64) as usize).min(self.size - 1);
        Some([face, at(s), at(t)])
    }
}

/// The number of texels, 6·size²; an error if the size is 0 or above [`CubeMap::MAX_SIZE`].
pub(crate) const fn texel_count(size: usize) -> Result<usize, ShError> {
    if size == 0 || size > CubeMap::MAX_SIZE {
        return Err(ShError::CubeSize { size, limit: CubeMap::MAX_SIZE });
    }
    Ok(6 * size * size)
}

/// The coordinate in (−1, 1) of the centre of a texel. Mirrored texels have exactly opposite coordinates.
pub(crate) fn texel_centre(size: usize, x: usize) -> f64 {
    (2.0 * x as f64 + 1.0 - size as f64) / size as f64
}

fn texel_way(size: usize, face: usize, x: usize, y: usize) -> DVec3 {
    cube_direction(CubePoint { face, s: texel_centre(size, x), t: texel_centre(size, y) })
}
