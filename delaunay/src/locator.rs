//! Finds the cell that holds a position, and the weights of its points there.

use crate::blend::Blend;
use crate::hull::Hull;
use crate::scale::power_of_two_to_one;
use crate::simplex::{HULL, Simplex};
use crate::vertices::Vertices;
use crate::walk::End;
use crate::{DelaunayError, OUTSIDE, Partition, parallel};
use glam::{DVec3, UVec3, dvec3, uvec3};

/// The cell in which the last query ended: the next query starts there. Keep one for each moving object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hint(u32);

impl Hint {
    /// Starts at an arbitrary cell.
    pub const START: Self = Self(0);
}

/// Finds the cell that holds a position, and the weights of its corners there: barycentric coordinates.
///
/// Positions outside of the points' hull get the weights of the nearest point on it: weights are continuous everywhere.
/// The walk from cell to cell is in `f64`: within 1e-12 of a side it may end in either of the cells beside it, whose
/// weights agree there. It passes cells that are flat up to rounding, and ends in one beside them.
///
/// ```
/// use glam::dvec3;
/// use pointillist_delaunay::{Delaunay, Locator};
///
/// // A function that is known at four points, and is linear between them.
/// let values = [1.0, 2.0, 1.0, 1.0];
/// let delaunay = Delaunay::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])?;
/// let locator = Locator::new(delaunay.points(), &delaunay.partition())?;
/// let blend = locator.locate_anywhere(dvec3(0.25, 0.25, 0.25))?;
/// let value: f64 = blend.parts().map(|(point, weight)| weight * values[point as usize]).sum();
/// assert_eq!(value, 1.25);
/// # Ok::<(), pointillist_delaunay::DelaunayError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Locator {
    pub(crate) cells: Vec<Simplex>,
    pub(crate) vertices: Vertices,
    pub(crate) hull: Hull,
    centre: DVec3,
    scale: f64,
    starts: Starts,
    /// The point that answers all queries where there is no cell.
    only: u32,
}

/// Positions farther from the middle than this many sizes of the hull are moved to that distance.
const FAR: f64 = 1e60;

impl Locator {
    /// For points and the cells between them, as [`Delaunay::partition`](crate::Delaunay::partition) gives them.
    ///
    /// # Errors
    /// [`DelaunayError::PointNotFinite`], and [`DelaunayError::BadCell`] for cells that are not between these points.
    pub fn new(positions: &[DVec3], partition: &Partition) -> Result<Self, DelaunayError> {
        if let Some(index) = positions.iter().position(|p| !p.is_finite()) {
            return Err(DelaunayError::PointNotFinite { index });
        }
        partition.check(positions.len())?;
        let (low, high) = positions
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        // Halved first: the sum or the difference of two large numbers could overflow.
        let centre = low * 0.5 + high * 0.5;
        let scale = power_of_two_to_one((high * 0.5 - low * 0.5).max_element().max(0.0));
        let vertices = Vertices::new(positions, centre, scale);
        let mut facets = Facets { vertices: &vertices, corners: vec![], outward: vec![] };
        let cells = cells(&vertices, partition, &mut facets);
        let Facets { corners, outward, .. } = facets;
        let hull = Hull::new(vertices.len(), corners, outward);
        let only = if let Partition::Point(only) = partition { *only } else { 0 };
        let mut locator = Self { cells, vertices, hull, centre, scale, starts: Starts::default(), only };
        locator.starts = Starts::new(&locator);
        Ok(locator)
    }

    /// The blend at `p`. The walk starts from `hint`, which is set to where it ends.
    ///
    /// # Errors
    /// [`DelaunayError::QueryNotFinite`].
    #[inline]
    pub fn locate(&self, p: DVec3, hint: &mut Hint) -> Result<Blend, DelaunayError> {
        let p = self.local(p)?;
        Ok(self.blend(p, hint))
    }

    /// The blend at `p`, without a hint.
    ///
    /// # Errors
    /// [`DelaunayError::QueryNotFinite`].
    #[inline]
    pub fn locate_anywhere(&self, p: DVec3) -> Result<Blend, DelaunayError> {
        let p = self.local(p)?;
        Ok(self.blend(p, &mut Hint(self.starts.at(p))))
    }

    /// The cell that holds `p`: an index of [`Partition::cell`], or `None` outside of the hull. The walk starts from
    /// `hint`, which is set to where it ends. A position up to 1e-12 of a cell's height outside of it counts as inside.
    /// Where all points lie in a plane or on a line, the projection of `p` counts; a single point's cell is everywhere.
    ///
    /// # Errors
    /// [`DelaunayError::QueryNotFinite`].
    ///
    /// ```
    /// use glam::{DVec3, dvec3};
    /// use pointillist_delaunay::{Delaunay, Hint, Locator};
    ///
    /// let delaunay = Delaunay::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])?;
    /// let locator = Locator::new(delaunay.points(), &delaunay.partition())?;
    /// let mut hint = Hint::START;
    /// assert_eq!(locator.cell(dvec3(0.1, 0.2, 0.3), &mut hint)?, Some(0));
    /// assert_eq!(locator.cell(DVec3::ONE, &mut hint)?, None);
    /// # Ok::<(), pointillist_delaunay::DelaunayError>(())
    /// ```
    pub fn cell(&self, p: DVec3, hint: &mut Hint) -> Result<Option<u32>, DelaunayError> {
        let p = self.local(p)?;
        if self.cells.is_empty() {
            return Ok(Some(0));
        }
        let (cell, is_inside) = match self.walk(p, hint.0) {
            End::Inside { cell, .. } => (cell, true),
            End::Outside { cell, .. } => (cell, false),
        };
        *hint = Hint(cell);
        Ok(is_inside.then_some(cell))
    }

    /// The blends at many positions, on all cores.
    ///
    /// # Errors
    /// [`DelaunayError::QueryNotFinite`] for the first that is not.
    pub fn locate_all(&self, positions: &[DVec3]) -> Result<Vec<Blend>, DelaunayError> {
        if let Some(index) = positions.iter().position(|p| !p.is_finite()) {
            return Err(DelaunayError::QueryNotFinite { index });
        }
        let unanswered = Blend::of_one(self.only);
        Ok(parallel::map(positions.len(), |i| self.locate_anywhere(positions[i]).unwrap_or(unanswered)))
    }

    /// A hint for a position without one, from a coarse grid.
    #[must_use]
    pub fn hint(&self, p: DVec3) -> Hint {
        self.local(p).map_or(Hint::START, |p| Hint(self.starts.at(p)))
    }

    #[inline]
    fn blend(&self, p: DVec3, hint: &mut Hint) -> Blend {
        if self.cells.is_empty() {
            return Blend::of_one(self.only);
        }
        match self.walk(p, hint.0) {
            End::Inside { cell, coordinates } => {
                *hint = Hint(cell);
                Blend::clamped(self.cells[cell as usize].corners, coordinates)
            }
            End::Outside { cell, facet } => {
                *hint = Hint(cell);
                self.blend_outside(p, facet)
            }
        }
    }

    /// The blend at the point of the hull that is nearest to `p`, found from `facet` on. Not inlined: the usual case, a position
    /// inside, would be slower.
    #[inline(never)]
    fn blend_outside(&self, p: DVec3, facet: u32) -> Blend {
        let nearest = self.hull.nearest(&self.vertices, facet, p);
        let ([a, b, c], [wa, wb, wc]) = (nearest.corners, nearest.weights);
        Blend::clamped([a, b, c, a], [wa, wb, wc, 0.0])
    }

    #[inline]
    fn local(&self, p: DVec3) -> Result<DVec3, DelaunayError> {
        if !p.is_finite() {
            return Err(DelaunayError::QueryNotFinite { index: 0 });
        }
        let local = (p - self.centre) * self.scale;
        let size = local.abs().max_element();
        if size <= FAR {
            return Ok(local);
        }
        // A position in the same direction, so near that squares of distances do not overflow.
        let half = p * 0.5 - self.centre * 0.5;
        Ok(half * power_of_two_to_one(half.abs().max_element()) * FAR)
    }
}

/// Collects the facets of the hull.
struct Facets<'a> {
    vertices: &'a Vertices,
    corners: Vec<[u32; 3]>,
    outward: Vec<DVec3>,
}

impl Facets<'_> {
    /// Adds a facet whose outer side is the one where `inner` is not; its number, marked.
    fn add(&mut self, corners: [u32; 3], inner: u32) -> u32 {
        let [a, b, c] = corners.map(|i| self.vertices.at(i));
        let inward = self.vertices.at(inner) - a;
        // 0 for an edge of a plane's hull and an end of a line's: with so few neighbours, all are asked.
        let outward = (b - a).cross(c - a);
        self.corners.push(corners);
        let height = outward.dot(inward);
        let reach = (b - a).length().max((c - a).length()).max(inward.length());
        // Which side of a flat cell is the inner one, only exact arithmetic would tell.
        let is_flat = height.abs() <= self.vertices.flat_below(reach) * outward.length();
        self.outward.push(if is_flat { DVec3::ZERO } else { outward * -height.signum() });
        (self.corners.len() as u32 - 1) | HULL
    }
}

fn cells(vertices: &Vertices, partition: &Partition, facets: &mut Facets<'_>) -> Vec<Simplex> {
    match partition {
        Partition::Point(_) => vec![],
        Partition::Line(line) => {
            let last = line.len().saturating_sub(2);
            let segment = |(i, ends): (usize, &[u32])| {
                let (a, b) = (ends[0], ends[1]);
                // Opposite the first corner lies what follows.
                let after = if i == last { facets.add([b; 3], a) } else { i as u32 + 1 };
                let before = if i == 0 { facets.add([a; 3], b) } else { i as u32 - 1 };
                Simplex::segment(vertices, [a, b], [after, before])
            };
            line.windows(2).enumerate().map(segment).collect()
        }
        Partition::Triangles(triangles) => {
            let triangle = |(corners, mut next): (&[u32; 3], [u32; 3])| {
                for k in 0..3 {
                    if next[k] == OUTSIDE {
                        let (a, b) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
                        next[k] = facets.add([a, b, b], corners[k]);
                    }
                }
                Simplex::triangle(vertices, *corners, next)
            };
            triangles.corners.iter().zip(triangles.neighbours.iter().copied()).map(triangle).collect()
        }
        Partition::Tetrahedra(tetrahedra) => {
            let tetrahedron = |(corners, mut next): (&[u32; 4], [u32; 4])| {
                for k in 0..4 {
                    if next[k] == OUTSIDE {
                        let others = [1, 2, 3].map(|i| corners[(k + i) % 4]);
                        next[k] = facets.add(others, corners[k]);
                    }
                }
                Simplex::tetrahedron(vertices, *corners, next)
            };
            tetrahedra.corners.iter().zip(tetrahedra.neighbours.iter().copied()).map(tetrahedron).collect()
        }
    }
}

/// A coarse grid over the hull, with a cell near the middle of each of its boxes, at which walks start.
#[derive(Clone, Debug, Default)]
struct Starts {
    low: DVec3,
    per_unit: DVec3,
    size: UVec3,
    cells: Vec<u32>,
}

/// Cells for each box of the grid of starts.
const CELLS_PER_BOX: f64 = 4.0;

impl Starts {
    fn new(locator: &Locator) -> Self {
        if locator.cells.is_empty() {
            return Self::default();
        }
        let (low, high) = locator.vertices.bounds();
        // Flat extents count for little, so that a plane of points gets a plane of boxes.
        let extent = (high - low).max(DVec3::splat((high - low).max_element() * 1e-6));
        let boxes = (locator.cells.len() as f64 / CELLS_PER_BOX).max(1.0);
        let size = box_counts(extent, boxes);
        let mut starts = Self { low, per_unit: size.as_dvec3() / extent, size, cells: vec![] };
        let rows = (size.y * size.z) as usize;
        let row = |row: usize, list: &mut Vec<u32>| {
            let mut hint = Hint(((row * locator.cells.len()) / rows) as u32);
            for x in 0..size.x {
                let at = uvec3(x, row as u32 % size.y, row as u32 / size.y);
                let middle = low + (at.as_dvec3() + 0.5) / starts.per_unit;
                let _ = locator.blend(middle, &mut hint);
                list.push(hint.0);
            }
        };
        starts.cells = parallel::flat_map(rows, row);
        starts
    }

    fn at(&self, p: DVec3) -> u32 {
        if self.cells.is_empty() {
            return 0;
        }
        let last = (self.size - 1).as_dvec3();
        let b = ((p - self.low) * self.per_unit).clamp(DVec3::ZERO, last).as_uvec3();
        self.cells[((b.z * self.size.y + b.y) * self.size.x + b.x) as usize]
    }
}

/// About `boxes` boxes, as near to cubes as whole numbers of them can be.
fn box_counts(extent: DVec3, boxes: f64) -> UVec3 {
    // Thin extents get one box, and the other axes share the remaining number.
    let mut count = dvec3(1.0, 1.0, 1.0);
    let mut free = [true; 3];
    loop {
        let (mut volume, mut axes) = (1.0, 0);
        for axis in (0..3).filter(|&a| free[a]) {
            volume *= extent[axis];
            axes += 1;
        }
        if axes == 0 {
            break;
        }
        let side = (volume / boxes).powf(1.0 / f64::from(axes));
        (0..3).filter(|&a| free[a]).for_each(|axis| count[axis] = (extent[axis] / side).max(1.0));
        let Some(thin) = (0..3).find(|&a| free[a] && extent[a] < side) else { break };
        free[thin] = false;
    }
    count.as_uvec3().max(UVec3::ONE)
}
