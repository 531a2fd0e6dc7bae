//! Patches as the caller sees them: leaves of the tree, in the scene's coordinates.

use crate::by_rays::RayTransport;
use crate::rgb::Rgb;
use crate::scene::Scene;
use crate::transport::Transport;
use crate::tree::ElementId;
use glam::DVec3;

/// One patch.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Patch {
    /// Its index in all lists about patches.
    pub index: usize,
    /// Index of the surface that it is a part of.
    pub surface: usize,
    /// Whether it is on the surface's back.
    pub back: bool,
    /// Mean of its corners, in the scene's coordinates.
    pub centre: DVec3,
    /// In squared units of the scene.
    pub area: f64,
    /// Of its surface.
    pub reflectance: Rgb,
    /// Of its surface.
    pub emission: Rgb,
}

impl Transport {
    /// How many patches there are: leaves of the tree.
    #[must_use]
    pub fn patch_count(&self) -> usize {
        self.leaves.len()
    }

    /// The patches, in the order in which all lists about patches are.
    pub fn patches(&self) -> impl Iterator<Item = Patch> + '_ {
        self.leaves.iter().enumerate().map(|(index, &leaf)| self.scene.patch(index, leaf))
    }

    /// Corners of the patches, in their order, in the scene's coordinates.
    pub fn patch_corners(&self) -> impl Iterator<Item = Vec<DVec3>> + '_ {
        let corners = |&leaf: &ElementId| {
            let ring = self.scene.tree.elements[leaf as usize].polygon.vertices();
            ring.iter().map(|&v| self.scene.outward(v)).collect()
        };
        self.leaves.iter().map(corners)
    }
}

impl RayTransport {
    /// The patches, in the order in which all lists about patches are.
    pub fn patches(&self) -> impl Iterator<Item = Patch> + '_ {
        self.leaves.iter().enumerate().map(|(index, &leaf)| self.scene.patch(index, leaf))
    }
}

impl Scene {
    fn patch(&self, index: usize, leaf: ElementId) -> Patch {
        let element = &self.tree.elements[leaf as usize];
        let side = &self.sides[element.side as usize];
        Patch {
            index,
            surface: side.surface,
            back: side.back,
            centre: self.outward(element.polygon.centre()),
            area: element.polygon.area() / (self.scale * self.scale),
            reflectance: side.reflectance,
            emission: side.emission,
        }
    }
}
