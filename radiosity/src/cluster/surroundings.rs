//! Which patch a ray meets.

use std::collections::HashMap;

use glam::DVec3;

use crate::polygon::{Polygon, edges};
use crate::rays::tree::{Hit, RayTree};
use crate::scene::Scene;
use crate::tree::ElementId;

/// No patch: a black back.
const NOTHING: ElementId = u32::MAX;
/// Rays start this far off their surface; the scene's longest side is between ½ and 1.
pub(crate) const LIFT: f64 = 1e-6;
/// Roots on both sides of a surface are one another's back if their centres are closer than 1 over this.
const CENTRE_STEPS: f64 = 1e9;

/// A scene for rays.
#[derive(Clone, Debug)]
pub(crate) struct Surroundings {
    tree: RayTree,
    /// Roots of the patches on the front and on the back of each tag.
    sides: Vec<[ElementId; 2]>,
}

impl Surroundings {
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut of_surface: HashMap<usize, [Vec<ElementId>; 2]> = HashMap::new();
        for &root in &scene.tree.roots {
            let side = &scene.sides[scene.tree.elements[root as usize].side as usize];
            of_surface.entry(side.surface).or_default()[usize::from(side.back)].push(root);
        }
        let (mut triangles, mut sides) = (vec![], vec![]);
        for (occluder, surface) in scene.occluders.iter().zip(&scene.surface_of) {
            let empty = [vec![], vec![]];
            let [front, back] = of_surface.get(surface).unwrap_or(&empty);
            let root = |list: &[ElementId]| list.first().copied().unwrap_or(NOTHING);
            if front.len() <= 1 && back.len() <= 1 {
                push(occluder, sides.len(), &mut triangles);
                sides.push([root(front), root(back)]);
                continue;
            }
            let key = |root: &ElementId| {
                let centre = scene.tree.elements[*root as usize].polygon.centre();
                (centre * CENTRE_STEPS).round().to_array().map(|x| x as i64)
            };
            let backs: HashMap<[i64; 3], ElementId> = back.iter().map(|r| (key(r), *r)).collect();
            for one in front {
                push(&scene.tree.elements[*one as usize].polygon, sides.len(), &mut triangles);
                sides.push([*one, backs.get(&key(one)).copied().unwrap_or(NOTHING)]);
            }
        }
        Self { tree: RayTree::new(&triangles), sides }
    }

    /// The patch that a ray meets first: `None` where it leaves the scene, an inner `None` where it meets a black back. Patches are
    /// divided as far as `elements` below this number say.
    pub(crate) fn patch(&self, scene: &Scene, elements: usize, origin: DVec3, direction: DVec3) -> Option<(Option<ElementId>, f64)> {
        let hit = self.tree.nearest(origin, direction, f64::INFINITY)?;
        let Hit { tag, front, distance } = hit;
        let root = self.sides[tag as usize][usize::from(!front)];
        if root == NOTHING {
            return Some((None, distance));
        }
        Some((Some(below(scene, elements, root, origin + direction * distance)), distance))
    }

    /// Whether something is between two points; surfaces that hold one of them are not.
    pub(crate) fn is_blocked(&self, from: DVec3, to: DVec3) -> bool {
        self.tree.is_blocked(from, to - from, 1.0 - 1e-6)
    }

    /// Whether something is in a direction, however far away.
    pub(crate) fn is_shaded(&self, from: DVec3, direction: DVec3) -> bool {
        self.tree.is_blocked(from, direction, f64::INFINITY)
    }
}

fn push(polygon: &Polygon, tag: usize, triangles: &mut Vec<([DVec3; 3], u32)>) {
    let ring = polygon.vertices();
    triangles.extend((1..ring.len() - 1).map(|i| ([ring[0], ring[i], ring[i + 1]], tag as u32)));
}

/// The patch below an element that holds a point of it.
fn below(scene: &Scene, elements: usize, mut id: ElementId, point: DVec3) -> ElementId {
    let all = &scene.tree.elements;
    loop {
        let element = &all[id as usize];
        if element.is_leaf() || element.first_child as usize >= elements {
            return id;
        }
        let depth = |child: &ElementId| inside(&all[*child as usize].polygon, point);
        id = element.children().max_by(|a, b| depth(a).total_cmp(&depth(b))).unwrap_or(id);
    }
}

/// How far inside an outline a point of its plane is; negative outside.
fn inside(polygon: &Polygon, point: DVec3) -> f64 {
    let normal = polygon.normal();
    edges(polygon.vertices()).fold(f64::INFINITY, |least, (a, b)| {
        let inward = normal.cross(b - a);
        least.min(inward.dot(point - a) / inward.length().max(f64::MIN_POSITIVE))
    })
}
