//! The mesh between the vertices of patches, on which light is baked.

use std::collections::HashMap;

use glam::DVec3;

use crate::bake::{Baked, BakedTriangle, BakedVertex, INWARD};
use crate::by_rays::surroundings::Surroundings;
use crate::rgb::{Rgb, add, times};
use crate::scene::Scene;
use crate::tree::ElementId;

/// A vertex whose irradiance is below this share of the largest counts as covered, such as one of the floor under a box.
const BURIED: f64 = 1e-9;
/// Normals are rounded to multiples of 1 over this before they are compared; sides with equal normals share vertices.
const NORMAL_STEPS: f64 = 1e6;
/// Cosine of the angle up to which facets of a curved surface share vertices: 35 degrees, which smooths columns of 12 sides.
const SMOOTH: f64 = 0.819;
/// Patches lie in one plane if the cosine of the angle between them is above this.
const FLAT: f64 = 1.0 - 1e-9;

/// Whether patches that meet at a small angle share vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Facets<'a> {
    /// Only patches of one part of a plane do.
    Apart,
    /// Those of a curved surface do, too, at a vertex with the mean of their normals, and parts of a plane unless something stands between them.
    Joined(&'a Surroundings),
}

/// Number of a combination of normal, material and part of a surface; vertices are shared within one.
type Group = u32;

/// A vertex.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) position: DVec3,
    /// Leaves that have this vertex on their outline.
    pub(crate) leaves: Vec<ElementId>,
    /// Whether something stands there between these and others in the same plane, which have a vertex of their own at this position.
    pub(crate) parted: bool,
}

impl Place {
    const fn new(position: DVec3, leaves: Vec<ElementId>) -> Self {
        Self { position, leaves, parted: false }
    }
}

/// The mesh between the leaves' vertices.
pub(crate) struct Mesh<'t> {
    scene: &'t Scene,
    leaves: &'t [ElementId],
    facets: Facets<'t>,
    groups: Vec<Group>,
    keys: HashMap<(u32, Group), u32>,
    pub(crate) places: Vec<Place>,
    /// For each leaf the places on its outline, and the place in its middle if it is drawn as a fan around it.
    pub(crate) rings: Vec<(ElementId, Vec<u32>, Option<u32>)>,
}

impl<'t> Mesh<'t> {
    pub(crate) fn new(scene: &'t Scene, leaves: &'t [ElementId], facets: Facets<'t>) -> Self {
        let mut known = HashMap::new();
        let mut of_side = vec![0; scene.sides.len()];
        for &leaf in leaves {
            let element = &scene.tree.elements[leaf as usize];
            let side = &scene.sides[element.side as usize];
            let normal = (element.polygon.normal() * NORMAL_STEPS).round();
            let bits = |v: [f64; 3]| v.map(|x| (x + 0.0).to_bits());
            let key = (bits(normal.to_array()), bits(side.reflectance), bits(side.emission), side.part);
            let next = known.len() as u32;
            of_side[element.side as usize] = *known.entry(key).or_insert(next);
        }
        let mut mesh = Self {
            scene,
            leaves,
            facets,
            groups: of_side,
            keys: HashMap::new(),
            places: vec![],
            rings: vec![],
        };
        mesh.collect();
        if let Facets::Joined(around) = facets {
            mesh.join(around);
        }
        mesh.outline();
        mesh
    }

    /// The mean of the normals of the patches around a place.
    pub(crate) fn normal(&self, place: &Place) -> DVec3 {
        let of = |&leaf: &ElementId| self.scene.tree.elements[leaf as usize].polygon.normal();
        let first = of(&place.leaves[0]);
        place.leaves.iter().map(of).sum::<DVec3>().try_normalize().unwrap_or(first)
    }

    fn group(&self, leaf: ElementId) -> Group {
        self.groups[self.scene.tree.elements[leaf as usize].side as usize]
    }

    /// A place for every corner of every group.
    fn collect(&mut self) {
        let tree = &self.scene.tree;
        for &leaf in self.leaves {
            let group = self.group(leaf);
            for &corner in tree.elements[leaf as usize].corners() {
                let next = self.places.len() as u32;
                let place = *self.keys.entry((corner, group)).or_insert(next);
                if place == next {
                    self.places.push(Place::new(tree.vertices[corner as usize], vec![]));
                }
                self.places[place as usize].leaves.push(leaf);
            }
        }
    }

    /// Groups of one material that meet at a corner at a small angle get one place there, unless something stands between them.
    fn join(&mut self, around: &Surroundings) {
        let mut corners: Vec<(u32, Group, u32)> = self.keys.iter().map(|(&(c, g), &p)| (c, g, p)).collect();
        corners.sort_unstable();
        let mut moved: Vec<u32> = (0..self.places.len() as u32).collect();
        for at_corner in corners.chunk_by(|a, b| a.0 == b.0) {
            // The first place of each surface that is kept, with its normal and its material.
            let mut kept: Vec<(u32, DVec3, [Rgb; 2])> = vec![];
            for &(.., place) in at_corner {
                let element = &self.scene.tree.elements[self.places[place as usize].leaves[0] as usize];
                let side = &self.scene.sides[element.side as usize];
                let (normal, material) = (element.polygon.normal(), [side.reflectance, side.emission]);
                let near = kept.iter().filter(|k| k.1.dot(normal) > SMOOTH && k.2 == material);
                let parted: Vec<u32> =
                    near.clone().map(|k| k.0).filter(|&k| self.is_parted(k, place, around)).collect();
                match near.map(|k| k.0).find(|k| !parted.contains(k)) {
                    Some(other) => moved[place as usize] = other,
                    None => {
                        kept.push((place, normal, material));
                        let all = parted.iter().chain(parted.first().map(|_| &place));
                        all.for_each(|&p| self.places[p as usize].parted = true);
                    }
                }
            }
        }
        self.keys.values_mut().for_each(|place| *place = moved[*place as usize]);
        for (place, &to) in moved.iter().enumerate() {
            if to as usize != place {
                let leaves = std::mem::take(&mut self.places[place].leaves);
                self.places[to as usize].leaves.extend(leaves);
            }
        }
        self.pack();
    }

    /// Whether something stands between the patches of two places at one corner, which lie in one plane: a little above them, the way from a place within the ones to
    /// one within the others is blocked.
    fn is_parted(&self, a: u32, b: u32, around: &Surroundings) -> bool {
        let of = |leaf: &ElementId| &self.scene.tree.elements[*leaf as usize].polygon;
        let [a, b] = [a, b].map(|place| &self.places[place as usize]);
        let normal = of(&a.leaves[0]).normal();
        if of(&b.leaves[0]).normal().dot(normal) < FLAT {
            return false;
        }
        let inward = |place: &Place| {
            let centre =
                place.leaves.iter().map(|l| of(l).centre()).sum::<DVec3>() / place.leaves.len() as f64;
            (centre - place.position) * INWARD
        };
        let ways = [inward(a), inward(b)];
        let above = normal * (0.5 * ways[0].length().min(ways[1].length()));
        around.is_blocked(a.position + ways[0] + above, b.position + ways[1] + above)
    }

    /// Leaves out places that no patch has any more.
    fn pack(&mut self) {
        let mut number = vec![0; self.places.len()];
        let mut next = 0;
        for (place, number) in self.places.iter().zip(&mut number) {
            *number = next;
            next += u32::from(!place.leaves.is_empty());
        }
        self.places.retain(|place| !place.leaves.is_empty());
        self.keys.values_mut().for_each(|place| *place = number[*place as usize]);
    }

    /// The places around every leaf.
    fn outline(&mut self) {
        for &leaf in self.leaves {
            let element = &self.scene.tree.elements[leaf as usize];
            let group = self.group(leaf);
            let corners = element.corners();
            let mut ring = vec![];
            for (i, &corner) in corners.iter().enumerate() {
                ring.push(self.keys[&(corner, group)]);
                self.between(corner, corners[(i + 1) % corners.len()], group, leaf, &mut ring);
            }
            let middle = (ring.len() > corners.len()).then(|| {
                self.places.push(Place::new(element.polygon.centre(), vec![leaf]));
                self.places.len() as u32 - 1
            });
            self.rings.push((leaf, ring, middle));
        }
    }

    /// Appends the vertices of smaller neighbours between two corners of a leaf, in order.
    fn between(&mut self, a: u32, b: u32, group: Group, leaf: ElementId, ring: &mut Vec<u32>) {
        let Some(middle) = self.scene.tree.known_middle(a, b) else { return };
        let Some(&place) = self.keys.get(&(middle, group)) else { return };
        self.between(a, middle, group, leaf, ring);
        ring.push(place);
        self.places[place as usize].leaves.push(leaf);
        self.between(middle, b, group, leaf, ring);
    }

    /// Gives covered vertices ([`BURIED`]) the mean irradiance of those of their neighbours that are not covered. Otherwise interpolation would
    /// spread the dark from under a box over the visible part of the patches that extend under it.
    pub(crate) fn lift_buried(&self, light: &mut [Rgb]) {
        let sum = |v: Rgb| v.iter().sum::<f64>();
        let largest = light.iter().map(|&v| sum(v)).fold(0.0, f64::max);
        let dark: Vec<bool> = light.iter().map(|&v| sum(v) <= BURIED * largest).collect();
        self.lift(&dark, light);
    }

    /// Gives the `dark` places the mean irradiance of those of their neighbours that are not.
    pub(crate) fn lift(&self, dark: &[bool], light: &mut [Rgb]) {
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

    /// The mesh with this irradiance at its places; `direct` is that of lamps on patches, in the order of the leaves.
    pub(crate) fn finish(&self, direct: &[Rgb], light: &[Rgb]) -> Baked {
        let scene = self.scene;
        let mut direct_of = vec![[0.0; 3]; scene.tree.elements.len()];
        for (&leaf, value) in self.leaves.iter().zip(direct) {
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
            let normal = match self.facets {
                Facets::Apart => element.polygon.normal(),
                Facets::Joined(_) => self.normal(place),
            };
            BakedVertex { position, normal, irradiance, radiosity }
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
