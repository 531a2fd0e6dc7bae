//! Triangles prepared once for any number of views and lights.

use crate::bounds::Bounds;
use crate::closed::{OPEN, Solid, find_solids, solid_angle};
use crate::error::MicropointError;
use crate::lens::{Lens, LensKind};
use glam::DVec3;
use pointillist_view::morton_code;

/// How a surface lets light through; the rest of a material is the shader's business.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceOpacity {
    /// Opacity, 0..=1, of every point of the surface, or the factor on a textured opacity.
    pub opacity: f32,
    /// The opacity varies: it is asked for through [`TexturedOpacity`](crate::TexturedOpacity).
    pub textured_opacity: bool,
    /// Back faces are visible, too.
    pub two_sided: bool,
}

impl Default for SurfaceOpacity {
    /// Opaque and two-sided.
    fn default() -> Self {
        Self { opacity: 1.0, textured_opacity: false, two_sided: true }
    }
}

impl SurfaceOpacity {
    /// Whether nothing shows through.
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        self.opacity >= 1.0 && !self.textured_opacity
    }
}

/// Where a triangle is in a [`Geometry`], which sorts triangles into clusters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClusterTriangle {
    /// Number of the cluster.
    pub cluster: u32,
    /// Position of the triangle in the cluster.
    pub index: u32,
}

/// A prepared triangle; its corners index the vertices of its cluster.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// Corners within the cluster's vertices.
    pub corners: [u8; 3],
    /// Position in the caller's triangle array.
    pub id: u32,
    /// Index of its surface.
    pub surface: u32,
    pub(crate) solid: u32,
}

/// Up to 64 neighbouring triangles with their own vertices and bounds.
#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    /// Bounds in the world.
    pub bounds: Bounds,
    first_vertex: u32,
    vertex_count: u32,
    first_triangle: u32,
    triangle_count: u32,
    /// If all triangles bound one solid: it, and a cone that holds their outward normals.
    facing: Option<Facing>,
}

/// The normals of a cluster.
#[derive(Clone, Copy, Debug)]
struct Facing {
    solid: u32,
    axis: DVec3,
    /// Sine of the cone's half-angle, which is less than a right angle.
    spread: f64,
}

/// Most triangles in a cluster: small enough that bounds are tight, large enough that refusing one
/// saves real work. 64 triangles have at most 192 vertices, so that a corner fits in a byte.
const CLUSTER_SIZE: usize = 64;

/// Children of a node of the hierarchy.
const FAN_OUT: usize = 4;

/// Which winding of a closed component a viewer can never see, for each component.
#[derive(Clone, Debug, Default)]
pub struct HiddenSides(pub(crate) Vec<i8>);

impl HiddenSides {
    /// The sides that may be left out as casters of light, if these are the sides hidden from the light
    /// and `viewer` those hidden from whoever sees the receivers.
    ///
    /// What a viewer outside a solid sees lies outside it, too, and then the faces turned away from the
    /// light cast the same shadow as those turned to it. The former are better: they lie behind the
    /// solid's own lit side and cost it nothing. Receivers inside a solid need the latter.
    #[must_use]
    pub fn of_casters(&self, viewer: &Self) -> Self {
        let side = |(&light, &viewer): (&i8, &i8)| if viewer == 0 { light } else { -light };
        Self(self.0.iter().zip(&viewer.0).map(side).collect())
    }
}

/// A scene's triangles in clusters, with a hierarchy of bounds and knowledge of closed components.
#[derive(Clone, Debug)]
pub struct Geometry {
    pub(crate) vertices: Vec<DVec3>,
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) clusters: Vec<Cluster>,
    /// `levels[0]` bounds groups of clusters, each further level groups of the one before.
    levels: Vec<Vec<Bounds>>,
    surfaces: Vec<SurfaceOpacity>,
    solids: Vec<Solid>,
    bounds: Bounds,
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
        check(positions, triangles, surface_of, surfaces)?;
        let opaque = |t: usize| surfaces[surface_of[t] as usize].is_opaque();
        let (solids, solid_of) = find_solids(positions, triangles, opaque);
        let order = morton_order(positions, triangles);
        let mut geometry = Self {
            vertices: Vec::with_capacity(triangles.len()),
            triangles: Vec::with_capacity(triangles.len()),
            clusters: Vec::with_capacity(triangles.len() / CLUSTER_SIZE + 1),
            levels: Vec::new(),
            surfaces: surfaces.to_vec(),
            solids,
            bounds: Bounds::EMPTY,
        };
        let mut local = LocalNumbers::new(positions.len());
        for ids in order.chunks(CLUSTER_SIZE) {
            geometry.push_cluster(ids, positions, triangles, surface_of, &solid_of, &mut local);
        }
        geometry.build_levels();
        Ok(geometry)
    }

    /// The same triangles in the same clusters, with other opacities of the surfaces, which `opacity` gives by number. A closed component that
    /// is not opaque any more counts as open.
    ///
    /// # Errors
    /// [`MicropointError::BadOpacity`] for an opacity that is not from 0 to 1.
    pub fn with_opacities(&self, opacity: impl Fn(usize) -> f32) -> Result<Self, MicropointError> {
        let mut geometry = self.clone();
        for (i, surface) in geometry.surfaces.iter_mut().enumerate() {
            surface.opacity = opacity(i);
        }
        check_opacities(&geometry.surfaces)?;
        let mut opened = vec![false; geometry.solids.len()];
        for t in geometry.triangles.iter().filter(|t| t.solid != OPEN) {
            opened[t.solid as usize] |= !geometry.surfaces[t.surface as usize].is_opaque();
        }
        for triangle in geometry.triangles.iter_mut().filter(|t| t.solid != OPEN) {
            if opened[triangle.solid as usize] {
                triangle.solid = OPEN;
            }
        }
        for cluster in &mut geometry.clusters {
            cluster.facing = cluster.facing.filter(|facing| !opened[facing.solid as usize]);
        }
        Ok(geometry)
    }

    fn push_cluster(
        &mut self,
        ids: &[u32],
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        surface_of: &[u32],
        solid_of: &[u32],
        local: &mut LocalNumbers,
    ) {
        let (first_vertex, first_triangle) = (self.vertices.len(), self.triangles.len());
        let mut bounds = Bounds::EMPTY;
        local.next_cluster();
        for &id in ids {
            let t = id as usize;
            let corners = triangles[t].map(|v| {
                let (number, new) = local.number(v);
                if new {
                    let p = positions[v as usize];
                    bounds.include(p);
                    self.vertices.push(p);
                }
                number
            });
            self.triangles.push(Triangle { corners, id, surface: surface_of[t], solid: solid_of[t] });
        }
        self.bounds = self.bounds.union(bounds);
        self.clusters.push(Cluster {
            bounds,
            first_vertex: first_vertex as u32,
            vertex_count: (self.vertices.len() - first_vertex) as u32,
            first_triangle: first_triangle as u32,
            triangle_count: ids.len() as u32,
            facing: None,
        });
        let facing = self.facing(self.clusters.len() - 1);
        self.clusters[facing.0].facing = facing.1;
    }

    fn facing(&self, index: usize) -> (usize, Option<Facing>) {
        let (_, vertices, triangles) = self.cluster(index as u32);
        let solid = triangles[0].solid;
        if solid == OPEN || triangles.iter().any(|t| t.solid != solid) {
            return (index, None);
        }
        let outward = f64::from(self.solids[solid as usize].orientation);
        let normal = |t: &Triangle| {
            let [a, b, c] = t.corners.map(|c| vertices[usize::from(c)]);
            ((b - a).cross(c - a) * outward).normalize_or_zero()
        };
        let axis = triangles.iter().map(normal).sum::<DVec3>().normalize_or_zero();
        let least = triangles.iter().map(|t| normal(t).dot(axis)).fold(1.0, f64::min);
        // Rounding of the normals, generously.
        let least = least - 1e-6;
        (index, (least > 0.1).then(|| Facing { solid, axis, spread: (1.0 - least * least).sqrt() }))
    }

    fn build_levels(&mut self) {
        let union = |group: &[Bounds]| group.iter().fold(Bounds::EMPTY, |a, &b| a.union(b));
        let leaves: Vec<Bounds> = self.clusters.iter().map(|c| c.bounds).collect();
        let mut level: Vec<Bounds> = leaves.chunks(FAN_OUT).map(union).collect();
        while !level.is_empty() {
            let next: Vec<Bounds> = level.chunks(FAN_OUT).map(union).collect();
            let last = level.len() == 1;
            self.levels.push(level);
            if last {
                break;
            }
            level = next;
        }
    }

    /// Number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Number of triangles that bound solids.
    #[must_use]
    pub fn solid_triangle_count(&self) -> usize {
        self.triangles.iter().filter(|t| t.solid != OPEN).count()
    }

    /// Number of clusters.
    #[must_use]
    pub fn cluster_count(&self) -> usize {
        self.clusters.len()
    }

    /// Bounds of everything; `low > high` of an empty scene.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The surfaces, as given.
    #[must_use]
    pub fn surfaces(&self) -> &[SurfaceOpacity] {
        &self.surfaces
    }

    /// A cluster's bounds, vertices and triangles.
    #[must_use]
    #[inline]
    pub(crate) fn cluster(&self, index: u32) -> (&Bounds, &[DVec3], &[Triangle]) {
        let c = &self.clusters[index as usize];
        let vertices = &self.vertices[c.first_vertex as usize..][..c.vertex_count as usize];
        let triangles = &self.triangles[c.first_triangle as usize..][..c.triangle_count as usize];
        (&c.bounds, vertices, triangles)
    }

    /// Corners of a prepared triangle in the world.
    ///
    /// # Panics
    /// If `triangle` is not that of a face of this geometry.
    #[must_use]
    #[inline]
    pub fn corners(&self, triangle: ClusterTriangle) -> [DVec3; 3] {
        let (_, vertices, triangles) = self.cluster(triangle.cluster);
        triangles[triangle.index as usize].corners.map(|c| vertices[usize::from(c)])
    }

    /// Whether all of a cluster is hidden from a viewer because it is the side of a solid that the viewer
    /// never sees.
    #[must_use]
    pub(crate) fn hides_cluster(&self, cluster: u32, lens: &Lens, hidden: &HiddenSides) -> bool {
        let c = &self.clusters[cluster as usize];
        let Some(facing) = c.facing else { return false };
        let side = hidden.0.get(facing.solid as usize).copied().unwrap_or(0);
        if side == 0 {
            return false;
        }
        // `hidden` names the orientation whose backs are culled; its opposite culls the fronts.
        let same = side == self.solids[facing.solid as usize].orientation;
        let axis = if same { facing.axis } else { -facing.axis };
        match lens.kind {
            LensKind::Orthographic => axis.dot(lens.forward) > facing.spread,
            LensKind::Perspective => {
                // For every point p and normal n of the cluster, n·(p − eye) > 0.
                let centre = 0.5 * (c.bounds.low + c.bounds.high) - lens.origin;
                let radius = 0.5 * (c.bounds.high - c.bounds.low).length();
                axis.dot(centre) > facing.spread * centre.length() + radius
            }
        }
    }

    /// What a lens never sees of closed components. A component that the lens may be inside of, or that
    /// an orthographic lens cuts open, keeps both sides.
    #[must_use]
    pub fn hidden_sides(&self, lens: &Lens) -> HiddenSides {
        let open = |i: usize, s: &Solid| match lens.kind {
            LensKind::Orthographic => {
                let bounds = Bounds { low: s.low, high: s.high };
                bounds.extent_along(lens.origin, lens.forward).least < 0.0
            }
            LensKind::Perspective => {
                let margin = 1e-9 * (s.high - s.low).length();
                let (above, below) = (lens.origin - s.low, s.high - lens.origin);
                let in_box = above.min(below).min_element() >= -margin;
                in_box && self.winding(i as u32, lens.origin).abs() > 0.01
            }
        };
        let hidden = |(i, s): (usize, &Solid)| if open(i, s) { 0 } else { s.orientation };
        HiddenSides(self.solids.iter().enumerate().map(hidden).collect())
    }

    /// The closed components with faces turned outward that a point lies in, each by a number that is its own. (Where
    /// faces are turned inward, inside is a room.)
    #[must_use]
    pub fn solids_around(&self, p: DVec3) -> Vec<u32> {
        let holds = |&i: &u32| {
            let solid = &self.solids[i as usize];
            solid.orientation > 0
                && p.cmpge(solid.low).all()
                && p.cmple(solid.high).all()
                && self.winding(i, p).abs() > 0.5
        };
        (0..self.solids.len() as u32).filter(holds).collect()
    }

    /// How often a closed component winds around a point.
    fn winding(&self, solid: u32, origin: DVec3) -> f64 {
        let mut total = 0.0;
        for cluster in 0..self.clusters.len() as u32 {
            let (_, vertices, triangles) = self.cluster(cluster);
            for t in triangles.iter().filter(|t| t.solid == solid) {
                total += solid_angle(t.corners.map(|c| vertices[usize::from(c)] - origin));
            }
        }
        total / (4.0 * std::f64::consts::PI)
    }

    /// The level of the hierarchy's root, above which there is nothing; clusters are level 0. `None` without geometry.
    pub(crate) fn top_level(&self) -> Option<usize> {
        self.levels.last()?.first().map(|_| self.levels.len())
    }

    /// A box of the hierarchy: a cluster's at level 0.
    pub(crate) fn box_at(&self, level: usize, index: usize) -> &Bounds {
        if level == 0 { &self.clusters[index].bounds } else { &self.levels[level - 1][index] }
    }

    /// The boxes within a box of a level above 0, at the level below.
    pub(crate) fn children(&self, level: usize, index: usize) -> std::ops::Range<usize> {
        let below = level - 1;
        let count = if below == 0 { self.clusters.len() } else { self.levels[below - 1].len() };
        let first = index * FAN_OUT;
        first..(first + FAN_OUT).min(count)
    }

    /// Visits the clusters that `bound` admits, in order of the distance it gives, nearest first.
    ///
    /// `bound` returns a lower bound of the distance of anything in the box, or `None` to refuse it
    /// with all its contents; `visit` returns the distance beyond which nothing matters any more.
    /// Returns how many boxes were refused or left unvisited.
    pub(crate) fn visit_near_to_far(
        &self,
        queue: &mut ClusterQueue,
        mut bound: impl FnMut(&Bounds) -> Option<f64>,
        mut visit: impl FnMut(u32) -> f64,
    ) -> u64 {
        let heap = &mut queue.heap;
        heap.clear();
        let mut skipped = 0;
        let Some(root) = self.levels.last().and_then(|l| l.first()) else { return 0 };
        let clusters_below = |level: usize| (FAN_OUT as u64).pow(level as u32);
        if let Some(d) = bound(root) {
            heap.push(Entry { distance: d, level: self.levels.len() as u32, index: 0 });
        }
        let mut limit = f64::INFINITY;
        while let Some(Entry { distance, level, index }) = heap.pop() {
            if distance > limit {
                skipped += heap.drain().map(|e| clusters_below(e.level as usize)).sum::<u64>() + 1;
                break;
            }
            if level == 0 {
                limit = visit(index);
                continue;
            }
            let below = level as usize - 1;
            for child in self.children(level as usize, index as usize) {
                match bound(self.box_at(below, child)) {
                    Some(d) if d <= limit => {
                        heap.push(Entry { distance: d, level: below as u32, index: child as u32 });
                    }
                    _ => skipped += clusters_below(below),
                }
            }
        }
        skipped
    }
}

/// Reusable memory of [`Geometry::visit_near_to_far`].
#[derive(Debug, Default)]
pub(crate) struct ClusterQueue {
    heap: std::collections::BinaryHeap<Entry>,
}

/// A box in the queue, ordered so that the heap gives the nearest first.
#[derive(Debug, PartialEq)]
struct Entry {
    distance: f64,
    level: u32,
    index: u32,
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other
            .distance
            .total_cmp(&self.distance)
            .then(other.level.cmp(&self.level))
            .then(other.index.cmp(&self.index))
    }
}

fn check(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    surface_of: &[u32],
    surfaces: &[SurfaceOpacity],
) -> Result<(), MicropointError> {
    if triangles.len() >= (u32::MAX / 4) as usize {
        return Err(MicropointError::TooManyTriangles { count: triangles.len() });
    }
    if surface_of.len() != triangles.len() {
        let (surfaces, triangles) = (surface_of.len(), triangles.len());
        return Err(MicropointError::LengthMismatch { surfaces, triangles });
    }
    // Squares and products of three coordinates must not overflow.
    let usable = |p: &DVec3| p.is_finite() && p.abs().max_element() < 1e90;
    if let Some(index) = positions.iter().position(|p| !usable(p)) {
        return Err(MicropointError::VertexNotFinite { index, value: positions[index].to_array() });
    }
    for (triangle, t) in triangles.iter().enumerate() {
        if let Some(&vertex) = t.iter().find(|&&v| v as usize >= positions.len()) {
            return Err(MicropointError::VertexOutOfRange { triangle, vertex, count: positions.len() });
        }
    }
    for (triangle, &surface) in surface_of.iter().enumerate() {
        if surface as usize >= surfaces.len() {
            return Err(MicropointError::SurfaceOutOfRange { triangle, surface, count: surfaces.len() });
        }
    }
    check_opacities(surfaces)
}

fn check_opacities(surfaces: &[SurfaceOpacity]) -> Result<(), MicropointError> {
    let bad = surfaces.iter().position(|s| !(0.0..=1.0).contains(&s.opacity));
    bad.map_or(Ok(()), |index| Err(MicropointError::BadOpacity { index, opacity: surfaces[index].opacity }))
}

/// Last cell per axis of the lattice that orders triangles: codes of 3 · 10 bits leave 32 for the number of the
/// triangle.
const LAST_CELL: u32 = 1023;

/// Triangle numbers along a Morton curve of their centres. Those that name a vertex twice are left out: they are never seen, and must not
/// decide which others share a cluster.
fn morton_order(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut bounds = Bounds::EMPTY;
    let centre = |t: &[u32; 3]| t.iter().map(|&v| positions[v as usize] / 3.0).sum::<DVec3>();
    let has_corners = |&(_, &[a, b, c]): &(usize, &[u32; 3])| a != b && b != c && c != a;
    let shown = || triangles.iter().enumerate().filter(has_corners);
    for (_, t) in shown() {
        bounds.include(centre(t));
    }
    // One scale for all axes keeps clusters compact in flat scenes.
    let size = (bounds.high - bounds.low).max_element();
    let scale = if size > 0.0 { f64::from(LAST_CELL) / size } else { 0.0 };
    let key = |(i, t): (usize, &[u32; 3])| {
        let q = (centre(t) - bounds.low) * scale;
        let cell = q.to_array().map(|c| (c as u32).min(LAST_CELL));
        morton_code(cell) << 32 | i as u64
    };
    let mut keys: Vec<u64> = shown().map(key).collect();
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
