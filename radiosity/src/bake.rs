//! Irradiance and radiosity per vertex, for drawing (final gather).
//!
//! The mean radiosity of a patch is accurate enough as a source for other patches, but drawn directly it shows the borders of the patches. So
//! the irradiance at each vertex is gathered from the elements that the patches around it are linked with: Lambert's formula for the
//! parts of each source that occluders leave, which are cut exactly.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use crate::gather::visible_share;
use crate::mesh::{Facets, Mesh, Place};
use crate::polygon::edges;
use crate::rgb::{Rgb, add};
use crate::solve::Solution;
use crate::transport::{Entry, Transport};
use crate::tree::ElementId;
use crate::visible::parts::Pieces;
use pointillist_dice::lambert;
use pointillist_parallel as parallel;

/// Irradiance is gathered at a point moved from the vertex by this share of the way to the mean centre of its patches. On an edge that two
/// surfaces share, the share of the other surface is discontinuous and has no value.
pub(crate) const INWARD: f64 = 0.02;
/// Light at a vertex of one side of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakedVertex {
    /// In the scene's coordinates.
    pub position: DVec3,
    /// Unit normal of the side.
    pub normal: DVec3,
    /// Irradiance from patches, without the direct light of lamps: power per area.
    pub irradiance: Rgb,
    /// Emitted and reflected power per area, direct light of lamps included.
    pub radiosity: Rgb,
}

/// A triangle between baked vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BakedTriangle {
    /// Indices into [`Baked::vertices`], counter-clockwise seen from its side.
    pub vertices: [u32; 3],
    /// Index of the surface it is a part of.
    pub surface: u32,
    /// Whether it is on the surface's back.
    pub back: bool,
}

/// Light per vertex, with the triangles between the vertices. Patches share a vertex if their normals, materials and parts of the surface
/// are the same. The outline of a patch includes the vertices of smaller neighbours on its edges, so that there are no T-junctions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Baked {
    /// Vertices, in the order in which triangles first use them.
    pub vertices: Vec<BakedVertex>,
    /// Triangles, surface by surface, the front before the back.
    pub triangles: Vec<BakedTriangle>,
}

impl Solution<'_> {
    /// Irradiance and radiosity at every vertex. Cost: for each vertex, the links of the patches around it.
    #[must_use]
    pub fn bake(&self) -> Baked {
        self.bake_with(&|_| ())
    }

    /// As [`Solution::bake`]; `done` is called for every vertex, from any thread, with the share of the work that is done (0 to 1).
    #[must_use]
    pub fn bake_with(&self, done: &(dyn Fn(f64) + Sync)) -> Baked {
        let transport = self.transport;
        let mesh = Mesh::new(&transport.scene, &transport.leaves, Facets::Apart);
        let (count, all) = (AtomicUsize::new(0), mesh.places.len() as f64);
        let light = parallel::map_with(mesh.places.len(), Pieces::default, |pieces, i| {
            done(count.fetch_add(1, Ordering::Relaxed) as f64 / all);
            self.light_at(&mesh.places[i], pieces)
        });
        let mut light: Vec<Rgb> = light;
        mesh.lift_buried(&mut light);
        mesh.finish(&transport.direct, &light)
    }

    /// Irradiance at one place: what arrives there along the links of the leaf that holds the point, and of the elements above it. All leaves around a place
    /// lie in one plane; their links to the same sources differ by what may be between, and only those of this leaf have all that is before the point.
    fn light_at(&self, place: &Place, pieces: &mut Pieces) -> Rgb {
        let transport = self.transport;
        let tree = &transport.scene.tree;
        let count = place.leaves.len() as f64;
        let of = |leaf: ElementId| &tree.elements[leaf as usize].polygon;
        let centre = place.leaves.iter().map(|&l| of(l).centre()).sum::<DVec3>();
        let point = place.position.lerp(centre / count, INWARD);
        let inside = |leaf: ElementId| {
            let polygon = of(leaf);
            let depth = |(a, b): (DVec3, DVec3)| polygon.normal().cross((b - a).normalize()).dot(point - a);
            edges(polygon.vertices()).map(depth).fold(f64::INFINITY, f64::min)
        };
        let deepest = place.leaves.iter().map(|&leaf| (inside(leaf), leaf));
        let deepest = deepest.reduce(|best, other| if other.0 > best.0 { other } else { best });
        let mut element = deepest.map(|(_, leaf)| leaf);
        let mut sum = [0.0; 3];
        while let Some(id) = element {
            let normal = of(id).normal();
            for entry in transport.row(id) {
                let share = transport.share_of(entry, point, normal, pieces);
                sum = add(sum, share, self.of_element[entry.to as usize]);
            }
            element = transport.parents[id as usize];
        }
        sum
    }
}

impl Transport {
    fn share_of(&self, entry: &Entry, point: DVec3, normal: DVec3, pieces: &mut Pieces) -> f64 {
        let source = &self.scene.tree.elements[entry.to as usize].polygon;
        if source.height(point) <= 0.0 {
            return 0.0;
        }
        let (from, to) = self.links[entry.link as usize].between;
        if from == to {
            return lambert::share_above_horizon(point, normal, source.vertices()).max(0.0);
        }
        let list = self.between[from as usize..to as usize].iter();
        let list = list.map(|&i| &self.scene.occluders[i as usize]);
        visible_share(point, normal, source, list, pieces)
    }
}
