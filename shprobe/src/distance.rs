//! How near the surfaces are that a probe sees, in every direction, and visibility from that.
//!
//! The nearness of a surface is 1/‖x‖₁ of the offset x at which it is met, with ‖x‖₁ = |x| + |y| + |z|. On the octahedral
//! square that of a plane is linear in every octant: the plane q·x = 1 is met at x = p/nearness for the point p of the
//! octahedron ‖p‖₁ = 1, so that its nearness is q·p. The square is divided into triangles of which none lies in two
//! octants, and interpolation between their corners is exact for planes, also at grazing angles, where distances
//! themselves change by orders of magnitude between two corners. What is open has nearness 0.
//!
//! Where walls meet, nearness is that of the nearest, the largest of linear functions, and what is interpolated between corners on
//! different walls is too near: what lies along an edge would be hidden. So nodes hold their planes as well, as far as they are
//! known. With L interpolated at p, wᵢ the weights of the corners of a triangle, nᵢ their nearness, and
//!
//! 1. Pᵢ = min(max(qᵢ·p, 0), L), or L where no plane is known: planes of walls that meet as in a room are both below L, and
//!    the larger is exact. Across outlines and ridges the plane of one corner is above L at the other, and L is left as it is.
//! 2. nearness is max(P₀, P₁, P₂), but at most max(Pⱼ, Pₖ) + wᵢ·(nᵢ + Q) for each i, with Q the largest coordinate of the three planes.
//!
//! The limit does nothing along edges: P of one end exceeds that of the other by less. It does nothing in triangles of two
//! planes either. With three it keeps nearness continuous: the third plane vanishes towards the edge opposite to its corner, where the
//! next triangle does not know it.

use crate::near_cube::NearCube;
use crate::octahedron::{direction_from_square, square_from_octahedron};
use crate::{ProbeError, parallel};
use glam::{DVec2, DVec3, Vec3, dvec2};

/// Nearness of the surfaces in the directions of the nodes of a grid on the octahedral square, how far it departs
/// from what is interpolated about each, and which planes these surfaces lie in.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceMap {
    /// Cells of the grid on a side.
    size: usize,
    /// Nearness and deviation of each node, row by row.
    nodes: Vec<[f32; 2]>,
    /// The plane q·x = 1 at each node, 0 where it is not known.
    planes: Vec<Vec3>,
}

/// Cells on a side of a map that [`DistanceMap::from_cube`] makes by default: a cell is some 10° wide. With an even number
/// none lies in more than two octants.
pub const DEFAULT_DISTANCE_SIZE: usize = 16;

/// Samples along a cell's side, at least and at most; between these there is one for half a texel of the cube map.
const SAMPLES: [usize; 2] = [2, 8];

/// How much farther than the surface, relative to the position's distance, something is seen for certain: that many
/// deviations, but at most so much. Next to outlines a cell holds a surface that is nearer than both sides. With more, light leaks about
/// the ends of walls. By experiment (`studies shprobe seams`, RMS in corners over the mean with 96 and 192 probes): 1 and 0.05 14.1 and 11.9 %,
/// 0 14.8 and 12.3 %, 3 and 0.2 15.6 and 13.6 %, which also leaves bright specks in `book/scenes/guests.toml`.
const TOLERANCE: f64 = 1.0;
const MOST_TOLERANCE: f64 = 0.05;

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
        let count = 6 * cube_size * cube_size;
        if distances.len() != count {
            return Err(ProbeError::BadDistances { index: distances.len().min(count) });
        }
        if let Some(index) = distances.iter().position(|d| d.is_nan() || *d < 0.0) {
            return Err(ProbeError::BadDistances { index });
        }
        let cube = NearCube::new(cube_size, distances, far);
        let mut map = Self::of_cube(size, &cube);
        map.measure_deviation(&cube);
        Ok(map)
    }

    /// What a cube map shows at nodes, without deviation.
    fn of_cube(size: usize, cube: &NearCube) -> Self {
        let nodes = (size + 1) * (size + 1);
        let found = parallel::map(nodes, |i| {
            let way = direction_from_square(node_square(i, size));
            (
                cube.at(way).min(f64::from(Self::FARTHEST)) as f32,
                cube.plane(way).unwrap_or_default().as_vec3(),
            )
        });
        Self::of_nodes(size, |i| [found[i].0, 0.0]).in_planes(|i| found[i].1)
    }

    /// Sets the deviation of nodes: the RMS, over the cells about each, of what the cube map shows less the map.
    fn measure_deviation(&mut self, cube: &NearCube) {
        let size = self.size;
        let samples = (2 * cube.size() / size).clamp(SAMPLES[0], SAMPLES[1]);
        let errors = parallel::map(size * size, |i| {
            let square = |at: DVec2| {
                // At a texel's middle: between texels on different walls a cube map is wrong itself.
                let (way, nearness) = cube.nearest(direction_from_square(at));
                (nearness - self.corners(way).nearness()).powi(2)
            };
            places(i, size, samples).map(square).sum::<f64>() / (samples * samples) as f64
        });
        let mut sums = vec![[0.0; 2]; self.nodes.len()];
        for (i, error) in errors.iter().enumerate() {
            for corner in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                let sum = &mut sums[canonical(i % size + corner[0], i / size + corner[1], size)];
                *sum = [sum[0] + error, sum[1] + 1.0];
            }
        }
        let most = f64::from(Self::FARTHEST);
        for (node, i) in self.nodes.iter_mut().zip(canonical_nodes(size)) {
            let [error, count] = sums[i];
            node[1] = (error / count).sqrt().min(most) as f32;
        }
    }

    /// Without planes.
    fn of_nodes(size: usize, node: impl Fn(usize) -> [f32; 2]) -> Self {
        let nodes: Vec<[f32; 2]> = canonical_nodes(size).map(node).collect();
        Self { size, planes: vec![Vec3::ZERO; nodes.len()], nodes }
    }

    /// Adds the planes that surfaces lie in, one for each node as in [`DistanceMap::new`]: q for the plane q·x = 1, in one over world
    /// units from the probe, and 0 where there is none. Nearness of a node follows its plane; a plane that is not met in its direction is
    /// none. Nearness between nodes on two walls that meet in an edge is then exact.
    ///
    /// # Errors
    /// [`ProbeError::BadDistances`] if there is not one for each node, or a coordinate is not finite or beyond
    /// [`DistanceMap::FARTHEST`].
    pub fn with_planes(self, planes: &[[f32; 3]]) -> Result<Self, ProbeError> {
        let count = self.nodes.len();
        if planes.len() != count {
            return Err(ProbeError::BadDistances { index: planes.len().min(count) });
        }
        let bad = |q: &[f32; 3]| !q.iter().all(|v| v.abs() <= Self::FARTHEST);
        match planes.iter().position(bad) {
            Some(index) => Err(ProbeError::BadDistances { index }),
            None => Ok(self.in_planes(|i| Vec3::from(planes[i]))),
        }
    }

    /// Puts the surfaces of nodes into these planes: nearness follows them. Planes that are not met are none.
    fn in_planes(mut self, plane: impl Fn(usize) -> Vec3) -> Self {
        for (i, from) in canonical_nodes(self.size).enumerate() {
            let way = direction_from_square(node_square(from, self.size));
            let plane = plane(from);
            let nearness = plane.as_dvec3().dot(way / way.abs().element_sum()) as f32;
            if nearness > 0.0 && nearness <= Self::FARTHEST && plane.abs().max_element() <= Self::FARTHEST {
                self.nodes[i][0] = nearness;
                self.planes[i] = plane;
            }
        }
        self
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

    /// The plane of each node, row by row, as [`DistanceMap::with_planes`] takes them.
    #[must_use]
    pub fn planes(&self) -> &[Vec3] {
        &self.planes
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
        let here = self.corners(offset / distance);
        let deviation = here.deviation();
        let uncertain = deviation * distance / UNCERTAIN;
        let certain = 1.0 / (1.0 + uncertain * uncertain);
        // What is in front of what is interpolated is in front of every plane that counts, too.
        if here.interpolated() * distance <= 1.0 {
            return [1.0, certain];
        }
        let nearness = here.nearness();
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

    /// The triangle that a point of the octahedron lies in: cells are divided along the diagonal that is parallel to the edge between
    /// the upper and the lower octant of their quadrant.
    fn corners(&self, point: DVec3) -> Corners<'_> {
        let size = self.size;
        let p = square_from_octahedron(point) * size as f64;
        // Rounding must not lead beyond the last cell.
        let (x, y) = ((p.x as usize).min(size - 1), (p.y as usize).min(size - 1));
        let (s, t) = (p.x - x as f64, p.y - y as f64);
        let low = y * (size + 1) + x;
        let high = low + size + 1;
        let falls = (2 * x + 1 > size) == (2 * y + 1 > size);
        let (nodes, weights) = match (falls, s + t <= 1.0, s >= t) {
            (true, true, _) => ([low, low + 1, high], [1.0 - s - t, s, t]),
            (true, false, _) => ([high + 1, high, low + 1], [s + t - 1.0, 1.0 - s, 1.0 - t]),
            (false, _, true) => ([low, low + 1, high + 1], [1.0 - s, s - t, t]),
            (false, _, false) => ([low, high, high + 1], [1.0 - t, t - s, s]),
        };
        Corners { map: self, point, nodes, weights }
    }
}

/// A point of the octahedron in its triangle.
struct Corners<'a> {
    map: &'a DistanceMap,
    point: DVec3,
    nodes: [usize; 3],
    weights: [f64; 3],
}

impl Corners<'_> {
    fn sum(&self, value: usize) -> f64 {
        let parts = self.nodes.iter().zip(self.weights);
        parts.map(|(&node, weight)| f64::from(self.map.nodes[node][value]) * weight).sum()
    }

    fn interpolated(&self) -> f64 {
        self.sum(0)
    }

    fn deviation(&self) -> f64 {
        self.sum(1)
    }

    /// See the module's documentation.
    fn nearness(&self) -> f64 {
        let most = self.interpolated();
        let planes = self.nodes.map(|node| self.map.planes[node]);
        let [a, b, c] = planes.map(|q| match q == Vec3::ZERO {
            true => most,
            false => q.as_dvec3().dot(self.point).clamp(0.0, most),
        });
        let largest = f64::from(planes.iter().fold(0.0, |most: f32, q| most.max(q.abs().max_element())));
        let limit = |i: usize, others: f64| {
            let own = f64::from(self.map.nodes[self.nodes[i]][0]);
            others + self.weights[i].max(0.0) * (own + largest)
        };
        a.max(b).max(c).min(limit(0, b.max(c))).min(limit(1, a.max(c))).min(limit(2, a.max(b)))
    }
}

/// Where a node lies on the square.
fn node_square(node: usize, size: usize) -> DVec2 {
    dvec2((node % (size + 1)) as f64, (node / (size + 1)) as f64) / size as f64
}

/// For all nodes, row by row, the first of the same direction.
fn canonical_nodes(size: usize) -> impl Iterator<Item = usize> {
    (0..=size).flat_map(move |y| (0..=size).map(move |x| canonical(x, y, size)))
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
