//! From triangles to clusters: checked, sorted along a space-filling curve, bounded.

use crate::bounds::Bounds;
use crate::closed::{OPEN, Solid, find_solids};
use crate::error::MicropointError;
use crate::geometry::{Cluster, Facing, Geometry, Run, SurfaceOpacity, Triangle};
use crate::instances::{Placed, Shape};
use glam::DVec3;
use pointillist_view::morton_code;

/// Most triangles in a cluster: small enough that bounds are tight, large enough that refusing one
/// saves real work. 32 have at most 96 vertices, so that a corner fits in a byte. By instructions for a picture of spheres whose triangles are about
/// as large as pixels, 64 take 2 % more and 16 take 1 % less, which a terrain pays for.
const CLUSTER_SIZE: usize = 32;

/// Whether the squares of coordinates, and products of three, do not overflow.
fn is_usable(p: DVec3) -> bool {
    p.is_finite() && p.abs().max_element() < 1e90
}

impl Geometry {
    /// Prepares triangles: checks them, finds closed components, sorts along a space-filling curve
    /// and bounds clusters.
    ///
    /// Triangles without area are kept and draw nothing. An empty set is a scene without geometry.
    ///
    /// # Errors
    /// [`MicropointError`] names the first vertex, triangle or surface that cannot be used.
    pub fn new(
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        surface_of: &[u32],
        surfaces: &[SurfaceOpacity],
    ) -> Result<Self, MicropointError> {
        Self::with_instances(&Shape { positions, triangles, surface_of, places: &[] }, surfaces, &[])
    }

    /// The same with shapes that stand in several places and are stored once: each of their places takes two bytes a triangle. `world` stands as it
    /// is stored, whatever its places are, and is numbered from 0.
    ///
    /// Closed components are those of a shape by itself.
    ///
    /// # Errors
    /// As [`Geometry::new`], and [`MicropointError::BadPlacement`] for a place that is not finite, or too far away.
    pub fn with_instances(
        world: &Shape<'_>,
        surfaces: &[SurfaceOpacity],
        shapes: &[Shape<'_>],
    ) -> Result<Self, MicropointError> {
        let placed = shapes.iter().map(|shape| shape.places.len() * shape.triangles.len());
        check_count(world.triangles.len() + placed.sum::<usize>())?;
        let mut geometry = Self {
            vertices: Vec::with_capacity(world.triangles.len()),
            triangles: Vec::with_capacity(world.triangles.len()),
            clusters: Vec::with_capacity(world.triangles.len() / CLUSTER_SIZE + 1),
            places: vec![Placed::AS_STORED],
            levels: Vec::new(),
            surfaces: surfaces.to_vec(),
            solids: Vec::new(),
            bounds: Bounds::EMPTY,
        };
        check_opacities(surfaces)?;
        let (solids, runs) = geometry.store(world)?;
        geometry.solids = solids;
        for run in runs {
            geometry.push_cluster(run, 0);
        }
        for (number, shape) in shapes.iter().enumerate() {
            geometry.place(number, shape)?;
        }
        if !shapes.is_empty() {
            geometry.sort_clusters();
        }
        geometry.build_levels();
        Ok(geometry)
    }

    /// Stores triangles in their own space: their closed components, and runs of neighbours.
    fn store(&mut self, shape: &Shape<'_>) -> Result<(Vec<Solid>, Vec<Run>), MicropointError> {
        let Shape { positions, triangles, surface_of, .. } = *shape;
        check(shape, self.surfaces.len())?;
        let opaque = |t: usize| self.surfaces[surface_of[t] as usize].is_opaque();
        let (solids, solid_of) = find_solids(positions, triangles, opaque);
        let order = triangle_order(positions, triangles);
        let mut local = LocalNumbers::new(positions.len());
        let mut runs = Vec::with_capacity(order.len().div_ceil(CLUSTER_SIZE));
        for ids in order.chunks(CLUSTER_SIZE) {
            let (first_vertex, first_triangle) = (self.vertices.len(), self.triangles.len());
            local.next_cluster();
            for &id in ids {
                let t = id as usize;
                let corners = triangles[t].map(|v| {
                    let (number, new) = local.number(v);
                    if new {
                        self.vertices.push(positions[v as usize]);
                    }
                    number
                });
                self.triangles.push(Triangle { corners, id, surface: surface_of[t], solid: solid_of[t] });
            }
            runs.push(Run {
                first_vertex: first_vertex as u32,
                vertex_count: (self.vertices.len() - first_vertex) as u32,
                first_triangle: first_triangle as u32,
                triangle_count: ids.len() as u32,
            });
        }
        Ok((solids, runs))
    }

    /// Stores a shape, and puts it in its places.
    fn place(&mut self, number: usize, shape: &Shape<'_>) -> Result<(), MicropointError> {
        let (solids, runs) = self.store(shape)?;
        for (index, place) in shape.places.iter().enumerate() {
            let (first_solid, placed) = (self.solids.len() as u32, self.places.len() as u32);
            self.places.push(Placed::new(place, first_solid));
            self.solids.extend(solids.iter().map(|solid| solid.moved(&place.world_from_shape, placed)));
            let first = self.clusters.len() as u32;
            runs.iter().for_each(|&run| self.push_cluster(run, placed));
            let mut vertices = (first..self.clusters.len() as u32).flat_map(|c| self.cluster(c).vertices());
            if !place.world_from_shape.is_finite() || !vertices.all(is_usable) {
                return Err(MicropointError::BadPlacement { shape: number, place: index });
            }
        }
        Ok(())
    }

    /// Adds a stored run of triangles in one of its places.
    fn push_cluster(&mut self, run: Run, place: u32) {
        let index = self.clusters.len() as u32;
        self.clusters.push(Cluster { bounds: Bounds::EMPTY, run, place, facing: None });
        let mut bounds = Bounds::EMPTY;
        self.cluster(index).vertices().for_each(|p| bounds.include(p));
        let facing = self.facing(index);
        let cluster = &mut self.clusters[index as usize];
        (cluster.bounds, cluster.facing) = (bounds, facing);
        self.bounds = self.bounds.union(bounds);
    }

    fn facing(&self, cluster: u32) -> Option<Facing> {
        let cluster = self.cluster(cluster);
        let solid = cluster.triangle(0).solid;
        if solid == OPEN || cluster.triangles().any(|t| t.solid != solid) {
            return None;
        }
        let outward = f64::from(self.solids[solid as usize].orientation);
        let normals: Vec<DVec3> = cluster
            .triangles()
            .map(|t| {
                let [a, b, c] = cluster.corners(&t);
                ((b - a).cross(c - a) * outward).normalize_or_zero()
            })
            .collect();
        let axis = normals.iter().sum::<DVec3>().normalize_or_zero();
        let least = normals.iter().map(|n| n.dot(axis)).fold(1.0, f64::min);
        // Rounding of the normals, generously.
        let least = least - 1e-6;
        (least > 0.1).then(|| Facing { solid, axis, spread: (1.0 - least * least).sqrt() })
    }

    /// Clusters of all places along one curve, so that those that share a box of the hierarchy are neighbours.
    fn sort_clusters(&mut self) {
        let centre = |c: &Cluster| 0.5 * (c.bounds.low + c.bounds.high);
        let order = morton_order(self.clusters.iter().enumerate().map(|(i, c)| (i as u32, centre(c))));
        self.clusters = order.into_iter().map(|i| self.clusters[i as usize].clone()).collect();
    }
}

fn check_count(triangles: usize) -> Result<(), MicropointError> {
    if triangles >= (u32::MAX / 4) as usize {
        return Err(MicropointError::TooManyTriangles { count: triangles });
    }
    Ok(())
}

fn check(shape: &Shape<'_>, surfaces: usize) -> Result<(), MicropointError> {
    let Shape { positions, triangles, surface_of, .. } = *shape;
    if surface_of.len() != triangles.len() {
        let (surfaces, triangles) = (surface_of.len(), triangles.len());
        return Err(MicropointError::LengthMismatch { surfaces, triangles });
    }
    if let Some(index) = positions.iter().position(|&p| !is_usable(p)) {
        return Err(MicropointError::VertexNotFinite { index, value: positions[index].to_array() });
    }
    for (triangle, t) in triangles.iter().enumerate() {
        if let Some(&vertex) = t.iter().find(|&&v| v as usize >= positions.len()) {
            return Err(MicropointError::VertexOutOfRange { triangle, vertex, count: positions.len() });
        }
    }
    for (triangle, &surface) in surface_of.iter().enumerate() {
        if surface as usize >= surfaces {
            return Err(MicropointError::SurfaceOutOfRange { triangle, surface, count: surfaces });
        }
    }
    Ok(())
}

pub(crate) fn check_opacities(surfaces: &[SurfaceOpacity]) -> Result<(), MicropointError> {
    let bad = surfaces.iter().position(|s| !(0.0..=1.0).contains(&s.opacity));
    bad.map_or(Ok(()), |index| Err(MicropointError::BadOpacity { index, opacity: surfaces[index].opacity }))
}

/// Last cell per axis of the lattice that orders triangles: codes of 3 · 10 bits leave 32 for the number of the
/// triangle.
const LAST_CELL: u32 = 1023;

/// Triangle numbers along a Morton curve of their centres. Those that name a vertex twice are left out: they are never seen, and must not
/// decide which others share a cluster.
fn triangle_order(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<u32> {
    let centre = |t: &[u32; 3]| t.iter().map(|&v| positions[v as usize] / 3.0).sum::<DVec3>();
    let has_corners = |&(_, &[a, b, c]): &(usize, &[u32; 3])| a != b && b != c && c != a;
    let shown = triangles.iter().enumerate().filter(has_corners);
    morton_order(shown.map(|(i, t)| (i as u32, centre(t))))
}

/// The numbers of places along a Morton curve.
fn morton_order(places: impl Iterator<Item = (u32, DVec3)> + Clone) -> Vec<u32> {
    let mut bounds = Bounds::EMPTY;
    places.clone().for_each(|(_, centre)| bounds.include(centre));
    // One scale for all axes keeps clusters compact in flat scenes.
    let size = (bounds.high - bounds.low).max_element();
    let scale = if size > 0.0 { f64::from(LAST_CELL) / size } else { 0.0 };
    let key = |(i, centre): (u32, DVec3)| {
        let q = (centre - bounds.low) * scale;
        let cell = q.to_array().map(|c| (c as u32).min(LAST_CELL));
        morton_code(cell) << 32 | u64::from(i)
    };
    let mut keys: Vec<u64> = places.map(key).collect();
    keys.sort_unstable();
    keys.into_iter().map(|k| k as u32).collect()
}

/// Numbers the vertices of one cluster from 0, in order of first use.
struct LocalNumbers {
    /// For each vertex: the last cluster that used it (from 1), and its number there.
    last: Vec<(u32, u8)>,
    cluster: u32,
    used: u32,
}

impl LocalNumbers {
    fn new(vertices: usize) -> Self {
        Self { last: vec![(0, 0); vertices], cluster: 0, used: 0 }
    }

    fn next_cluster(&mut self) {
        self.cluster += 1;
        self.used = 0;
    }

    fn number(&mut self, vertex: u32) -> (u8, bool) {
        let entry = &mut self.last[vertex as usize];
        let new = entry.0 != self.cluster;
        if new {
            *entry = (self.cluster, self.used as u8);
            self.used += 1;
        }
        (entry.1, new)
    }
}
