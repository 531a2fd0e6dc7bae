//! Triangles prepared once for any number of views and lights.

use crate::bounds::Bounds;
use crate::build::check_opacities;
use crate::closed::{OPEN, Solid, solid_angle};
use crate::error::MicropointError;
use crate::instances::Placed;
use crate::lens::{Lens, LensKind};
use glam::DVec3;

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

/// A run of stored triangles with vertices of their own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    pub(crate) first_vertex: u32,
    pub(crate) vertex_count: u32,
    pub(crate) first_triangle: u32,
    pub(crate) triangle_count: u32,
}

/// Up to 32 neighbouring triangles in one of their places.
#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    /// Bounds in the world.
    pub bounds: Bounds,
    pub(crate) run: Run,
    /// Which of [`Geometry::places`].
    pub(crate) place: u32,
    /// If all triangles bound one solid: it, and a cone that holds their outward normals.
    pub(crate) facing: Option<Facing>,
}

/// The normals of a cluster.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    pub(crate) solid: u32,
    pub(crate) axis: DVec3,
    /// Sine of the cone's half-angle, which is less than a right angle.
    pub(crate) spread: f64,
}

/// A cluster's triangles where they stand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedCluster<'a> {
    pub(crate) bounds: &'a Bounds,
    place: &'a Placed,
    stored_vertices: &'a [DVec3],
    stored_triangles: &'a [Triangle],
}

impl<'a> PlacedCluster<'a> {
    /// Its vertices in the world.
    #[inline]
    pub(crate) fn vertices(self) -> impl Iterator<Item = DVec3> + 'a {
        self.stored_vertices.iter().map(|&p| self.place.point(p))
    }

    /// The same as a slice; `memory` holds those that are not stored as they stand.
    pub(crate) fn vertex_slice(self, memory: &'a mut Vec<DVec3>) -> &'a [DVec3] {
        if self.place.world_from_shape.is_none() {
            return self.stored_vertices;
        }
        memory.clear();
        memory.extend(self.vertices());
        memory
    }

    #[inline]
    pub(crate) fn triangles(self) -> impl Iterator<Item = Triangle> + 'a {
        self.stored_triangles.iter().map(|t| self.place.triangle(t))
    }

    #[inline]
    pub(crate) fn triangle(self, index: u32) -> Triangle {
        self.place.triangle(&self.stored_triangles[index as usize])
    }

    /// Corners of one of its triangles in the world.
    #[inline]
    pub(crate) fn corners(self, triangle: &Triangle) -> [DVec3; 3] {
        triangle.corners.map(|c| self.place.point(self.stored_vertices[usize::from(c)]))
    }
}

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
    /// Where clusters stand; the first is that of all that are stored as they stand.
    pub(crate) places: Vec<Placed>,
    /// `levels[0]` bounds groups of clusters, each further level groups of the one before.
    pub(crate) levels: Vec<Vec<Bounds>>,
    pub(crate) surfaces: Vec<SurfaceOpacity>,
    /// Those of all places, one place after the other.
    pub(crate) solids: Vec<Solid>,
    pub(crate) bounds: Bounds,
}

impl Geometry {
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
        for cluster in 0..geometry.clusters.len() as u32 {
            for t in geometry.cluster(cluster).triangles().filter(|t| t.solid != OPEN) {
                opened[t.solid as usize] |= !geometry.surfaces[t.surface as usize].is_opaque();
            }
        }
        for cluster in &mut geometry.clusters {
            cluster.facing = cluster.facing.filter(|facing| !opened[facing.solid as usize]);
            // A solid is open in all places of its shape, or in none.
            let first_solid = geometry.places[cluster.place as usize].first_solid;
            let (first, count) = (cluster.run.first_triangle as usize, cluster.run.triangle_count as usize);
            for triangle in &mut geometry.triangles[first..][..count] {
                if triangle.solid != OPEN && opened[(triangle.solid + first_solid) as usize] {
                    triangle.solid = OPEN;
                }
            }
        }
        Ok(geometry)
    }

    /// Number of triangles, each counted in all of its places.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.clusters.iter().map(|c| c.run.triangle_count as usize).sum()
    }

    /// Number of triangles that bound solids.
    #[must_use]
    pub fn solid_triangle_count(&self) -> usize {
        let bound = |cluster: u32| self.cluster(cluster).triangles().filter(|t| t.solid != OPEN).count();
        (0..self.clusters.len() as u32).map(bound).sum()
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

    /// A cluster's triangles where they stand.
    #[must_use]
    #[inline]
    pub(crate) fn cluster(&self, index: u32) -> PlacedCluster<'_> {
        let c = &self.clusters[index as usize];
        let Run { first_vertex, vertex_count, first_triangle, triangle_count } = c.run;
        PlacedCluster {
            bounds: &c.bounds,
            place: &self.places[c.place as usize],
            stored_vertices: &self.vertices[first_vertex as usize..][..vertex_count as usize],
            stored_triangles: &self.triangles[first_triangle as usize..][..triangle_count as usize],
        }
    }

    /// Corners of a prepared triangle in the world.
    ///
    /// # Panics
    /// If `triangle` is not that of a face of this geometry.
    #[must_use]
    #[inline]
    pub fn corners(&self, triangle: ClusterTriangle) -> [DVec3; 3] {
        let cluster = self.cluster(triangle.cluster);
        cluster.corners(&cluster.triangle(triangle.index))
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
        let place = self.solids[solid as usize].place;
        for (number, _) in self.clusters.iter().enumerate().filter(|(_, c)| c.place == place) {
            let cluster = self.cluster(number as u32);
            for t in cluster.triangles().filter(|t| t.solid == solid) {
                total += solid_angle(cluster.corners(&t).map(|p| p - origin));
            }
        }
        total / (4.0 * std::f64::consts::PI)
    }
}
