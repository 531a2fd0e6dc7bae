//! A scene with links by rays.

use super::emitters::Emitters;
use super::links::{Links, NONE};
use super::options::RayOptions;
use super::surroundings::{LIFT, Surroundings};
use crate::error::RadiosityError;
use crate::rays::sequence::shift_of;
use crate::rgb::{Rgb, add, replace_direct};
use crate::scene::Scene;
use crate::tree::ElementId;
use pointillist_parallel as parallel;

/// Patches with all links along the scene's longest side, unless said otherwise.
const ACROSS: f64 = 64.0;

/// A scene with links from each patch to those that its rays meet, and its direct light.
///
/// Links depend on the geometry alone: [`RayTransport::set_material`] and [`RayTransport::set_direct`] leave them as they are.
#[derive(Clone, Debug)]
pub struct RayTransport {
    pub(crate) scene: Scene,
    pub(crate) leaves: Vec<ElementId>,
    pub(crate) around: Surroundings,
    pub(crate) links: Links,
    pub(crate) emitters: Emitters,
    /// Irradiance of each patch by lamps, and by emitters.
    pub(crate) direct: Vec<Rgb>,
    pub(crate) emitted: Vec<Rgb>,
    pub(crate) options: RayOptions,
}

/// What a scene in clusters consists of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RayCounts {
    /// Patches.
    pub patches: usize,
    /// Links from patches to patches.
    pub links: usize,
    /// Rays that left the scene, or met a black back.
    pub lost: usize,
}

impl Scene {
    /// Links by rays, for scenes of too many surfaces to look at in pairs: each patch is linked to those that rays from it meet. `direct` is the irradiance of each patch by lamps, as [`Scene::direct`] gives
    /// it, or empty for none. `done` is told the share of the work that is done (0 to 1).
    ///
    /// # Errors
    /// [`RadiosityError::CountMismatch`] and [`RadiosityError::DirectIrradiance`] for `direct`, [`RadiosityError::Option`].
    pub fn transport_by_rays(
        self,
        direct: &[Rgb],
        options: &RayOptions,
        done: &(dyn Fn(f64) + Sync),
    ) -> Result<RayTransport, RadiosityError> {
        options.check()?;
        let leaves = self.tree.leaves();
        let mut all = vec![[0.0; 3]; leaves.len()];
        replace_direct(&mut all, direct)?;
        let around = Surroundings::new(&self, &leaves);
        let size = if options.size > 0.0 { options.size * self.scale } else { 1.0 / ACROSS };
        let links = Links::new(&self, &around, &leaves, (size * size, options.links), done);
        let mut transport = RayTransport {
            scene: self,
            leaves,
            around,
            links,
            emitters: Emitters::default(),
            direct: all,
            emitted: vec![],
            options: *options,
        };
        transport.light_by_emitters();
        Ok(transport)
    }
}

impl RayTransport {
    /// The scene.
    #[must_use]
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What there is.
    #[must_use]
    pub fn counts(&self) -> RayCounts {
        let lost = self.links.hits.iter().filter(|&&hit| hit == NONE).count();
        let links = self.links.hits.len() - lost;
        RayCounts { patches: self.leaves.len(), links, lost }
    }

    /// Irradiance of each patch by lamps, in their order.
    #[must_use]
    pub fn direct(&self) -> &[Rgb] {
        &self.direct
    }

    /// Calls `f` with patch, other patch and form factor from the first to the second: the share of its rays that meet the other.
    pub fn factors(&self, mut f: impl FnMut(usize, usize, f64)) {
        for patch in 0..self.leaves.len() {
            let mut row: Vec<u32> = self.links.row(patch).to_vec();
            row.sort_unstable();
            for met in row.chunk_by(|a, b| a == b).filter(|met| met[0] != NONE) {
                f(patch, met[0] as usize, met.len() as f64 / row.len() as f64);
            }
        }
    }

    /// Replaces the direct light: the irradiance of each patch, in their order, or empty for none.
    ///
    /// # Errors
    /// [`RadiosityError::CountMismatch`] and [`RadiosityError::DirectIrradiance`]; then nothing is changed.
    pub fn set_direct(&mut self, direct: &[Rgb]) -> Result<(), RadiosityError> {
        replace_direct(&mut self.direct, direct)
    }

    /// Gives a surface another reflectance and emission. Links stay; what emitters give is found anew only if the emission changes.
    ///
    /// # Errors
    /// As [`Scene::set_material`]; then nothing is changed.
    pub fn set_material(
        &mut self,
        surface: usize,
        reflectance: Rgb,
        emission: Rgb,
    ) -> Result<(), RadiosityError> {
        if self.scene.set_material(surface, reflectance, emission)? {
            self.light_by_emitters();
        }
        Ok(())
    }

    /// The scene as vertices see it, and the direct light of each of its elements that is a leaf: patches that were divided at shadow edges are whole again, since what other surfaces give
    /// has no edge there.
    pub(crate) fn for_vertices(&self) -> (Scene, Vec<Rgb>) {
        let mut of_element = vec![[0.0; 3]; self.scene.tree.elements.len()];
        self.leaves.iter().zip(&self.direct).for_each(|(&leaf, light)| of_element[leaf as usize] = *light);
        let mut scene = self.scene.clone();
        let size = scene.options.patch * scene.scale;
        scene.tree.merge(size, scene.options.sliver(size));
        let mut direct = vec![[0.0; 3]; of_element.len()];
        for whole in scene.tree.leaves() {
            let area = |id: ElementId| self.scene.tree.elements[id as usize].polygon.area();
            let mut sum = [0.0; 3];
            let mut add_part = |part: ElementId| sum = add(sum, area(part), of_element[part as usize]);
            self.scene.tree.leaves_below(whole, &mut add_part);
            direct[whole as usize] = sum.map(|s| s / area(whole));
        }
        (scene, direct)
    }

    fn light_by_emitters(&mut self) {
        self.emitters = Emitters::new(&self.scene);
        self.emitted = parallel::map_heavy(self.leaves.len(), |i| {
            let polygon = &self.scene.tree.elements[self.leaves[i] as usize].polygon;
            self.emitters.on(&self.around, polygon, LIFT, shift_of(i as u64 ^ 0x5eed))
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
