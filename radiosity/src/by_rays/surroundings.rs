//! Which patch a ray meets.

use std::collections::HashMap;

use glam::DVec3;

use super::links::NONE;
use crate::polygon::Polygon;
use crate::rays::tree::{Corners, RayTree};
use crate::scene::Scene;
use crate::tree::ElementId;

/// Rays start this far off their surface; the scene's longest side is between ½ and 1.
pub(crate) const LIFT: f64 = 1e-6;
/// Patches on both sides of a surface are one another's back if their centres are closer than 1 over this.
const CENTRE_STEPS: f64 = 1e9;

/// A scene for rays.
#[derive(Clone, Debug)]
pub(crate) struct Surroundings {
    tree: RayTree,
    /// Index of the patch on the front and on the back of each tag; [`NONE`] for a black back.
    sides: Vec<[u32; 2]>,
}

impl Surroundings {
    /// With the patches of a scene, which are leaves of its tree.
    pub(crate) fn new(scene: &Scene, leaves: &[ElementId]) -> Self {
        let mut number = vec![NONE; scene.tree.elements.len()];
        let mut of_surface: HashMap<usize, [Vec<ElementId>; 2]> = HashMap::new();
        for (i, &leaf) in leaves.iter().enumerate() {
            number[leaf as usize] = i as u32;
            let side = &scene.sides[scene.tree.elements[leaf as usize].side as usize];
            of_surface.entry(side.surface).or_default()[usize::from(side.back)].push(leaf);
        }
        let (mut triangles, mut sides) = (vec![], vec![]);
        for (occluder, surface) in scene.occluders.iter().zip(&scene.surface_of) {
            let empty = [vec![], vec![]];
            let [front, back] = of_surface.get(surface).unwrap_or(&empty);
            let backs: HashMap<[i64; 3], ElementId> =
                back.iter().map(|&leaf| (key(scene, leaf), leaf)).collect();
            let matched = front.iter().filter(|&&leaf| backs.contains_key(&key(scene, leaf))).count();
            if front.is_empty() {
                push(occluder, (sides.len(), false), &mut triangles);
                sides.push([NONE; 2]);
                continue;
            }
            // Where both sides are divided in different ways, patches are seen from their own side alone.
            let apart = !back.is_empty() && (matched < front.len() || matched < back.len());
            let mut add = |leaf: ElementId, of_tag: [u32; 2]| {
                push(&scene.tree.elements[leaf as usize].polygon, (sides.len(), apart), &mut triangles);
                sides.push(of_tag);
            };
            for &leaf in front {
                let behind = backs.get(&key(scene, leaf)).map_or(NONE, |&b| number[b as usize]);
                add(leaf, [number[leaf as usize], behind]);
            }
            for &leaf in back.iter().filter(|_| apart) {
                add(leaf, [number[leaf as usize], NONE]);
            }
        }
        Self { tree: RayTree::new(&triangles), sides }
    }

    /// For [`Surroundings::is_blocked`] and [`Surroundings::is_shaded`] alone.
    pub(crate) fn without_patches(scene: &Scene) -> Self {
        let mut triangles = vec![];
        scene.occluders.iter().for_each(|occluder| push(occluder, (0, false), &mut triangles));
        Self { tree: RayTree::new(&triangles), sides: vec![] }
    }

    /// Index of the patch that a ray meets first, or [`NONE`] for a black back, and how far away it is; `None` where the ray leaves the scene.
    #[inline]
    pub(crate) fn patch(&self, origin: DVec3, direction: DVec3) -> Option<(u32, f64)> {
        let hit = self.tree.nearest(origin, direction, f64::INFINITY)?;
        Some((self.sides[hit.tag as usize][usize::from(!hit.front)], hit.distance))
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

/// The same for patches on both sides of one place.
fn key(scene: &Scene, leaf: ElementId) -> [i64; 3] {
    (scene.tree.elements[leaf as usize].polygon.centre() * CENTRE_STEPS).round().to_array().map(|x| x as i64)
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
