//! A scene in clusters with their links.

use super::emitters::Emitters;
use super::groups::Groups;
use super::links::{Links, NONE};
use super::options::ClusterOptions;
use super::surroundings::{LIFT, Surroundings};
use crate::error::RadiosityError;
use crate::rays::sequence::mix;
use crate::rgb::{Rgb, add, check_direct};
use crate::scene::Scene;
use crate::tree::ElementId;
use pointillist_parallel as parallel;

/// Clusters along the scene's longest side, unless said otherwise.
const ACROSS: f64 = 64.0;

/// A scene in clusters, with the links of each cluster and its direct light.
///
/// Links depend on the geometry alone: [`Clusters::set_material`] and [`Clusters::set_direct`] leave them as they are.
#[derive(Clone, Debug)]
pub struct Clusters {
    pub(crate) scene: Scene,
    pub(crate) leaves: Vec<ElementId>,
    pub(crate) around: Surroundings,
    pub(crate) groups: Groups,
    pub(crate) links: Links,
    pub(crate) emitters: Emitters,
    /// Irradiance of each patch by lamps, and by emitters.
    pub(crate) direct: Vec<Rgb>,
    pub(crate) emitted: Vec<Rgb>,
    /// Index of each leaf among the patches, by element.
    pub(crate) number: Vec<u32>,
    pub(crate) options: ClusterOptions,
}

/// What a scene in clusters consists of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ClusterCounts {
    /// Patches.
    pub patches: usize,
    /// Clusters.
    pub clusters: usize,
    /// Links from clusters to patches.
    pub links: usize,
    /// Rays that left the scene, or met a black back.
    pub lost: usize,
}

impl Scene {
    /// Clusters with their links, for scenes of too many surfaces to look at in pairs. `direct` is the irradiance of each patch by lamps, as [`Scene::direct`] gives
    /// it, or empty for none. `done` is told the share of the work that is done (0 to 1).
    ///
    /// # Errors
    /// [`RadiosityError::CountMismatch`] and [`RadiosityError::DirectIrradiance`] for `direct`, [`RadiosityError::Option`].
    pub fn clusters(
        self,
        direct: &[Rgb],
        options: &ClusterOptions,
        done: &(dyn Fn(f64) + Sync),
    ) -> Result<Clusters, RadiosityError> {
        options.check()?;
        let leaves = self.tree.leaves();
        check_direct(leaves.len(), direct)?;
        let mut number = vec![NONE; self.tree.elements.len()];
        leaves.iter().enumerate().for_each(|(i, &leaf)| number[leaf as usize] = i as u32);
        let around = Surroundings::new(&self);
        let size = if options.size > 0.0 { options.size * self.scale } else { 1.0 / ACROSS };
        let groups = Groups::new(&self, &leaves, size);
        let links = Links::new(&self, &around, (&leaves, &number), &groups, options.links as usize, done);
        let mut all = vec![[0.0; 3]; leaves.len()];
        all[..direct.len()].copy_from_slice(direct);
        let mut clusters = Clusters {
            scene: self,
            leaves,
            around,
            groups,
            links,
            emitters: Emitters::default(),
            direct: all,
            emitted: vec![],
            number,
            options: *options,
        };
        clusters.light_by_emitters();
        Ok(clusters)
    }
}

impl Clusters {
    /// The scene.
    #[must_use]
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What there is.
    #[must_use]
    pub fn counts(&self) -> ClusterCounts {
        let lost = self.links.hits.iter().filter(|&&hit| hit == NONE).count();
        let links = self.links.hits.len() - lost;
        ClusterCounts { patches: self.leaves.len(), clusters: self.groups.len(), links, lost }
    }

    /// Irradiance of each patch by lamps, in their order.
    #[must_use]
    pub fn direct(&self) -> &[Rgb] {
        &self.direct
    }

    /// Replaces the direct light: the irradiance of each patch, in their order, or empty for none.
    ///
    /// # Errors
    /// [`RadiosityError::CountMismatch`] and [`RadiosityError::DirectIrradiance`]; then nothing is changed.
    pub fn set_direct(&mut self, direct: &[Rgb]) -> Result<(), RadiosityError> {
        check_direct(self.leaves.len(), direct)?;
        self.direct.fill([0.0; 3]);
        self.direct[..direct.len()].copy_from_slice(direct);
        Ok(())
    }

    /// Gives a surface another reflectance and emission. Links stay; what emitters give is found anew only if the emission changes.
    ///
    /// # Errors
    /// As [`Scene::set_material`]; then nothing is changed.
    pub fn set_material(&mut self, surface: usize, reflectance: Rgb, emission: Rgb) -> Result<(), RadiosityError> {
        if self.scene.set_material(surface, reflectance, emission)? {
            self.light_by_emitters();
        }
        Ok(())
    }

    fn light_by_emitters(&mut self) {
        self.emitters = Emitters::new(&self.scene);
        let unit = |bits: u64| (bits >> 40) as f64 / (1_u64 << 24) as f64;
        self.emitted = parallel::map_heavy(self.leaves.len(), |i| {
            let polygon = &self.scene.tree.elements[self.leaves[i] as usize].polygon;
            let bits = mix(i as u64 ^ 0x5eed);
            self.emitters.on(&self.around, polygon, LIFT, [unit(bits), unit(mix(bits))])
        });
    }

    /// What a patch sends out, if its cluster gathers this irradiance.
    pub(crate) fn radiosity(&self, patch: usize, gathered: Rgb) -> Rgb {
        let side = &self.scene.sides[self.scene.tree.elements[self.leaves[patch] as usize].side as usize];
        let arriving = add(add(self.direct[patch], 1.0, self.emitted[patch]), 1.0, gathered);
        crate::rgb::add(side.emission, 1.0, crate::rgb::times(side.reflectance, arriving))
    }

    /// The emission of a patch that rays leave out, since emitters are looked at one by one.
    pub(crate) fn known_emission(&self, patch: usize) -> Rgb {
        let side = self.scene.tree.elements[self.leaves[patch] as usize].side as usize;
        if self.emitters.known[side] { self.scene.sides[side].emission } else { [0.0; 3] }
    }

    pub(crate) fn reflectance(&self, patch: usize) -> Rgb {
        self.scene.sides[self.scene.tree.elements[self.leaves[patch] as usize].side as usize].reflectance
    }
}
