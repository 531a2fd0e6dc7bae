//! Distances from a probe to the nearest surface in every direction, and visibility from them.

use crate::octahedron::{direction_from_square, square_from_direction, wrapped};
use crate::sh::{CubePoint, cube_direction, texel_solid_angle};
use crate::{ProbeError, parallel};
use glam::{DVec3, dvec2};

/// Mean distance to the nearest surface, and its mean square, in the directions of an octahedral square.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceMap {
    size: usize,
    /// Lower bound of the standard deviation, world units: visibility is continuous also where a probe touches a surface.
    least: f64,
    /// Mean and mean square of each texel, row by row.
    moments: Vec<[f32; 2]>,
}

/// Texels on a side of a map that [`DistanceMap::from_cube`] makes by default: a texel is some 10° wide.
pub const DEFAULT_DISTANCE_SIZE: usize = 16;

/// Lower bound of the standard deviation of a texel's distances, relative to their mean.
const RELATIVE_SLACK: f64 = 0.01;

/// The same over the mean of all texels.
const LEAST_SLACK: f64 = 1e-3;

/// Refuses a size of 0, and one above [`DistanceMap::MAX_SIZE`].
const fn check_size(size: usize) -> Result<(), ProbeError> {
    let limit = DistanceMap::MAX_SIZE;
    if size == 0 || size > limit { Err(ProbeError::MapSize { size, limit }) } else { Ok(()) }
}

impl DistanceMap {
    /// Most texels along an edge, of maps and of cube maps of distances.
    pub const MAX_SIZE: usize = 8192;

    /// Largest distance, world units: its square is finite in single precision.
    pub const FARTHEST: f32 = 1e19;

    /// A map of these moments: mean (world units) and mean square of each texel of a `size` × `size` square, row by
    /// row.
    ///
    /// # Errors
    /// [`ProbeError::MapSize`]; [`ProbeError::BadDistances`] if there are not `size²`, or one is negative or not
    /// finite.
    pub fn new(size: usize, moments: Vec<[f32; 2]>) -> Result<Self, ProbeError> {
        check_size(size)?;
        if moments.len() != size * size {
            return Err(ProbeError::BadDistances { index: moments.len().min(size * size) });
        }
        let bad = |m: &[f32; 2]| !m.iter().all(|v| v.is_finite() && *v >= 0.0);
        match moments.iter().position(bad) {
            Some(index) => Err(ProbeError::BadDistances { index }),
            None => Ok(Self::of_moments(size, moments)),
        }
    }

    /// A map from a cube map of distances: six faces of `cube_size`² texels, row by row. Distances above `far`, also
    /// infinite ones, count as `far`: world units, above 0, at most [`DistanceMap::FARTHEST`].
    ///
    /// # Errors
    /// [`ProbeError::MapSize`] if either size is 0 or above [`DistanceMap::MAX_SIZE`]; [`ProbeError::BadOption`] for
    /// `far`; [`ProbeError::BadDistances`] if there are not `6 · cube_size²`, or one is negative or NaN.
    pub fn from_cube(size: usize, cube_size: usize, distances: &[f32], far: f32) -> Result<Self, ProbeError> {
        check_size(size)?;
        check_size(cube_size)?;
        if !(far > 0.0 && far <= Self::FARTHEST) {
            let range = "it must be above 0 and at most 1e19";
            return Err(ProbeError::BadOption { name: "far", value: f64::from(far), range });
        }
        let area = cube_size * cube_size;
        if distances.len() != 6 * area {
            return Err(ProbeError::BadDistances { index: distances.len().min(6 * area) });
        }
        if let Some(index) = distances.iter().position(|d| d.is_nan() || *d < 0.0) {
            return Err(ProbeError::BadDistances { index });
        }
        let mut sums = vec![[0.0_f64; 3]; size * size];
        let weights: Vec<f64> =
            (0..area).map(|i| texel_solid_angle(cube_size, i % cube_size, i / cube_size)).collect();
        for (i, distance) in distances.iter().enumerate() {
            let (face, texel) = (i / area, i % area);
            let square = square_from_direction(direction(face, texel, cube_size)) * size as f64;
            let (x, y) = ((square.x as usize).min(size - 1), (square.y as usize).min(size - 1));
            let (distance, weight) = (f64::from(distance.min(far)), weights[texel]);
            let sum = &mut sums[y * size + x];
            *sum = [sum[0] + weight, sum[1] + weight * distance, sum[2] + weight * distance * distance];
        }
        let moments = parallel::map(size * size, |i| {
            let [weight, first, second] = sums[i];
            if weight > 0.0 {
                return [(first / weight) as f32, (second / weight) as f32];
            }
            // No texel of the cube is centred here: the one that this texel's centre lies in.
            let at = (dvec2((i % size) as f64, (i / size) as f64) + 0.5) / size as f64;
            let distance = nearest(direction_from_square(at), cube_size, distances).min(far);
            [distance, distance * distance]
        });
        Ok(Self::of_moments(size, moments))
    }

    fn of_moments(size: usize, moments: Vec<[f32; 2]>) -> Self {
        let mean = moments.iter().map(|m| f64::from(m[0])).sum::<f64>() / moments.len() as f64;
        Self { size, least: LEAST_SLACK * mean, moments }
    }

    /// Texels on a side.
    #[must_use]
    pub const fn size(&self) -> usize {
        self.size
    }

    /// Mean and mean square of each texel, row by row.
    #[must_use]
    pub fn moments(&self) -> &[[f32; 2]] {
        &self.moments
    }

    /// Share of the neighbourhood of a position that the probe sees, 0 to 1. `offset` leads from the probe to the
    /// position, world units. Continuous in the position; NaN for an offset that is not finite.
    ///
    /// Where the position is farther than the mean distance of the surface, Chebyshev's inequality bounds the share of
    /// the surface that is farther still (Donnelly & Lauritzen, *Variance shadow maps*, 2006, eq. 5). The bound is
    /// cubed to reduce light leaks at edges.
    #[must_use]
    pub fn visibility(&self, offset: DVec3) -> f64 {
        let distance = offset.length();
        if distance == 0.0 {
            return 1.0;
        }
        let [mean, square] = self.at(offset);
        let behind = distance - mean;
        if behind <= 0.0 {
            return 1.0;
        }
        let slack = (mean * RELATIVE_SLACK).max(self.least);
        let variance = (square - mean * mean).max(0.0) + slack * slack;
        // As a ratio of lengths: squares of tiny ones would be 0 by 0.
        let deviations = behind / variance.sqrt();
        let seen = 1.0 / (1.0 + deviations * deviations);
        seen * seen * seen
    }

    /// The moments in a direction, interpolated between texels.
    fn at(&self, direction: DVec3) -> [f64; 2] {
        let size = self.size as i32;
        let p = square_from_direction(direction) * f64::from(size) - 0.5;
        let low = p.floor();
        let t = p - low;
        let texel = |dx: i32, dy: i32| {
            let (x, y) = wrapped(low.x as i32 + dx, low.y as i32 + dy, size);
            self.moments[(y * size + x) as usize].map(f64::from)
        };
        let corners = [texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)];
        let weights = [(1.0 - t.x) * (1.0 - t.y), t.x * (1.0 - t.y), (1.0 - t.x) * t.y, t.x * t.y];
        [0, 1].map(|k| corners.iter().zip(weights).map(|(c, w)| c[k] * w).sum())
    }
}

fn direction(face: usize, texel: usize, size: usize) -> DVec3 {
    let to_unit = |i: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    cube_direction(CubePoint { face, s: to_unit(texel % size), t: to_unit(texel / size) })
}

/// The texel of a cube map that a direction lies in.
fn nearest(d: DVec3, size: usize, texels: &[f32]) -> f32 {
    let Some(point) = crate::sh::cube_point(d) else { return 0.0 };
    let column = |s: f64| (((s + 1.0) * 0.5 * size as f64) as usize).min(size - 1);
    texels[(point.face * size + column(point.t)) * size + column(point.s)]
}
