//! For which objects light was baked: the light of a scene fits one that has other objects besides.

use pointillist_render::Mesh;
use pointillist_render::fingerprint::{ObjectTriangles, of_objects};
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, VecDeque};
use std::ops::Range;

/// The triangles of one object, as files of baked light tell of them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BakedObject {
    /// Stands for where they are.
    pub geometry: String,
    /// How many there are.
    pub triangles: u32,
}

impl BakedObject {
    fn new(object: &ObjectTriangles) -> Self {
        Self { geometry: format!("{:016x}", object.fingerprint), triangles: object.triangles.len() as u32 }
    }

    /// The objects of a scene, in the order of their triangles.
    pub fn all_of(mesh: &Mesh) -> Vec<Self> {
        of_objects(mesh).iter().map(Self::new).collect()
    }
}

/// For each triangle that light was baked for, its number in this scene; `None` if not all of the objects are there, or it is not known for which light
/// was baked. Equal objects are taken in the order of their triangles.
pub(crate) fn find_baked(baked: &[BakedObject], mesh: &Mesh) -> Option<Vec<u32>> {
    if baked.is_empty() {
        return None;
    }
    let mut there: HashMap<BakedObject, VecDeque<Range<u32>>> = HashMap::new();
    for object in of_objects(mesh) {
        there.entry(BakedObject::new(&object)).or_default().push_back(object.triangles);
    }
    let mut numbers = vec![];
    for object in baked {
        numbers.extend(there.get_mut(object)?.pop_front()?);
    }
    Some(numbers)
}
