//! How near the surfaces are that a probe sees, in every direction, and visibility from that.
//!
//! The nearness of a surface is 1/‖x‖₁ of the offset x at which it is met, with ‖x‖₁ = |x| + |y| + |z|. On the octahedral
//! square that of a plane is linear in every octant: the plane n·x = h is met at x = p/nearness for the point p of the
//! octahedron ‖p‖₁ = 1, so that its nearness is n·p/h. The square is divided into triangles of which none lies in two
//! octants, and interpolation between their corners is exact for planes, also at grazing angles, where distances
//! themselves change by orders of magnitude between two corners. What is open has nearness 0.

use crate::octahedron::{direction_from_square, square_from_octahedron};
use crate::sh::{CubePoint, cube_direction, cube_point};
use crate::{ProbeError, parallel};
use glam::{DVec2, DVec3, dvec2};

/// Nearness of the surfaces in the directions of the nodes of a grid on the octahedral square, and how far it departs
/// from what is interpolated about each.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceMap {
    /// Cells of the grid on a side.
    size: usize,
    /// Nearness and deviation of each node, row by row.
    nodes: Vec<[f32; 2]>,
}

/// Cells on a side of a map that [`DistanceMap::from_cube`] makes by default: a cell is some 10° wide. With an even number
/// none lies in more than two octants.
pub const DEFAULT_DISTANCE_SIZE: usize = 16;

/// Samples along a cell's side, at least and at most; between these there is one for half a texel of the cube map.
const SAMPLES: [usize; 2] = [2, 8];

/// Least distance that counts, over the mean of all: visibility is continuous also where a probe touches a surface.
const LEAST: f64 = 1e-3;

/// How much farther than the surface, relative to the position's distance, something is seen for certain: that many
/// deviations, but at most so much. Where two walls meet, the square holds a surface that is nearer than both: without
/// this what is in corners would be hidden. With more, light leaks about edges. By experiment, with two rooms as in
/// `studies shprobe seams` and with `examples/house.toml`: 2 to 4 deviations and 0.05 to 0.2; the corners of the rooms
/// err least with much tolerance (RMS of ln ratio 0.21 with 4, 0.30 with 2), those of the house with little (0.67, 0.58).
const TOLERANCE: f64 = 3.0;
const MOST_TOLERANCE: f64 = 0.2;

/// Deviation that is added to that of every node, relative to nearness.
const SLACK: f64 = 0.02;

/// Deviation over the nearness of the position at which what a probe sees is half as certain: a probe close behind a wall
/// sees along it, and a cell does not tell one side from the other there. By experiment as above: without this the corners
/// of the house err twice as much; 0.03 and 0.05 err no less there, and more on the wall of the rooms.
const UNCERTAIN: f64 = 0.1;

/// Refuses a size of 0, and one above [`DistanceMap::MAX_SIZE`].
const fn check_size(size: usize) -> Result<(), ProbeError> {
    let limit = DistanceMap::MAX_SIZE;
    if size == 0 || size > limit { Err(ProbeError::MapSize { size, limit }) } else { Ok(()) }
}

impl DistanceMap {
    /// Most cells along an edge of a map, and texels along one of a cube map of distances.
    pub const MAX_SIZE: usize = 8192;

    /// Largest distance, world units; a surface that is nearer than its inverse counts as that near.
    pub const FARTHEST: f32 = 1e19;

    /// A map of nearness (one over world units, 0 where nothing is) and its deviation at each of (`size` + 1)² nodes, row by
    /// row. Of nodes at the rim that have the same direction the first counts.
    ///
    /// # Errors
    /// [`ProbeError::MapSize`]; [`ProbeError::BadDistances`] if there are not (`size` + 1)², or one is negative or not
    /// finite.
    pub fn new(size: usize, nodes: &[[f32; 2]]) -> Result<Self, ProbeError> {
        check_size(size)?;
        let count = (size + 1) * (size + 1);
        if nodes.len() != count {
            return Err(ProbeError::BadDistances { index: nodes.len().min(count) });
        }
        let bad = |m: &[f32; 2]| !m.iter().all(|v| v.is_finite() && *v >= 0.0);
        match nodes.iter().position(bad) {
            Some(index) => Err(ProbeError::BadDistances { index }),
            None => Ok(Self::of_nodes(size, |i| nodes[i])),
        }
    }

    /// A map of surfaces that are equally far in all directions, ‖x‖₁ = `distance` in world units; infinite is open space.
    ///
    /// # Errors
    /// [`ProbeError::BadOption`] if the distance is not above 0.
    pub fn open(distance: f32) -> Result<Self, ProbeError> {
        if distance > 0.0 {
            let nearness = distance.recip().min(Self::FARTHEST);
            return Ok(Self::of_nodes(1, |_| [nearness, 0.0]));
        }
        let range = "it must be above 0";
        Err(ProbeError::BadOption { name: "distance", value: f64::from(distance), range })
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
        let least = LEAST * mean_of(distances, far);
        // In the metric of the cube, ‖x‖∞, in which planes are linear on its faces.
        let nearness = |i: usize| {
            let distance = f64::from(distances[i].min(far)).max(least);
            1.0 / (distance * direction(i / area, i % area, cube_size).normalize().abs().max_element())
        };
        let cube: Vec<f64> = (0..6 * area).map(nearness).collect();
        let sample = |at: DVec2| {
            let way = direction_from_square(at);
            between_texels(way, cube_size, &cube) * way.abs().max_element() / way.abs().element_sum()
        };
        let most = f64::from(Self::FARTHEST);
        let at_node = |i: usize| dvec2((i % (size + 1)) as f64, (i / (size + 1)) as f64) / size as f64;
        let found = parallel::map((size + 1) * (size + 1), |i| sample(at_node(i)).min(most) as f32);
        let mut map = Self::of_nodes(size, |i| [found[i], 0.0]);
        let samples = (2 * cube_size / size).clamp(SAMPLES[0], SAMPLES[1]);
        let errors = parallel::map(size * size, |i| {
            let square = |at: DVec2| (sample(at) - map.at(at)[0]).powi(2);
            places(i, size, samples).map(square).sum::<f64>() / (samples * samples) as f64
        });
        let mut sums = vec![[0.0; 2]; map.nodes.len()];
        for (i, error) in errors.iter().enumerate() {
            for corner in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                let sum = &mut sums[canonical(i % size + corner[0], i / size + corner[1], size)];
                *sum = [sum[0] + error, sum[1] + 1.0];
            }
        }
        for (i, node) in map.nodes.iter_mut().enumerate() {
            let [error, count] = sums[canonical(i % (size + 1), i / (size + 1), size)];
            node[1] = (error / count).sqrt().min(most) as f32;
        }
        Ok(map)
    }

    fn of_nodes(size: usize, node: impl Fn(usize) -> [f32; 2]) -> Self {
        let each = (0..=size).flat_map(|y| (0..=size).map(move |x| (x, y)));
        Self { size, nodes: each.map(|(x, y)| node(canonical(x, y, size))).collect() }
    }

    /// Cells on a side.
    #[must_use]
    pub const fn size(&self) -> usize {
        self.size
    }

    /// Nearness and deviation of each node, row by row, as [`DistanceMap::new`] takes them.
    #[must_use]
    pub fn nodes(&self) -> &[[f32; 2]] {
        &self.nodes
    }

    /// How much of the neighbourhood of a position the probe sees, and how certainly: 0 to 1. `offset` leads from the
    /// probe to the position, world units. Continuous in the position; NaN for an offset that is not finite.
    ///
    /// Where the position is less near than the surface, beyond a tolerance, Chebyshev's inequality bounds the share of
    /// the surface that is farther still (Donnelly & Lauritzen, *Variance shadow maps*, 2006, eq. 5), here with nearness
    /// in place of distance. The bound is cubed to reduce light leaks at edges.
    #[must_use]
    pub fn visibility(&self, offset: DVec3) -> f64 {
        let [seen, certain] = self.seen(offset);
        seen * certain
    }

    /// How much of the neighbourhood of a position is seen, and how certain that is.
    pub(crate) fn seen(&self, offset: DVec3) -> [f64; 2] {
        let distance = offset.abs().element_sum();
        if distance == 0.0 {
            return [1.0; 2];
        }
        let [nearness, deviation] = self.at(square_from_octahedron(offset / distance));
        let uncertain = deviation * distance / UNCERTAIN;
        let certain = 1.0 / (1.0 + uncertain * uncertain);
        let beyond = nearness * distance;
        if beyond <= 1.0 {
            return [1.0, certain];
        }
        let deviation = deviation / nearness;
        let behind = 1.0 - 1.0 / beyond - (TOLERANCE * deviation).min(MOST_TOLERANCE);
        if behind <= 0.0 {
            return [1.0, certain];
        }
        let seen = 1.0 / (1.0 + behind * behind / (SLACK * SLACK + deviation * deviation));
        [seen * seen * seen, certain]
    }

    /// Nearness and deviation at a point of the square, interpolated in a triangle: cells are divided along the diagonal
    /// that is parallel to the edge between the upper and the lower octant of their quadrant.
    fn at(&self, square: DVec2) -> [f64; 2] {
        let size = self.size;
        let p = square * size as f64;
        // Rounding must not lead beyond the last cell.
        let (x, y) = ((p.x as usize).min(size - 1), (p.y as usize).min(size - 1));
        let (s, t) = (p.x - x as f64, p.y - y as f64);
        let low = &self.nodes[y * (size + 1) + x..][..2];
        let high = &self.nodes[(y + 1) * (size + 1) + x..][..2];
        let falls = (2 * x + 1 > size) == (2 * y + 1 > size);
        let (corners, [u, v, w]) = match (falls, s + t <= 1.0, s >= t) {
            (true, true, _) => ([low[0], low[1], high[0]], [1.0 - s - t, s, t]),
            (true, false, _) => ([high[1], high[0], low[1]], [s + t - 1.0, 1.0 - s, 1.0 - t]),
            (false, _, true) => ([low[0], low[1], high[1]], [1.0 - s, s - t, t]),
            (false, _, false) => ([low[0], high[0], high[1]], [1.0 - t, t - s, s]),
        };
        [0, 1].map(|k| {
            let [a, b, c] = corners.map(|corner| f64::from(corner[k]));
            a * u + b * v + c * w
        })
    }
}

/// The first of the nodes of the same direction: those at the rim are mirrored about the middle of their side.
fn canonical(x: usize, y: usize, size: usize) -> usize {
    let is_rim = |v: usize| v == 0 || v == size;
    let (x, y) = match (is_rim(x), is_rim(y)) {
        (true, true) => (0, 0),
        (true, false) => (x, y.min(size - y)),
        (false, true) => (x.min(size - x), y),
        (false, false) => (x, y),
    };
    y * (size + 1) + x
}

/// The middles of equal parts of a cell, on the square.
fn places(cell: usize, size: usize, parts: usize) -> impl Iterator<Item = DVec2> {
    let corner = dvec2((cell % size) as f64, (cell / size) as f64);
    let part = move |k: usize| dvec2((k % parts) as f64, (k / parts) as f64) + 0.5;
    (0..parts * parts).map(move |k| (corner + part(k) / parts as f64) / size as f64)
}

/// The mean of distances of which none counts as more than `far`; above 0.
fn mean_of(distances: &[f32], far: f32) -> f64 {
    let sum: f64 = distances.iter().map(|d| f64::from(d.min(far))).sum();
    (sum / distances.len() as f64).max(f64::from(DistanceMap::FARTHEST.recip()))
}

fn direction(face: usize, texel: usize, size: usize) -> DVec3 {
    let to_unit = |i: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    cube_direction(CubePoint { face, s: to_unit(texel % size), t: to_unit(texel / size) })
}

/// The value in a direction of what a cube map holds, linear between the middles of texels of a face and beyond the
/// outer ones; at least 0.
fn between_texels(way: DVec3, size: usize, texels: &[f64]) -> f64 {
    let Some(point) = cube_point(way) else { return 0.0 };
    let column = |s: f64| {
        let x = (s + 1.0) * 0.5 * size as f64 - 0.5;
        let low = x.floor().clamp(0.0, size.saturating_sub(2) as f64);
        (low as usize, if size > 1 { x - low } else { 0.0 })
    };
    let ((x, s), (y, t)) = (column(point.s), column(point.t));
    let texel = |x: usize, y: usize| texels[(point.face * size + y.min(size - 1)) * size + x.min(size - 1)];
    let row = |y: usize| texel(x, y) + (texel(x + 1, y) - texel(x, y)) * s;
    (row(y) + (row(y + 1) - row(y)) * t).max(0.0)
}
