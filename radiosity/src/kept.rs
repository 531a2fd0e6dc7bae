//! Form factors of a transport that another one of nearly the same scene can keep: one moved object pays for its own links.
//!
//! A partly hidden pair exchanges what it did if both polygons and all that may be between them are the same, bit for bit. So nothing has to be said of what
//! was moved: whatever differs is found anew. Open pairs cost less than a look for them, and are always found anew.

use std::collections::HashMap;

use glam::DVec3;

use crate::link::Link;
use crate::polygon::Polygon;
use crate::scene::Scene;
use crate::transport::Transport;
use crate::tree::ElementId;

/// Bits of all corners.
type Key = Vec<[u64; 3]>;

/// The partly hidden links of a transport, to be found by what they link.
#[derive(Debug)]
pub(crate) struct Kept<'t> {
    before: &'t Transport,
    elements: HashMap<Key, ElementId>,
    links: HashMap<(ElementId, ElementId), u32>,
    /// The occluder of before for each of now.
    occluders: Vec<Option<u32>>,
}

impl<'t> Kept<'t> {
    /// None if no form factor can be the same: the scene has another size or place, by which coordinates are rounded, or was asked for another accuracy.
    pub(crate) fn new(before: &'t Transport, scene: &Scene) -> Option<Self> {
        let old = &before.scene;
        let same_frame = old.by == scene.by && old.scale == scene.scale;
        if !same_frame || old.options.factors != scene.options.factors {
            return None;
        }
        let mut elements = HashMap::new();
        let mut links = HashMap::new();
        for (number, link) in before.links.iter().enumerate().filter(|(_, l)| l.between.0 < l.between.1) {
            for element in [link.a, link.b] {
                elements.insert(key(&old.tree.elements[element as usize].polygon), element);
            }
            links.insert((link.a, link.b), number as u32);
        }
        let mut known = HashMap::new();
        for (number, occluder) in old.occluders.iter().enumerate() {
            // Of copies the first; they hide the same.
            known.entry(key(occluder)).or_insert(number as u32);
        }
        let occluders = scene.occluders.iter().map(|o| known.get(&key(o)).copied()).collect();
        Some(Self { before, elements, links, occluders })
    }

    /// The link between the same two polygons past the same occluders, in the same order.
    pub(crate) fn link(&self, a: &Polygon, b: &Polygon, between: &[u32]) -> Option<&'t Link> {
        let [a, b] = [a, b].map(|p| self.elements.get(&key(p)).copied());
        let number = *self.links.get(&(a?, b?))?;
        let link = &self.before.links[number as usize];
        let old = &self.before.between[link.between.0 as usize..link.between.1 as usize];
        let same = |(now, then): (&u32, &u32)| {
            let first = self.occluders[*now as usize];
            // A copy of an occluder is as good as the occluder.
            first == Some(*then)
                || first.is_some_and(|f| {
                    let all = &self.before.scene.occluders;
                    all[f as usize] == all[*then as usize]
                })
        };
        (old.len() == between.len() && between.iter().zip(old).all(same)).then_some(link)
    }
}

fn key(polygon: &Polygon) -> Key {
    let bits = |v: &DVec3| (*v + 0.0).to_array().map(f64::to_bits);
    polygon.vertices().iter().map(bits).collect()
}
