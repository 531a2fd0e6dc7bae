//! Irradiance and radiosity per vertex, for drawing (final gather).
//!
//! The mean radiosity of a patch is accurate enough as a source for other patches, but drawn directly it shows the borders of the patches. So
//! the irradiance at each vertex is gathered from the elements that the patches around it are linked with: Lambert's formula for the
//! parts of each source that occluders leave, which are cut exactly.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use crate::gather::visible_share;
use crate::rgb::{Rgb, add, times};
use crate::solve::Solution;
use crate::transport::{Entry, Transport};
use crate::tree::ElementId;
use crate::visible::parts::Pieces;
use pointillist_dice::lambert;
use pointillist_parallel as parallel;

/// Irradiance is gathered at a point moved from the vertex by this share of the way to the mean centre of its patches. On an edge that two
/// surfaces share, the share of the other surface is discontinuous and has no value.
const INWARD: f64 = 0.02;
/// A vertex whose irradiance is below this share of the largest counts as covered, such as one of the floor under a box.
const BURIED: f64 = 1e-9;
/// Normals are rounded to multiples of 1 over this before they are compared; sides with equal normals share vertices.
const NORMAL_STEPS: f64 = 1e6;

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

/// Number of a combination of normal, material and part of a surface; vertices are shared within one.
type Group = u32;

struct Place {
    position: DVec3,
    /// Leaves that have this vertex on their outline.
    leaves: Vec<ElementId>,
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
        let mut mesh = Mesh::new(self.transport);
        mesh.collect();
        let (count, all) = (AtomicUsize::new(0), mesh.places.len() as f64);
        let light = parallel::map_with(mesh.places.len(), Pieces::default, |pieces, i| {
            done(count.fetch_add(1, Ordering::Relaxed) as f64 / all);
            self.light_at(&mesh.places[i], pieces)
        });
        let mut light: Vec<Rgb> = light;
        mesh.lift_buried(&mut light);
        mesh.finish(&light)
    }

    /// Irradiance at one place: the mean over its leaves of what arrives along the links of the leaf and of the elements above it.
    fn light_at(&self, place: &Place, pieces: &mut Pieces) -> Rgb {
        let transport = self.transport;
        let tree = &transport.scene.tree;
        let count = place.leaves.len() as f64;
        let centre = place.leaves.iter().map(|&l| tree.elements[l as usize].polygon.centre()).sum::<DVec3>();
        let point = place.position.lerp(centre / count, INWARD);
        let mut sum = [0.0; 3];
        for &leaf in &place.leaves {
            let normal = tree.elements[leaf as usize].polygon.normal();
            let mut element = Some(leaf);
            while let Some(id) = element {
                for entry in transport.row(id) {
                    let share = transport.share_of(entry, point, normal, pieces);
                    let light = self.of_element[entry.to as usize];
                    for (s, l) in sum.iter_mut().zip(light) {
                        *s += share * l / count;
                    }
                }
                element = transport.parents[id as usize];
            }
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

/// The mesh between the leaves' vertices.
struct Mesh<'t> {
    transport: &'t Transport,
    groups: Vec<Group>,
    keys: HashMap<(u32, Group), u32>,
    places: Vec<Place>,
    /// For each leaf the places on its outline, and the place in its middle if it is drawn as a fan around it.
    rings: Vec<(ElementId, Vec<u32>, Option<u32>)>,
}

impl<'t> Mesh<'t> {
    fn new(transport: &'t Transport) -> Self {
        let mut known = HashMap::new();
        let mut of_side = vec![0; transport.scene.sides.len()];
        for element in &transport.scene.tree.elements {
            let side = &transport.scene.sides[element.side as usize];
            let normal = (element.polygon.normal() * NORMAL_STEPS).round();
            let bits = |v: [f64; 3]| v.map(|x| (x + 0.0).to_bits());
            let key = (bits(normal.to_array()), bits(side.reflectance), bits(side.emission), side.part);
            let next = known.len() as u32;
            of_side[element.side as usize] = *known.entry(key).or_insert(next);
        }
        Self { transport, groups: of_side, keys: HashMap::new(), places: vec![], rings: vec![] }
    }

    fn collect(&mut self) {
        let tree = &self.transport.scene.tree;
        for &leaf in &self.transport.leaves {
            let element = &tree.elements[leaf as usize];
            let group = self.groups[element.side as usize];
            for &corner in element.corners() {
                let next = self.places.len() as u32;
                let place = *self.keys.entry((corner, group)).or_insert(next);
                if place == next {
                    self.places.push(Place { position: tree.vertices[corner as usize], leaves: vec![] });
                }
                self.places[place as usize].leaves.push(leaf);
            }
        }
        for &leaf in &self.transport.leaves {
            let element = &tree.elements[leaf as usize];
            let group = self.groups[element.side as usize];
            let corners = element.corners();
            let mut ring = vec![];
            for (i, &corner) in corners.iter().enumerate() {
                ring.push(self.keys[&(corner, group)]);
                self.between(corner, corners[(i + 1) % corners.len()], group, leaf, &mut ring);
            }
            let middle = (ring.len() > corners.len()).then(|| {
                self.places.push(Place { position: element.polygon.centre(), leaves: vec![leaf] });
                self.places.len() as u32 - 1
            });
            self.rings.push((leaf, ring, middle));
        }
    }

    /// Appends the vertices of smaller neighbours between two corners of a leaf, in order.
    fn between(&mut self, a: u32, b: u32, group: Group, leaf: ElementId, ring: &mut Vec<u32>) {
        let Some(middle) = self.transport.scene.tree.known_middle(a, b) else { return };
        let Some(&place) = self.keys.get(&(middle, group)) else { return };
        self.between(a, middle, group, leaf, ring);
        ring.push(place);
        self.places[place as usize].leaves.push(leaf);
        self.between(middle, b, group, leaf, ring);
    }

    /// Gives covered vertices ([`BURIED`]) the mean irradiance of those of their neighbours that are not covered. Otherwise interpolation would
    /// spread the dark from under a box over the visible part of the patches that extend under it.
    fn lift_buried(&self, light: &mut [Rgb]) {
        let sum = |v: Rgb| v.iter().sum::<f64>();
        let largest = light.iter().map(|&v| sum(v)).fold(0.0, f64::max);
        let dark: Vec<bool> = light.iter().map(|&v| sum(v) <= BURIED * largest).collect();
        let mut lifted = vec![([0.0; 3], 0.0); light.len()];
        for (_, ring, _) in &self.rings {
            for &place in ring.iter().filter(|p| dark[**p as usize]) {
                for &other in ring.iter().filter(|p| !dark[**p as usize]) {
                    let (total, count) = &mut lifted[place as usize];
                    *total = add(*total, 1.0, light[other as usize]);
                    *count += 1.0;
                }
            }
        }
        for (value, (total, count)) in light.iter_mut().zip(lifted) {
            if count > 0.0 {
                *value = total.map(|t| t / count);
            }
        }
    }

    fn finish(&self, light: &[Rgb]) -> Baked {
        let scene = &self.transport.scene;
        let mut direct_of = vec![[0.0; 3]; scene.tree.elements.len()];
        for (&leaf, value) in self.transport.leaves.iter().zip(&self.transport.direct) {
            direct_of[leaf as usize] = *value;
        }
        let vertex = |place: &Place, irradiance: Rgb| {
            let element = &scene.tree.elements[place.leaves[0] as usize];
            let side = &scene.sides[element.side as usize];
            let count = place.leaves.len() as f64;
            let lamps =
                place.leaves.iter().fold([0.0; 3], |sum, &l| add(sum, 1.0 / count, direct_of[l as usize]));
            let arriving = add(irradiance, 1.0, lamps);
            let radiosity = add(side.emission, 1.0, times(side.reflectance, arriving));
            let position = scene.outward(place.position);
            BakedVertex { position, normal: element.polygon.normal(), irradiance, radiosity }
        };
        let vertices = self.places.iter().zip(light).map(|(place, &light)| vertex(place, light)).collect();
        let mut triangles = vec![];
        for (leaf, ring, middle) in &self.rings {
            let side = &scene.sides[scene.tree.elements[*leaf as usize].side as usize];
            let mut push = |vertices: [u32; 3]| {
                // The middle of an edge too short to be divided rounds to one of its ends: no triangle.
                let [a, b, c] = vertices;
                if a == b || b == c || c == a {
                    return;
                }
                triangles.push(BakedTriangle { vertices, surface: side.surface as u32, back: side.back });
            };
            match middle {
                Some(middle) => {
                    for i in 0..ring.len() {
                        push([*middle, ring[i], ring[(i + 1) % ring.len()]]);
                    }
                }
                None => (1..ring.len() - 1).for_each(|i| push([ring[0], ring[i], ring[i + 1]])),
            }
        }
        Baked { vertices, triangles }
    }
}
