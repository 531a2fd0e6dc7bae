//! What the places on the outlines of the same patches have seen.

use super::gather::Gathered;
use super::parts::Parts;
use crate::mesh::Mesh;
use crate::scene::Scene;

/// Finds the neighbours of places of a mesh.
pub(crate) struct Neighbours<'m> {
    mesh: &'m Mesh<'m>,
    /// Index of each leaf's outline.
    outlines: Vec<u32>,
}

impl<'m> Neighbours<'m> {
    pub(crate) fn new(scene: &Scene, mesh: &'m Mesh<'m>) -> Self {
        let mut outlines = vec![0; scene.tree.elements.len()];
        mesh.rings.iter().enumerate().for_each(|(i, (leaf, ..))| outlines[*leaf as usize] = i as u32);
        Self { mesh, outlines }
    }

    /// All parts that neighbours of a place have seen, one that shares two patches twice; what the place itself has seen if it has no neighbours.
    pub(crate) fn parts(&self, place: usize, gathered: &[Gathered]) -> Parts {
        let mut all = Parts::default();
        let mut any = false;
        for &leaf in &self.mesh.places[place].leaves {
            let (_, ring, middle) = &self.mesh.rings[self.outlines[leaf as usize] as usize];
            for &other in ring.iter().chain(middle).filter(|&&other| other as usize != place) {
                all.join(&gathered[other as usize].parts);
                any = true;
            }
        }
        if any { all } else { gathered[place].parts }
    }
}
