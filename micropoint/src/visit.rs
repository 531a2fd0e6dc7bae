//! The faces that a lens sees, from near to far: one loop for viewers and for lights.

use crate::bounds::Bounds;
use crate::face::{Face, GridRect, ProjectedVertex, Setup, set_up_face};
use crate::geometry::{ClusterTriangle, Geometry, PlacedCluster, SurfaceOpacity};
use crate::hierarchy::ClusterQueue;
use crate::volume::ViewVolume;
use glam::{DVec2, DVec3};

/// A visitor of faces, for [`Geometry::visit_faces`].
pub trait FaceVisitor {
    /// Whether anything in a cluster with these bounds matters. Asked once for each cluster that is reached.
    fn wants(&self, bounds: &Bounds) -> bool;

    /// Whether a triangle with these corners and this surface can be left out before it is set up: the cheapest and commonest test.
    fn skips(&self, corners: [&ProjectedVertex; 3], surface: &SurfaceOpacity) -> bool;

    /// Takes a face. `outline` is convex, in grid coordinates, in positive order; `opacity` is that of its surface, or `None` if it is textured.
    fn visit(&mut self, face: Face, outline: &[DVec2], opacity: Option<f32>);

    /// The depth beyond which nothing matters any more; asked after each cluster.
    fn farthest(&self) -> f64;
}

/// Reusable memory of [`Geometry::visit_faces`].
#[derive(Debug, Default)]
pub struct VisitMemory {
    queue: ClusterQueue,
    projected: Vec<ProjectedVertex>,
}

/// Counts of what [`Geometry::visit_faces`] visited and skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct VisitCounts {
    /// Clusters whose triangles were projected.
    pub clusters: u64,
    /// Clusters skipped: outside, too far, unwanted, or hidden sides of solids.
    pub clusters_skipped: u64,
    /// Triangles skipped by the visitor, or without anything to see: turned away, edge-on, outside.
    pub triangles_culled: u64,
}

impl Geometry {
    /// Hands the faces behind `window`, a rectangle of the lens's grid, to a visitor: cluster by cluster, nearest first.
    ///
    /// 1. Boxes outside the window's volume, or beyond `farthest` (a depth) or [`FaceVisitor::farthest`], are skipped with all their contents.
    /// 2. Clusters that are the hidden side of a solid, or unwanted, are skipped.
    /// 3. Vertices are projected; triangles are skipped, or culled, clipped where they reach behind the lens, and visited.
    pub fn visit_faces(
        &self,
        setup: &Setup<'_>,
        window: &GridRect,
        farthest: f64,
        memory: &mut VisitMemory,
        visitor: &mut impl FaceVisitor,
    ) -> VisitCounts {
        let VisitMemory { queue, projected } = memory;
        let volume = ViewVolume::new(setup.lens, window);
        let mut counts = VisitCounts::default();
        let unreached = self.visit_near_to_far(
            queue,
            |bounds| volume.nearest_depth(bounds).filter(|&depth| depth <= farthest),
            |cluster| {
                self.visit_cluster(setup, cluster, projected, &mut counts, visitor);
                visitor.farthest()
            },
        );
        counts.clusters_skipped += unreached;
        counts
    }

    #[inline]
    fn visit_cluster(
        &self,
        setup: &Setup<'_>,
        cluster: u32,
        projected: &mut Vec<ProjectedVertex>,
        counts: &mut VisitCounts,
        visitor: &mut impl FaceVisitor,
    ) {
        let placed = self.cluster(cluster);
        if self.hides_cluster(cluster, setup.lens, setup.hidden) || !visitor.wants(placed.bounds) {
            counts.clusters_skipped += 1;
            return;
        }
        counts.clusters += 1;
        projected.clear();
        projected.extend(placed.vertices().map(|v| ProjectedVertex::new(setup.lens, v)));
        for (i, triangle) in placed.triangles().enumerate() {
            let corners = triangle.corners.map(|c| &projected[usize::from(c)]);
            let surface = &self.surfaces()[triangle.surface as usize];
            if visitor.skips(corners, surface) {
                counts.triangles_culled += 1;
                continue;
            }
            let source = ClusterTriangle { cluster, index: i as u32 };
            match set_up_face(setup, &triangle, source, corners, surface) {
                None => counts.triangles_culled += 1,
                Some((face, outline)) => {
                    let opacity = if surface.textured_opacity { None } else { Some(surface.opacity) };
                    visitor.visit(face, outline.vertices(), opacity);
                }
            }
        }
    }
}

/// A cluster's triangles in the world, for [`Geometry::visit_clusters`].
#[derive(Clone, Copy, Debug)]
pub struct ClusterView<'a> {
    number: u32,
    /// Vertices that its triangles refer to, in the world.
    pub vertices: &'a [DVec3],
    placed: PlacedCluster<'a>,
}

/// A triangle of a [`ClusterView`].
#[derive(Clone, Copy, Debug)]
pub struct ClusterFace {
    /// Where it is in the geometry.
    pub source: ClusterTriangle,
    /// Its corners, as indices into [`ClusterView::vertices`].
    pub corners: [usize; 3],
    /// Position in the caller's triangle array.
    pub id: u32,
    /// Index of its surface.
    pub surface: u32,
}

impl ClusterView<'_> {
    /// Its triangles.
    pub fn faces(&self) -> impl Iterator<Item = ClusterFace> + '_ {
        self.placed.triangles().enumerate().map(|(i, t)| ClusterFace {
            source: ClusterTriangle { cluster: self.number, index: i as u32 },
            corners: t.corners.map(usize::from),
            id: t.id,
            surface: t.surface,
        })
    }
}

impl Geometry {
    /// Hands over every cluster whose box, and each larger box around it, `wants` admits; in the order of clusters.
    pub fn visit_clusters(
        &self,
        mut wants: impl FnMut(&Bounds) -> bool,
        mut visit: impl FnMut(&ClusterView<'_>),
    ) {
        let Some(top) = self.top_level() else { return };
        self.visit_boxes(top, 0, &mut vec![], &mut wants, &mut visit);
    }

    fn visit_boxes(
        &self,
        level: usize,
        index: usize,
        memory: &mut Vec<DVec3>,
        wants: &mut impl FnMut(&Bounds) -> bool,
        visit: &mut impl FnMut(&ClusterView<'_>),
    ) {
        if !wants(self.box_at(level, index)) {
            return;
        }
        if level == 0 {
            let number = index as u32;
            let placed = self.cluster(number);
            return visit(&ClusterView { number, vertices: placed.vertex_slice(memory), placed });
        }
        for child in self.children(level, index) {
            self.visit_boxes(level - 1, child, memory, wants, visit);
        }
    }
}
