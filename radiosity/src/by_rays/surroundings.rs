//! Which patch a ray meets.
//!
//! Rays look for the undivided pieces of surfaces, which are far fewer than patches and stay in the processor's caches; the patch is then found where the piece was met,
//! down the piece's quadtree.

use std::collections::HashMap;

use glam::{DVec3, Vec4};

use super::links::NONE;
use crate::polygon::Polygon;
use crate::rays::tree::{Corners, RayTree};
use crate::scene::Scene;
use crate::tree::{Element, ElementId};

/// Rays start this far off their surface; the scene's longest side is between ½ and 1.
pub(crate) const LIFT: f64 = 1e-6;
/// Pieces on both sides of a surface are one another's back if their centres are closer than 1 over this.
const CENTRE_STEPS: f64 = 1e9;
/// Bit of what is a patch and no node of a quadtree; [`NONE`] has it, too.
const PATCH: u32 = 1 << 31;

/// A scene for rays.
#[derive(Clone, Debug)]
pub(crate) struct Surroundings {
    tree: RayTree,
    /// What is on the front and on the back of each tag: the number of a node, or a patch with the bit [`PATCH`], or [`NONE`] for a black side.
    sides: Vec<[u32; 2]>,
    nodes: Vec<Node>,
}

/// A divided piece of a side. Single precision: next to a line between two patches either is right.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Planes through the lines between children: triangles have one for each of the first three, who are on its upper side; of a quadrangle the children 1 and 2 are above the
    /// first, 2 and 3 above the second.
    lines: [Vec4; 3],
    /// As in [`Surroundings::sides`].
    children: [u32; 4],
    is_triangle: bool,
}

impl Surroundings {
    /// With the patches of a scene, which are leaves of its tree.
    pub(crate) fn new(scene: &Scene, leaves: &[ElementId]) -> Self {
        let mut number = vec![NONE; scene.tree.elements.len()];
        leaves.iter().enumerate().for_each(|(i, &leaf)| number[leaf as usize] = i as u32);
        let mut of_surface: HashMap<usize, [Vec<ElementId>; 2]> = HashMap::new();
        for &root in &scene.tree.roots {
            let side = &scene.sides[scene.tree.elements[root as usize].side as usize];
            of_surface.entry(side.surface).or_default()[usize::from(side.back)].push(root);
        }
        let mut around = Self { tree: RayTree::default(), sides: vec![], nodes: vec![] };
        let mut triangles = vec![];
        for (occluder, surface) in scene.occluders.iter().zip(&scene.surface_of) {
            let empty = [vec![], vec![]];
            let [front, back] = of_surface.get(surface).unwrap_or(&empty);
            if front.is_empty() {
                push(occluder, (around.sides.len(), false), &mut triangles);
                around.sides.push([NONE; 2]);
                continue;
            }
            let backs: HashMap<[i64; 3], ElementId> =
                back.iter().map(|&root| (key(scene, root), root)).collect();
            let matched = front.iter().filter(|&&root| backs.contains_key(&key(scene, root))).count();
            // Where both sides are in different pieces, these are seen from their own side alone.
            let apart = !back.is_empty() && (matched < front.len() || matched < back.len());
            for &root in front {
                push(
                    &scene.tree.elements[root as usize].polygon,
                    (around.sides.len(), apart),
                    &mut triangles,
                );
                let behind = backs.get(&key(scene, root)).map_or(NONE, |&b| around.entry(scene, &number, b));
                let before = around.entry(scene, &number, root);
                around.sides.push([before, behind]);
            }
            for &root in back.iter().filter(|_| apart) {
                push(
                    &scene.tree.elements[root as usize].polygon,
                    (around.sides.len(), apart),
                    &mut triangles,
                );
                let before = around.entry(scene, &number, root);
                around.sides.push([before, NONE]);
            }
        }
        around.tree = RayTree::new(&triangles);
        around
    }

    /// What stands for an element: a patch, or the node of its quadtree, which is added.
    fn entry(&mut self, scene: &Scene, number: &[u32], id: ElementId) -> u32 {
        let element = &scene.tree.elements[id as usize];
        if element.is_leaf() {
            return number[id as usize] | PATCH;
        }
        let node = self.nodes.len();
        self.nodes.push(Node::between(element));
        for (slot, child) in element.children().enumerate() {
            self.nodes[node].children[slot] = self.entry(scene, number, child);
        }
        node as u32
    }

    /// For [`Surroundings::is_blocked`] and [`Surroundings::is_shaded`] alone.
    pub(crate) fn without_patches(scene: &Scene) -> Self {
        let mut triangles = vec![];
        scene.occluders.iter().for_each(|occluder| push(occluder, (0, false), &mut triangles));
        Self { tree: RayTree::new(&triangles), sides: vec![], nodes: vec![] }
    }

    /// Index of the patch that a ray meets first, or [`NONE`] for a black back, and how far away it is; `None` where the ray leaves the scene.
    #[inline]
    pub(crate) fn patch(&self, origin: DVec3, direction: DVec3) -> Option<(u32, f64)> {
        let hit = self.tree.nearest(origin, direction, f64::INFINITY)?;
        let mut entry = self.sides[hit.tag as usize][usize::from(!hit.front)];
        if entry & PATCH == 0 {
            let at = (origin + direction * hit.distance).as_vec3().extend(1.0);
            while entry & PATCH == 0 {
                entry = self.nodes[entry as usize].child(at);
            }
        }
        Some((if entry == NONE { NONE } else { entry & !PATCH }, hit.distance))
    }

    /// Whether something is between two points; surfaces that hold the second are not.
    pub(crate) fn is_blocked(&self, from: DVec3, to: DVec3) -> bool {
        self.tree.is_blocked(from, to - from, 1.0 - 1e-6)
    }

    /// Whether something is in a direction, however far away.
    pub(crate) fn is_shaded(&self, from: DVec3, direction: DVec3) -> bool {
        self.tree.is_blocked(from, direction, f64::INFINITY)
    }
}

impl Node {
    /// The lines between the children of an element.
    fn between(element: &Element) -> Self {
        let (ring, normal) = (element.polygon.vertices(), element.polygon.normal());
        let count = ring.len();
        let middle = |i: usize| 0.5 * (ring[i % count] + ring[(i + 1) % count]);
        // Above is where a corner is.
        let line = |from: DVec3, to: DVec3, above: DVec3| {
            let across = normal.cross(to - from).normalize_or_zero();
            let plane = across.extend(-across.dot(from));
            (if across.dot(above - from) < 0.0 { -plane } else { plane }).as_vec4()
        };
        let is_triangle = count == 3;
        let lines = if is_triangle {
            [0, 1, 2].map(|i| line(middle(i), middle(i + 2), ring[i]))
        } else {
            [line(middle(0), middle(2), ring[1]), line(middle(1), middle(3), ring[2]), Vec4::ZERO]
        };
        Self { lines, children: [NONE; 4], is_triangle }
    }

    /// What stands for the child that holds a point (with 1 for its last coordinate).
    fn child(&self, at: Vec4) -> u32 {
        let above = |i: usize| self.lines[i].dot(at) > 0.0;
        let slot = if self.is_triangle {
            (0..3).find(|&i| above(i)).unwrap_or(3)
        } else {
            match (above(0), above(1)) {
                (false, false) => 0,
                (true, false) => 1,
                (true, true) => 2,
                (false, true) => 3,
            }
        };
        self.children[slot]
    }
}

/// The same for pieces on both sides of one place.
fn key(scene: &Scene, root: ElementId) -> [i64; 3] {
    (scene.tree.elements[root as usize].polygon.centre() * CENTRE_STEPS).round().to_array().map(|x| x as i64)
}

/// Adds the triangles of a polygon with a tag, and whether they are seen from the front alone.
fn push(polygon: &Polygon, (tag, from_front): (usize, bool), triangles: &mut Vec<Corners>) {
    let ring = polygon.vertices();
    let corners = |i: usize| [ring[0], ring[i], ring[i + 1]];
    triangles.extend((1..ring.len() - 1).map(|i| Corners {
        corners: corners(i),
        tag: tag as u32,
        from_front,
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SceneOptions, Surface};
    use glam::dvec3;

    /// A triangle and a crooked quadrangle, seen from above and from below: every patch is met at its centre, and by its own side.
    #[test]
    fn every_patch_is_met_at_its_centre() -> Result<(), crate::RadiosityError> {
        let flat = |x: f64, y: f64| dvec3(x, y, 0.25 * x);
        let triangle = [flat(0.0, 0.0), flat(2.0, 0.0), flat(0.3, 1.7)];
        let quadrangle = [flat(3.0, 0.0), flat(6.0, 0.4), flat(5.0, 2.0), flat(3.2, 1.0)];
        let surfaces = [triangle.to_vec(), quadrangle.to_vec()]
            .map(|ring| Surface { two_sided: true, ..Surface::new(&ring, [0.5; 3]) });
        let scene = Scene::new(&surfaces, &SceneOptions::DEFAULT.with_patch(0.2))?;
        let leaves = scene.tree.leaves();
        let around = Surroundings::new(&scene, &leaves);
        assert!(leaves.len() > 400, "{}", leaves.len());
        for (i, &leaf) in leaves.iter().enumerate() {
            let polygon = &scene.tree.elements[leaf as usize].polygon;
            let met = around.patch(polygon.centre() + polygon.normal(), -polygon.normal());
            assert_eq!(met.map(|m| m.0), Some(i as u32));
        }
        Ok(())
    }
}
